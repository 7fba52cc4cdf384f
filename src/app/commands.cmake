# Writes the table of commands from the OBSCURA_COMMAND(place, name) of the room's files: a command is one file, and needs
# to be named nowhere else.
file(GLOB_RECURSE files CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/app/*.cpp)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${files})
set(found)
foreach(file IN LISTS files)
  file(STRINGS ${file} line REGEX "^OBSCURA_COMMAND\\([0-9]+, [a-z]+\\)")
  if(line MATCHES "^OBSCURA_COMMAND\\(([0-9]+), ([a-z]+)\\)")
    list(APPEND found "${CMAKE_MATCH_1} ${CMAKE_MATCH_2}")
  endif()
endforeach()
list(SORT found COMPARE NATURAL)
set(declared)
set(listed)
set(OBSCURA_COMMANDS)
foreach(command IN LISTS found)
  string(REGEX REPLACE ".* " "" name "${command}")
  string(APPEND declared "AddCommand add_${name};\n")
  list(APPEND listed "add_${name}")
  list(APPEND OBSCURA_COMMANDS ${name})
endforeach()
list(JOIN listed ", " listed)
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/app/commands.cpp CONTENT [=[// Written by commands.cmake.
#include "app/console/commands.h"

namespace obscura::app {

@declared@
std::span<AddCommand* const> commands() {
  static constexpr AddCommand* kAll[] = {@listed@};
  return kAll;
}

}  // namespace obscura::app
]=] @ONLY)
target_sources(obscura_app PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/app/commands.cpp)
