// SPDX-License-Identifier: BSD-3-Clause
#include "wave/arm/arm_waves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/functions.hpp"
#include "base/math/rng.hpp"
#include "base/math/samples.hpp"
#include "base/process/threads.hpp"
#include "beams/cavity_mode.hpp"
#include "beams/overlap.hpp"
#include "wave/arm/arm_checks.hpp"
#include "wave/arm/arm_solver.hpp"
#include "wave/arm/irradiance.hpp"
#include "world/model/world.hpp"

namespace straytrace::wave {
namespace {

// NaN beyond the reach of the Hankel transform.
double loss_of_smooth_mirrors(ArmCavity const& arm) {
  RoundCavity cavity{arm.cavity.wavelength, arm.mirrors[0].curvature, arm.mirrors[1].curvature, {}};
  cavity.openings = {{0, std::fmin(arm.mirrors[0].radius, 4.5 * arm.mirrors[0].spot)},
                     {arm.cavity.length, std::fmin(arm.mirrors[1].radius, 4.5 * arm.mirrors[1].spot)}};
  if (fresnel_number(cavity) > largest_fresnel_number) return std::nan("");
  return round_modes(cavity, 0, 1).front().loss();
}

double normal(Rng& random) {
  double const radius = std::sqrt(-2 * log_positive(random.uniform()));
  return radius * sincos_turn(random.uniform()).cos;
}

// The rim as drawn in the scene, then with its tolerances and the roll of a mirror, drawn anew in each draw of the
// heights. Draw 0 has no roll.
std::vector<RimCurve> curves_of(ArmCavity const& arm, std::size_t number, WaveSettings const& settings,
                                std::uint32_t map_draw) {
  ArmRim const& rim = arm.rims[number];
  std::vector<RimCurve> curves{curve_of(arm, rim)};
  auto const rolled = settings.rolled();
  if (!settings.tolerance.any() && !rolled) return curves;
  for (std::uint32_t draw = 0; draw < settings.draws; ++draw) {
    Rng random(settings.mirrors[0].seed, std::uint64_t(map_draw) * settings.draws + draw, std::uint32_t(number),
               Stream::static_phase);
    double const wider = settings.tolerance.radius * normal(random);
    Vec3 const displacement{settings.tolerance.centre * normal(random), settings.tolerance.centre * normal(random),
                            settings.tolerance.place * normal(random)};
    curves.push_back(curve_of(arm, rim, displacement, wider));
    if (rolled) curves.back().roll[*rolled] = 2 * pi * draw / settings.draws;
  }
  return curves;
}

std::vector<ModeLine> listed_modes(CavityWaves const& waves, int highest_order, ArmSolver::Progress const& progress) {
  SolveOptions options;
  options.loss_error = 1e-2;
  options.progress = [&](int, double residual) { progress(fmt::format("higher modes, residual {:.1e}", residual)); };
  return mode_table(waves, highest_order, options);
}

PowerLedger mean_of(std::vector<ArmDraw> const& draws) {
  PowerLedger mean = draws.front().ledger;
  double const count = double(draws.size());
  auto const average = [&](auto const& part) {
    double sum = 0;
    for (ArmDraw const& d : draws) sum += part(d.ledger);
    return sum / count;
  };
  for (std::size_t i = 0; i < mean.towards_mirror1.size(); ++i) {
    mean.towards_mirror1[i] = average([i](PowerLedger const& l) { return l.towards_mirror1[i]; });
    mean.towards_mirror2[i] = average([i](PowerLedger const& l) { return l.towards_mirror2[i]; });
  }
  mean.mirror1 = average([](PowerLedger const& l) { return l.mirror1; });
  mean.mirror2 = average([](PowerLedger const& l) { return l.mirror2; });
  mean.beyond_band = average([](PowerLedger const& l) { return l.beyond_band; });
  return mean;
}

std::array<double, 2> centroid(Field const& field) {
  Grid const& grid = field.grid;
  double power = 0, x = 0, y = 0;
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      double const here = std::norm(field(row, column));
      power += here;
      x += here * grid.at(column);
      y += here * grid.at(row);
    }
  return {x / power, y / power};
}

std::array<MirrorSpot, 2> expected_spots(WaveCavity const& cavity) {
  CavityAxis const axis = axis_of(cavity);
  return {MirrorSpot{{}, {axis.x1, axis.y1}}, MirrorSpot{{}, {axis.x2, axis.y2}}};
}

// One draw of the heights after the other.
class ArmEnsemble {
 public:
  ArmEnsemble(World const& world, WaveSettings const& settings, ArmSolver& solver, ArmSolver::Progress progress)
      : world_(world), settings_(settings), solver_(solver), progress_(std::move(progress)) {}

