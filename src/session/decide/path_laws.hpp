// SPDX-License-Identifier: BSD-3-Clause
// The kept paths of a run traced again, for the laws at their vertices: what other BSDFs and coatings make of their
// light (docs/theory/decisions.md, eq. D.7).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "noise/bands/elasticity.hpp"
#include "session/open_run.hpp"
#include "trace/tally/replay.hpp"

namespace straytrace::session {

// Whether the BSDF of a material changes by one factor at all angles, and its coating not at all.
std::optional<double> common_factor(WorldView const& before, Optic const&, WorldView const& after, Optic const&);
bool same_coating(WorldView const& before, Optic const&, WorldView const& after, Optic const&);

// What a change of materials does.
struct MaterialChange {
  bool shape = false;    // of a BSDF: by more than one factor
  bool coating = false;
  std::vector<GroupId> groups;  // whose surfaces have a material that changes
};
MaterialChange change_of(World const& before, World const& after);
// By class: computed, not traced, and on surfaces of these groups, so that no kept path tells of the change.
std::vector<bool> computed_anew(CouplingTable const&, MaterialChange const&);

// The largest ratio of the BSDF after and before over all directions in the plane of incidence; infinite where only one
// is zero before.
double largest_ratio(WorldView const& before, Optic const&, WorldView const& after, Optic const&);

// ln of the factor on the light of each kept path, by class and record, with that of the beams that it leaves and joins
// (their shares of the main mode, eq. 1.1); NaN: the path is not known. Empty: a class that
// is computed, not traced.
using PathFactors = std::vector<std::vector<double>>;

class PathLaws {
 public:
  explicit PathLaws(RunFile const&, unsigned threads);

  Model const& model() const { return model_; }
  // With the BSDFs and coatings of another model of the same geometry. Minus infinity: a BSDF is zero there.
  PathFactors factors(Model const& other) const;
  // By material: the largest ratio of its BSDF at a vertex of a kept path; 0: none scatters there.
  std::vector<double> largest_ratios(Model const& other) const;

 private:
  CouplingTable const& table_;
  Model model_;
  struct Path {
    std::vector<trace::PassedVertex> vertices;  // empty: not known
    std::uint32_t source = 0, goal = 0;         // footprints, or a receiver
  };
  double log_factor(World const& other, Path const&) const;

  std::vector<std::vector<Path>> paths_;  // by class and record
};

// Couplings with the light of each path times exp(its factor). The mean of a row and the sums of its replicas follow
// those of their kept paths; classes that are computed stay. `unknown`: share of the light of each row whose factor is
// not known. `effective`: number of equally strong paths that carry the changed light, (sum of w)^2/(sum of w^2).
struct ReweightedCouplings {
  ScaledCouplings light;
  std::vector<double> effective;  // by class of the table before
};
ReweightedCouplings reweighted(CouplingTable const&, PathFactors const&);

// The same with ghosts times the reflectances and transmittances that they meet, taken at normal incidence.
ReweightedCouplings reweighted(CouplingTable const&, PathFactors const&, World const& before, World const& after);

}  // namespace straytrace::session
