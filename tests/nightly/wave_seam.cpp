// SPDX-License-Identifier: BSD-3-Clause
// The noise of detectors at three crossover angles, on which it must not depend (docs/theory/wave.md, eq. W.21):
// validation case V16 with arms of the library.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "scenes/benches.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing::nightly_seam {
namespace {

struct Detector {
  char const *arm, *crossover;
  int map_draws = 1;  // so that five standard errors of the change of light from baffles stay below 3 %
};

nlohmann::json seam_of(Detector const& detector) {
  Folder const folder;
  write_text(folder / "arm.yaml",
             text_of(fmt::format("{}/examples/{}_arm.yaml", source_folder, detector.arm)) +
                 fmt::format("wave: {{beam: arm, baffles: \"baffles*\", crossover: {}, map_draws: {}}}\n",
                             detector.crossover, detector.map_draws));
  Launch slow;
  slow.seconds = 3600;
  Finished const done =
      straytrace({"wave", folder / "arm.yaml", "--seam", "--histories", "1e6", "--quiet", "--format", "json"}, slow);
  EXPECT_EQ(done.code, 0) << done.err;
  return nlohmann::json::parse(done.out);
}

double spread(nlohmann::json const& seam, char const* curve) {
  double low = 1e300, high = 0;
  for (auto const& point : seam["points"]) {
    low = std::fmin(low, point[curve]["value"].get<double>());
    high = std::fmax(high, point[curve]["value"].get<double>());
  }
  return high / low - 1;
}

class DetectorSeam : public ::testing::TestWithParam<Detector> {};

// Light from baffles, of rays and halo together, whose shares change by much more; and all stray light, with edges.
TEST_P(DetectorSeam, StrayLightIsTheSameV16) {
  auto const seam = seam_of(GetParam());
  ASSERT_EQ(seam["points"].size(), 3u);
  for (char const* const of : {"change_of_rays_and_halo", "change_of_total"})
    EXPECT_LT(std::fabs(seam[of]["value"].get<double>()), 0.03) << of;
  EXPECT_LT(5 * seam["change_of_rays_and_halo"]["sigma"].get<double>(), 0.03);
  EXPECT_GT(std::fmax(spread(seam, "rays"), spread(seam, "halo")), 0.1);  // control
}

INSTANTIATE_TEST_SUITE_P(V16, DetectorSeam,
                         ::testing::Values(Detector{"et_hf", "100 urad"}, Detector{"et_lf", "100 urad", 2},
                                           Detector{"ce", "60 urad"}, Detector{"kagra", "120 urad"},
                                           Detector{"ligo", "120 urad", 4}, Detector{"virgo", "120 urad"}),
                         [](auto const& info) { return std::string(info.param.arm); });

}  // namespace
}  // namespace straytrace::testing::nightly_seam
