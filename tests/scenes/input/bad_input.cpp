// SPDX-License-Identifier: BSD-3-Clause
// Wrong input is an error with place, reason and remedy, and leaves no files (docs/reference/commands.md).
#include <nlohmann/json.hpp>

#include <regex>

#include "scenes/program.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;

struct Case {
  std::string name, from, to;      // of examples/virgo_arm.yaml
  std::string at;                  // the text at the place named; empty: the file as a whole
  std::string reason, suggestion;  // parts of the message
  int errors = 1;                  // in all: no message may repeat itself or drag others along
};

std::vector<Case> const cases = {
    {"wrong unit", "mirror_radius: 17.5 cm", "mirror_radius: 17.5 cmm", "cmm", "'cmm' is not a unit", "known units: m"},
    {"missing unit", "half_angle: 35 deg", "half_angle: 35", "35}",
     "'half_angle' is an angle, got \"35\" without a unit", "write '35 deg'"},
    {"wrong dimension", "half_angle: 35 deg", "half_angle: 35 m", "35 m", "'half_angle' is an angle, got \"35 m\"",
     "write an angle"},
    {"unknown key", "half_angle: 35 deg", "half_angel: 35 deg", "half_angel",
     "unknown key 'half_angel' in shape 'cone'", "did you mean 'half_angle'?"},
    {"unknown table", "noise:", "nose:", "nose", "unknown key 'nose'", "did you mean 'noise'?"},
    {"no interferometer", "interferometer:", "interferometr:", "interferometr", "unknown key 'interferometr'",
     "did you mean 'interferometer'?"},
    {"ports without an interferometer",
     "interferometer:\n  preset: fabry-perot-michelson\n  arm_length: L\n  mirror_mass: 42 kg\n"
     "  input_transmission: 1.4 %\n  end_transmission: 1 ppm\n  round_trip_loss: 75 ppm\n"
     "  signal_recycling_transmission: 20 %\n  arms: 2\n",
     "", "straytrace", "the scene has ports but no 'interferometer'", "add 'interferometer: {preset:"},
    {"key twice", "towers: {motion: still}", "towers: {motion: still}\n  ETM: {motion: still}",
     "ETM:", "key 'ETM' is written twice", "remove one of them"},
    {"name twice", "{name: link_in,", "{name: tube,", "tube,", "name 'tube' is used twice", "choose another name"},
    {"material as a table", "material: baffle_steel", "material: {scatter: baffle_steel}", "{scatter",
     "'material' is a single text, got a table", "write 'material: text'"},
    {"material", "material: baffle_steel", "material: bafle_steel", "bafle_steel",
     "material 'bafle_steel' is not defined", "did you mean 'baffle_steel'?"},
    {"body", "{name: baffles_in, use: baffle, body: tube", "{name: baffles_in, use: baffle, body: tubes", "tubes",
     "body 'tubes' is not defined", "did you mean 'tube'?"},
    {"part", "{name: baffles_in, use: baffle,", "{name: baffles_in, use: bafle,", "bafle",
     "part 'bafle' is not defined", "did you mean 'baffle'?"},
    {"beam", "ITM: {beam: arm,", "ITM: {beam: arms,", "arms", "beam 'arms' is not defined", "did you mean 'arm'?"},
    {"surface", "cavity: [ITM, ETM]", "cavity: [ITM, EMT]", "EMT", "'EMT' is not a surface of the scene",
     "did you mean 'ETM'?"},
    {"shape", "shape: {cone:", "shape: {cones:", "{cones", "unknown shape 'cones'", "did you mean 'cone'?"},
    {"rim wider than the wall", "rim: 49.5 cm ", "rim: 62 cm ", "{inner_radius", "the rim (0.62 m) is not smaller",
     "make inner_radius smaller than outer_radius"},
    {"unstable cavity", "radius_of_curvature: 1420 m", "radius_of_curvature: 100 m", "[ITM, ETM]",
     "the cavity is unstable: g1 g2 = 22.6884", "change the mirror curvatures or the length"},
    {"mirror turned away", "facing: [0, 0, 1], body: ITM", "facing: [0, 0, -1], body: ITM", "[ITM, ETM]",
     "the mirrors of 'arm' do not face each other", "set 'at' and 'facing'"},
    {"in the beam", "  - {name: link_in,",
     "  - {name: plug, shape: {disk: {outer_radius: 1 cm}}, at: [0 m, 0 m, 100 m], body: tube, material: black}\n"
     "  - {name: link_in,",
     "{cavity", "'plug' obstructs the beam 'arm'", "give it a hole or move it"},
    {"more light out than in", "tis: 39.5 %", "tis: 99.9 %", "specular",
     "material 'tube_steel' violates energy conservation", "lower one of them"},
    {"negative scatter", "tis: 39.5 %", "tis: -2 %", "-2 %", "'tis' must be between 0 and 1", "write a value between"},
    {"no motion", "towers: {motion: still}", "towers: {}", "{}", "body 'towers' has no 'motion'",
     "write 'motion: still'"},
    {"no motion along y", "      y: {like: z}\n", "", "z:", "body 'tube' has no motion along y", "write 'y: still'"},
    {"which amplitude", "rms: 0.5 um rms", "rms: 0.5 um", "0.5 um", "does not say which amplitude it is",
     "'0.5 um peak', '0.5 um pp' or '0.5 um rms'"},
    {"negative count", "baffles_per_half: 35", "baffles_per_half: -3", "baffles_per_half, along",
     "'count' must be between", "write a value between 1 and", 2},
    {"count zero", "baffles_per_half: 35", "baffles_per_half: 0", "baffles_per_half, along", "'count' must be between",
     "write a value between 1 and", 2},
    {"half a baffle", "baffles_per_half: 35", "baffles_per_half: 3.5", "baffles_per_half, along",
     "'count' must be a whole number", "write 3 or 4", 2},
    {"half a seed", "seed: 1", "seed: 1.5", "1.5", "'seed' must be a whole number", "write 1 or 2"},
    {"dark port", "ETM: {beam: arm, at: ETM}", "ETM: {beam: arm, at: tube}", "tube",
     "beam 'arm' does not illuminate 'tube'", "place the port where its beam meets a surface"},
    {"circle", "mirror_radius: 17.5 cm ", "mirror_radius: 0.3 m*shadow ", "mirror_radius",
     "parameter 'mirror_radius' depends on itself", "write one of them as a number"},
    {"include", "params:\n", "include: [common.yaml]\n\nparams:\n", "common.yaml", "cannot read file 'common.yaml'",
     "names are relative to the file that contains them"},
    {"negative power", "power: 650 kW", "power: -650 kW", "-650 kW", "'power' must be between",
     "write a value between"},
    {"no mass", "  mirror_mass: 42 kg\n", "", "preset", "key 'mirror_mass' (a mass) is missing",
     "add 'mirror_mass: 1 kg'"},
    {"preset", "preset: fabry-perot-michelson", "preset: michelson", "michelson", "'preset' cannot be \"michelson\"",
     "fabry-perot-michelson"},
    {"band", "band: [5 Hz, 1 kHz]", "band: [1 kHz, 5 Hz]", "[1 kHz", "from a low to a higher frequency",
     "write '[3 Hz, 1 kHz]'"},
    {"design curve", "compare: [adv-lal]", "compare: [adv-lol]", "adv-lol", "'adv-lol' is not a design curve",
     "did you mean 'adv-lal'?"},
    {"stop rule", "until: \"h_total < 3 %\"", "until: \"h_total < 3\"", "\"h_total < 3\"",
     "'h_total < 3' is not a stop rule", "write 'h_total < 5 %'"},
    {"version", "straytrace: 1", "straytrace: 2", "2", "format version 2 is newer", "install a newer straytrace"},
};

