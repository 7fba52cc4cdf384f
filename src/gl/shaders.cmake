# Embeds shaders/*.vert and *.frag into obscura_gl, so that the program needs no files. Each `#include "name"` line is
# replaced by shaders/name. Run as a script (cmake -D FROM=... -D TO=... -P) it writes the source.
if(CMAKE_SCRIPT_MODE_FILE)
  file(GLOB shaders ${FROM}/*.vert ${FROM}/*.frag)
  set(source "// Written by shaders.cmake.\n#include \"gl/shaders.h\"\n\nnamespace obscura::gl {\n\nconst Shader kShaders[] = {\n")
  foreach(shader IN LISTS shaders)
    get_filename_component(name ${shader} NAME)
    file(READ ${shader} text)
    file(GLOB parts ${FROM}/*.glsl)
    foreach(part IN LISTS parts)
      get_filename_component(part_name ${part} NAME)
      file(READ ${part} part_text)
      string(REPLACE "#include \"${part_name}\"\n" "${part_text}" text "${text}")
    endforeach()
    string(APPEND source "    {\"${name}\", R\"glsl(${text})glsl\"},\n")
  endforeach()
  string(APPEND source "    {nullptr, nullptr},\n};\n\n}  // namespace obscura::gl\n")
  file(WRITE ${TO} "${source}")
  return()
endif()

file(GLOB shaders CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/shaders/*.vert ${PROJECT_SOURCE_DIR}/shaders/*.frag
     ${PROJECT_SOURCE_DIR}/shaders/*.glsl)
set(embedded ${CMAKE_CURRENT_BINARY_DIR}/gl/shaders.cpp)
add_custom_command(OUTPUT ${embedded}
  COMMAND ${CMAKE_COMMAND} -D FROM=${PROJECT_SOURCE_DIR}/shaders -D TO=${embedded} -P ${CMAKE_CURRENT_LIST_FILE}
  DEPENDS ${shaders} ${CMAKE_CURRENT_LIST_FILE} COMMENT "Embedding the shaders" VERBATIM)
target_sources(obscura_gl PRIVATE ${embedded})
