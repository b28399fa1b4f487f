# cmake --install: the program, the rooms as static libraries with their headers, the cases and data, and the package
# for find_package(gladstone).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(rooms GLOBAL PROPERTY GLADSTONE_ROOMS)
target_compile_options(gladstone_base INTERFACE
  $<INSTALL_INTERFACE:$<$<COMPILE_LANGUAGE:CXX>:${GLADSTONE_USAGE_FLAGS}>>)
install(TARGETS ${rooms} EXPORT gladstoneTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
# loaded when an image is first read or written that is not a plain TIFF
install(TARGETS gladstone_image_codecs LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT program)
if(TARGET gladstone)
  set_target_properties(gladstone PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
  install(TARGETS gladstone RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  include(GladstoneCompletion)
endif()

# headers are installed with their paths: #include "render/base/vec.h"
install(DIRECTORY render analysis cuda studies DESTINATION include/gladstone
        FILES_MATCHING PATTERN "*.h" PATTERN "*.cuh" PATTERN "cases" EXCLUDE)
install(DIRECTORY ${CMAKE_BINARY_DIR}/generated/ DESTINATION include/gladstone FILES_MATCHING PATTERN "*.h")

# cases and data are installed with their paths, too, since cases refer to their data by relative paths
install(DIRECTORY studies/cases DESTINATION share/gladstone/studies COMPONENT program OPTIONAL)
install(DIRECTORY data DESTINATION share/gladstone COMPONENT program)
install(FILES LICENSE DESTINATION share/gladstone COMPONENT program)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/gladstone)
configure_package_config_file(cmake/gladstoneConfig.cmake.in ${CMAKE_BINARY_DIR}/gladstoneConfig.cmake
                              INSTALL_DESTINATION ${package})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/gladstoneConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/gladstoneConfig.cmake ${CMAKE_BINARY_DIR}/gladstoneConfigVersion.cmake
              cmake/GladstoneDependencies.cmake cmake/FindOpenCVModules.cmake
        DESTINATION ${package})
install(EXPORT gladstoneTargets NAMESPACE gladstone:: DESTINATION ${package})

include(GladstonePackage)
