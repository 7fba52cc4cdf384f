# obscura_add_golden_tests(SCENE... [REFERENCES DIR] [ARGUMENTS ...])
#
# A test a scene, golden.NAME: its moments against references, by default in golden/ beside the scene. What
# fails leaves pictures, a page and JUnit's XML in golden/ of the build folder; ctest attaches the pictures.
function(obscura_add_golden_tests)
  cmake_parse_arguments(GOLDEN "" "REFERENCES" "ARGUMENTS" ${ARGN})
  foreach(scene IN LISTS GOLDEN_UNPARSED_ARGUMENTS)
    get_filename_component(path ${scene} ABSOLUTE)
    get_filename_component(name ${scene} NAME_WLE)
    set(folder ${CMAKE_CURRENT_BINARY_DIR}/golden/${name})
    file(MAKE_DIRECTORY ${folder})
    set(references)
    if(GOLDEN_REFERENCES)
      get_filename_component(there ${GOLDEN_REFERENCES} ABSOLUTE)
      set(references --references ${there})
    endif()
    add_test(NAME golden.${name}
             COMMAND $<TARGET_FILE:obscura::program> golden ${path} ${references} --actual ${folder}
                     --junit ${folder}/junit.xml --report ${folder}/report.html -j 1 ${GOLDEN_ARGUMENTS})
    set_tests_properties(golden.${name} PROPERTIES LABELS golden TIMEOUT 600)
  endforeach()
endfunction()
