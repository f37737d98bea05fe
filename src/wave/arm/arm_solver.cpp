// SPDX-License-Identifier: BSD-3-Clause
#include "wave/arm/arm_solver.hpp"

#include <fmt/format.h>

#include <utility>

#include "base/errors.hpp"

namespace straytrace::wave {
namespace {

WaveCavity without_baffles(WaveCavity cavity) {
  cavity.baffles.clear();
  return cavity;
}

}  // namespace

ArmSolver::ArmSolver(ArmCavity const& arm, Computing const& on, Progress progress)
    : mirrors_(without_baffles(arm.cavity), on), waves_(arm.cavity, on), progress_(std::move(progress)) {}

void ArmSolver::set_heights(std::array<std::vector<double>, 2> const& heights) {
  mirrors_.set_heights(heights);
  waves_.set_heights(heights);
}

WaveMode ArmSolver::mode_of_mirrors() {
  progress_("mode of the mirrors");
  try {
    WaveMode mode = mirrors_.mode(last_ ? *last_ : mirrors_.hermite_gauss());
    last_ = mode.spectrum;
    return mode;
  } catch (NumericalError const& e) {
    throw InputError(fmt::format("wave: the mirrors hold no mode that resembles a Gaussian beam: {}", e.what()),
                     "enlarge the mirrors or change their curvatures");
  }
}

WaveMode ArmSolver::mode(Field const& start) const {
  SolveOptions solve;
  solve.loss_error = 1e-5;  // levers of rims converge as the field, the loss as its square
  solve.progress = [&](int trips, double residual) {
    progress_(fmt::format("round trip {}, residual {:.1e}", trips, residual));
  };
  return waves_.mode(start, solve);
}

}  // namespace straytrace::wave
