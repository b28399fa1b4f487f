# Installs the build under WORK, moves it elsewhere, builds consumer/ against it with find_package(gladstone), and runs
# it: what somebody gets who takes the libraries without the source tree.
cmake_minimum_required(VERSION 3.25)

function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${what} failed (${result}):\n${said}")
  endif()
  set(said "${said}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
run("installing" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
file(RENAME ${WORK}/prefix ${WORK}/moved)

# nothing of the tree it came from
file(GLOB_RECURSE package ${WORK}/moved/lib*/cmake/*.cmake)
foreach(file IN LISTS package)
  file(READ ${file} text)
  foreach(place IN ITEMS ${SOURCE} ${BUILD})
    string(FIND "${text}" "${place}" at)
    if(NOT at EQUAL -1)
      message(FATAL_ERROR "${file} names ${place}")
    endif()
  endforeach()
endforeach()

run("configuring the consumer" ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/consumer -B ${WORK}/build
    -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${WORK}/moved -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS})
run("building the consumer" ${CMAKE_COMMAND} --build ${WORK}/build)
run("running the consumer" ${WORK}/build/consumer)
set(expected "gladstone ${VERSION}, f = 0.105 m, rms = 3.53553 px\n")  # sqrt((3^2 + 4^2)/2)
if(NOT said STREQUAL expected)
  message(FATAL_ERROR "the consumer printed '${said}', expected '${expected}'")
endif()
if(EXISTS ${WORK}/moved/bin/gladstone)
  run("running the installed program" ${WORK}/moved/bin/gladstone --version)
endif()
file(REMOVE_RECURSE ${WORK})
