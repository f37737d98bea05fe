// SPDX-License-Identifier: BSD-3-Clause
// What moving mirrors of a cavity do to its mode (docs/theory/wave.md, eq. W.25 to W.27).
#pragma once

#include <array>

#include "wave/cavity.hpp"
#include "wave/rims.hpp"

namespace straytrace::wave {

struct MirrorLevers {
  // Derivatives of s by the displacement and by the rotation about the vertex. The phase 2k per displacement along the
  // axis with which the mode itself is reflected (eq. 2.5) is left out.
  RimLevers whole{};
  // Of the outline and the heights alone, while the curvature of the mirror rests: by a displacement along x and y
  // [1/m], and by a rotation about z [1/rad].
  std::array<Complex, 3> figure{};
};
// Of the mirror at which the field of a mode arrives.
MirrorLevers mirror_levers(CavityWaves const&, Arrival const&);

}  // namespace straytrace::wave
