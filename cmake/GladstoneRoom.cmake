# gladstone_room(name DEPENDS rooms... PUBLIC libraries... PRIVATE libraries...)
# A room is one library made of the .cpp files of its folder (but main.cpp); its alias is gladstone::name.
# A room of headers alone is an INTERFACE library.
function(gladstone_room name)
  cmake_parse_arguments(ROOM "" "" "DEPENDS;PUBLIC;PRIVATE" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
  list(TRANSFORM ROOM_DEPENDS PREPEND gladstone::)
  if(sources)
    add_library(gladstone_${name} STATIC ${sources})
    set(scope PUBLIC)
    target_link_libraries(gladstone_${name} PRIVATE ${ROOM_PRIVATE} $<BUILD_INTERFACE:gladstone_flags>)
    # its files use the same names in their unnamed namespaces: they are compiled one by one, also in a unity build
    set_target_properties(gladstone_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON UNITY_BUILD OFF)
    if(GLADSTONE_FUZZ)
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

# gladstone_watched(target): where there is libFuzzer, it sees which way the target's code goes.
function(gladstone_watched target)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fsanitize=fuzzer-no-link>)
  endif()
endfunction()
