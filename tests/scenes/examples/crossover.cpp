// SPDX-License-Identifier: BSD-3-Clause
// Noise does not depend on the angle at which rays begin and waves end (docs/theory/wave.md, eq. W.21): case V16.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "scenes/benches.hpp"
#include "support/recorded.hpp"
#include "support/statistics.hpp"
#include "wave/arm/wave_record.hpp"

namespace straytrace::testing::crossover {
namespace {

std::string const crossover_arm = source_folder + "/tests/scenes/crossover_arm.yaml";

struct SeamCurve {
  std::vector<double> value, sigma;
  double spread() const { return std::ranges::max(value) / std::ranges::min(value) - 1; }
  double error() const { return 5 * std::ranges::max(sigma) / std::ranges::min(value); }
};
SeamCurve curve_of(nlohmann::json const& seam, char const* name) {
  SeamCurve curve;
  for (auto const& point : seam["points"]) {
    curve.value.push_back(point[name]["value"]);
    curve.sigma.push_back(point[name]["sigma"]);
  }
  return curve;
}

// Strain noise at 10 Hz of the scene without its table `wave`: all angles by rays.
double rays_from_above() {
  Folder const folder;
  std::string text = text_of(crossover_arm);
  std::size_t const at = text.find("\nwave: ");
  write_text(folder / "arm.yaml", text.erase(at, text.find('\n', at + 1) - at));
  expect_done({"run", folder / "arm.yaml", "-o", folder / "out", "--histories", "65536", "--quiet"});
  auto const said = nlohmann::json::parse(expect_done({"paths", folder / "out/run.h5", "--format", "json"}).out);
  return said["total_strain"][0]["value"];
}

// Between 140 and 280 urad, half of the coupling goes from rays to the halo.
TEST(Crossover, NoiseDoesNotDependOnItV16) {
  auto const seam = nlohmann::json::parse(
      expect_done({"wave", crossover_arm, "--seam", "--histories", "65536", "--format", "json"}).out);
  ASSERT_EQ(seam["points"].size(), 3u);
  SeamCurve const rays = curve_of(seam, "rays"), halo = curve_of(seam, "halo"), both = curve_of(seam, "rays_and_halo");
  EXPECT_LT(rays.error(), 0.03);
  EXPECT_LT(both.spread(), 0.03);
  EXPECT_LT(both.spread(), both.error());  // whose error holds the spread of mirrors
  // Controls: each part alone, and rays that begin at `above` with the halo beside them.
  EXPECT_GT(rays.spread(), 0.2);
  EXPECT_GT(halo.spread(), 0.15);
  EXPECT_GT(std::hypot(rays_from_above(), halo.value[1]) / both.value[1] - 1, 0.2);
}

// A run of the scene with another crossover angle; `grid`: keys of that table. Without baffles in the table `wave`, no
// path starts or ends in the field.
RunFile run_at(double crossover_urad, std::string const& grid, std::uint64_t histories,
               std::vector<std::string> const& more = {}, bool in_the_field = true) {
  Folder const folder;
  std::string text = text_of(crossover_arm);
  std::string const stated = "crossover: 200 urad";
  text.replace(text.find(stated), stated.size(), fmt::format("crossover: {} urad, grid: {{{}}}", crossover_urad, grid));
  if (!in_the_field) text = edited(text, "baffles: \"baffles\", ", "");
  write_text(folder / "arm.yaml", text);
  std::vector<std::string> command{"run",         folder / "arm.yaml",       "-o",     folder / "arm.h5",
                                   "--histories", std::to_string(histories), "--quiet"};
  command.insert(command.end(), more.begin(), more.end());
  expect_done(command);
  return read_run(folder / "arm.h5");
}
CouplingTable traced_at(int crossover_urad, bool in_the_field = true) {
  return run_at(crossover_urad, "window: 0.75 m", 524288, {"--no-seam"}, in_the_field).trace.coupling;
}

// `run` compares two angles. The other one is that of a run of its own, to rounding.
TEST(Crossover, RunsCompareTwoAngles) {
  RunFile const here = run_at(200, "window: 0.75 m", 65536);
  ASSERT_TRUE(here.about.seam);
  SeamCheck const& seam = *here.about.seam;
  EXPECT_EQ(seam.histories, 16384u);
  EXPECT_NEAR(seam.other_crossover, 200e-6 / std::sqrt(2), 1e-12);
  EXPECT_LT(std::fabs(seam.baffles.change), 5 * seam.baffles.change_sigma);
  EXPECT_LT(std::fabs(seam.baffles.change), 0.03);
  EXPECT_THAT(seam_sentence(here.content()), ::testing::HasSubstr("at 141.4 instead of 200 urad"));
  RunFile const other =
      run_at(1e6 * seam.other_crossover, fmt::format("points: {}, window: 0.75 m", here.about.waves->grid.points),
             16384, {"--no-seam"});
  ASSERT_TRUE(here.noise && other.noise);
  std::size_t const bin = here.noise->grid.bin_of(seam.frequency);
  EXPECT_NEAR(seam.total.strain, here.noise->total.asd[bin], 1e-3 * seam.total.strain);
  EXPECT_NEAR(seam.total.other, other.noise->total.asd[bin], 1e-3 * seam.total.strain);
  EXPECT_FALSE(other.about.seam);
  EXPECT_THAT(seam_sentence(other.content()), ::testing::HasSubstr("not checked"));
  // Changes that are made up, one after the other.
  auto const said = [&](double change, double sigma) {
    auto made_up = std::make_shared<SeamCheck>(seam);
    made_up->total.change = change;
    made_up->total.change_sigma = sigma;
    RunContent content = here.content();
    content.seam = made_up;
    return seam_sentence(content);
  };
  EXPECT_THAT(said(-0.02, 0.004), ::testing::HasSubstr("changes by -2 % ± 0.4 %: the result does not depend"));
  EXPECT_THAT(said(-0.04, 0.004), ::testing::HasSubstr("DEPENDS ON THE CROSSOVER ANGLE"));
  EXPECT_THAT(said(0.02, 0.01), ::testing::HasSubstr("more histories"));
  EXPECT_THAT(said(std::nan(""), std::nan("")), ::testing::HasSubstr("is not resolved"));
}

// Ctrl-C while the other angle is traced leaves the whole run, and the same command compares.
TEST(Crossover, InterruptedComparisonLeavesTheRun) {
  Folder const folder;
  std::vector<std::string> const command{"run", crossover_arm, "-o", folder / "arm.h5", "--histories", "65536"};
  Program running(command);
  ASSERT_TRUE(running.says("comparing with a crossover angle")) << running.said();
  running.interrupt();
  EXPECT_EQ(running.wait().code, 85);
  RunFile const first = read_run(folder / "arm.h5");
  EXPECT_EQ(first.trace.total.histories, 65536u);
  EXPECT_FALSE(first.about.seam);
  expect_done(command);
  EXPECT_TRUE(read_run(folder / "arm.h5").about.seam);
}
CouplingClass rays_of(CouplingTable const& table, std::string const& route) {
  for (CouplingClass const& c : table.classes)
    if (c.kind == ClassKind::scattered && route_name(table, c) == route) return c;
  ADD_FAILURE() << route;
  return {};
}
template <class Estimate>
SampleMean sampled(CouplingTable const& table, Estimate const& found) {
  return {found.mean, found.std_error, (long long)table.histories};
}
// Of a route with a row of its own or, where it is not resolved, in a row `other`.
SampleMean hint_of(CouplingTable const& table, std::uint64_t route) {
  for (CouplingClass const& c : table.classes) {
    if (c.hash == route) return sampled(table, c.coupling);
    for (FoldedRoute const& folded : c.folded)
      if (folded.hash == route) return sampled(table, folded);
  }
  ADD_FAILURE() << "no such route";
  return {};
}

// The inside of a cone scatters the light of the field and that of the rays twice (eq. W.60, W.61): together they do
// not depend on the angle. Control: the rays alone, which begin there.
TEST(Crossover, LightScatteredTwiceDoesNotDependOnIt) {
  std::string const twice = "E·S > baffles·S > baffles·S > E·S";
  CouplingTable const at_140 = traced_at(140), at_280 = traced_at(280), alone = traced_at(280, false);
  CouplingClass const route = rays_of(at_140, twice);
  SampleMean const before = sampled(at_140, route.coupling), after = sampled(at_280, rays_of(at_280, twice).coupling);
  expect_mean("scattered twice", difference(after, before), 0, 0.15 * before.mean);
  expect_rejected("rays alone", difference(hint_of(alone, route.hash), before), 0);
}

// Errors of the halo over mirrors, 8 and 10 % here, are printed with its h and do not keep the trace from its goal.
TEST(Crossover, StopRulesDoNotWaitForMirrors) {
  Folder const folder;
  constexpr std::uint64_t most = 1 << 16;
  expect_done({"run", crossover_arm, "-o", folder / "out", "--until", "class:* < 5 %, h_total < 5 %", "--histories",
               std::to_string(most), "--quiet"});
  EXPECT_LT(read_run(folder / "out/run.h5").trace.total.histories, most / 2);
  auto const said = nlohmann::json::parse(expect_done({"paths", folder / "out/run.h5", "--format", "json"}).out);
  int halos = 0;
  for (auto const& row : said["routes"]) {
    if (row["kind"] != "halo") continue;
    ++halos;
    double const coupling = row["coupling"]["sigma"].get<double>() / row["coupling"]["value"].get<double>();
    EXPECT_GT(coupling, 0.06);  // above the goal
    EXPECT_NEAR(row["strain"][0]["sigma"].get<double>() / row["strain"][0]["value"].get<double>(), coupling / 2, 1e-9);
  }
  EXPECT_EQ(halos, 2);
}

// Ctrl-C while rays are traced at the first angle: the table of what is done, and the words that it is not all.
TEST(Crossover, InterruptedSeamPrintsTheAnglesDone) {
  Program running({"wave", crossover_arm, "--seam", "--histories", "1e10"});
  ASSERT_TRUE(running.says("histories/s")) << running.said();
  running.interrupt();
  Finished const stopped = running.wait();
  EXPECT_EQ(stopped.code, 85) << stopped.err;
  EXPECT_THAT(stopped.err, ::testing::HasSubstr("interrupted after 1 of 3 angles"));
  EXPECT_THAT(stopped.out, ::testing::HasSubstr("largest change of rays and halo not known"));
}

}  // namespace
}  // namespace straytrace::testing::crossover
