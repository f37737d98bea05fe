// SPDX-License-Identifier: BSD-3-Clause
// straytrace render, importance and paths --first-order: examples of the help, legends, and messages.
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <png.h>
#include <set>

#include "base/math/vec3.hpp"
#include "scenes/program.hpp"

namespace straytrace::testing::app_render {
namespace {

using ::testing::HasSubstr;

std::string const bench = source_folder + "/examples/bench.yaml";

struct Picture {
  unsigned columns = 0, rows = 0;
  std::vector<std::uint8_t> rgb;
  std::set<unsigned> colours() const {
    std::set<unsigned> all;
    for (std::size_t i = 0; i + 2 < rgb.size(); i += 3) all.insert(rgb[i] << 16 | rgb[i + 1] << 8 | rgb[i + 2]);
    return all;
  }
};
Picture read_png(std::string const& file) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_file(&image, file.c_str())) << file;
  image.format = PNG_FORMAT_RGB;
  Picture p{image.width, image.height, std::vector<std::uint8_t>(PNG_IMAGE_SIZE(image))};
  EXPECT_TRUE(png_image_finish_read(&image, nullptr, p.rgb.data(), 0, nullptr));
  return p;
}

nlohmann::json rendered(Words words) {
  words.insert(words.begin(), "render");
  words.insert(words.end(), {"--format", "json"});
  if (std::ranges::find(words, "--pixels") == words.end()) words.insert(words.end(), {"--pixels", "160x120"});
  Finished const r = straytrace(words);
  EXPECT_EQ(r.code, 0) << r.err;
  return r.code == 0 ? nlohmann::json::parse(r.out) : nlohmann::json();
}

TEST(Render, ExamplesOfTheHelpRun) {
  Folder const folder;
  fs::create_directory_symlink(source_folder + "/examples", folder / "examples");
  Finished const help = straytrace({"render", "--help"});
  EXPECT_THAT(help.out, HasSubstr("straytrace render examples/bench.yaml -o bench.png"));
  EXPECT_THAT(help.out, HasSubstr("straytrace render examples/virgo_arm.yaml -o view.png --from ITM --fov 2deg"));
  Finished const one = straytrace({"render", "examples/bench.yaml", "-o", "bench.png"}, {folder.path()});
  EXPECT_EQ(one.code, 0) << one.err;
  EXPECT_THAT(one.out, HasSubstr("lens_1"));
  EXPECT_THAT(one.out, HasSubstr("photodiode"));
  Picture const p = read_png(folder / "bench.png");
  EXPECT_EQ(p.columns, 800u);
  EXPECT_EQ(p.rows, 600u);
  EXPECT_GT(p.colours().size(), 100u);
  Finished const two = straytrace(
      {"render", "examples/virgo_arm.yaml", "-o", "view.png", "--from", "ITM", "--fov", "2deg"}, {folder.path()});
  EXPECT_EQ(two.code, 0) << two.err;
  EXPECT_THAT(two.out, HasSubstr("baffles_in"));
  EXPECT_EQ(two.out.find(" tube\n"), std::string::npos) << "the shadow rule hides the wall";
}

// Every colour of an id picture is in its legend. Control: another picture's legend lacks some.
TEST(Render, IdsAreInTheLegend) {
  Folder const folder;
  std::string const file = folder / "id.png";
  auto const legend = [](nlohmann::json const& said) {
    std::set<unsigned> colours{0};
    for (auto const& e : said["legend"])
      colours.insert(unsigned(std::stoul(e["colour"].get<std::string>().substr(1), nullptr, 16)));
    return colours;
  };
  auto const whole = legend(rendered({bench, "-o", file, "--mode", "id"}));
  auto const drawn = read_png(file).colours();
  EXPECT_TRUE(std::includes(whole.begin(), whole.end(), drawn.begin(), drawn.end()));
  EXPECT_GT(drawn.size(), 10u);
  auto const one =
      legend(rendered({bench, "-o", file, "--mode", "id", "--eye", "0,0,12cm", "--look", "0,0,30cm", "--fov", "5deg"}));
  EXPECT_FALSE(std::includes(one.begin(), one.end(), drawn.begin(), drawn.end()));
}

