# The Fourier transform of DUCC0 0.42 (Max-Planck-Society; BSD-3-Clause or GPL-2.0-or-later, here BSD-3-Clause), fetched by
# scripts/setup; without it, Eigen's. No flags for newer processors: every machine has the same bits.
set(STRAYTRACE_DUCC0 ${CMAKE_SOURCE_DIR}/build/ducc0 CACHE PATH "Folder with DUCC0's sources, in ducc0/; without them Eigen transforms fields")
if(NOT EXISTS ${STRAYTRACE_DUCC0}/ducc0/fft/fft1d_impl.h)
  message(STATUS "DUCC0 was not found in '${STRAYTRACE_DUCC0}': Eigen transforms the fields of wave optics, four times slower (scripts/setup)")
  return()
endif()
add_library(straytrace_ducc0 STATIC ${STRAYTRACE_DUCC0}/ducc0/infra/threading.cc)
target_compile_options(straytrace_ducc0 PRIVATE -ffp-contract=off -w)
target_compile_definitions(straytrace_ducc0 PUBLIC DUCC0_NO_LOWLEVEL_THREADING INTERFACE STRAYTRACE_DUCC0)
target_include_directories(straytrace_ducc0 SYSTEM PUBLIC ${STRAYTRACE_DUCC0})
target_link_libraries(straytrace_wave PRIVATE straytrace_ducc0)
set_source_files_properties(wave/line_transform.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
