// SPDX-License-Identifier: BSD-3-Clause
// To be included first where a device compiles the walk. Its compiler copies every inline function to where it is used,
// a hundred times over for shapes, laws and searches; these are called here instead: one body each, a kernel that
// compiles in minutes instead of hours and is small enough for the instruction cache.
#pragma once

#if defined(__NVCC__)
#define STRAY_CALLED __noinline__ __host__ __device__ inline

// What the headers below include is left as it is.
#include "base/vec3.hpp"
#include "beams/footprint.hpp"
#include "optics/abg.hpp"
#include "optics/dust.hpp"
#include "optics/gaussian.hpp"
#include "optics/grooves.hpp"
#include "optics/harvey.hpp"
#include "optics/lambertian.hpp"
#include "optics/measured.hpp"
#include "optics/microfacet.hpp"
#include "optics/optic.hpp"
#include "optics/polynomial.hpp"
#include "optics/power_law.hpp"
#include "optics/roughness.hpp"
#include "optics/specular_types.hpp"
#include "optics/through.hpp"

#pragma push_macro("STRAY_HD")
#undef STRAY_HD
#define STRAY_HD STRAY_CALLED
#include "geometry/pieces.hpp"
#include "optics/law_types.hpp"
#include "optics/specular.hpp"
#pragma pop_macro("STRAY_HD")

#include "base/rng.hpp"
#include "geometry/strips.hpp"
#include "optics/media_stack.hpp"
#include "optics/polarisation.hpp"
#include "optics/refraction.hpp"
#include "trace/result.hpp"
#include "world/hit.hpp"
#include "world/mode_shapes.hpp"
#include "world/receiver.hpp"
#include "world/scatter_spread.hpp"
#include "world/search.hpp"
#include "world/search_kernels.hpp"
#include "world/steering.hpp"

#pragma push_macro("STRAY_HD")
#undef STRAY_HD
#define STRAY_HD STRAY_CALLED
#include "trace/estimate/connect.hpp"
#include "trace/estimate/receive.hpp"
#include "trace/estimate/scatter.hpp"
#include "trace/estimate/through_glass.hpp"
#include "world/vertex.hpp"
#include "world/world.hpp"
#pragma pop_macro("STRAY_HD")
#endif

#include "trace/history/step.hpp"
