# Installs the build under WORK, moves it elsewhere, builds consumer/ against it with find_package(gladstone), and runs
# it. Then renders, correlates and compares a small case with the installed program and its data: what users get who
# have no source tree.
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

# the consumer has no command line and reads no case: libraries that only studies use are not required
run("configuring the consumer" ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/consumer -B ${WORK}/build
    -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${WORK}/moved -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS}
    -DCMAKE_DISABLE_FIND_PACKAGE_CLI11=ON -DCMAKE_DISABLE_FIND_PACKAGE_spdlog=ON
    -DCMAKE_DISABLE_FIND_PACKAGE_nlohmann_json=ON)
run("building the consumer" ${CMAKE_COMMAND} --build ${WORK}/build)
run("running the consumer" ${WORK}/build/consumer)
set(expected "gladstone ${VERSION}: 64 x 64 px; theory follows the rays, correlation follows them\n")
if(NOT said STREQUAL expected)
  message(FATAL_ERROR "the consumer printed '${said}', expected '${expected}'")
endif()
if(NOT EXISTS ${WORK}/moved/bin/gladstone)
  file(REMOVE_RECURSE ${WORK})
  return()
endif()

# a case of the installed folder, whose field is a file of this folder
set(program ${WORK}/moved/bin/gladstone)
set(share ${WORK}/moved/share/gladstone)
run("rendering" ${program} render ${share}/studies/cases/table1.toml -o ${WORK}/case --set "camera.pixels=[64, 64]"
    --set "render.rays_per_dot=32" --set "correlate.window_px=[32, 16]")
file(READ ${WORK}/case/setup.toml setup)
string(FIND "${setup}" "${share}/data/fields/" at)
if(at EQUAL -1)
  message(FATAL_ERROR "the case does not use the field of the installed folder:\n${setup}")
endif()
run("correlating" ${program} correlate ${WORK}/case)
run("comparing" ${program} compare ${WORK}/case --no-figures)
file(READ ${WORK}/case/errors.json errors)
string(JSON rms_px GET "${errors}" ray_truth rms_px)
if(NOT rms_px LESS 0.5)  # vectors of 32 px windows: a fraction of a pixel
  message(FATAL_ERROR "the vectors differ from the rays by ${rms_px} px")
endif()

# The demo finds its case and fields beside the installed program. It stops when the first scene is built.
file(WRITE ${WORK}/start_demo.sh [[
GLADSTONE_STOP_AT=rendering "$1" demo -o "$2" &
demo=$!
while read -r stat < /proc/$demo/stat; do
  case "${stat##*) }" in
    T*) kill -9 $demo; exit 0 ;;
    Z*) exit 1 ;;
  esac
  sleep 0.1
done
exit 1
]])
run("starting the demo" sh ${WORK}/start_demo.sh ${program} ${WORK}/demo)

# A program without these folders does not use those of the source tree.
file(COPY ${program} DESTINATION ${WORK}/alone/bin)
execute_process(COMMAND ${WORK}/alone/bin/gladstone demo -o ${WORK}/demo_alone
                RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE said)
if(result EQUAL 0 OR NOT said MATCHES "${WORK}/alone/share/gladstone")
  message(FATAL_ERROR "the demo of an incomplete installation did not fail as it should (${result}): ${said}")
endif()
file(REMOVE_RECURSE ${WORK})
