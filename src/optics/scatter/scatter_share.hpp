// SPDX-License-Identifier: BSD-3-Clause
// Gives a scatter law a stated total at every angle of incidence without spoiling its reciprocity.
#pragma once

#include <functional>

#include "optics/scatter/law_types.hpp"

namespace straytrace {

// Weight under which law `ref` scatters share(cos_i) of the light. The law is multiplied by g(theta_i) g(theta_s),
// where g solves g(theta_i) int law g cos dOmega = share(theta_i) at the angles of the albedo table.
AngleWeight weight_for_share(LawPool const&, PoolRef ref, std::function<double(double)> const& share);

// The weight w(theta) itself: the law is multiplied by sqrt(w(theta_i) w(theta_s)).
AngleWeight weight_of(LawPool const&, PoolRef ref, std::function<double(double)> const& weight);

}  // namespace straytrace
