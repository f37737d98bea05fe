// SPDX-License-Identifier: BSD-3-Clause
// To be included first where a device compiles the walk. Its compiler inlines every inline function at every call,
// a hundred times for shapes, BSDF models and searches. These are called here instead: the kernel then compiles in
// minutes instead of hours and is small enough for the instruction cache.
#pragma once

#if defined(__NVCC__)
#define STRAY_CALLED __noinline__ __host__ __device__ inline

// Headers included by those below are unaffected.
#include "base/math/vec3.hpp"
#include "beams/footprint.hpp"
#include "optics/coating/coating.hpp"
#include "optics/optic.hpp"
#include "optics/polarisation.hpp"
#include "optics/scatter/law_types.hpp"

#pragma push_macro("STRAY_HD")
#undef STRAY_HD
#define STRAY_HD STRAY_CALLED
#include "geometry/shapes/shape.hpp"
#include "optics/coating/specular.hpp"
#include "optics/scatter/mixture.hpp"
#pragma pop_macro("STRAY_HD")

#include "base/math/rng.hpp"
#include "geometry/shape_types.hpp"
#include "optics/coating/fresnel.hpp"
#include "optics/media_stack.hpp"
#include "trace/result.hpp"
#include "world/model/halo.hpp"
#include "world/model/receiver.hpp"
#include "world/model/steering.hpp"
#include "world/search/search.hpp"
#include "world/search/search_kernels.hpp"

#pragma push_macro("STRAY_HD")
#undef STRAY_HD
#define STRAY_HD STRAY_CALLED
#include "trace/step/balance.hpp"
#include "trace/step/connect.hpp"
#include "trace/step/goal.hpp"
#include "trace/step/halo_ends.hpp"
#include "trace/step/receive.hpp"
#include "trace/step/scatter.hpp"
#include "trace/step/sub_path.hpp"
#include "trace/step/way.hpp"
#include "world/model/vertex.hpp"
#include "world/model/view.hpp"
#pragma pop_macro("STRAY_HD")
#endif

#include "trace/step/step.hpp"
