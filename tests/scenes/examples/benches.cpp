// SPDX-License-Identifier: BSD-3-Clause
// The small benches of examples/benches against their closed forms (E.2, E.3; docs/theory/beams.md,
// docs/theory/spectra.md and docs/theory/interferometer.md).
#include "scenes/benches.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <complex>

#include "support/recorded.hpp"
#include "support/sequential.hpp"
#include "world/model/world.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;

// Largest fringe frequency that `straytrace fringes` gives for a run, Hz.
double fastest_fringe_of(std::string const& run) {
  auto const said = nlohmann::json::parse(expect_done({"fringes", run, "--duration", "8s", "--format", "json"}).out);
  double largest = 0;
  for (double const hz : said["y"][0]["values"]) largest = std::fmax(largest, hz);
  return largest;
}

// E.3, last row: f_sc of 2019, 10 um at 0.2 Hz: edge 4 pi A f/lambda (eq. 7.2), plateau G/sqrt(pi f_max) and rms mean
// G/sqrt(2 f_max) (eq. 7.6) of the phase quadrature.
TEST(EndBenches2019, ShelvesOfNorthAndWest) {
  Folder const folder;
  expect_done({"run", benches + "recoupled_2019.yaml", "-o", folder / "out", "--quiet"});
  RunFile const run = read_run(folder / "out/run.h5");
  struct Bench {
    char const* route;
    double fraction, plateau, rms_mean;
  };
  for (Bench const& b : {Bench{"SNEB·S", 3e-8, 2.27e-21, 2.84e-21}, {"SWEB·S", 5e-9, 9.27e-22, 1.16e-21}}) {
    expect_coupling(run, b.route, b.fraction, 0.03);
    NoiseTrace const& t = noise_of(*run.noise, b.route);
    FrequencyGrid const& grid = run.noise->grid;
    double const edge = 23.62, low = grid.edges[0];
    double slow = 0, until = low, all = 0, beyond = 0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      double const power = t.phase_asd[i] * t.phase_asd[i] * grid.width(i);
      if (grid.edges[i + 1] < edge / 2) slow += power, until = grid.edges[i + 1];
      (grid.edges[i] < 1.05 * edge ? all : beyond) += power;
    }
    // S(f) = 1/(pi sqrt(f_max^2 - f^2)), so from `low` to f lies the power (asin(f/f_max) - asin(low/f_max))/pi of 1/2.
    // Lines are 0.2 Hz apart: one more or less in the range.
    double const missing = std::asin(low / edge) / M_PI, share = std::asin(until / edge) / M_PI - missing;
    EXPECT_NEAR(std::sqrt(slow / share / (M_PI * edge)) / b.plateau, 1, 0.05) << b.route;
    EXPECT_NEAR(std::sqrt(all / (0.5 - missing) * 0.5 / edge) / b.rms_mean, 1, 0.02) << b.route;
    EXPECT_LT(beyond, 1e-6 * all) << b.route;
    EXPECT_GT(std::sqrt(all / edge) / b.plateau, 1.15) << "control: the plateau taken for the rms mean";
    EXPECT_GT(t.amplitude_asd[bin_at(grid, 10)], 10 * t.phase_asd[bin_at(grid, 10)]);  // eq. 9.4: what was seen
  }
}

// E.2b: EFL and BFL of the lens by rays, the phase of the chief ray, its fringes, the error at 256 Hz.
TEST(VibratingMirror, LensByRays) {
  struct Glass {
    char const* n;
    double index, efl, bfl;
  };
  for (Glass const& g :
       {Glass{"n=1.5168", 1.5168, 99.998e-3, 99.170e-3}, {"n=1.50669", 1.50669, 101.987e-3, 101.154e-3}}) {
    Scene const scene = read_scene(benches + "vibrating_mirror.yaml", {g.n});
    World const world = build_world(scene);
    scene.throw_if_problems();
    std::vector<SequenceStep> steps{{{}, Event::transmit, g.index}, {{}, Event::transmit, 1}};
    for (std::uint32_t id = 0; id < world.surfaces().size(); ++id) {
      std::string const& name = world.groups()[world.surfaces()[id].group.value];
      if (name == "lens/front") steps[0].surface = {id};
      if (name == "lens/back") steps[1].surface = {id};
    }
    double const height = 1e-5;
    Sequence const ray = trace_sequence(world.view(), {{0, height, -0.1}, {0, 0, 1}}, steps);
    ASSERT_EQ(ray.points.size(), 2u);
    SequencePoint const& out = ray.points[1];
    double const slope = -out.dir.y / out.dir.z;
    EXPECT_NEAR(height / slope, g.efl, 1e-6);
    EXPECT_NEAR(out.point.y / slope, g.bfl, 1e-6);
    EXPECT_GT(std::fabs(height / slope - out.point.y / slope), 8e-4) << "control: the principal plane at the back face";
  }
}

