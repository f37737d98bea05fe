// SPDX-License-Identifier: BSD-3-Clause
// Couplings with other BSDFs and coatings, by the laws at the vertices of the kept paths (docs/theory/decisions.md, eq.
// D.7).
#pragma once

#include <vector>

#include "noise/bands/elasticity.hpp"
#include "session/open_run.hpp"
#include "trace/tally/path_laws.hpp"
#include "world/model/material_change.hpp"

namespace straytrace::session {

// The model of a run as it was traced, and its kept paths.
class KeptPaths {
 public:
  KeptPaths(RunFile const&, unsigned threads);
  KeptPaths(KeptPaths const&) = delete;
  World const& world() const { return model_.world; }
  Scene const& scene() const { return model_.scene; }
  PathLaws const& laws() const { return laws_; }

 private:
  Model model_;
  PathLaws laws_;
};

// By class: computed, not traced, and on surfaces that change, so that no kept path tells of it. Ghosts are followed.
std::vector<bool> computed_anew(CouplingTable const&, MaterialChange const&);

// Couplings with the light of each path times exp(its factor), and ghosts times the coatings that they meet, at normal
// incidence. The mean of a row and the sums of its replicas follow those of its kept paths; other computed classes
// stay. `unknown`: share of the light of each row whose factor is not known. `effective`: number of equally strong
// paths that carry the changed light, (sum of w)^2/(sum of w^2).
struct ReweightedCouplings {
  ScaledCouplings light;
  std::vector<double> effective;  // by class of the table before
  bool meets_edge = false;        // a BSDF is zero at a vertex of a kept path
};
ReweightedCouplings reweighted(CouplingTable const&, KeptPaths const&, World const& after);

}  // namespace straytrace::session
