// SPDX-License-Identifier: BSD-3-Clause
// Light of a cavity at small angles on baffles, in pictures: render --mode halo and view (docs/reference/render.md).
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>

#include "scenes/answers.hpp"

namespace straytrace::testing::halo_pictures {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

std::string const crossover_arm = source_folder + "/tests/scenes/crossover_arm.yaml";

std::vector<float> floats_of(std::string const& base64) {
  std::string const letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0, count = 0;
  for (char const c : base64) {
    if (c == '=') break;
    bits = bits << 6 | unsigned(letters.find(c));
    if ((count += 6) >= 8) bytes += char(bits >> (count -= 8) & 0xff);
  }
  std::vector<float> values(bytes.size() / sizeof(float));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(float));
  return values;
}

Json page_data(std::string const& file) {
  std::string const text = text_of(file), begin = "<script type=\"application/json\" id=\"data\">";
  std::size_t const at = text.find(begin) + begin.size();
  return Json::parse(text.substr(at, text.find("</script>", at) - at));
}

// W on the patches of a surface as they are drawn: irradiance times area between two edges, a disc or a cone.
double watts_of(Json const& surface, int sectors) {
  std::vector<float> const p = floats_of(surface["patches"]);
  double sum = 0;
  for (std::size_t i = 0; i + 5 < p.size(); i += 6) {
    double const width = std::hypot(p[i + 2] - p[i + 1], p[i + 4] - p[i + 3]);
    sum += double(p[i + 5]) * width * 3.14159265358979 * double(p[i + 1] + p[i + 2]) / sectors;
  }
  return sum;
}

// The field is solved once; what is drawn from its file is not solved again.
class HaloPictures : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    solved_ = std::make_unique<Folder>();
    wave_ = answer({"wave", crossover_arm, "--quiet", "--order", "0", "-o", field()});
  }
  static void TearDownTestSuite() { solved_.reset(); }
  static std::string field() { return *solved_ / "field.h5"; }

  static std::unique_ptr<Folder> solved_;
  static Json wave_;
  Folder const folder_;
};
std::unique_ptr<Folder> HaloPictures::solved_;
Json HaloPictures::wave_;

TEST_F(HaloPictures, PageHoldsTheWattsOfEachBaffle) {
  constexpr double power = 1e4;  // W, of the scene
  std::string const page = folder_ / "view.html";
  ASSERT_EQ(straytrace({"view", field(), "-o", page, "--rays", "0", "--quiet"}).code, 0);
  Json const halo = page_data(page)["scene"]["halo"];
  EXPECT_EQ(halo["in_watts"], true);
  std::map<std::pair<std::string, int>, double> drawn;  // by mirror, and place in m; edges to an eighth of a ring
  for (Json const& s : halo["surfaces"]) {
    EXPECT_EQ(s["name"], "baffles");
    double const watts = watts_of(s, halo["sectors"]);
    EXPECT_NEAR(watts / s["power"].get<double>(), 1, 1e-4);
    drawn[{s["towards"], int(std::lround(s["place"].get<double>()))}] += watts;
  }
  for (Json const& rim : wave_["edges"])
    for (char const* const towards : {"I", "E"}) {
      double field = 0;
      for (Json const& share :
           rim[towards[0] == 'I' ? "sector_shares_towards_mirror1" : "sector_shares_towards_mirror2"])
        field += power * share.get<double>();
      double const found = drawn[{towards, int(std::lround(rim["z_m"].get<double>()))}];
      EXPECT_NEAR(found / field, 1, 0.015) << rim["z_m"] << " towards " << towards;
    }
  EXPECT_GT(halo["high"], halo["low"]);
  // Control: a scene is not solved unbidden.
  ASSERT_EQ(straytrace({"view", crossover_arm, "-o", page, "--rays", "0", "--quiet"}).code, 0);
  EXPECT_FALSE(page_data(page)["scene"].contains("halo"));
}

TEST_F(HaloPictures, RenderPaintsTheLitSides) {
  std::string const png = folder_ / "halo.png";
  Words const command{"render", field(), "-o",     png,        "--mode",  "halo",   "--from",
                      "I",      "--fov", "0.1deg", "--pixels", "200x150", "--quiet"};
  Json const said = answer(command);
  ASSERT_EQ(said["halo"].size(), 1u);
  EXPECT_EQ(said["halo"][0]["object"], "baffles");
  double on_baffles = 0;
  for (Json const& rim : wave_["edges"])
    on_baffles +=
        1e4 * (rim["power_share_towards_mirror1"].get<double>() + rim["power_share_towards_mirror2"].get<double>());
  EXPECT_NEAR(said["halo"][0]["power_W"].get<double>() / on_baffles, 1, 0.1);
  EXPECT_THAT(said["scale"], HasSubstr("W/m^2 (yellow)"));
  std::string const lit = text_of(png);
  Words shaded = command;
  std::ranges::replace(shaded, std::string("halo"), std::string("shaded"));
  answer(shaded);
  EXPECT_NE(lit, text_of(png));
  Words one = command;
  one.insert(one.end(), {"--threads", "1"});
  answer(one);
  EXPECT_EQ(lit, text_of(png));
}

TEST_F(HaloPictures, NeedsAFieldWithBaffles) {
  std::string const png = folder_ / "a.png", two_mirrors = source_folder + "/examples/virgo_arm.yaml";
  EXPECT_THAT(error_text({"render", two_mirrors, "-o", png, "--mode", "halo"}), HasSubstr("has no table 'wave'"));
  EXPECT_THAT(error_text({"view", two_mirrors, "-o", folder_ / "a.html", "--halo"}), HasSubstr("has no table 'wave'"));
  std::string const bare = folder_ / "bare.yaml";
  write_text(bare, edited(text_of(crossover_arm), "baffles: \"baffles\", ", ""));
  EXPECT_THAT(error_text({"render", bare, "-o", png, "--mode", "halo"}), HasSubstr("names no baffles"));
  EXPECT_FALSE(fs::exists(png));
  EXPECT_THAT(straytrace({"render", two_mirrors, "-o", png, "--mode", "importance", "--pixels", "80x60"}).out,
              Not(HasSubstr("small angles")));
}

}  // namespace
}  // namespace straytrace::testing::halo_pictures
