// SPDX-License-Identifier: BSD-3-Clause
// The wording and layout of messages (docs/reference/scene.md).
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <sstream>

#include "unit/scene/support.hpp"

namespace straytrace::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// The readers that other rooms call, in the order of a reader of shapes, materials and motion.
void read_like_the_rooms(Scene const& scene) {
  Node const sine = scene.table("bodies").table("tube").table("motion").table("z");
  sine.amplitude("sine", dim::length);
  sine.number("frequency", dim::frequency);
  for (Scene::Instance const& i : scene.instances()) {
    Node const cone = i.node.table("shape").table("cone");
    cone.number("inner_radius", dim::length);
    cone.number("outer_radius", dim::length, 0.5);
    cone.number("height", dim::length, 0.1);
    cone.number("half_angle", dim::angle);
    cone.refuse_unknown("shape 'cone'");
    std::vector<std::string> known;
    for (auto const& [name, material] : scene.table("materials").items()) known.push_back(name);
    Node const material = i.node["material"];
    std::string const near = nearest_word(material.text(), known);
    if (near != material.text())
      material.problem(
          "material '" + material.text() + "' is not defined",
          "did you mean '" + near + "' (line " + std::to_string(scene.table("materials").key_place(near).line) + ")?");
  }
}

TEST(Messages, TheBlockOfTheInterface) {
  std::string const text =
      "straytrace: 1\n"
      "title: broken\n"
      "params: {L: 3 km, aperture: 84 cm}\n"
      "materials:\n"
      "  dlc: {preset: dlc}\n"
      "  steel: {preset: steel}\n"
      "bodies:\n"
      "  tube: {motion: {z: {sine: 10 um, frequency: 1.14 Hz}}}\n"
      "# nothing\n"
      "parts:\n"
      "  baffle:\n"
      "    faces:\n"
      "      cone: {shape: {cone: {inner_radius: aperture/2, heigth: 10 cm, half_angle: 55}}, material: dcl}\n"
      "\n"
      "scene:\n"
      "  - {name: baffles, use: baffle, body: tube, repeat: {count: 40, along: z, from: 50 m, to: L - 50}}\n"
      "  - {name: one, use: baffle}\n";
  std::string const expected =
      R"(arm.yaml:8:29: error: "10 um" does not say which amplitude it is
    8 |   tube: {motion: {z: {sine: 10 um, frequency: 1.14 Hz}}}
      |                             ^^^^^ write '10 um peak', '10 um pp' or '10 um rms'
arm.yaml:13:55: error: unknown key 'heigth' in shape 'cone'
   13 |       cone: {shape: {cone: {inner_radius: aperture/2, heigth: 10 cm, half_angle: 55}}, material: dcl}
      |                                                       ^^^^^^ did you mean 'height'?
arm.yaml:13:82: error: 'half_angle' is an angle, got "55" without a unit
   13 |       cone: {shape: {cone: {inner_radius: aperture/2, heigth: 10 cm, half_angle: 55}}, material: dcl}
      |                                                                                  ^^ write '55 deg' (accepted: rad, mrad, urad, deg, arcmin, arcsec)
arm.yaml:13:98: error: material 'dcl' is not defined
   13 |       cone: {shape: {cone: {inner_radius: aperture/2, heigth: 10 cm, half_angle: 55}}, material: dcl}
      |                                                                                                  ^^^ did you mean 'dlc' (line 5)?
arm.yaml:16:92: error: cannot subtract a plain number from a length
   16 |   - {name: baffles, use: baffle, body: tube, repeat: {count: 40, along: z, from: 50 m, to: L - 50}}
      |                                                                                            ^^^^^^ write 'L - 50 m'
5 errors. Nothing was run.
)";
  FileTexts const texts{{"arm.yaml", text}};
  Scene const scene = scene_of(texts);
  read_like_the_rooms(scene);
  try {
    scene.throw_if_problems();
    FAIL() << "no error was reported";
  } catch (InputError const& e) {
    EXPECT_EQ(std::string(e.what()), expected);
    ASSERT_EQ(e.problems.size(), 5u);
    auto const json = nlohmann::ordered_json::parse(problems_as_json(e));
    EXPECT_THAT(
        json[0].dump(),
        StartsWith(
            R"({"file":"arm.yaml","line":8,"column":29,"width":5,"end_column":34,"severity":"error","what":"\"10 um\" does not say)"));
  }
}

