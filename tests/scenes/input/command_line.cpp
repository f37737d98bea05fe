// SPDX-License-Identifier: BSD-3-Clause
// The command line: help that is true, and one clear sentence when it is wrong (docs/reference/commands.md).
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>
#include <sstream>

#include "scenes/program.hpp"
#include "support/help_examples.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;

char const* const commands[] = {"check", "trace", "run", "noise", "paths", "inspect"};

TEST(CommandLine, SplitsLikeAShell) {
  EXPECT_EQ(split(R"(a -u "h < 1 %" -p b=1 > c)"), (Words{"a", "-u", "h < 1 %", "-p", "b=1"}));
  EXPECT_EQ(split(R"(a "b" c)"), (Words{"a", "b", "c"}));
  EXPECT_EQ(split(R"(a 'h("b") > 1' c)"), (Words{"a", "h(\"b\") > 1", "c"}));
  EXPECT_EQ(examples_in("no such section\n  straytrace run x y").size(), 0u);
}

// As printed, in a folder that holds examples/ and a run in out/; the only change: a stop rule becomes a small number.
TEST(CommandLine, ExamplesOfTheHelpRun) {
  Folder const folder;
  fs::create_directory_symlink(source_folder + "/examples", folder / "examples");
  Launch const how{folder.path()};
  ASSERT_EQ(straytrace({"run", "examples/virgo_arm.yaml", "-o", "out", "--histories", "8192"}, how).code, 0);
  for (std::string const command : commands) {
    Finished const help = straytrace({command, "--help"});
    EXPECT_EQ(help.code, 0) << command;
    EXPECT_EQ(help.err, "");
    auto const examples = examples_in(help.out);
    EXPECT_GE(examples.size(), 2u) << command;
    for (Words words : examples) {
      EXPECT_EQ(words[0], command);
      if (std::ranges::find(words, "--live") != words.end()) continue;  // waits for a browser: tools.live
      if (command == "run" || command == "trace") {
        fs::remove_all(folder / "out.h5");
        bool const part = std::find(words.begin(), words.end(), "part007.h5") != words.end();
        if (auto const given = std::find(words.begin(), words.end(), "--histories"); given != words.end())
          words.erase(given, given + 2);
        words.insert(words.end(), {"--force", "--histories", part ? "819200" : "4096"});  // 200 blocks, or one
      }
      Launch one = how;
      one.picture = std::find(words.begin(), words.end(), "--plot") != words.end();
      Finished const r = straytrace(words, one);
      EXPECT_TRUE(r.code == 0 || r.code == 85) << ::testing::PrintToString(words) << r.err;
      EXPECT_GT(r.out.size(), 20u);
    }
  }
  EXPECT_TRUE(fs::exists(folder / "fine/report.txt"));
  EXPECT_TRUE(fs::exists(folder / "storm/h_asd.txt"));
  EXPECT_TRUE(fs::exists(folder / "virgo.h5"));
}

TEST(CommandLine, HelpAndVersion) {
  Finished const help = straytrace({"--help"});
  EXPECT_EQ(help.code, 0);
  for (std::string const command : commands) EXPECT_THAT(help.out, HasSubstr("\n  " + command + " "));
  EXPECT_THAT(straytrace({"--version"}).out, ::testing::StartsWith("straytrace 0."));
}

struct Wrong {
  Words words;
  std::string reason, suggestion;
};

// One sentence and a remedy, at most three lines; nothing on stdout, nothing written.
std::string fault(Finished const& r, Wrong const& w) {
  if (r.code != 2) return "exit code " + std::to_string(r.code);
  if (!r.out.empty()) return "something on stdout";
  if (r.err.find("error: ") == r.err.npos) return "no error";
  if (r.err.find("error: ") != r.err.rfind("error: ")) return "more than one error";
  if (r.err.find(w.reason) == r.err.npos) return "wrong reason";
  return r.err.find(w.suggestion) == r.err.npos ? "wrong suggestion" : "";
}

