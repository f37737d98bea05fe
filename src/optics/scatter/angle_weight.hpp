// SPDX-License-Identifier: BSD-3-Clause
// Weights of a BSDF model against the angle: as stated, or such that the model scatters a stated total at every angle
// of incidence. Both keep the model reciprocal.
#pragma once

#include <functional>

#include "optics/scatter/mixture.hpp"

namespace straytrace::optics {

// The weight w(theta) itself: the model is multiplied by sqrt(w(theta_i) w(theta_s)).
AngleWeight weight_of(LawPool const&, PoolRef ref, std::function<double(double)> const& weight);

// Weight under which model `ref` scatters share(cos_i) of the light. The model is multiplied by g(theta_i) g(theta_s),
// where g solves g(theta_i) int model g cos dOmega = share(theta_i) at the angles of the albedo table.
AngleWeight weight_for_share(LawPool const&, PoolRef ref, std::function<double(double)> const& share);

}  // namespace straytrace::optics