// The same object has the same colour in every picture; the number of threads changes nothing.
TEST(Render, ColoursAndBitsAreStable) {
  Folder const folder;
  std::string const file = folder / "a.png", other = folder / "b.png";
  auto const colour = [](nlohmann::json const& said, std::string const& object) -> std::string {
    for (auto const& e : said["legend"])
      if (e["object"] == object) return e["colour"];
    return "none";
  };
  auto const all = rendered({bench, "-o", file, "--threads", "1"}),
             one = rendered({bench, "-o", other, "--at", "lens_1"});
  EXPECT_EQ(colour(all, "lens_1"), colour(one, "lens_1"));
  EXPECT_NE(colour(all, "lens_1"), "none");
  rendered({bench, "-o", other, "--threads", "4"});
  EXPECT_EQ(text_of(file), text_of(other));
}

TEST(Render, OtherModesDraw) {
  Folder const folder;
  std::string const file = folder / "a.png";
  for (std::string const mode : {"depth", "normal", "importance"}) {
    auto const said = rendered({virgo_arm, "-o", file, "--mode", mode});
    EXPECT_FALSE(said["scale"].get<std::string>().empty()) << mode;
    EXPECT_GT(read_png(file).colours().size(), 5u) << mode;
  }
  EXPECT_NEAR(rendered({bench, "-o", file, "--fov", "90deg"})["focal_length_pixels"].get<double>(), 60, 1e-9);
  rendered({bench, "-o", file, "--cut", "x=0", "--cut", "y>10cm", "--whole", "--section"});
}

// Whether two pictures by one camera differ where a point is.
bool differ_at(Picture const& a, Picture const& b, nlohmann::json const& camera, Vec3 point) {
  auto const vector = [&](char const* key) { return Vec3{camera[key][0], camera[key][1], camera[key][2]}; };
  Vec3 const forward = vector("forward"), up = vector("up"), right = cross(forward, up), v = point - vector("eye");
  double const f = camera["focal_length_pixels"], ahead = dot(v, forward);
  int const column = int(0.5 * a.columns + f * dot(v, right) / ahead), row = int(0.5 * a.rows - f * dot(v, up) / ahead);
  std::size_t const at = 3 * (std::size_t(row) * a.columns + std::size_t(column));
  return std::abs(int(a.rgb.at(at)) - int(b.rgb.at(at))) > 20;
}

// The main beam of the bench runs along z, and along x behind the folding mirror: solid in sight, dotted behind the
// table. Control: 3 cm beside it nothing is drawn.
TEST(Render, BeamsLieOnTheirChiefRay) {
  Folder const folder;
  std::string const with = folder / "with.png", without = folder / "without.png";
  struct Case {
    std::string eye;
    double least, most;  // share of the points
  };
  for (Case const& c : {Case{"-35cm,70cm,5cm", 0.9, 1}, Case{"10cm,-90cm,50cm", 0.3, 0.8}}) {
    Words words{bench,         "-o",    without, "--eye=" + c.eye, "--look",
                "10cm,0,50cm", "--fov", "60deg", "--pixels",       "640x480"};
    rendered(words);
    words[2] = with;
    words.emplace_back("--beams");
    auto const camera = rendered(words);
    Picture const a = read_png(with), b = read_png(without);
    int on = 0, beside = 0, all = 0;
    for (double s = 0.12; s < 1.05; s += 0.002, ++all) {
      Vec3 const point = s < 0.79 ? Vec3{0, 0, s} : Vec3{s - 0.8, 0, 0.8};
      on += differ_at(a, b, camera, point);
      beside += differ_at(a, b, camera, point + (s < 0.79 ? Vec3{-0.03, 0, 0} : Vec3{0, 0, 0.03}));
    }
    EXPECT_GE(on, c.least * all) << c.eye;
    EXPECT_LE(on, c.most * all) << c.eye;
    EXPECT_LT(beside, 0.05 * all) << c.eye;
  }
}