TEST(CommandLine, MistakesAreExplained) {
  Folder const folder;
  std::string const out = folder / "out";
  write_text(folder / "file", "");
  write_text(folder / "text.h5", "no run");
  ASSERT_EQ(straytrace({"trace", virgo_arm, "-o", folder / "run.h5", "--histories", "300"}).code, 0);
  write_text(folder / "cut.h5", text_of(folder / "run.h5").substr(0, 2000));
  Wrong const all[] = {
      {{}, "a command is missing", "straytrace --help"},
      {{"chek", virgo_arm}, "'chek' is not a command", "did you mean 'check'?"},
      {{"run", "-o", out}, "'scene' is missing", "straytrace run --help"},
      {{"run", virgo_arm}, "--out is missing", "straytrace run --help"},
      {{"run", virgo_arm, "-o", out, "--histores", "9"},
       "'--histores' is not an option",
       "did you mean '--histories'?"},
      {{"run", virgo_arm, "-o", out, "--slice", "1/3"}, "'--slice' is not an option", "it is an option of trace; see"},
      {{"check", virgo_arm, "--histories", "5"}, "'--histories' is not an option", " and others; see"},
      {{"check", virgo_arm, "twice"}, "'twice' is not expected", "straytrace check --help"},
      {{"noise"}, "'run' is missing", "straytrace noise --help"},
      {{"run", virgo_arm, "-o", out, "--until", "5%"}, "'5%' is not a stop rule", "write 'h_total < 5 %'"},
      {{"run", virgo_arm, "-o", out, "--until", "h_total < 5"}, "is not a stop rule", "'10 min'"},
      {{"run", virgo_arm, "-o", out, "--until", ""}, "'' is not a stop rule", "write 'h_total < 5 %'"},
      {{"run", virgo_arm, "-o", out, "-p", "rimm=1 m"}, "'rimm' is not defined", "did you mean 'rim'?"},
      {{"run", virgo_arm, "-o", out, "-p", "rim"}, "'rim' does not set a parameter", "write 'name=value'"},
      {{"run", virgo_arm, "-o", out, "--histories", "many"}, "'many' is not a number", "write for example 1e6"},
      {{"run", virgo_arm, "-o", out, "--histories", "-5"}, "'-5' is not a number", "write for example 1e6"},
      {{"run", virgo_arm, "-o", out, "--seed", "-1"}, "'-1' is not a whole number", "write for example 7"},
      {{"run", virgo_arm, "-o", out, "--threads", "0"}, "'0' is not a whole number", "write for example 4"},
      {{"check", virgo_arm, "--format", "xml"}, "xml", "json"},
      {{"--quiet", "check", virgo_arm},
       "'--quiet' is written before its command",
       "write straytrace check ... --quiet; see"},
      {{"couple", "taps", "--force", "a", "--target", "b", "--quiet", "c", "--list", folder / "none.csv"},
       "--list: file '" + folder / "none.csv' does not exist",
       "check the name and the folder; see"},
      {{"couple", "taps", "--force", "a", "--target", "b", "--quiet", "c", "--list", folder.path()},
       "--list: '" + folder.path() + "' is a folder",
       "name a file; see"},
      {{"diff", virgo_arm}, "'files' needs 2 values, but received 1", "write all of them; see"},
      {{"run", virgo_arm, "-o", folder / "file"}, "cannot make the folder", "choose another one"},
      {{"trace", virgo_arm, "-o", folder / "none/a.h5"}, "there is no folder", "create it first"},
      {{"trace", virgo_arm, "-o", folder.path()}, "is a folder", "name a file with -o"},
      {{"noise", folder / "none.h5"}, "there is no such file", "\n  check the name and the folder"},
      {{"noise", folder / "rum.h5"}, "there is no such file", "did you mean '" + folder / "run.h5" + "'?"},
      {{"check", folder / "rum.h5"}, "there is no such file", "did you mean '" + folder / "run.h5" + "'?"},
      {{"paths", folder.path()}, "is not a regular file", "name the run in this folder: '" + folder / "run.h5" + "'"},
      {{"noise", folder / "text.h5"}, "is not a straytrace run file", "\n  name the run.h5"},
      {{"paths", folder / "cut.h5"}, "is damaged: its content does not match its checksum", "\n  copy it again"},
      {{"paths", virgo_arm}, "is a scene, not a run", "trace it first"},
      {{"paths", folder / "run.h5", "-p", "rim=48cm"}, "the parameters of a run are fixed", "or add --first-order"},
      {{"paths", folder / "run.h5", "--histories", "5"}, "the histories of a run are fixed", "or add --first-order"},
      {{"paths", folder / "run.h5", "--band", "20 Hz..80 Hz"}, "--band: this run has no noise", "straytrace noise"},
      {{"paths", folder / "run.h5", "--band", "20 Hz, 80 Hz"}, "--band: this run has no noise", "straytrace noise"},
      {{"project", folder / "run.h5", "--gps", "5..8", "--unit", "kg"}, "--unit: no --channel", "remove it"},
      {{"fit", "--path", "9"}, "choose from a run, but none is given", "name the run file"},
      {{"fit", "--body", "x"}, "choose from a run, but none is given", "name the run file"},
      {{"run", virgo_arm, "-o", out, "-p", "rim=48cm", "-p", "rim=49cm"}, "-p sets 'rim' twice", "keep one of them"},
      {{"budget", "adv", "-p", "Laser.Power=2", "-p", "Laser.Power=3"}, "-p sets 'Laser.Power' twice", "keep one"},
      {{"run", virgo_arm, "-o", out, "--max-time", "5"}, "'5' is not a time", "90s, 50min or 1h"},
  };
  for (Wrong const& w : all) {
    Finished const r = straytrace(w.words);
    EXPECT_EQ(fault(r, w), "") << ::testing::PrintToString(w.words) << "\n" << r.err;
    EXPECT_LE(std::count(r.err.begin(), r.err.end(), '\n'), 5) << r.err;
    EXPECT_FALSE(fs::exists(out));
  }
  for (char const* file : {"none.h5", "text.h5", "cut.h5"}) {
    Finished const r = straytrace({"noise", folder / file, "--format", "json"});
    EXPECT_NE(nlohmann::json::parse(r.err).at(0).at("suggestion"), "") << r.err;
  }
  EXPECT_EQ(fault(straytrace({"check", virgo_arm}), all[0]), "exit code 0");
  Words const first_order{"paths", virgo_arm, "--first-order", "--histories", "4096", "-p", "rim=48cm"};
  EXPECT_EQ(straytrace(first_order).code, 0);  // negative control
  EXPECT_EQ(fault(straytrace({"run", "-o", out}), all[3]), "wrong reason");
}