TEST(VibratingMirror, FringesOfTheChiefRayE2b) {
  Folder const folder;
  RunFile const run = traced_in(folder, "a.h5", {benches + "vibrating_mirror.yaml", "-p", "tones=0"});
  char const* const route = "probe·B > lens/front·T > lens/back·T > mirror·R > screen·S";
  CouplingClass const& c = route_of(run, route);
  // beta lambda^2 |u(0)|^2 of a ray on the axis of a mode of 1 mm (eq. 1.7), behind two perfect faces.
  EXPECT_NEAR(c.coupling.mean / (0.05 / M_PI * 1064e-9 * 1064e-9 * 2 / (M_PI * 1e-6)), 1, 1e-9);
  ASSERT_FALSE(c.records.empty());
  for (PhaseSensitivity const& l : c.records[0].phase_sensitivities) {
    if (run.trace.coupling.bodies[l.body.value] != "shaker") continue;
    double const phase = 10.5e-6 * (l.d[1] + l.d[2]);  // k (d_in - d_out)·A, eq. 2.2
    EXPECT_NEAR(std::fabs(phase), 124.0102, 1e-4);
    EXPECT_NEAR(std::fabs(10.5e-6 * l.d[2]), 124.0102 / 2, 1e-4) << "control: one axis";
  }
  EXPECT_NEAR(fastest_fringe_of(folder / "a.h5"), 1240.10, 0.01);
  Finished const slow = straytrace({"project", folder / "a.h5", "--duration", "2s", "--rate", "256"});
  EXPECT_EQ(slow.code, 2);
  EXPECT_THAT(slow.err, HasSubstr("reaches 1240.1 Hz"));
  EXPECT_THAT(slow.err, HasSubstr("write a rate of 8192 Hz"));
}

// E.2b: three tones on the phase of the light, which the reader does not share, and a still mirror (eq. N.25):
// first-order lines of Im s, mean over the static phase, of amplitude m. Controls: amplitudes as rms; a reader that
// shares the light.
TEST(VibratingMirror, TonesOfTheLightE2b) {
  Folder const folder;
  RunFile const run = traced_in(folder, "a.h5", {benches + "vibrating_mirror.yaml", "-p", "shake=0 um"});
  auto const said = nlohmann::json::parse(
      expect_done({"sensors", folder / "a.h5", "--kind", "phase", "--at", "40 Hz, 110 Hz, 120 Hz", "--format", "json"})
          .out);
  double light = 0;
  for (CouplingClass const& c : run.trace.coupling.classes) light += c.reverse * c.coupling.mean;
  FrequencyGrid const grid = logarithmic_grid(4, 2000, 60);
  struct Tone {
    double hz, amplitude;
  };
  for (Tone const& t : {Tone{40, 0.051}, {110, 0.1}, {120, 0.01}}) {
    double const asd = said["sensors"][0][fmt::format("asd_{:g}Hz", t.hz)].get<double>();
    double const line = 2 * asd * std::sqrt(grid.width(grid.bin_of(t.hz)) / light);
    EXPECT_NEAR(line / t.amplitude, 1, 0.01) << t.hz;
    EXPECT_GT(std::fabs(line / t.amplitude - std::sqrt(0.5)), 0.25) << t.hz;
  }
  // Both at once: the fringes of the mirror, and 2 pi f m of each tone at most.
  traced_in(folder, "b.h5", {benches + "vibrating_mirror.yaml"});
  double const fastest = fastest_fringe_of(folder / "b.h5");
  EXPECT_GT(fastest, 1240.10 + 0.1 * 110);
  EXPECT_LT(fastest, 1240.10 + 0.051 * 40 + 0.1 * 110 + 0.01 * 120 + 0.01);
}

// E.2c: both tones and each alone: 4 pi A f/lambda (eq. 7.2). 360 Hz are more than twice the fringe frequency, but less
// than the margin of eq. 7.13 asks for.
TEST(TwoToneWall, FringesE2c) {
  Folder const folder;
  traced_in(folder, "a.h5", {benches + "two_tone_wall.yaml"});
  auto const fastest = [&](std::string const& slow, std::string const& fast) {
    traced_in(folder, "b.h5", {benches + "two_tone_wall.yaml", "-p", "slow=" + slow, "-p", "fast=" + fast, "--force"});
    return fastest_fringe_of(folder / "b.h5");
  };
  EXPECT_NEAR(fastest("2.5 um", "0 um"), 62.83, 0.01);
  EXPECT_NEAR(fastest("0 um", "0.7 um"), 87.96, 0.01);
  double const both = fastest("2.5 um", "0.7 um");
  // d/dt of 62.8319 sin(2 pi t + pi/2) + 17.5929 sin(10 pi t + pi), over 2 pi, on a fine grid.
  double largest = 0;
  for (int i = 0; i < 100000; ++i) {
    double const t = i * 1e-5;
    largest = std::fmax(
        largest, std::fabs(62.8319 * std::cos(2 * M_PI * t + M_PI / 2) + 5 * 17.5929 * std::cos(10 * M_PI * t + M_PI)));
  }
  EXPECT_NEAR(both, largest, 0.05);
  EXPECT_LE(both, 150.80);
  EXPECT_GT(std::fabs(both - 2 * largest), 100) << "control: met twice";
  EXPECT_THAT(straytrace({"project", folder / "a.h5", "--duration", "8s", "--rate", "256"}).err,
              HasSubstr("write a rate of 1024 Hz"));
}