struct Message {
  std::string file, what, suggestion;
  std::size_t line = 0, column = 0;
};

// The messages as a person reads them: place and reason, the line, then a caret and what to write.
std::vector<Message> messages_in(std::string const& text) {
  static std::regex const head(
      R"(^([^:\n]+):(\d+):(\d+): error: ([^\n]*)\n *\d+ \| [^\n]*\n *\| (?:\.\.\.)? *\^+ ([^\n]*))",
      std::regex::ECMAScript | std::regex::multiline);
  std::vector<Message> found;
  for (std::sregex_iterator i(text.begin(), text.end(), head), end; i != end; ++i)
    found.push_back({(*i)[1], (*i)[4], (*i)[5], std::stoul((*i)[2]), std::stoul((*i)[3])});
  return found;
}

std::string text_at(std::string const& text, std::size_t line, std::size_t column) {
  std::size_t start = 0;
  for (; line > 1; --line) start = text.find('\n', start) + 1;
  return text.substr(start + column - 1);
}

bool sorted_by_place(std::vector<Message> const& all) {
  return std::is_sorted(all.begin(), all.end(), [](Message const& a, Message const& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
}

// The fault of the error message; empty: none.
std::string fault(Case const& c, std::string const& text, Finished const& r) {
  if (r.code != 2) return "exit code " + std::to_string(r.code);
  if (!r.out.empty()) return "something on stdout";
  std::vector<Message> const all = messages_in(r.err);
  std::string const count = std::to_string(c.errors) + (c.errors == 1 ? " error" : " errors");
  if (all.size() != std::size_t(c.errors) || r.err.find(count + ". Nothing was run.") == r.err.npos)
    return "not " + count;
  if (!sorted_by_place(all)) return "not sorted";
  for (Message const& m : all)
    if (m.what.find(c.reason) != m.what.npos)
      return m.file != "arm.yaml"                                 ? "wrong file"
             : !text_at(text, m.line, m.column).starts_with(c.at) ? "wrong place"
             : m.suggestion.find(c.suggestion) == m.what.npos     ? "wrong suggestion"
                                                                  : "";
  return "wrong reason";
}

Finished failed_run(Folder const& folder, std::string const& text) {
  write_text(folder / "arm.yaml", text);
  return straytrace({"run", folder / "arm.yaml", "-o", folder / "out", "--histories", "4096"});
}

TEST(BadInput, EveryEditIsAnError) {
  Folder const folder;
  std::string const good = text_of(written_arm);
  for (Case const& c : cases) {
    std::string const text = edited(good, c.from, c.to);
    Finished const r = failed_run(folder, text);
    EXPECT_EQ(fault(c, text, r), "") << c.name << "\n" << r.err;
    EXPECT_FALSE(fs::exists(folder / "out")) << c.name;
  }
}

// The same check on the unedited file, and on a wrong expectation.
TEST(BadInput, TheCheckCanFail) {
  Folder const folder;
  std::string const good = text_of(written_arm);
  Case c = cases.front();
  Finished const accepted = failed_run(folder, good);
  EXPECT_EQ(accepted.code, 0) << accepted.err;
  EXPECT_EQ(fault(c, good, accepted), "exit code 0");
  EXPECT_TRUE(fs::exists(folder / "out/run.h5"));
  std::string const text = edited(good, c.from, c.to);
  Finished const r = failed_run(folder, text);
  c.at = "17.5";
  EXPECT_EQ(fault(c, text, r), "wrong place");
}

// A scene without ports is not told that it has some (the case 'ports without an interferometer' has them).
TEST(BadInput, AnEmptySceneHasNoPorts) {
  Folder const folder;
  struct {
    std::string text, says;
    std::size_t errors;
  } const files[] = {{"straytrace: 1\n", "the scene has no beam", 1},
                     {"straytrace: 1\nscene: []\n", "the scene has no beam", 1},
                     {"scene: []\n", "the format version is missing", 2},
                     {"straytrace: 2\n", "format version 2 is newer", 1}};
  for (auto const& file : files) {
    Finished const r = failed_run(folder, file.text);
    EXPECT_EQ(r.code, 2) << file.text;
    EXPECT_EQ(messages_in(r.err).size(), file.errors) << r.err;
    EXPECT_THAT(r.err, HasSubstr(file.says));
    EXPECT_EQ(r.err.find("has ports"), r.err.npos) << r.err;
  }
}

TEST(BadInput, AllErrorsAtOnceInOrderAndOnce) {
  std::string text = text_of(written_arm);
  text = edited(text, "half_angle: 35 deg", "half_angle: 35");  // in a part that is placed 70 times
  text = edited(text, "material: baffle_steel", "material: bafle_steel");
  text = edited(text, "compare: [adv-lal]", "compare: [adv-lol]");
  Folder const folder;
  Finished const r = failed_run(folder, text);
  EXPECT_EQ(r.code, 2);
  std::vector<Message> const all = messages_in(r.err);
  ASSERT_EQ(all.size(), 3u) << r.err;
  EXPECT_THAT(all[0].what, HasSubstr("half_angle"));
  EXPECT_THAT(all[1].what, HasSubstr("bafle_steel"));
  EXPECT_THAT(all[2].what, HasSubstr("adv-lol"));
  EXPECT_TRUE(sorted_by_place(all));
  EXPECT_FALSE(sorted_by_place({all[2], all[0]}));
  EXPECT_THAT(r.err, HasSubstr("3 errors. Nothing was run."));
}

TEST(BadInput, ProblemsAsJson) {
  std::string text = edited(text_of(written_arm), "half_angle: 35 deg", "half_angle: 35");
  text = edited(text, "compare: [adv-lal]", "compare: [adv-lol]");
  Folder const folder;
  write_text(folder / "arm.yaml", text);
  Finished const r = straytrace({"check", folder / "arm.yaml", "--format", "json"});
  EXPECT_EQ(r.code, 2);
  auto const list = nlohmann::json::parse(r.err, nullptr, false);
  ASSERT_TRUE(list.is_array() && list.size() == 2) << r.err;
  for (auto const& p : list) {
    EXPECT_EQ(p["file"], "arm.yaml");
    EXPECT_EQ(p["severity"], "error");
    EXPECT_GT(p["suggestion"].get<std::string>().size(), 5u);
  }
  EXPECT_TRUE(text_at(text, list[0]["line"], list[0]["column"]).starts_with("35}"));
  EXPECT_TRUE(text_at(text, list[1]["line"], list[1]["column"]).starts_with("adv-lol"));
}

TEST(BadInput, FilesThatAreNotScenes) {
  Folder const folder;
  struct {
    std::string text, says;
  } const files[] = {{"", "the file is empty"},
                     {"\x7f"
                      "ELF\x01\x02\xff\xfe",
                      "arm.yaml: error: this is a binary file, but a text file is needed here"},
                     {"straytrace: 1\nmaterials: [\n", "arm.yaml:"},
                     {"# nothing\n", "arm.yaml"},
                     {"just a sentence\n", "arm.yaml"},
                     {std::string(3000, '['), "arm.yaml:1:"}};
  for (auto const& file : files) {
    Finished const r = failed_run(folder, file.text);
    EXPECT_EQ(r.code, 2) << file.text;
    EXPECT_THAT(r.err, HasSubstr(file.says));
    EXPECT_THAT(r.err, HasSubstr("Nothing was run."));
    EXPECT_EQ(r.err.find('\xff'), r.err.npos) << "broken bytes on the terminal";
    EXPECT_EQ(r.err.find("ELF"), r.err.npos) << "bytes of a binary file";
    EXPECT_FALSE(fs::exists(folder / "out"));
    auto const list =
        nlohmann::json::parse(straytrace({"check", folder / "arm.yaml", "--format", "json"}).err, nullptr, false);
    EXPECT_TRUE(list.is_array() && !list.empty()) << file.text;
  }
  for (std::string const& name : {folder / "none.yaml", folder.path()}) {
    Finished const r = straytrace({"run", name, "-o", folder / "out"});
    EXPECT_EQ(r.code, 2);
    EXPECT_THAT(r.err, HasSubstr("cannot read this file"));
    EXPECT_FALSE(fs::exists(folder / "out"));
  }
}

// Existing results stay unchanged.
TEST(BadInput, EarlierResultsAreUntouched) {
  Folder const folder;
  fs::create_directory(folder / "out");
  write_text(folder / "out/run.h5", "precious");
  Finished const r = failed_run(folder, edited(text_of(written_arm), "half_angle: 35 deg", "half_angle: 35"));
  EXPECT_EQ(r.code, 2);
  EXPECT_EQ(text_of(folder / "out/run.h5"), "precious");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "out"), {}), 1);
}

TEST(BadInput, MotionFiles) {
  Folder const folder;
  std::string const good = text_of(storm);
  auto const check = [&](std::string const& text) {
    write_text(folder / "storm.yaml", text);
    return straytrace({"check", folder / "storm.yaml"});
  };
  EXPECT_EQ(check(good).code, 0);
  Finished const key = check(edited(good, "width: 0.08 Hz", "widht: 0.08 Hz"));
  EXPECT_EQ(key.code, 2);
  EXPECT_THAT(key.err, HasSubstr("did you mean 'width'?"));
  Finished const table = check(edited(good, "bodies:", "bodys:"));
  EXPECT_EQ(table.code, 2);
  EXPECT_THAT(table.err, HasSubstr("did you mean 'bodies'?"));
}

}  // namespace
}  // namespace straytrace::testing
