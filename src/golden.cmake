# obscura_add_golden_tests(SCENE... [ROOT DIR] [REFERENCES DIR] [ARGUMENTS ...])
#
# A test a scene, golden.NAME: its moments against references, by default in golden/ beside the scene, or
# REFERENCES/NAME-SECONDS.png. NAME is the scene's path from ROOT, by default the project's folder, without
# its ending. What fails leaves pictures, a page and JUnit's XML in golden/NAME of the build folder; ctest attaches
# the pictures.
function(obscura_add_golden_tests)
  cmake_parse_arguments(GOLDEN "" "ROOT;REFERENCES" "ARGUMENTS" ${ARGN})
  set(root ${PROJECT_SOURCE_DIR})
  if(GOLDEN_ROOT)
    get_filename_component(root ${GOLDEN_ROOT} ABSOLUTE)
  endif()
  foreach(scene IN LISTS GOLDEN_UNPARSED_ARGUMENTS)
    get_filename_component(path ${scene} ABSOLUTE)
    file(RELATIVE_PATH inside ${root} ${path})
    if(IS_ABSOLUTE "${inside}" OR inside MATCHES "^\\.\\./")
      message(FATAL_ERROR "obscura_add_golden_tests: ${path} lies outside of ${root}; say ROOT, a folder that holds it")
    endif()
    get_filename_component(stem ${path} NAME_WLE)
    get_filename_component(home ${path} DIRECTORY)
    get_filename_component(below ${inside} DIRECTORY)
    set(name ${stem})
    if(below)
      set(name ${below}/${stem})
    endif()

    # neither references nor what fails of two scenes lie in one place
    set(folder ${CMAKE_CURRENT_BINARY_DIR}/golden/${name})
    set(references)
    set(kept ${home}/golden/${stem})
    if(GOLDEN_REFERENCES)
      get_filename_component(there ${GOLDEN_REFERENCES} ABSOLUTE)
      set(kept ${there}/${name})
      set(references --references ${there}/${below})
    endif()
    get_property(other GLOBAL PROPERTY "obscura references ${kept}")
    get_property(twice GLOBAL PROPERTY "obscura golden ${folder}")
    if(twice)
      message(FATAL_ERROR "obscura_add_golden_tests: ${twice} and ${path} are both called ${name}")
    elseif(other AND NOT other STREQUAL path)
      message(FATAL_ERROR "obscura_add_golden_tests: ${other} and ${path} have the same references, ${kept}-*.png; "
                          "say ROOT, a folder that holds both")
    endif()
    set_property(GLOBAL PROPERTY "obscura references ${kept}" ${path})
    set_property(GLOBAL PROPERTY "obscura golden ${folder}" ${path})

    file(MAKE_DIRECTORY ${folder})
    add_test(NAME golden.${name}
             COMMAND $<TARGET_FILE:obscura::program> golden ${path} --root ${home} ${references} --actual ${folder}
                     --junit ${folder}/junit.xml --report ${folder}/report.html -j 1 ${GOLDEN_ARGUMENTS})
    set_tests_properties(golden.${name} PROPERTIES LABELS golden TIMEOUT 1800)
  endforeach()
endfunction()
