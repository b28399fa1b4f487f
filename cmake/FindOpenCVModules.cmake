# Finds OpenCV's core, imgproc and video in their small development packages. The package with OpenCVConfig.cmake
# depends on two hundred others.
find_path(OpenCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
find_library(OpenCV_core_LIBRARY opencv_core)
find_library(OpenCV_imgproc_LIBRARY opencv_imgproc)
find_library(OpenCV_video_LIBRARY opencv_video)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenCVModules REQUIRED_VARS OpenCV_core_LIBRARY OpenCV_imgproc_LIBRARY
                                  OpenCV_video_LIBRARY OpenCV_INCLUDE_DIR)
foreach(module core imgproc video)
  if(OpenCVModules_FOUND AND NOT TARGET OpenCV::${module})
    add_library(OpenCV::${module} UNKNOWN IMPORTED)
    set_target_properties(OpenCV::${module} PROPERTIES IMPORTED_LOCATION ${OpenCV_${module}_LIBRARY}
                          INTERFACE_INCLUDE_DIRECTORIES ${OpenCV_INCLUDE_DIR})
  endif()
endforeach()
