# Language standard, build type, flags and output folders of all targets.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()
# CMake reads the commit that the program writes into its files when it runs, so that it must run after every commit.
if(EXISTS ${CMAKE_SOURCE_DIR}/.git/logs/HEAD)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/.git/logs/HEAD)
endif()

# Libraries that a program does not call are not loaded.
add_link_options($<$<PLATFORM_ID:Linux>:LINKER:--as-needed>)

# Flags that change results or the layout of Eigen's types: equal for the libraries and for all users of their headers.
set(GLADSTONE_USAGE_FLAGS -fno-math-errno)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND GLADSTONE_ARCHITECTURE)
  list(APPEND GLADSTONE_USAGE_FLAGS -march=${GLADSTONE_ARCHITECTURE})
endif()

# For our own targets only. Files that are compiled together may use the same names.
add_library(gladstone_flags INTERFACE)
target_compile_options(gladstone_flags INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic ${GLADSTONE_USAGE_FLAGS}
  $<$<NOT:$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>>:-Wshadow>>)
# Device code calls the constexpr functions of the shared headers.
list(JOIN GLADSTONE_USAGE_FLAGS "," usage_flags)
target_compile_options(gladstone_flags INTERFACE
  $<$<COMPILE_LANGUAGE:CUDA>:--expt-relaxed-constexpr -Xcompiler=-Wall,-Wextra,${usage_flags}>)
if(GLADSTONE_WARNINGS_AS_ERRORS)
  target_compile_options(gladstone_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Werror>
                                                   $<$<COMPILE_LANGUAGE:CUDA>:-Werror=all-warnings>)
endif()
