# Embeds keys_page.md, the words of the page of keys, into obscura_scene. Run as a script (cmake -D FROM=... -D TO=... -P)
# it writes the source.
if(CMAKE_SCRIPT_MODE_FILE)
  file(READ ${FROM} text)
  file(WRITE ${TO} "// Written by keys_page.cmake.\n#include \"scene/keys_page.h\"\n\nnamespace obscura::scene {\n\n"
                   "const char* const kKeysPageOpening = R\"page(${text})page\";\n\n}  // namespace obscura::scene\n")
  return()
endif()

set(embedded ${CMAKE_CURRENT_BINARY_DIR}/scene/keys_page_opening.cpp)
add_custom_command(OUTPUT ${embedded}
  COMMAND ${CMAKE_COMMAND} -D FROM=${CMAKE_CURRENT_SOURCE_DIR}/scene/keys_page.md -D TO=${embedded} -P ${CMAKE_CURRENT_LIST_FILE}
  DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/scene/keys_page.md ${CMAKE_CURRENT_LIST_FILE} COMMENT "Embedding the page of keys" VERBATIM)
target_sources(obscura_scene PRIVATE ${embedded})
