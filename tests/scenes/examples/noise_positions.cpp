// SPDX-License-Identifier: BSD-3-Clause
// Positions of a body in one command (docs/theory/spectra.md, eq. N.26).
#include <nlohmann/json.hpp>

#include <cmath>

#include "scenes/program.hpp"

namespace straytrace::testing::noise_positions {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string const bench = text_of(source_folder + "/examples/benches/swinging_bench.yaml");

std::string with(std::string const& phase) {
  return edited(edited(bench, "static_phase: {bench: phi}", phase), "histories: 131072", "histories: 8192");
}

nlohmann::json strain_of(Folder const& folder, std::string const& text) {
  write_text(folder / "a.yaml", text);
  Finished const done = straytrace({"run", folder / "a.yaml", "-o", folder / "out", "--force", "--format", "json"});
  EXPECT_EQ(done.code, 0) << done.err;
  return nlohmann::json::parse(done.out)["total_strain"];
}

TEST(NoisePositions, AsOneRunForEach) {
  Folder const folder;
  nlohmann::json const all = strain_of(folder, with("static_phase: {bench: {positions: 4}}"));
  std::string const columns = text_of(folder / "out/h_asd.txt");
  EXPECT_THAT(columns, HasSubstr(" static_phase_0deg static_phase_45deg static_phase_90deg static_phase_135deg "
                                 "positions_low positions_high\n"));
  nlohmann::json const one = strain_of(folder, with("static_phase: {bench: 45 deg}"));
  EXPECT_THAT(text_of(folder / "out/h_asd.txt"), Not(HasSubstr("positions_low"))) << "control";
  nlohmann::json const &positions = all[0]["positions"], &curve = positions["curves"][1];
  EXPECT_EQ(curve["static_phase_deg"], 45);
  EXPECT_NEAR(curve["h"].get<double>() / one[0]["value"].get<double>(), 1, 1e-9);
  double mean = 0;
  for (auto const& c : positions["curves"]) mean += std::pow(c["h"].get<double>(), 2) / 4;
  EXPECT_NEAR(std::sqrt(mean) / all[0]["value"].get<double>(), 1, 1e-9);
  EXPECT_GT(positions["highest"].get<double>() / positions["lowest"].get<double>(), 2) << "control: it matters";
}

TEST(NoisePositions, OneBodyAtATime) {
  Folder const folder;
  write_text(folder / "a.yaml", edited(with("static_phase: {bench: {positions: 4}, other: {positions: 3}}"),
                                       "bodies: {", "bodies: {other: {motion: still}, "));
  Finished const done = straytrace({"check", folder / "a.yaml"});
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, HasSubstr("'bench' and 'other' both have positions"));
}

}  // namespace
}  // namespace straytrace::testing::noise_positions
