# What other projects take, as components of find_package(obscura): the program with a function that adds golden tests,
# which needs no language; the simulation, which needs Eigen; the library (obscura/obscura.h), which needs all, or as a
# shared one nothing. The library is in pkg-config, too.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# The public headers (docs/library.md), and what they include: no others are installed. obscura/obscura.h is the
# interface; those of sim are of its component; the two others are deprecated.
set(public obscura/obscura.h scene/scene.h app/film/pictures.h sim/step/run.h sim/step/stepper.h sim/step/playback.h sim/energy/energy.h)
# of a header: the beginning of a declaration, and what to use
set(deprecations
    "scene/scene.h|Scene read(|Scene::read()"
    "scene/scene.h|Scene parse(|Scene::parse()"
    "app/film/pictures.h|std::vector<Pictured> pictures(|Renderer")
if(OBSCURA_SUMS)
  list(APPEND public sim/math/sums.h sim/math/order.h)
endif()
set(waiting ${public})
set(OBSCURA_HEADERS)
while(waiting)
  list(POP_FRONT waiting header)
  if(header IN_LIST OBSCURA_HEADERS)
    continue()
  endif()
  list(APPEND OBSCURA_HEADERS ${header})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${header})
  file(STRINGS ${header} included REGEX "^#include \"")
  list(TRANSFORM included REPLACE "^#include \"([^\"]+)\".*" "\\1")
  list(APPEND waiting ${included})
endwhile()
foreach(header IN LISTS OBSCURA_HEADERS)
  get_filename_component(folder ${header} DIRECTORY)
  if(folder STREQUAL obscura)
    set(folder .)
  endif()
  set(installed ${header})
  # to those outside what is to go says its successor
  foreach(deprecation IN LISTS deprecations)
    string(REPLACE "|" ";" deprecation "${deprecation}")
    list(GET deprecation 0 of)
    if(of STREQUAL header)
      list(GET deprecation 1 declared)
      list(GET deprecation 2 successor)
      file(READ ${installed} text)
      string(REPLACE "\n${declared}" "\n[[deprecated(\"${successor}, of obscura/obscura.h\")]] ${declared}" marked "${text}")
      if(marked STREQUAL text)
        message(FATAL_ERROR "${header} does not declare ${declared}")
      endif()
      set(installed ${CMAKE_CURRENT_BINARY_DIR}/deprecated/${header})
      file(WRITE ${installed} "${marked}")
    endif()
  endforeach()
  install(FILES ${installed} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/obscura/${folder})
endforeach()

# not below an architecture's folder: a project of no language does not look there
set(OBSCURA_CMAKE_DIR lib/cmake/obscura)
set(OBSCURA_ROOMS)
foreach(room IN ITEMS obscura app scene gl page media draw sim)
  if(NOT TARGET obscura_${room})
    continue()
  endif()
  list(APPEND OBSCURA_ROOMS ${room})
  set_target_properties(obscura_${room} PROPERTIES EXPORT_NAME ${room})
  set(component Library)
  if(room STREQUAL sim)
    set(component Sim)
  endif()
  install(TARGETS obscura_${room} EXPORT obscura${component}Targets
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/obscura)
endforeach()

# the shared one asks for nothing but the header
if(OBSCURA_SHARED)
  set_target_properties(obscura_shared PROPERTIES EXPORT_NAME shared)
  target_compile_features(obscura_shared INTERFACE cxx_std_20)
  target_include_directories(obscura_shared INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  install(TARGETS obscura_shared EXPORT obscuraSharedTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
endif()

# a program that uses the headers sees Eigen as the libraries do: the second changes the size of structs
target_compile_features(obscura_sim INTERFACE cxx_std_20)
target_compile_options(obscura_sim INTERFACE $<INSTALL_INTERFACE:-ffp-contract=off>)
target_compile_definitions(obscura_sim INTERFACE $<INSTALL_INTERFACE:EIGEN_DONT_VECTORIZE>)
if(OBSCURA_SUMS)
  target_compile_definitions(obscura_sim INTERFACE $<INSTALL_INTERFACE:${OBSCURA_SUMS}>)
endif()

# sim first, as in the program (CMakeLists.txt)
target_link_options(obscura_obscura INTERFACE
                    "$<INSTALL_INTERFACE:LINKER:--whole-archive,$<TARGET_FILE:obscura::sim>,--no-whole-archive>")

# the one header is included as <obscura/obscura.h>
target_include_directories(obscura_obscura INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)

set_target_properties(obscura PROPERTIES EXPORT_NAME program)
add_executable(obscura::program ALIAS obscura)
install(TARGETS obscura EXPORT obscuraProgramTargets)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/obscura)
set(components Program Sim Library)
if(OBSCURA_SHARED)
  list(APPEND components Shared)
endif()
foreach(component IN LISTS components)
  install(EXPORT obscura${component}Targets NAMESPACE obscura:: DESTINATION ${OBSCURA_CMAKE_DIR})
endforeach()

configure_package_config_file(obscuraConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/obscuraConfig.cmake
                              INSTALL_DESTINATION ${OBSCURA_CMAKE_DIR})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/obscuraConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/obscuraConfig.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/obscuraConfigVersion.cmake golden.cmake
        DESTINATION ${OBSCURA_CMAKE_DIR})

list(TRANSFORM OBSCURA_ROOMS PREPEND "-lobscura_" OUTPUT_VARIABLE OBSCURA_LIBS)
list(JOIN OBSCURA_LIBS " " OBSCURA_LIBS)
set(OBSCURA_REQUIRES "eigen3 libpng freetype2 harfbuzz harfbuzz-subset fmt tomlplusplus libxxhash libdeflate")
if(CAIRO_FOUND)
  string(APPEND OBSCURA_REQUIRES " cairo cairo-ft cairo-pdf")
endif()
if(FONTCONFIG_FOUND)
  string(APPEND OBSCURA_REQUIRES " fontconfig")
endif()
# a definition with quotes does not outlive a shell's $(pkg-config --cflags): a header makes it
if(OBSCURA_SUMS)
  set(OBSCURA_PC_SUMS " -include sim/math/order.h")
endif()
# wherever it is installed, pkg-config looks from where the file is
file(RELATIVE_PATH OBSCURA_PC_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(obscura.pc.in ${CMAKE_CURRENT_BINARY_DIR}/obscura.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/obscura.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
if(OBSCURA_SHARED)
  configure_file(obscura-shared.pc.in ${CMAKE_CURRENT_BINARY_DIR}/obscura-shared.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/obscura-shared.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endif()
