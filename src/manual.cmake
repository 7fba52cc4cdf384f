# What the program says of itself, installed where systems look for it: a manual page of the program and one of each
# command, and what completes its lines in bash, zsh and fish. `obscura docs` writes them from the tables of --help.
if(CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR)
  message(STATUS "Without manual pages: the program that writes them does not run here")
  return()
endif()
set(OBSCURA_ZSH_DIR ${CMAKE_INSTALL_DATADIR}/zsh/site-functions CACHE STRING "Where zsh finds what completes lines")

set(written)
function(obscura_written file)
  set(file ${CMAKE_CURRENT_BINARY_DIR}/manual/${file})
  add_custom_command(OUTPUT ${file} COMMAND obscura docs ${ARGN} > ${file}.new
                     COMMAND ${CMAKE_COMMAND} -E rename ${file}.new ${file} DEPENDS obscura VERBATIM)
  set(written ${written} ${file} PARENT_SCOPE)
endfunction()

file(MAKE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/manual/man1)
obscura_written(man1/obscura.1 man)
foreach(name IN LISTS OBSCURA_COMMANDS)
  obscura_written(man1/obscura-${name}.1 man ${name})
endforeach()
obscura_written(obscura bash)
obscura_written(_obscura zsh)
obscura_written(obscura.fish fish)
add_custom_target(obscura_manual ALL DEPENDS ${written})

set(manual ${CMAKE_CURRENT_BINARY_DIR}/manual)
install(DIRECTORY ${manual}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} FILES_MATCHING PATTERN "*.1")
install(FILES ${manual}/obscura DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${manual}/_obscura DESTINATION ${OBSCURA_ZSH_DIR})
install(FILES ${manual}/obscura.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