// Eq. 9.6: as-port behind -37 dB of power; the same bench, field 10^(-37/20), strain with it.
TEST(OutputIsolator, ActsOnTheField) {
  Folder const folder;
  expect_done({"run", benches + "output_isolator.yaml", "-o", folder / "out", "--quiet"});
  RunFile const run = read_run(folder / "out/run.h5");
  double const fraction = 1e-3 * 1064e-9 * 1064e-9 / (M_PI * 1e-6);  // A6
  for (char const* name : {"SDB1·S", "SDB2·S"}) expect_coupling(run, name, fraction, 0.03);
  NoiseTrace const &open = noise_of(*run.noise, "SDB1·S"), &behind = noise_of(*run.noise, "SDB2·S");
  for (std::size_t i = 0; i < open.asd.size(); i += 20) {
    double const ratio = behind.asd[i] / open.asd[i];
    EXPECT_NEAR(ratio / std::pow(10, -37.0 / 20), 1,
                5 * (open.sigma[i] / open.asd[i] + behind.sigma[i] / behind.asd[i]));
    EXPECT_GT(ratio, 10 * std::pow(10, -37.0 / 10)) << "control: decibels of the field";
  }
}

// Eq. 5.4, R2.25: powers and direction of the two ghosts of a wedged plate at 45 degrees, and what a dump gains.
TEST(PickOff, GhostAndItsDump) {
  Folder const folder;
  auto const told = nlohmann::json::parse(
      expect_done({"ghosts", benches + "pick_off.yaml", "--format", "json", "--quiet", "--show", "10"}).out);
  double const n = 1.44963, wedge = 10e-3, inside = std::asin(std::sqrt(0.5) / n);
  double const leaves = std::asin(n * std::sin(inside + 2 * wedge)) - M_PI / 4;  // of the front face, from the pick-off
  std::size_t seen = 0;
  for (auto const& ghost : told.at(0)["ghosts"]) {
    if (ghost["route"] != "main > plate/back·R > wall·land") continue;
    ++seen;
    EXPECT_NEAR(ghost["power"].get<double>() / (0.99 * 0.99 * 1e-4), 1, 1e-9);
  }
  EXPECT_EQ(seen, 1u);
  EXPECT_NEAR(leaves, 36.2e-3, 5e-4);  // it ends 2.1 degrees off the monitor
  auto const h = [&](std::string const& dump) {
    expect_done(
        {"run", benches + "pick_off.yaml", "-o", folder / "out.h5", "--quiet", "--force", "-p", "dump=" + dump});
    RunFile const run = read_run(folder / "out.h5");
    std::size_t const at = bin_at(run.noise->grid, 30);
    return std::array<double, 4>{noise_of(*run.noise, "wall·S").asd[at], noise_of(*run.noise, "photodiode·S").asd[at],
                                 route_of(run, "wall·S").coupling.mean, route_of(run, "wall·S").coupling.std_error};
  };
  auto const bare = h("0"), dumped = h("1");
  EXPECT_GT(bare[0], 500 * bare[1]);  // 1e-4 of the light on a wall that shakes, all of it on a bench that hangs
  EXPECT_NEAR(bare[0] / dumped[0], std::sqrt(5e-2 / 1e-5), 0.02 * std::sqrt(5e-2 / 1e-5));
  // q^2 beta cos lambda^2/(pi w w'), with the spot of the table of lit surfaces.
  auto const checked = nlohmann::json::parse(expect_done({"check", benches + "pick_off.yaml", "--format", "json"}).out);
  for (auto const& row : checked["lit"]) {
    if (row["surface"] != "wall") continue;
    double const q = row["power"], area = M_PI * row["radii_m"][0].get<double>() * row["radii_m"][1].get<double>();
    double const expected = q * q * 5e-2 * std::cos(row["incidence_rad"].get<double>()) * 1064e-9 * 1064e-9 / area;
    EXPECT_NEAR(row["incidence_rad"].get<double>(), leaves, 2e-4);
    EXPECT_NEAR(bare[2], expected, 5 * bare[3]);
    EXPECT_LT(5 * bare[3], 0.03 * expected);
    EXPECT_GT(std::fabs(bare[2] - expected / q), 100 * bare[3]) << "control: the ghost's share counted once";
  }
}

}  // namespace
}  // namespace straytrace::testing