TEST(Messages, MissingKeyNamesUnitAndExample) {
  Scene const scene = scene_of("trace: {b: 1}\n");
  scene.table("trace").number("radius", dim::length);
  scene.table("trace").number("share", dim::plain, required, 0, 0.5);
  scene.table("trace").word("model");
  scene.table("trace").amplitude("sine", dim::length);
  try {
    scene.throw_if_problems();
    FAIL();
  } catch (InputError const& e) {
    EXPECT_THAT(e.what(), HasSubstr("arm.yaml:2:8: error: key 'radius' (a length) is missing in 'trace'"));
    EXPECT_THAT(e.what(), HasSubstr("add 'radius: 1 m' (accepted: m, km, cm, mm, um, nm, in)"));
    EXPECT_THAT(e.what(), HasSubstr("add 'share: 0.5'"));
    EXPECT_THAT(e.what(), HasSubstr("key 'model' (text) is missing in 'trace'"));
    EXPECT_THAT(e.what(), HasSubstr("add 'sine: 1 m peak' (or pp, or rms)"));
    EXPECT_THAT(e.what(), HasSubstr("4 errors. Nothing was run."));
  }
}

TEST(Messages, RangesChoicesAndKinds) {
  Scene const scene =
      scene_of("trace: {a: 2, b: -1 m, c: 100 deg, model: lambertain, s: maybe, t: 5, l: [1 m, 2], w: {x: 1}, u: 3}\n");
  Node const t = scene.table("trace");
  EXPECT_TRUE(std::isnan(t.number("a", dim::plain, required, 0, 1)));
  EXPECT_TRUE(std::isnan(t.number("b", dim::length, required, 0)));
  EXPECT_TRUE(std::isnan(t.number("c", dim::angle, required, 0, pi / 2)));
  std::array<std::string_view, 2> const models{"lambertian", "abg"};
  t.choice("model", models);
  t.flag("s", true);
  EXPECT_FALSE(t.table("t"));
  t["l"].as_numbers(dim::length, 3);
  t["l"].as_numbers(dim::length, 2);
  t.number("w", dim::length);
  t.refuse_unknown("'trace'");
  try {
    scene.throw_if_problems();
    FAIL();
  } catch (InputError const& e) {
    for (char const* what : {"'a' must be between 0 and 1, got \"2\"", "'b' must be at least 0, got \"-1 m\"",
                             "'c' must be between 0 and 90 deg, got \"100 deg\"", "'model' cannot be \"lambertain\"",
                             "did you mean 'lambertian'? (accepted: lambertian, abg)", "'s' is a switch, got \"maybe\"",
                             "'t' needs a table of keys, got a single value", "'l' needs 3 values, got 2",
                             "'l' is a length, got \"2\" without a unit", "'w' is a length, got a table of keys",
                             "unknown key 'u' in 'trace'", "10 errors. Nothing was run."})
      EXPECT_THAT(e.what(), HasSubstr(what));
  }
}

TEST(Messages, ValuesFromTheCommandLineAreNamed) {
  auto const said = [](std::string const& value) {
    Scene const scene = scene_of("params: {L: 3 km}\ntrace: {x: " + value + "}\n", {"L=-3km"});
    scene.table("trace").number("x", dim::length, required, 0, 1e6);
    return said_by(scene);
  };
  EXPECT_THAT(said("2*L"), HasSubstr("^ it is -6000 m (-p L=-3km): write a value between 0 and 1e+06 m"));
  EXPECT_THAT(said("-3 km"), HasSubstr("^ write a value between 0 and 1000 km"));  // a literal is printed already
  EXPECT_EQ(said("-L"), "");
}

TEST(Messages, RepeatedWarningsStayQuiet) {
  Scene const scene = scene_of("trace: {a: , b: 5}\n");
  scene.table("trace").number("a", dim::length);
  scene.table("trace").table("b").number("c", dim::length);
  scene.table("trace").table("b").table("d").word("e");
  try {
    scene.throw_if_problems();
    FAIL();
  } catch (InputError const& e) {
    EXPECT_EQ(e.problems.size(), 2u) << e.what();
  }
}

TEST(Messages, DataFilesReportTheSameWay) {
  FileTexts const texts{{"arm.yaml", "straytrace: 1\ntrace: {file: data/steel.csv}\n"},
                        {"data/steel.csv", "# angle, brdf\n0, 1\n71, -2e-7\n"}};
  Scene const scene = scene_of(texts);
  Node const file = scene.table("trace")["file"];
  EXPECT_EQ(file.data_file(file.text()), texts.at("data/steel.csv"));
  file.file_problem(file.text(), 3, 5, "BRDF -2e-7 /sr at 71 deg", "remove this point");
  file.file_problem(file.text(), 0, 0, "no wavelength is declared", "add a header line");
  try {
    scene.throw_if_problems();
    FAIL();
  } catch (InputError const& e) {
    EXPECT_EQ(std::string(e.what()), R"(data/steel.csv: error: no wavelength is declared
      | add a header line
data/steel.csv:3:5: error: BRDF -2e-7 /sr at 71 deg
    3 | 71, -2e-7
      |     ^ remove this point
2 errors. Nothing was run.
)");
  }
}

