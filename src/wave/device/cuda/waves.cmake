# Fields on NVIDIA devices: a shared library of its own beside the program, since it needs cuFFT where it runs. Fused
# operations are allowed: its bits are not those of the host anyway.
if(NOT TARGET straytrace_cuda)
  return()
endif()
get_filename_component(cuda_bin ${STRAYTRACE_NVCC} REALPATH)
get_filename_component(cuda_bin ${cuda_bin} DIRECTORY)
find_path(STRAYTRACE_CUFFT_INCLUDE cufft.h HINTS ${cuda_bin}/../include ${cuda_bin}/../targets/x86_64-linux/include)
find_library(STRAYTRACE_CUFFT cufft HINTS ${cuda_bin}/../lib64 ${cuda_bin}/../targets/x86_64-linux/lib)
if(NOT STRAYTRACE_CUFFT OR NOT STRAYTRACE_CUFFT_INCLUDE)
  if(STRAYTRACE_CUDA STREQUAL "ON")
    message(FATAL_ERROR "STRAYTRACE_CUDA is ON and cuFFT was not found: install libcufft-dev of the CUDA toolkit, or set "
                        "STRAYTRACE_CUFFT and STRAYTRACE_CUFFT_INCLUDE to its library and to the folder of cufft.h")
  endif()
  message(STATUS "cuFFT was not found: fields are not computed on NVIDIA devices")
  return()
endif()

add_device_library(
  straytrace_cufft
  SOURCE ${CMAKE_SOURCE_DIR}/src/wave/device/cuda/waves.cu
  FLAGS -std=c++20 -O3 -I ${CMAKE_SOURCE_DIR}/src -I ${STRAYTRACE_CUFFT_INCLUDE}
  LIBRARIES ${STRAYTRACE_CUFFT}
  COMMENT "Building fields for NVIDIA devices")
