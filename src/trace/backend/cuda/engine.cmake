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

set(STRAYTRACE_NVCC_FLAGS -std=c++20 --expt-relaxed-constexpr --fmad=false -diag-suppress 20012 -O3
    -I ${CMAKE_SOURCE_DIR}/src -I ${RANDOM123_INCLUDE})
set(cuda_targets)
foreach(architecture ${STRAYTRACE_CUDA_ARCHITECTURES})
  list(APPEND cuda_targets -gencode arch=compute_${architecture},code=sm_${architecture})
endforeach()
list(GET STRAYTRACE_CUDA_ARCHITECTURES -1 last)
list(APPEND cuda_targets -gencode arch=compute_${last},code=compute_${last})  # for later ones

# A shared library beside the program, made by nvcc of SOURCE for all architectures, and a target of its name. FLAGS are
# those of the compiler, LIBRARIES are linked and found where they are now.
function(add_device_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "SOURCE;COMMENT" "FLAGS;LIBRARIES")
  set(library ${CMAKE_BINARY_DIR}/lib${name}.so)
  set(linker -z,defs)
  foreach(linked ${arg_LIBRARIES})
    get_filename_component(folder ${linked} DIRECTORY)
    string(APPEND linker ",-rpath,${folder}")
  endforeach()
  add_custom_command(
    OUTPUT ${library}
    COMMAND ${STRAYTRACE_NVCC} ${arg_FLAGS} ${cuda_targets} --threads 0 -shared
            -Xcompiler=-fPIC,-fvisibility=hidden,-ffp-contract=off -Xlinker=${linker} -MD -MF ${name}.d -o ${library}
            ${arg_SOURCE} ${arg_LIBRARIES}
    DEPENDS ${arg_SOURCE}
    DEPFILE ${CMAKE_BINARY_DIR}/${name}.d
    WORKING_DIRECTORY ${CMAKE_BINARY_DIR}
    COMMENT ${arg_COMMENT}
    VERBATIM)
  add_custom_target(${name} ALL DEPENDS ${library})
  add_dependencies(wheel ${name})
  if(SKBUILD)
    install(PROGRAMS ${library} DESTINATION straytrace/bin)
  endif()
endfunction()

add_device_library(
  straytrace_cuda
  SOURCE ${CMAKE_SOURCE_DIR}/src/trace/backend/cuda/engine.cu
  FLAGS ${STRAYTRACE_NVCC_FLAGS}
  COMMENT "Building the engine for NVIDIA devices: a few minutes")
