// SPDX-License-Identifier: BSD-3-Clause
// The search for the mode of an arm: first with the mirrors alone, whose mode starts the search with all baffles.
#pragma once

#include <functional>
#include <string>

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

}  // namespace straytrace::wave