  // The mode, whose levers and losses are added to `waves`, and its light to the meter.
  WaveMode solve(ArmWaves& waves, IrradianceMeter& meter, std::uint32_t number, Field const& start) {
    WaveMode mode = solver_.mode(start);
    progress_("edges");
    std::vector<std::vector<RimCurve>> curves;
    for (std::size_t j = 0; j < waves.arm.rims.size(); ++j)
      curves.push_back(waves.arm.rims[j].in_band ? curves_of(waves.arm, j, settings_, number)
                                                 : std::vector<RimCurve>{});
    DiodeMeter diodes(solver_.waves(), waves.arm.diodes);
    LightMeter light(waves.arm, solver_.waves().cavity());
    CavityRims found = rim_responses(solver_.waves(), mode, curves, [&](Arrival const& arrival) {
      meter(arrival);
      diodes(arrival);
      light(arrival);
      bool const at_mirror1 = arrival.plane == 0;
      if (number > 0 || (!at_mirror1 && arrival.plane != int(waves.rims.size()) + 1)) return;
      std::size_t const mirror = at_mirror1 ? 0 : 1;
      waves.spots[mirror].found = centroid(arrival.field);
      if (!waves.fields.empty()) waves.fields[mirror] = arrival.field;
    });
    for (std::size_t i = 0; i < waves.diodes.size(); ++i)
      if (diode_angle(waves.arm, waves.arm.diodes[i]) <= waves.arm.crossover)
        waves.diodes[i].draws.push_back(diodes.light()[i].power());
    for (std::size_t j = 0; j < waves.rims.size(); ++j)
      if (!curves[j].empty()) waves.rims[j].draws.push_back({std::move(found.responses[j]), found.clipped[j]});
    waves.light.push_back(std::move(light).result());
    progress_("balance of power");
    WaveCavity const& cavity = solver_.waves().cavity();
    waves.draws.push_back({{height_rms(cavity.mirror1.height), height_rms(cavity.mirror2.height)},
                           mode.loss(),
                           mode.residual,
                           mode.round_trips,
                           solver_.waves().ledger(mode),
                           found.mirrors});
    return mode;
  }
  // False if nothing in them is random.
  bool draw_heights(ArmCavity const& arm, std::uint32_t number) {
    auto const heights = drawn_heights(world_, settings_, arm, number);
    if (heights[0] == arm.cavity.mirror1.height && heights[1] == arm.cavity.mirror2.height) return false;
    solver_.set_heights(heights);
    return true;
  }

 private:
  World const& world_;
  WaveSettings const& settings_;
  ArmSolver& solver_;
  ArmSolver::Progress progress_;
};

// Mean and spread over all heights of the mirrors.
void expect_diodes(World const& world, WaveSettings const& settings, ArmWaves& waves, Computing const& on) {
  if (waves.arm.diodes.empty()) return;
  DiodeExpectation const expected = expected_on_diodes(world, settings, HaloMoments::mean_and_covariance, on);
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < waves.arm.diodes.size(); ++i) {
    auto const n = Eigen::Index(i);
    beyond += diode_angle(waves.arm, waves.arm.diodes[i]) > waves.arm.crossover;
    waves.diodes.push_back({{}, expected.smooth[n] + expected.halo.mean[n], std::sqrt(expected.halo.covariance(n, n))});
  }
  if (beyond > 0)
    waves.arm.warnings.push_back(
        fmt::format("wave: {} of {} photodiodes lie beyond the crossover angle of {:.4g} urad, seen from the mirror "
                    "that their light comes from; only the mean over mirrors is given for them",
                    beyond, waves.arm.diodes.size(), 1e6 * waves.arm.crossover));
}

void warn_of_clipping(ArmWaves& waves) {
  double largest = 0;
  for (ArmDraw const& d : waves.draws) largest = std::fmax(largest, d.loss);
  if (largest > 0.01)
    waves.arm.warnings.push_back(
        fmt::format("wave: the mode loses {:.2g} of its power per round trip: mirrors or baffles clip the "
                    "beam itself, and the levers are those of the clipped mode",
                    largest));
}

}  // namespace

Spread spread_of(std::vector<double> values) {
  std::ranges::sort(values);
  std::size_t const n = values.size();
  double const sum = std::accumulate(values.begin(), values.end(), 0.0);
  double const median = 0.5 * (values[(n - 1) / 2] + values[n / 2]);
  return {sum / double(n), median, nearest_rank(values, 0.05), nearest_rank(values, 0.95)};
}

std::vector<RimResponse const*> RimResult::ensemble() const {
  std::vector<RimResponse const*> all;
  for (RimDraw const& draw : draws)
    for (std::size_t i = draw.responses.size() > 1 ? 1 : 0; i < draw.responses.size(); ++i)
      all.push_back(&draw.responses[i]);
  return all;
}

