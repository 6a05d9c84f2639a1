# Modules of OpenCV as targets, opencv_core and so on, from Debian's packages of single modules. OpenCV's
# own CMake files come with libopencv-dev, which installs all modules and 280 packages with them.
#   leviosim_find_opencv(MODULE...)
function(leviosim_find_opencv)
  find_path(OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
  foreach(module IN LISTS ARGN)
    if(TARGET opencv_${module})
      continue()
    endif()
    find_library(OPENCV_${module}_LIBRARY opencv_${module} REQUIRED)
    add_library(opencv_${module} UNKNOWN IMPORTED GLOBAL)
    set_target_properties(opencv_${module} PROPERTIES
      IMPORTED_LOCATION ${OPENCV_${module}_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${OPENCV_INCLUDE_DIR})
  endforeach()
endfunction()
