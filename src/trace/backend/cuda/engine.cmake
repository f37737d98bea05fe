# The engine for NVIDIA devices: a shared library beside the program, which loads it on request. nvcc is called
# here and not through CMake, which knows no C++20 for it before 3.26 and wants the toolkit wherever it configures.
# --fmad=false: no operation is contracted, so that a device has the bits of the host.
if(NOT STRAYTRACE_CUDA MATCHES "^(AUTO|ON|OFF)$")
  message(FATAL_ERROR "STRAYTRACE_CUDA is '${STRAYTRACE_CUDA}'; write AUTO, ON or OFF")
endif()
find_program(STRAYTRACE_NVCC nvcc PATHS /usr/local/cuda/bin)
if(STRAYTRACE_CUDA STREQUAL "OFF" OR (STRAYTRACE_CUDA STREQUAL "AUTO" AND NOT STRAYTRACE_NVCC))
  return()
endif()
if(NOT STRAYTRACE_NVCC)
  message(FATAL_ERROR "STRAYTRACE_CUDA is ON and nvcc was not found: install the CUDA toolkit (12 or later), or set "
                      "STRAYTRACE_NVCC to its path")
endif()

set(cuda_source ${CMAKE_SOURCE_DIR}/src/trace/backend/cuda/engine.cu)
set(STRAYTRACE_NVCC_FLAGS -std=c++20 --expt-relaxed-constexpr --fmad=false -diag-suppress 20012 -O3
    -I ${CMAKE_SOURCE_DIR}/src -I ${RANDOM123_INCLUDE})
set(cuda_targets)
foreach(architecture ${STRAYTRACE_CUDA_ARCHITECTURES})
  list(APPEND cuda_targets -gencode arch=compute_${architecture},code=sm_${architecture})
endforeach()
list(GET STRAYTRACE_CUDA_ARCHITECTURES -1 last)
list(APPEND cuda_targets -gencode arch=compute_${last},code=compute_${last})  # for later ones
set(STRAYTRACE_CUDA_LIBRARY ${CMAKE_BINARY_DIR}/libstraytrace_cuda.so)
add_custom_command(
  OUTPUT ${STRAYTRACE_CUDA_LIBRARY}
  COMMAND ${STRAYTRACE_NVCC} ${STRAYTRACE_NVCC_FLAGS} ${cuda_targets} --threads 0 -shared
          -Xcompiler=-fPIC,-fvisibility=hidden,-ffp-contract=off -Xlinker=-z,defs -MD -MF cuda_engine.d
          -o ${STRAYTRACE_CUDA_LIBRARY} ${cuda_source}
  DEPENDS ${cuda_source}
  DEPFILE ${CMAKE_BINARY_DIR}/cuda_engine.d
  WORKING_DIRECTORY ${CMAKE_BINARY_DIR}
  COMMENT "Building the engine for NVIDIA devices: a few minutes"
  VERBATIM)
add_custom_target(straytrace_cuda ALL DEPENDS ${STRAYTRACE_CUDA_LIBRARY})
add_dependencies(wheel straytrace_cuda)
if(SKBUILD)
  install(PROGRAMS ${STRAYTRACE_CUDA_LIBRARY} DESTINATION straytrace/bin)
endif()
