// SPDX-License-Identifier: BSD-3-Clause
// The search for the mode of an arm: first with the mirrors alone, whose mode starts the search with all baffles.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "wave/arm/arm_cavity.hpp"

namespace straytrace::wave {

class ArmSolver {
 public:
  using Progress = std::function<void(std::string const&)>;
  ArmSolver(ArmCavity const&, Computing const&, Progress);

  CavityWaves const& mirrors() const { return mirrors_; }  // without baffles
  CavityWaves const& waves() const { return waves_; }
  void set_heights(std::array<std::vector<double>, 2> const&);
  // The fundamental mode of the mirrors alone; from the second time on, the search starts with the last one.
  // InputError if they hold none.
  WaveMode mode_of_mirrors();
  // That of all planes.
  WaveMode mode(Field const& start) const;

 private:
  CavityWaves mirrors_, waves_;
  std::optional<Field> last_;
  Progress progress_;
};

// The loss of an arm by the spatial frequency of the heights of its mirrors (docs/theory/wave.md, eq. W.34).

class ArmSolver;

// Heights with spatial frequencies above `from` and up to `to`. 1/m
struct HeightBand {
  double from = 0, to = 0;
  std::array<double, 2> scattered{};  // share of the power of the mode that each mirror scatters, to first order
  double loss = 0;  // of power per round trip, with these heights alone, less that of smooth mirrors; may be negative
};
// The loss of a band is resolved to this share of the loss of the mode.
inline constexpr double resolved_loss_of_bands = 1e-5;
struct HeightBands {
  double smooth = 0;              // loss of mirrors without heights: what the openings take
  std::vector<HeightBand> bands;  // ascending; octaves below the crossover angle
  double beyond = 0;              // scattered beyond the crossover angle by both mirrors (eq. W.2)
};
// Of the heights that `arm` has. The solver is left with others.
HeightBands frequency_bands(ArmCavity const& arm, ArmSolver&);

// What a finer grid changes in the results of an arm (docs/theory/wave.md, Errors).

struct ArmWaves;

// Results on a grid of some 1.4 times the points, less those on the grid itself.
struct GridCheck {
  int points = 0;      // of the finer grid, along one side
  double loss = 0;     // of power per round trip
  PowerLedger ledger;  // the same, by surface
  // Largest change of a lever over the rims, relative to the rms of that lever over the rims; NaN where none is known.
  double across = 0, along = 0;
  double expected = 0;  // relative, of the rms over all edges beyond the grid of the expected lever across; NaN: none
};

// Of the cavity on a grid of some 1.4 times the points, with the same window, crossover angle and heights. InputError
// if it is too large.
WaveSettings finer_settings(WaveSettings, double crossover, Grid const&);
ArmCavity finer_arm(World const&, WaveSettings const&, ArmCavity const&);
// Of the first draw of the heights.
GridCheck grid_check(World const&, ArmCavity const& finer, ArmWaves const&, Computing const&,
                     std::function<void(std::string const&)> const& progress);

}  // namespace straytrace::wave