// Every option that is a number refuses nan, which compares as within any range, and numbers beyond its range. The
// negative control: a number within the range is not what the message is about.
TEST(CommandLine, NumbersAreWithinTheirRange) {
  struct Option {
    Words command;
    std::string option, below, good;
  };
  std::vector<Option> const all{
      {{"apertures"}, "--points", "2", "101"},
      {{"budget"}, "--points", "1", "300"},
      {{"couple", "events"}, "--averages", "1", "20"},
      {{"couple", "events"}, "--significance", "-1", "3"},
      {{"couple", "impulse"}, "--modes", "-1", "3"},
      {{"couple", "impulse"}, "--threshold", "-1", "8"},
      {{"couple", "lines"}, "--harmonics", "2", "5"},
      {{"couple", "lines"}, "--multiplicity", "0", "2"},
      {{"couple", "lines"}, "--z-max", "0", "20"},
      {{"couple", "noise"}, "--significance", "-1", "3"},
      {{"couple", "noise"}, "--target-ratio", "0", "2"},
      {{"couple", "noise"}, "--witness-ratio", "0", "2"},
      {{"couple", "predict"}, "--points-per-decade", "0", "60"},
      {{"couple", "ramp"}, "--significance", "-1", "3"},
      {{"couple", "sweep"}, "--significance", "-1", "3"},
      {{"couple", "sweep"}, "--witness-ratio", "0", "10"},
      {{"couple", "taps"}, "--force-ratio", "0", "2"},
      {{"couple", "taps"}, "--significance", "-1", "3"},
      {{"couple", "taps"}, "--target-ratio", "0", "3"},
      {{"explain"}, "--at", "0", "30"},
      {{"fringes"}, "--bounces", "0", "2"},
      {{"fringes"}, "--rate", "0", "4096"},
      {{"paths"}, "--histories", "0", "1e6"},
      {{"project"}, "--rate", "0", "4096"},
      {{"scan"}, "--tolerance", "0", "0.01"},
      {{"signal", "psd"}, "--confidence", "0", "0.95"},
      {{"signal", "q"}, "--q", "1", "12"},
  };
  for (Option const& o : all)
    for (std::string const& value : {std::string("nan"), o.below, o.good}) {
      Words words = o.command;
      words.insert(words.end(), {o.option, value});
      Finished const f = straytrace(words);
      EXPECT_EQ(f.code, 2) << ::testing::PrintToString(words);
      bool const refused = f.err.starts_with("error: " + o.option + ": '" + value + "' is not a ");
      EXPECT_EQ(refused, value != o.good) << ::testing::PrintToString(words) << f.err;
    }
}

