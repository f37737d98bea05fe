// SPDX-License-Identifier: BSD-3-Clause
#include "wave/arm/arm_waves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/functions.hpp"
#include "base/math/rng.hpp"
#include "base/process/threads.hpp"
#include "beams/round_cavity.hpp"
#include "world/model/world.hpp"

namespace straytrace::wave {
namespace {

void say(ArmOptions const& options, std::string const& what) {
  if (options.progress) options.progress(what);
}

// NaN beyond the reach of the Hankel transform.
double loss_of_smooth_mirrors(ArmCavity const& arm) {
  RoundCavity cavity{arm.cavity.wavelength, arm.mirrors[0].curvature, arm.mirrors[1].curvature, {}};
  cavity.openings = {{0, std::fmin(arm.mirrors[0].radius, 4.5 * arm.mirrors[0].spot)},
                     {arm.cavity.length, std::fmin(arm.mirrors[1].radius, 4.5 * arm.mirrors[1].spot)}};
  if (fresnel_number(cavity) > largest_fresnel_number) return std::nan("");
  return round_modes(cavity, 0, 1).front().loss();
}

// Power that a mode shares with another; both of unit power.
double shared_power(Field const& a, Field const& b) {
  Complex sum = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) sum += std::conj(a.values[i]) * b.values[i];
  double const scale = a.grid.pitch() * a.grid.pitch() / double(a.grid.size());
  return std::norm(sum * scale);
}

double normal(Rng& random) {
  double const radius = std::sqrt(-2 * log_positive(random.uniform()));
  return radius * sincos_turn(random.uniform()).cos;
}

// The rim as drawn in the scene, then with its tolerances.
std::vector<RimCurve> curves_of(ArmCavity const& arm, std::size_t number, WaveSettings const& settings) {
  ArmRim const& rim = arm.rims[number];
  std::vector<RimCurve> curves{curve_of(arm, rim)};
  if (!settings.tolerance.any()) return curves;
  for (std::uint32_t draw = 0; draw < settings.draws; ++draw) {
    Rng random(settings.mirrors[0].seed, draw, std::uint32_t(number), Stream::static_phase);
    double const wider = settings.tolerance.rim * normal(random);
    Vec3 const displacement{settings.tolerance.centre * normal(random), settings.tolerance.centre * normal(random),
                            settings.tolerance.place * normal(random)};
    curves.push_back(curve_of(arm, rim, displacement, wider));
  }
  return curves;
}

SpeckleMeans speckle_of(World const& world, ArmCavity const& arm, ArmRim const& rim) {
  auto const& [one, two] = arm.mirrors;
  Vec3 const along = arm.frame.z;  // light falls on mirror 1 against z
  return speckle_means({arm.cavity.wavelength, rim.rim.radius, rim.centre.z, arm.cavity.length - rim.centre.z, one.spot,
                        two.spot, mirror_brdf(world, one, -along, rim.angle1),
                        mirror_brdf(world, two, along, rim.angle2)});
}

// Higher modes of the mirrors alone, and the start of the search with baffles.
struct MirrorModes {
  Field start;
  std::vector<ModeLine> lines;
};

// The mode next to each Hermite-Gauss mode. Those of one order are nearly degenerate, so that a mode may share less
// than half of its power with one of them.
std::vector<ModeLine> listed_modes(CavityWaves const& waves, WaveMode const& fundamental, int highest_order) {
  SolveOptions coarse;
  coarse.loss_error = 1e-2;
  std::vector<ModeLine> lines;
  for (int order = 0; order <= highest_order; ++order)
    for (int m = 0; m <= order; ++m) {
      Field const pure = waves.hermite_gauss(order - m, m);
      try {
        WaveMode const mode = waves.mode(pure, coarse);
        double const turns = std::arg(mode.eigenvalue / fundamental.eigenvalue) / (2 * pi);
        lines.push_back({order - m, m, shared_power(pure, mode.spectrum), mode.loss(), turns, mode.residual});
      } catch (NumericalError const&) {  // no mode is near: the rims take too much of it
        continue;
      }
    }
  return lines;
}

MirrorModes modes_of_mirrors(ArmCavity const& arm, ArmOptions const& options, int threads) {
  WaveCavity mirrors = arm.cavity;
  mirrors.baffles.clear();
  CavityWaves const waves(mirrors, threads);
  say(options, "mode of the mirrors");
  WaveMode mode = [&] {
    try {
      return waves.mode(waves.hermite_gauss());
    } catch (NumericalError const& e) {
      throw InputError(fmt::format("wave: the mirrors hold no mode that resembles a Gaussian beam: {}", e.what()),
                       "enlarge the mirrors or change their curvatures");
    }
  }();
  MirrorModes result{mode.spectrum, {}};
  if (options.highest_order < 0) return result;
  say(options, "higher modes");
  result.lines = listed_modes(waves, mode, options.highest_order);
  return result;
}

}  // namespace

ArmWaves solve_arm(World const& world, WaveSettings const& settings, ArmOptions const& options) {
  int const threads = int(thread_count(unsigned(options.threads)));
  ArmCavity arm = arm_cavity(world, settings);
  MirrorModes const mirrors = modes_of_mirrors(arm, options, threads);
  CavityWaves const waves(arm.cavity, threads);
  SolveOptions solve;
  solve.loss_error = 1e-5;  // levers of rims converge as the field, the loss as its square
  solve.progress = [&](int trips, double residual) {
    say(options, fmt::format("round trip {}, residual {:.1e}", trips, residual));
  };
  WaveMode mode = waves.mode(mirrors.start, solve);
  if (mode.loss() > 0.01)
    arm.warnings.push_back(
        fmt::format("wave: the mode loses {:.2g} of its power per round trip: mirrors or baffles clip the "
                    "beam itself, and the levers are those of the clipped mode",
                    mode.loss()));
  say(options, "rims");
  std::vector<std::vector<RimCurve>> curves;
  for (std::size_t j = 0; j < arm.rims.size(); ++j)
    curves.push_back(arm.rims[j].in_band ? curves_of(arm, j, settings) : std::vector<RimCurve>{});
  IrradianceMeter meter(arm.cavity.grid, arm.rims.size() + 2);
  CavityRims const found = rim_responses(waves, mode, curves, std::ref(meter));
  std::vector<RimResult> rims;
  for (std::size_t j = 0; j < arm.rims.size(); ++j)
    rims.push_back({found.responses[j], found.clipped[j], speckle_of(world, arm, arm.rims[j])});
  say(options, "balance of power");
  PowerLedger ledger = waves.ledger(mode);
  double const perfect = loss_of_smooth_mirrors(arm);
  return {std::move(arm),  std::move(mode),           perfect,       mirrors.lines, std::move(ledger),
          std::move(rims), std::move(meter).result(), found.mirror1, found.mirror2};
}

}  // namespace straytrace::wave
