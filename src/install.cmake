# What other projects take: the program, the rooms as static libraries with their headers, and three ways to
# find them: find_package(obscura), pkg-config, and a function that adds golden tests.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# The public headers (docs/library.md), and what they include: no others are installed.
set(public scene/scene.h app/film/pictures.h sim/step/run.h sim/step/stepper.h sim/step/playback.h sim/energy/energy.h)
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
  install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/obscura/${folder})
endforeach()

set(OBSCURA_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/obscura)
set(OBSCURA_ROOMS)
foreach(room IN ITEMS app scene gl page media draw sim)
  if(NOT TARGET obscura_${room})
    continue()
  endif()
  list(APPEND OBSCURA_ROOMS ${room})
  set_target_properties(obscura_${room} PROPERTIES EXPORT_NAME ${room})
  install(TARGETS obscura_${room} EXPORT obscuraTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/obscura)
endforeach()

# who uses the headers sees Eigen as the libraries do: the second changes the size of structs
target_compile_features(obscura_sim INTERFACE cxx_std_20)
target_compile_options(obscura_sim INTERFACE $<INSTALL_INTERFACE:-ffp-contract=off>)
target_compile_definitions(obscura_sim INTERFACE $<INSTALL_INTERFACE:EIGEN_DONT_VECTORIZE>)
if(OBSCURA_SUMS)
  target_compile_definitions(obscura_sim INTERFACE $<INSTALL_INTERFACE:${OBSCURA_SUMS}>)
endif()

add_library(obscura_all INTERFACE)
target_link_libraries(obscura_all INTERFACE obscura::app)
set_target_properties(obscura_all PROPERTIES EXPORT_NAME obscura)
set_target_properties(obscura PROPERTIES EXPORT_NAME program)
add_executable(obscura::program ALIAS obscura)
install(TARGETS obscura obscura_all EXPORT obscuraTargets)
install(EXPORT obscuraTargets NAMESPACE obscura:: DESTINATION ${OBSCURA_CMAKE_DIR})

configure_package_config_file(obscuraConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/obscuraConfig.cmake
                              INSTALL_DESTINATION ${OBSCURA_CMAKE_DIR})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/obscuraConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/obscuraConfig.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/obscuraConfigVersion.cmake golden.cmake
        DESTINATION ${OBSCURA_CMAKE_DIR})

list(TRANSFORM OBSCURA_ROOMS PREPEND "-lobscura_" OUTPUT_VARIABLE OBSCURA_LIBS)
list(JOIN OBSCURA_LIBS " " OBSCURA_LIBS)
set(OBSCURA_REQUIRES "eigen3 libpng freetype2 harfbuzz harfbuzz-subset fmt tomlplusplus libxxhash libdeflate libavcodec libavformat libavutil libswscale")
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