// CLI::Range accepts nan.
TEST(CommandLine, NoOptionUsesCliRange) {
  std::size_t files = 0, own = 0;
  for (auto const& entry : fs::recursive_directory_iterator(source_folder + "/src/cli")) {
    if (entry.path().extension() != ".cpp") continue;
    std::string const text = text_of(entry.path());
    EXPECT_EQ(text.find("CLI::Range("), text.npos) << entry.path() << ": use number_between or whole_between";
    own += text.find("number_between(") != text.npos;
    ++files;
  }
  EXPECT_GT(files, 40u);
  EXPECT_GT(own, 10u) << "the search reads the files";
}

// One line of JSON, and no second form of the same problem. Control: without the option, text.
TEST(CommandLine, EventsAreTheOnlyFormOfProblems) {
  for (Words const& words :
       {Words{"check", "none.yaml"}, Words{"check", "none.yaml", "--format", "json"}, Words{"chek", "none.yaml"}}) {
    Words with{"--events"};
    with.insert(with.end(), words.begin(), words.end());
    Finished const r = straytrace(with);
    EXPECT_EQ(r.code, 2);
    EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
    auto const event = nlohmann::json::parse(r.err);
    EXPECT_EQ(event.at("event"), "problems");
    EXPECT_NE(event.at("problems").at(0).at("suggestion"), "");
  }
  EXPECT_TRUE(straytrace({"check", "none.yaml"}).err.starts_with("none.yaml: error: "));
}

// Errors of both models in one run, each with the path as written. Control: a sound model beside a wrong one.
TEST(CommandLine, DiffTellsFilesOfOneNameApart) {
  Folder const folder;
  std::string const a = folder / "A/arm.yaml", b = folder / "B/arm.yaml";
  for (std::string const& file : {a, b}) {
    fs::create_directory(fs::path(file).parent_path());
    write_text(file, "straytrace: 1\nbafles: 1\n");
  }
  Finished const both = straytrace({"diff", a, b});
  EXPECT_EQ(both.code, 2);
  EXPECT_THAT(both.err, HasSubstr(a + ":2:1: error: "));
  EXPECT_THAT(both.err, HasSubstr(b + ":2:1: error: "));
  std::set<std::string> files;
  for (auto const& problem : nlohmann::json::parse(straytrace({"diff", a, b, "--format", "json"}).err))
    files.insert(problem.at("file"));
  EXPECT_TRUE(files.contains(a) && files.contains(b));
  Finished const one = straytrace({"diff", virgo_arm, b});
  EXPECT_THAT(one.err, HasSubstr(b + ":2:1: error: "));
  EXPECT_THAT(one.err, ::testing::Not(HasSubstr("virgo_arm")));
}

// Control: a text that is read in place of the scene.
TEST(CommandLine, UnsavedTextsThatNothingReadsAreNamed) {
  std::string const warning = "warning: --unsaved: nothing read 'other.yaml'";
  Finished const unread = straytrace({"--unsaved", "other.yaml=" + virgo_arm, "check", virgo_arm});
  EXPECT_EQ(unread.code, 0);
  EXPECT_THAT(unread.err, HasSubstr(warning));
  EXPECT_EQ(straytrace({"--unsaved", virgo_arm + "=" + virgo_arm, "check", virgo_arm}).err, "");
}

