// SPDX-License-Identifier: BSD-3-Clause
// straytrace render --flash: light returned from an arm and a bench, and errors. paths --by source.
#include <nlohmann/json.hpp>

#include <cmath>
#include <map>

#include "scenes/answers.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;

// From the input mirror: the end mirror sends a glint, baffles scatter. R/(2 d (1 - d/RoC))^2 of the intensity comes
// back from a concave mirror at d: the rays through a point at the height h of it return at a distance from the eye of
// 2 h (1 - d/RoC).
TEST(RenderFlash, GlintOfTheEndMirror) {
  Folder const folder;
  auto const said = answer({"render", virgo_arm, "-o", folder / "a.png", "--from", "ITM", "--fov", "0.05deg", "--flash",
                            "--lamp", "5cm", "--pixels", "400x300"});
  std::map<std::string, nlohmann::json> shine;
  for (auto const& o : said["shine"]) shine[o["object"]] = o;
  double const d = 2999.8, expected = 1 / std::pow(2 * d * (1 - d / 1683), 2);
  EXPECT_NEAR(shine["ETM"]["glint"].get<double>() / expected, 1, 0.05);
  EXPECT_GT(std::fabs(shine["ETM"]["glint"].get<double>() * 4 * d * d - 1), 0.3) << "control: a flat mirror";
  EXPECT_EQ(shine["baffles_in"]["glint"], 0);
  EXPECT_GT(shine["baffles_in"]["scattered"].get<double>(), 0);
  EXPECT_THAT(said["scale"].get<std::string>(), HasSubstr("glints"));
  std::string const first = text_of(folder / "a.png");
  answer({"render", virgo_arm, "-o", folder / "a.png", "--from", "ITM", "--fov", "0.05deg", "--flash", "--lamp", "5cm",
          "--pixels", "400x300", "--threads", "1"});
  EXPECT_EQ(text_of(folder / "a.png"), first);
}

TEST(RenderFlash, ErrorsStateARemedy) {
  Folder const folder;
  std::string const file = folder / "a.png";
  EXPECT_THAT(error_text({"render", virgo_arm, "-o", file, "--flash"}), HasSubstr("write --from NAME or --eye X,Y,Z"));
  EXPECT_THAT(error_text({"render", virgo_arm, "-o", file, "--from", "ITM", "--flash", "--lamp", "0"}),
              HasSubstr("write for example --lamp 5mm"));
  EXPECT_THAT(error_text({"render", virgo_arm, "-o", file, "--from", "ITM", "--lamp", "-5mm"}),
              HasSubstr("--lamp requires --flash"));
  EXPECT_FALSE(fs::exists(file));
}

// Sources by receivers: the numbers of the routes. Control: light of both beams together is not that of one source.
TEST(PathsBySource, SumsResolvedRoutes) {
  Folder const folder;
  std::string const run = folder / "a.h5";
  ASSERT_EQ(
      straytrace({"trace", source_folder + "/examples/two_mirrors.yaml", "-o", run, "--histories", "131072", "--quiet"})
          .code,
      0);
  Finished const text = straytrace({"paths", run, "--by", "source"}),
                 csv = straytrace({"paths", run, "--by", "source", "--csv"});
  EXPECT_THAT(text.out, HasSubstr("not resolved"));
  EXPECT_THAT(csv.out, HasSubstr("source,receiver,power,power_sigma\n"));
  EXPECT_THAT(csv.out, HasSubstr("PD"));
}

}  // namespace
}  // namespace straytrace::testing
