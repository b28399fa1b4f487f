# Rooms that read files of users: their code counts as coverage of the fuzz targets. That of the others, which compute,
# would take longer to compile and to run.
set(GLADSTONE_READING_ROOMS base setup files light optics scene vectors preparation)

# The rooms of render/ below the renderers, the renderers, and the rooms of analysis/.
set(GLADSTONE_SCENE_ROOMS base setup files light medium optics sensor scene)
set(GLADSTONE_RENDERERS rays focused_dots ideal_images)
set(GLADSTONE_ANALYSIS_ROOMS vectors preparation correlation uncertainty tracking calibration errors density stereo
    tomography)

# gladstone_room(name DEPENDS rooms... PUBLIC libraries... PRIVATE libraries...)
# A room is one library of the .cpp files (with CUDA also the .cu files) of its folder, except main.cpp; its alias is
# gladstone::name. A room that consists of headers is an INTERFACE library. DEPENDS lists the rooms that the room may
# include; a test compares it with the table of includes (tests/architecture/include_arrows.cpp).
# WITHOUT_FOLDERS: subfolders are rooms of their own.
function(gladstone_room name)
  cmake_parse_arguments(ROOM "WITHOUT_FOLDERS" "" "DEPENDS;PUBLIC;PRIVATE" ${ARGN})
  set(glob GLOB_RECURSE)
  if(ROOM_WITHOUT_FOLDERS)
    set(glob GLOB)
  endif()
  file(${glob} sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
  set(kernels "")
  if(GLADSTONE_CUDA_VERSION)
    file(${glob} kernels CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cu)
  endif()
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${CMAKE_SOURCE_DIR} OUTPUT_VARIABLE place)
  string(REPLACE ";" " " described "${name};${place};${ROOM_DEPENDS}")
  set_property(GLOBAL APPEND PROPERTY GLADSTONE_ROOM_DESCRIPTIONS "${described}")
  list(TRANSFORM ROOM_DEPENDS PREPEND gladstone::)
  if(sources OR kernels)
    add_library(gladstone_${name} STATIC ${sources} ${kernels})
    set(scope PUBLIC)
    target_link_libraries(gladstone_${name} PRIVATE ${ROOM_PRIVATE} $<BUILD_INTERFACE:gladstone_flags>)
    set_target_properties(gladstone_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON UNITY_BUILD_MODE GROUP)
    foreach(source IN LISTS sources)  # in a unity build the files of a folder are compiled together
      cmake_path(GET source PARENT_PATH folder)
      cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${CMAKE_SOURCE_DIR})
      string(REPLACE "/" "_" group ${folder})
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
    endforeach()
    if(kernels)
      target_link_libraries(gladstone_${name} PRIVATE CUDA::cudart_static)
    endif()
    if(GLADSTONE_FUZZ AND name IN_LIST GLADSTONE_READING_ROOMS)
      gladstone_watched(gladstone_${name})
    endif()
  else()
    add_library(gladstone_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  target_link_libraries(gladstone_${name} ${scope} ${ROOM_DEPENDS} ${ROOM_PUBLIC})
  target_include_directories(gladstone_${name} ${scope}
    $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}> $<BUILD_INTERFACE:${CMAKE_BINARY_DIR}/generated>
    $<INSTALL_INTERFACE:include/gladstone>)
  target_compile_features(gladstone_${name} ${scope} cxx_std_20)
  set_target_properties(gladstone_${name} PROPERTIES EXPORT_NAME ${name})
  add_library(gladstone::${name} ALIAS gladstone_${name})
  set_property(GLOBAL APPEND PROPERTY GLADSTONE_ROOMS gladstone_${name})
endfunction()

# gladstone_rooms(name rooms...): defines the target gladstone::name, which links all of these rooms.
function(gladstone_rooms name)
  list(TRANSFORM ARGN PREPEND gladstone:: OUTPUT_VARIABLE rooms)
  add_library(gladstone_${name} INTERFACE)
  target_link_libraries(gladstone_${name} INTERFACE ${rooms})
  set_target_properties(gladstone_${name} PROPERTIES EXPORT_NAME ${name})
  add_library(gladstone::${name} ALIAS gladstone_${name})
  set_property(GLOBAL APPEND PROPERTY GLADSTONE_ROOMS gladstone_${name})
endfunction()

# gladstone_watched(target): if libFuzzer is available, instruments the target for its coverage feedback.
function(gladstone_watched target)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fsanitize=fuzzer-no-link>)
  endif()
endfunction()