TEST(Messages, WarningsAreAggregatedAndDoNotStop) {
  Scene const scene = scene_of("trace: {a: 1, b: 2}\n");
  for (char const* key : {"a", "b"}) scene.table("trace")[key].warning("is extrapolated", "measure more");
  EXPECT_NO_THROW(scene.throw_if_problems());
  EXPECT_EQ(scene.warnings(), R"(arm.yaml:2:12: warning: is extrapolated (2 places, this is the first)
    2 | trace: {a: 1, b: 2}
      |            ^ measure more
)");
}

TEST(Messages, LongLinesAndControlCharactersAreTamed) {
  std::string const said =
      errors_of("trace: {l: " + std::string(5000, 'x') + ", a: 1, a: 2, b: \"" + std::string(5000, 'y') + "\"}\n");
  std::size_t longest = 0;
  std::istringstream lines(said);
  for (std::string line; std::getline(lines, line);) longest = std::max(longest, line.size());
  EXPECT_LT(longest, 260u);
  EXPECT_THAT(said, HasSubstr("a: 2, b: "));
  std::string const escaped = errors_of(FileTexts{{"arm.yaml", "straytrace: 1\ntitle: \x1b[31m\n"}});
  EXPECT_EQ(escaped.find('\x1b'), std::string::npos);
}

TEST(Messages, JsonEscapesText) {
  InputError const e({{{0, 1, 2}, "a \"b\" \\ \n", "c", Severity::error, 3}}, "text", {"x.yaml"});
  EXPECT_EQ(nlohmann::json::parse(problems_as_json(e))[0]["what"], "a \"b\" \\ \n");
  auto const plain = nlohmann::json::parse(problems_as_json(InputError("plain", "remedy")))[0];
  EXPECT_EQ(plain["what"], "plain");
  EXPECT_EQ(plain["suggestion"], "remedy");
  EXPECT_EQ(plain["file"], "");
  EXPECT_EQ(plain["line"], 0);
  EXPECT_STREQ(InputError("plain", "remedy").what(), "error: plain\n  remedy");
}

// A remedy of several lines is printed as such, each behind the bar; other control characters never are.
TEST(Messages, RemediesKeepTheirLines) {
  FileTexts const texts{{"a.yaml", "straytrace: 1\ntitle: x\n"}};
  Scene const scene = read_scene("a.yaml", {}, &texts);
  scene.root()["title"].warning("something is wrong", "write\n  one: 1\n\x1b[2Jtwo: 2");
  EXPECT_THAT(scene.warnings(), HasSubstr("^ write\n      |   one: 1\n      | ?[2Jtwo: 2\n"));
  scene.root()["title"].warning("something else", "write one: 1");
  EXPECT_THAT(scene.warnings(), HasSubstr("^ write one: 1\n"));
}

// A misspelt required key is one error. Control: a key that is near no missing one.
TEST(Messages, AMisspeltRequiredKeyIsOneError) {
  auto const said = [](std::string const& keys) {
    Scene const scene = scene_of("trace: {" + keys + "}\n");
    Node const trace = scene.table("trace");
    trace.number("width", dim::length);
    trace.number("height", dim::length, 1);
    trace.refuse_unknown("'trace'");
    try {
      scene.throw_if_problems();
    } catch (InputError const& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_THAT(said("widht: 1 m"), ::testing::AllOf(HasSubstr("unknown key 'widht' in 'trace'"),
                                                   HasSubstr("did you mean 'width'?"), HasSubstr("1 error.")));
  EXPECT_THAT(said("heigth: 1 m"), ::testing::AllOf(HasSubstr("key 'width' (a length) is missing"),
                                                    HasSubstr("did you mean 'height'?"), HasSubstr("2 errors.")));
}

// A binary file in place of a text file gives one sentence, and none of its bytes. Control: text with one stray
// byte.
TEST(Messages, BytesOfABinaryFileAreNotPrinted) {
  std::string const zeros(
      "\x7f"
      "ELF\x02\x01\0\0\0label\n12 13\n",
      22);
  auto const said = [](std::string const& data) {
    FileTexts const texts{{"a.yaml", "straytrace: 1\ntitle: data.txt\n"}, {"data.txt", data}};
    Scene const scene = read_scene("a.yaml", {}, &texts);
    Node const file = scene.root()["title"];
    file.data_file(file.text());
    for (std::uint32_t line : {1u, 2u}) file.file_problem(file.text(), line, 1, "'ELF' is not a number", "write one");
    try {
      scene.throw_if_problems();
    } catch (InputError const& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(said(zeros),
            "data.txt: error: this is a binary file, but a text file is needed here\n"
            "      | name a text file, or export it as text\n1 error. Nothing was run.\n");
  EXPECT_THAT(said("label\x01, some more text\n1\n"), HasSubstr("data.txt:1:1: error: 'ELF' is not a number"));
}

}  // namespace
}  // namespace straytrace::test
