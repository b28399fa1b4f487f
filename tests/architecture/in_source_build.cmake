# A build inside the source tree is rejected with a remedy. Tested with a copy of the top-level CMakeLists.txt.
cmake_minimum_required(VERSION 3.25)

file(REMOVE_RECURSE ${WORK})
file(COPY ${SOURCE}/CMakeLists.txt DESTINATION ${WORK})
execute_process(COMMAND ${CMAKE_COMMAND} . WORKING_DIRECTORY ${WORK}
                RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE said)
if(result EQUAL 0 OR NOT said MATCHES "out of source" OR NOT said MATCHES "rm -r CMakeCache.txt CMakeFiles")
  message(FATAL_ERROR "a build in the source tree was not refused as it should (${result}): ${said}")
endif()
file(REMOVE_RECURSE ${WORK})