ArmWaves solve_arm(World const& world, WaveSettings const& settings, ArmCavity planned, ArmOptions const& options) {
  Computing const on(int(thread_count(unsigned(options.threads))), options.device);
  std::string prefix;
  ArmSolver::Progress const say = [&](std::string const& what) {
    if (options.progress) options.progress(prefix + what);
  };
  ArmCavity arm = arm_cavity(world, settings, std::move(planned));
  std::optional<ArmCavity> const finer =
      options.grid_check ? std::optional(finer_arm(world, settings, arm)) : std::nullopt;
  ArmSolver solver(arm, on, say);
  WaveMode const mirrors = solver.mode_of_mirrors();
  std::vector<ModeLine> lines;
  if (options.highest_order >= 0) lines = listed_modes(solver.mirrors(), options.highest_order, say);
  double const perfect = loss_of_smooth_mirrors(arm);
  ArmWaves waves{std::move(arm), mirrors, {}, perfect, std::move(lines), {}, {}, {}, {}, {}, {}, {}};
  waves.spots = expected_spots(waves.arm.cavity);
  if (on.device) waves.device = on.device->name();
  if (options.fields) waves.fields.assign(2, Field(waves.arm.cavity.grid));
  waves.rims.resize(waves.arm.rims.size());
  if (!waves.arm.diodes.empty()) say("photodiodes");
  expect_diodes(world, settings, waves, on);
  ArmEnsemble ensemble(world, settings, solver, say);
  IrradianceMeter meter(waves.arm.cavity.grid, waves.rims.size() + 2);
  waves.mode = ensemble.solve(waves, meter, 0, mirrors.spectrum);
  for (std::uint32_t draw = 1; draw < settings.map_draws; ++draw) {
    prefix = fmt::format("heights {} of {}, ", draw + 1, settings.map_draws);
    if (!ensemble.draw_heights(waves.arm, draw)) {
      waves.arm.warnings.push_back(
          "wave: 'map_draws' has no effect: the measured maps hold all heights up to the crossover angle");
      break;
    }
    ensemble.solve(waves, meter, draw, solver.mode_of_mirrors().spectrum);
  }
  prefix.clear();
  warn_of_clipping(waves);
  waves.ledger = mean_of(waves.draws);
  waves.irradiance = std::move(meter).result();
  ExpectedLevers const expected(world, waves.arm);
  for (std::size_t j = 0; j < waves.rims.size(); ++j) waves.rims[j].speckle = expected(j, waves.light);
  if (finer) waves.grid_check = grid_check(world, *finer, waves, on, say);
  prefix = "heights by frequency, ";
  if (options.by_frequency) waves.bands = frequency_bands(waves.arm, solver);
  return waves;
}

namespace {

// The mode of the mirrors alone behind mirror 1, along its axis.
beams::Mode mode_of_mirrors(WaveCavity const& c) {
  CavityAxis const axis = axis_of(c);
  double const w = cavity_mode(c.length, 1 / c.mirror1.curvature, 1 / c.mirror2.curvature, c.wavelength).w1;
  Vec3 const travel = unit(Vec3{(axis.x2 - axis.x1) / c.length, (axis.y2 - axis.y1) / c.length, 1});
  return beams::circular_mode({axis.x1, axis.y1, 0}, travel, w, -c.mirror1.curvature, c.wavelength);
}

// In the frame of the cavity, which misaligned mirrors do not turn.
beams::Mode input_of(WaveSettings::Input const& input, WaveCavity const& c, double radius) {
  return beams::circular_mode({input.shift[0], input.shift[1], 0}, unit(Vec3{input.tilt[0], input.tilt[1], 1}),
                              input.radius.value_or(radius), input.wavefront_curvature.value_or(-c.mirror1.curvature),
                              c.wavelength);
}

std::vector<double> shares_by_order(beams::Mode const& beam, beams::Mode const& basis, int highest_order) {
  beams::ModeCoefficients const amplitudes = beams::hermite_coefficients(beam, basis, highest_order);
  std::vector<double> shares;
  for (int order = 0; order <= highest_order; ++order) {
    double share = 0;
    for (int m = 0; m <= order; ++m) share += std::norm(amplitudes(order - m, m));
    shares.push_back(share);
  }
  return shares;
}

}  // namespace

DrivenScan drive_arm(WaveSettings const& settings, ArmWaves const& solved, std::vector<MirrorCoating> const& coatings,
                     std::vector<double> const& detunings, DriveOptions const& options) {
  WaveCavity const& cavity = solved.arm.cavity;
  DrivenScan driven;
  driven.coatings = coatings;
  for (WaveSettings::Mirror const& m : settings.mirrors) driven.surfaces.push_back(m.surface);
  driven.free_spectral_range = speed_of_light / (2 * cavity.length);
  CavityWaves const waves(cavity, {int(thread_count(unsigned(options.threads))), options.device});
  Field input = solved.mode.spectrum;
  if (settings.input) {
    beams::Mode const beam = input_of(*settings.input, cavity, solved.arm.mirrors[0].spot);
    driven.input_orders = shares_by_order(beam, mode_of_mirrors(cavity), options.highest_order);
    input = gaussian_field(waves, beam);
  }
  DrivenOptions const solve = solve_options(options);
  driven.take(DrivenCavity(waves, {coatings[0], coatings[1]}, solved.mode.eigenvalue, input, detunings, solve),
              detunings, solve);
  return driven;
}

DrivenOptions solve_options(DriveOptions const& options) {
  DrivenOptions solve;
  solve.highest_order = options.highest_order;
  solve.progress = [say = options.progress](int trips, double error) {
    if (say) say(fmt::format("driven field, round trip {}, error {:.1e}", trips, error));
  };
  return solve;
}

}  // namespace straytrace::wave
