// SPDX-License-Identifier: BSD-3-Clause
// End bench RB-1 (E.3): the closed forms of a bench behind an end mirror.
#include <nlohmann/json.hpp>

#include <map>

#include "results/receivers/receivers.hpp"
#include "scenes/benches.hpp"

namespace straytrace::testing::app_rb1 {
namespace {

constexpr double wavelength = 1064e-9, length_of_arm = 3000, transmission = 4e-6, splitter_tis = 1e-4;
constexpr double half = (1 - splitter_tis) / 2;  // each way of a splitter
double const mode_solid_angle = wavelength * wavelength / (M_PI * 4e-6);

// The bench in a folder, with these words of its main file changed, and without receivers, which take most of the time.
std::string changed_bench(Folder const& folder, std::string const& name, std::string const& from,
                          std::string const& to) {
  std::string const bench = text_of(benches + "rb1_bench.yaml");
  write_text(folder / "rb1_bench.yaml", bench.substr(0, bench.find("receivers:")));
  write_text(folder / name, edited(text_of(benches + name), from, to));
  return folder / name;
}

// 1e-9 m/sqrt(Hz) along the beam around 10 Hz, of the whole bench.
NoiseBudget shaken(Folder const& folder, Words more = {}) {
  Words words{"noise", folder / "rb1.h5", "--motion", benches + "rb1_shaken.yaml",
              "-o",    folder / "shaken", "--quiet",  "--force"};
  words.insert(words.end(), more.begin(), more.end());
  expect_done(words);
  return *read_run(folder / "shaken/run.h5").noise;
}

struct Recoupled {
  char const* route;
  double fraction;  // q^2 beta cos(theta) lambda^2/(pi w^2), eq. 1.4
};
// At 5 and 10 cm from the waist the beam is wider than there by 1.8e-5 and 7.2e-5 of w^2, which the errors resolve.
std::vector<Recoupled> lit_sensors() {
  auto const one = [](double z) {
    double const rayleigh = M_PI * std::pow(2e-3, 2) / wavelength;
    return 1e-3 * mode_solid_angle / (1 + std::pow(z / rayleigh, 2));
  };
  return {{"PD2·S", half * half * one(0.1)},
          {"4Q1·S", std::pow(half, 4) * one(0.05)},
          {"CAM2·S", std::pow(half, 4) * one(0.1)}};
}

// Any light of the bench, whatever it has met, has k(d_in - d_out)·x of the whole bench alone (eq. 2.4): 2k along the
// beam when it rejoins, nothing across. On a sensor of the bench the outgoing leg is zero: k for all light, the main
// beam included, so nothing beats there.
void expect_rigid(CouplingTable const& table) {
  double const k = 2 * M_PI / wavelength;
  std::size_t several = 0, controls = 0;
  auto const check = [&](CouplingClass const& c, std::string const& name, double along) {
    if (c.steps.empty() || name.find("ETM") != name.npos) return;  // that one does not move with the bench
    for (PathRecord const& record : c.records) {
      ASSERT_EQ(record.phase_sensitivities.size(), 1u) << name;
      double const* const d = record.phase_sensitivities[0].d;
      EXPECT_NEAR(d[0], along, 0.01 * k) << name;  // rays within a spot differ by its divergence, squared
      EXPECT_NEAR(std::hypot(d[1], d[2]), 0, 1e-3 * k) << name;
      several += c.steps.size() > 2;
      controls += std::fabs(d[0] - (3 * k - along)) < 0.01 * k;  // the sensor left out at ports, put in at receivers
    }
  };
  for (CouplingClass const& c : table.classes) check(c, route_name(table, c), 2 * k);
  for (CouplingClass const& c : table.received) check(c, received_name(table, c), k);
  EXPECT_GT(several, 100u);
  EXPECT_EQ(controls, 0u);
}

TEST(EndBenchRb1, ClosedFormsE3) {
  Folder const folder;
  std::string const scene = changed_bench(folder, "rb1.yaml", "lit: yes", "lit: yes");
  write_text(scene, text_of(scene) + "receivers: {PD1: {on: PD1, side: front}}\n");
  RunFile const run = traced_in(folder, "rb1.h5", {scene, "--histories", "131072"});
  double sum = 0, fields = 0;
  for (Recoupled const& r : lit_sensors()) {
    expect_coupling(run, r.route, r.fraction, 0.05);
    sum += r.fraction;
    fields += std::sqrt(r.fraction);
  }
  EXPECT_NEAR(lit_sensors()[0].fraction / 2.25223e-11, 1, 3e-4);  // of E.3, whose splitters lose nothing
  EXPECT_NEAR(mode_solid_angle / 9.00893e-8, 1, 1e-6);
  // eq. 9.3: (T/L) sqrt(sum f) x, over sqrt(2) for the mean over static phases; all in phase: the sum of the fields.
  NoiseBudget const noise = shaken(folder);
  std::size_t const at = bin_at(noise.grid, 10);
  double power = 0, linear = 0, error = 0;
  for (Recoupled const& r : lit_sensors()) {
    NoiseTrace const& t = noise_of(noise, r.route);
    power += t.phase_asd[at] * t.phase_asd[at];
    error += std::pow(t.phase_asd[at] * t.phase_asd[at] * 2 * t.sigma[at] / t.asd[at], 2);
    linear += t.phase_asd[at];
  }
  double const h = std::sqrt(power), tolerance = 2.5 * std::sqrt(error) / power;
  EXPECT_LT(tolerance, 0.02);
  EXPECT_NEAR(h / 5.480e-24, 1, tolerance);
  EXPECT_NEAR(std::sqrt(2.0) * h / 7.7498e-24, 1, tolerance);
  EXPECT_NEAR(std::sqrt(2.0) * linear / (transmission / length_of_arm * fields * 1e-9), 1, tolerance);
  EXPECT_GT(std::fabs(h / 7.7498e-24 - 1), 10 * tolerance) << "control: no mean over the static phase";
  // eq. 9.4 over 9.3: equal at 52.0 Hz without the pole. One bin at 10 Hz is enough: the ratio falls as 1/f^2.
  auto const crossing = [&](NoiseBudget const& b) {
    NoiseTrace const& t = noise_of(b, "PD2·S");
    return b.grid.centre(at) * std::sqrt(t.amplitude_asd[at] / t.phase_asd[at]);
  };
  EXPECT_NEAR(crossing(noise) * std::pow(1 + std::pow(10 / 55.0, 2), 0.25) / 52.0, 1, 0.01);
  EXPECT_GT(std::fabs(crossing(noise) / 45.6 - 1), 0.05) << "control: the crossing with the pole is elsewhere";
  expect_rigid(run.trace.coupling);
}

// The table of lit surfaces: E.3's power and capture of each sensor.
TEST(EndBenchRb1, PowerOnTheSensors) {
  Finished const f = expect_done({"check", benches + "rb1.yaml", "--format", "json"});
  std::map<std::string, nlohmann::json> lit;
  nlohmann::json const all = nlohmann::json::parse(f.out);
  for (nlohmann::json const& row : all["lit"]) lit[row["surface"]] = row;
  double const launched = 100e3 * transmission;
  EXPECT_NEAR(launched * lit["PD2"]["power"].get<double>(), 0.2, 2e-4 * 0.2);
  for (char const* name : {"4Q1", "CAM2"}) EXPECT_NEAR(launched * lit[name]["power"].get<double>(), 0.1, 3e-4 * 0.1);
  for (char const* name : {"PD2", "4Q1", "CAM2"}) {
    EXPECT_NEAR(lit[name]["radii_m"][0].get<double>(), 2e-3, 1e-6) << name;
    EXPECT_NEAR(1 - lit[name]["beside"].get<double>(), 0.9999963, 1e-7) << name;  // 1 - exp(-2 a^2/w^2)
  }
  for (char const* name : {"PD1", "4Q2", "CAM1"}) EXPECT_EQ(lit.count(name), 0u) << name;
}

// S a^2 cos(theta)/d^2 of what the front of BS1 scatters by the cosine law, with d^2 + a^2 for a sensor that is not
// small; the uniform law would give S a^2/(2 d^2).
TEST(EndBenchRb1, SplitterToCamera) {
  Folder const folder;
  std::string const scene = changed_bench(folder, "rb1.yaml", "lit: yes", "lit: {only: BS1/plate}");
  write_text(scene, text_of(scene) + "receivers: {CAM1: {on: CAM1, side: front}}\n");
  RunFile const run = traced_in(folder, "a.h5", {scene, "--histories", "1048576"});
  double const a = 5e-3, d = std::hypot(0.25, 0.1), cosine = 0.35 / std::sqrt(2) / d;
  double const share = splitter_tis * a * a * cosine / (d * d + a * a);
  expect_coupling(run, "BS1/plate·S > CAM1·D", share, 1e-3, 1e-4);  // the spot has (w/d)^2 = 6e-5
  Estimate const& e = route_of(run, "BS1/plate·S > CAM1·D").coupling;
  EXPECT_GT(std::fabs(e.mean - splitter_tis * a * a / (2 * d * d)), 20 * e.std_error) << "control: uniform law";
}

// Children 1, 10, 100 of what PD2 scatters: the same f. Histories 2^17, 2^19, 2^20: the error falls.
TEST(EndBenchRb1, ChildrenAndHistories) {
  Folder const folder;
  std::string const scene = changed_bench(folder, "rb1.yaml", "lit: yes", "lit: {only: PD2}");
  std::string const text = edited(text_of(scene), "trace: {", "trace: {order_limit: 2, children: 1, ");
  char const* const by_the_top = "PD2·S > top·S > PD2·S";
  std::vector<Estimate> family, series;
  for (char const* children : {"children: 1,", "children: 10,", "children: 100,"}) {
    write_text(scene, edited(text, "children: 1,", children));
    family.push_back(
        route_of(traced_in(folder, "a.h5", {scene, "--histories", "131072", "--force"}), by_the_top).coupling);
  }
  for (Estimate const& e : family) {
    EXPECT_TRUE(e.trusted) << e.why_not;
    EXPECT_NEAR(e.mean, family[0].mean, 5 * std::hypot(e.std_error, family[0].std_error));
    EXPECT_LT(e.std_error, 0.01 * e.mean);
  }
  // Power divided among children once more (or not at all) would show as a factor 10.
  write_text(scene, text);
  for (char const* histories : {"131072", "524288", "1048576"})
    series.push_back(
        route_of(traced_in(folder, "a.h5", {scene, "--histories", histories, "--force"}), "PD2·S").coupling);
  double const more[] = {1, 4, 8};
  for (std::size_t i : {0u, 1u, 2u}) {
    EXPECT_NEAR(series[i].mean, lit_sensors()[0].fraction, 5 * series[i].std_error) << i;
    // Blocks agree to less than one history in all, 1/N: the least error that is stated.
    EXPECT_NEAR(series[i].std_error / series[0].std_error * more[i], 1, 0.5) << i;
  }
  EXPECT_LT(series[2].std_error, 0.5 * series[0].std_error) << "control: an error that does not fall";
}

// R3.30, R5.11: the main beam on 4Q1, 0.1, 0.2 and 0.3 mm off the middle of its quadrants: the halves differ by
// erf(sqrt(2) d/w). Here the beam is traced as rays, not followed as a mode.
TEST(EndBenchRb1, DecentredQuadrant) {
  Folder const folder;
  std::string const scene = changed_bench(folder, "rb1.yaml", ", lit: yes", ""), text = text_of(scene);
  write_text(scene, text.substr(0, text.find("ports:")) +
                        "receivers: {4Q1: {on: 4Q1, side: front, quadrants: {centre: [Q_x, 0 mm]}}}\n");
  for (double const millimetres : {0.1, 0.2, 0.3}) {
    RunFile const run =
        traced_in(folder, "q.h5",
                  {scene, "--histories", "131072", "--force", "-p", "Q_x=" + std::to_string(millimetres) + " mm"});
    BlockSums const& total = run.trace.total;
    CellEstimates const q = cell_estimates(total.receivers.at(0).quadrants, total.histories, total.blocks);
    double const all = q.mean[0] + q.mean[1] + q.mean[2] + q.mean[3];
    double const halves = std::fabs(q.mean[1] + q.mean[3] - q.mean[0] - q.mean[2]) / all,
                 error = std::hypot(std::hypot(q.error[0], q.error[1]), std::hypot(q.error[2], q.error[3])) / all;
    EXPECT_NEAR(halves, std::erf(std::sqrt(2) * millimetres / 2), 5 * error) << millimetres;
    EXPECT_LT(5 * error, 0.03);
    EXPECT_GT(std::fabs(halves - std::erf(std::sqrt(2) * millimetres)), 5 * error) << "control: w taken as a diameter";
    EXPECT_NEAR(all, half * half, 0.01) << "power of 4Q1, share of P_t";
  }
}

// The arm and the telescope in place of the collimated start: f of each sensor is that of its own spot, and T^2 comes
// in by the passages through the end mirror.
TEST(EndBenchRb1, TelescopeDropsOut) {
  Folder const folder;
  std::string const scene = changed_bench(folder, "rb1_telescope.yaml", "lit: {floor: 1e-10}",
                                          "lit: {floor: 1e-10, only: [PD2, \"4Q1\", CAM2]}");
  RunFile const run = traced_in(folder, "t.h5", {scene, "--histories", "131072"});
  nlohmann::json const lit = nlohmann::json::parse(expect_done({"check", scene, "--format", "json"}).out)["lit"];
  double const through = transmission * (1 - 1e-4);
  std::size_t seen = 0;
  for (nlohmann::json const& row : lit)
    for (Recoupled const& r : lit_sensors()) {
      if (row["surface"].get<std::string>() + "·S" != r.route) continue;
      ++seen;
      double const w_x = row["radii_m"][0], w_y = row["radii_m"][1];
      EXPECT_NEAR(w_x / 2e-3, 1, 0.03) << r.route;  // 1/29, and what a beam of 2 mm grows in 2 m
      EXPECT_NEAR(w_x / w_y, 1, 1e-3) << r.route;
      expect_coupling(run, r.route, r.fraction * through * through * 4e-6 / (w_x * w_y), 0.05);
    }
  EXPECT_EQ(seen, 3u);
}

}  // namespace
}  // namespace straytrace::testing::app_rb1