// Wrong values, unknown and missing options in one run. Control: alone, each is the only error.
TEST(CommandLine, AllWrongOptionsAreToldAtOnce) {
  auto const errors = [](Words words) {
    words.insert(words.end(), {"--format", "json"});
    Finished const r = straytrace(words);
    EXPECT_EQ(r.code, 2);
    EXPECT_EQ(r.out, "");
    Words all;
    for (auto const& problem : nlohmann::json::parse(r.err)) all.push_back(problem.at("what"));
    return all;
  };
  using ::testing::UnorderedElementsAre;
  EXPECT_THAT(errors({"run", "--histories", "many", "--seed", "-1", "--max-time", "soon", "--until", "5%", "--untl",
                      "5 %", "--colour"}),
              UnorderedElementsAre(HasSubstr("'many' is not a number"), HasSubstr("'-1' is not a whole number"),
                                   HasSubstr("'soon' is not a time"), HasSubstr("'5%' is not a stop rule"),
                                   "'--untl' is not an option here", "'--colour' is not an option here",
                                   HasSubstr("is missing")));
  EXPECT_THAT(errors({"run", virgo_arm, "-o", "x", "--seed", "-1"}), UnorderedElementsAre(HasSubstr("'-1' is not")));
  EXPECT_THAT(errors({"couple", "predict", "none.h5", "--bdy", "tube", "--axis", "w", "--show", "0"}),
              UnorderedElementsAre("'--bdy' is not an option here", "--axis cannot be 'w'",
                                   HasSubstr("'0' is not a whole number")))
      << "a misspelt option is not missing as well";
  EXPECT_THAT(errors({"run", virgo_arm, "--ot", "x"}), UnorderedElementsAre("'--ot' is not an option here"));
  EXPECT_THAT(errors({"fit", "--paths", "9", "--axis", "w"}),
              UnorderedElementsAre(HasSubstr("'9' is not a whole number"), "--axis cannot be 'w'"));
  Finished const text = straytrace({"run", virgo_arm, "-o", "x", "--seed", "-1", "--threads", "0"});
  EXPECT_THAT(text.err, ::testing::ContainsRegex("error: --seed: [^\n]*\n  [^\n]*\nerror: --threads: "));
}

// As copied from typeset text: no-break and thin spaces in options are spaces, and 1e-999 is no 0. Controls: the same
// with plain spaces, and 0.
TEST(CommandLine, NumbersOfTypesetTextAndOutsideTheRange) {
  for (std::string const space : {" ", "\xc2\xa0", "\xe2\x80\x89", "\xe2\x80\xaf"}) {
    EXPECT_EQ(straytrace({"budget", "adv", "--at", "10.5" + space + "Hz,20" + space + "Hz"}).code, 0) << space;
    EXPECT_THAT(straytrace({"run", "none.yaml", "-o", "x", "--max-time", "5" + space + "min"}).err,
                ::testing::Not(HasSubstr("is not a time")));
  }
  for (std::string const number : {"1e-999", "1e999"}) {
    EXPECT_THAT(straytrace({"render", virgo_arm, "-o", "x.png", "--eye", number + " m,0 m,0 m"}).err,
                HasSubstr("is not valid for --eye"));
    EXPECT_THAT(straytrace({"budget", "adv", "--margin", number}).err, HasSubstr("is not a positive ratio"));
    EXPECT_EQ(straytrace({"run", virgo_arm, "-o", "x", "-p", "rim=" + number + " m"}).code, 2);
    EXPECT_THAT(straytrace({"project", "--rate", number}).err, HasSubstr("--rate: '" + number + "' is not a number"));
  }
  EXPECT_THAT(straytrace({"render", virgo_arm, "-o", "none/x.png", "--eye", "0,0 m,0 m"}).err,
              ::testing::Not(HasSubstr("is not valid for --eye")));
}

TEST(CommandLine, DecimalCommasAreNamed) {
  EXPECT_THAT(straytrace({"project", "--rate", "1,5"}).err,
              HasSubstr("--rate: '1,5' has a decimal comma; write a decimal point: 1.5"));
  EXPECT_THAT(straytrace({"fringes", "--bounces", "2,5"}).err, HasSubstr("'2,5' has a decimal comma"));
  EXPECT_THAT(straytrace({"fringes", "--bounces", "2;5"}).err, HasSubstr("'2;5' is not a number from"));
  Finished const list = straytrace({"budget", "adv", "--at", "10,5Hz"});
  EXPECT_EQ(list.code, 2);
  EXPECT_THAT(list.err, HasSubstr("decimal points, not commas"));
  EXPECT_EQ(straytrace({"budget", "adv", "--at", "10.5Hz,20Hz"}).code, 0);
}

}  // namespace
}  // namespace straytrace::testing
