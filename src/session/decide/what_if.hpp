// SPDX-License-Identifier: BSD-3-Clause
// Noise of a run with other inputs, without tracing, where its coupling table gives the exact answer
// (docs/theory/decisions.md).
#pragma once

#include <nlohmann/json.hpp>

#include <array>
#include <string>
#include <vector>

#include "noise/bands/elasticity.hpp"
#include "results/results.hpp"
#include "session/model.hpp"
#include "session/open_run.hpp"
#include "trace/tally/path_laws.hpp"
#include "world/model/material_change.hpp"

namespace straytrace::session {

// Couplings with other BSDFs and coatings, by the laws at the vertices of the kept paths (docs/theory/decisions.md, eq.
// D.7).

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

struct WhatIf {
  ProjectionModel model;                // with the changes of motion and interferometer
  CouplingTable light;                  // with those of the scatter
  std::vector<std::string> statements;  // each change in words
  std::string warning;                  // of light whose scatters are not counted; empty: it is below 1e-3 of the noise
};

// `settings`, any number together:
//   MATERIAL=x2, MATERIAL=black      the whole BRDF times a factor, or none
//   MATERIAL.tis=2e-4                the share that it scatters at normal incidence
//   BODY.motion=x2                   all motion of a body
//   PLACE=VALUE, PLACE=x2            a value of the scene by its place, "materials.steel.scatter.brdf" or any keys of
//   it
//                                    that name one value, "steel.brdf"
// Takes the model of the run. Throws one InputError with all problems: unknown names, changes of the light that need a
// trace, BSDFs above 1.
WhatIf what_if(OpenRun&, std::vector<std::string> const& settings);

// A value of the scene that a number describes.
struct SceneValue {
  std::string place;                 // "interferometer.mirror_mass"
  std::string written;               // as in the file
  std::optional<Quantity> quantity;  // where it was read as a number
  bool given = true;                 // false: its default
  bool whole = false;
};
// Scalars of the model that are given, and those of the tables `bodies` and `interferometer` that have defaults.
std::vector<SceneValue> scene_values(Scene const&);

// "place=value" with its value times a factor.
std::string times(SceneValue const&, double factor);
// Whether a place lies in a table that the projection alone reads.
bool of_projection(std::string const& place);

// The noise of a run as a polynomial of the strengths of its BSDFs, and as a function of the motion of one body: what
// the sliders of a report need (docs/theory/decisions.md, eq. D.8 to D.11).

using Spectrum = std::vector<double>;  // per bin

struct WhatIfTerms {
  struct Material {
    std::string name;
    double most = 1;  // factor at which it scatters, reflects and transmits all light
  };
  // A body whose motion is scaled, all others as they are. Paths that make less than 1e-3 of the noise follow the
  // others.
  struct Moved {
    std::string name;
    std::vector<double> factors;       // empty: the PSD is quadratic in the factor, and the ratio is that at rest
    std::vector<std::size_t> of_term;  // which ratio a term has
    std::vector<std::vector<Spectrum>> ratio;  // [ratio][factor, or 0][bin]: PSD over that as traced
  };
  // A row of the path table: a route has one part, a row `other` one of each term that it has light of.
  struct Row {
    std::uint64_t hash = 0;
    std::string name;  // "ITM·S > baffles·S > ITM·S"
    std::vector<std::size_t> terms;
    std::vector<std::vector<double>> psd;  // [part][place]: in the bins of `frequencies`, then the sum over the band
  };

  std::string none;    // why there are no sliders; all else is empty then
  double unnamed = 0;  // largest share of the noise power, over bins, of light whose scatters are not counted
  std::vector<Material> materials;
  std::vector<std::vector<int>> exponents;                    // [term][material]
  std::vector<Spectrum> psd;                                  // [term][bin], strain^2/Hz, as traced
  std::vector<std::array<double, replica_count>> deviations;  // [term][replica], relative
  Spectrum error_factor;                                      // of h of the run over that by the deviations
  Spectrum error_kept;  // relative, of h, in bins whose error the deviations do not have
  std::vector<Moved> moved;
  std::vector<Row> rows;
  std::vector<double> frequencies;    // Hz
  std::vector<std::string> left_out;  // what has no slider, with the reason
};

// `rows`: of the table, by rank.
WhatIfTerms what_if_terms(Model const&, CouplingTable const&, NoiseBudget const&, PathTable const&, std::size_t rows);

// For data/page/what_if.js: PSDs over that of the total as traced.
nlohmann::json what_if_json(WhatIfTerms const&, NoiseBudget const&, PathTable const&);

// The most that a material can scatter, over what it does, and the incidence at which that is reached.
struct LargestFactor {
  double factor = infinity, degrees = 0;
  double scattered = 0, others = 0;  // shares of the light there: scattered now; reflected and transmitted
};
LargestFactor largest_factor(World const&, std::string const& material);

}  // namespace straytrace::session