TEST(Render, ErrorsOfOptionsStateARemedy) {
  Folder const folder;
  std::string const file = folder / "a.png";
  struct Case {
    Words words;
    std::string says;
  };
  for (Case const& c : {Case{{"--eye", "0,0,1"}, "--eye 0,20cm,-1.5m"}, Case{{"--eye", "0,0"}, "--eye 0,20cm,-1.5m"},
                        Case{{"--fov", "200deg"}, "--fov 30deg"}, Case{{"--pixels", "800"}, "--pixels 800x600"},
                        Case{{"--cut", "w=0"}, "--cut x=0"}, Case{{"--at", "lens_9"}, "did you mean 'lens_1'"},
                        Case{{"--from", "PDD"}, "the scene has no"}, Case{{"--beams", "--mode", "id"}, "--mode shaded"},
                        Case{{"--look", "0,0,0"}, "--eye"}}) {
    Words words{"render", bench, "-o", file};
    words.insert(words.end(), c.words.begin(), c.words.end());
    Finished const r = straytrace(words);
    EXPECT_EQ(r.code, 2) << c.words[1];
    EXPECT_THAT(r.err, HasSubstr(c.says)) << c.words[1];
  }
  Finished const r = straytrace({"render", bench, "-o", folder / "no/such/folder.png"});
  EXPECT_EQ(r.code, 2);
  EXPECT_FALSE(fs::exists(file));
}

// A scene without problems of its beams: what is lit and seen on the bench. The fold mirror is lit by the lenses.
TEST(FirstOrderLists, OfTheBench) {
  Finished const text = straytrace({"paths", bench, "--first-order", "--histories", "20000"});
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("illuminated"));
  EXPECT_THAT(text.out, HasSubstr("Seen from receiver PD"));
  Finished const r = straytrace({"paths", bench, "--first-order", "--histories", "20000", "--format", "json"});
  auto const lists = nlohmann::json::parse(r.out);
  ASSERT_EQ(lists.size(), 1u);
  bool fold = false;
  for (auto const& row : lists[0]["surfaces"])
    if (row["surface"] == "fold/front") {
      fold = true;
      EXPECT_GT(row["power"]["value"].get<double>(), 0.5);
      EXPECT_GT(row["throughput"]["value"].get<double>(), 0);
    }
  EXPECT_TRUE(fold);
  Finished const csv = straytrace({"paths", bench, "--first-order", "--histories", "20000", "--csv"});
  EXPECT_EQ(csv.out.rfind("ending,surface,power", 0), 0u);
}

TEST(Importance, TableOfTheArm) {
  Finished const text = straytrace({"importance", virgo_arm, "--show", "3"});
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("and "));
  Finished const r = straytrace({"importance", virgo_arm, "--format", "json"});
  double most = 0;
  for (auto const& row : nlohmann::json::parse(r.out)) most = std::max(most, row["adjoint_front"].get<double>());
  EXPECT_GT(most, 0);
}

// A run keeps the map it was steered by; other parameters are another scene.
TEST(Importance, OfARunIsThatOfItsScene) {
  Folder const folder;
  std::string const run = folder / "run.h5", from_run = folder / "run.png", from_scene = folder / "scene.png";
  Finished const traced = straytrace({"trace", bench, "-o", run, "--histories", "4096", "--quiet"});
  ASSERT_EQ(traced.code, 0) << traced.err;
  Finished const kept = straytrace({"importance", run, "--csv"}), made = straytrace({"importance", bench, "--csv"});
  EXPECT_EQ(kept.code, 0) << kept.err;
  EXPECT_EQ(kept.out, made.out);
  rendered({run, "-o", from_run, "--mode", "importance"});
  rendered({bench, "-o", from_scene, "--mode", "importance"});
  EXPECT_EQ(text_of(from_run), text_of(from_scene));
  Finished const virgo = straytrace({"importance", virgo_arm, "--csv"}),
                 wider = straytrace({"importance", virgo_arm, "-p", "rim=50cm", "--csv"});
  EXPECT_NE(virgo.out, wider.out) << "negative control";
}

}  // namespace
}  // namespace straytrace::testing::app_render
