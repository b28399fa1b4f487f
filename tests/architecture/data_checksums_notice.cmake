# The checksum test detects a changed, a missing and an unlisted file: each is created in a copy of DATA under WORK.
cmake_minimum_required(VERSION 3.25)

function(expect_refusal reason)
  execute_process(COMMAND ${CMAKE_COMMAND} -DDATA=${WORK} -P ${CMAKE_CURRENT_LIST_DIR}/data_checksums.cmake
                  RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE said)
  string(REGEX REPLACE "[ \n]+" " " said "${said}")
  if(result EQUAL 0 OR NOT said MATCHES "${reason}")
    message(SEND_ERROR "expected a complaint '${reason}', got (${result}): ${said}")
  endif()
endfunction()

function(fresh_copy)
  file(REMOVE_RECURSE ${WORK})
  file(COPY ${DATA}/ DESTINATION ${WORK})
endfunction()

fresh_copy()
file(GLOB fields ${WORK}/fields/*.h5)
list(GET fields 0 field)
file(APPEND ${field} "x")
expect_refusal("differs from")

fresh_copy()
file(REMOVE ${field})
expect_refusal("which is not there")

fresh_copy()
file(WRITE ${WORK}/fields/stray.h5 "x")
expect_refusal("has no row")
file(REMOVE_RECURSE ${WORK})
