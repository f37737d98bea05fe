// SPDX-License-Identifier: BSD-3-Clause
// Warnings about omissions and wrong comparisons of a scene: ghosts that return, a design curve of
// another detector.
#include <cmath>

#include "scenes/answers.hpp"

namespace straytrace::testing::app_left_out {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string const end_bench = text_of(source_folder + "/examples/end_bench.yaml");
std::string const uncounted = "ghost beams are not counted";

std::string with_ghosts(std::string const& line) { return edited(end_bench, "ghosts: {order: 2}\n", line); }

std::string said_of(std::string const& text, Words words = {"check"}) {
  Folder const folder;
  write_text(folder / "a.yaml", text);
  words.insert(words.begin() + 1, folder / "a.yaml");
  Finished const done = straytrace(words, {.in = folder.path()});
  EXPECT_EQ(done.code, 0) << done.err;
  return done.err;
}

double number_behind(std::string const& text, std::string const& mark) {
  std::size_t const at = text.find(mark);
  EXPECT_NE(at, text.npos) << mark << " is not in " << text;
  return at == text.npos ? 0 : std::stod(text.substr(at + mark.size()));
}

// The warning names what `straytrace ghosts` finds: power outside the main beam, share at the port, strain.
TEST(UncountedGhosts, AreAWarningWithTheirStrain) {
  std::string const said = said_of(with_ghosts(""));
  EXPECT_THAT(said, AllOf(HasSubstr(uncounted), HasSubstr("back to port 'ETM'"), HasSubstr("'ghosts: off'")));
  EXPECT_THAT(said_of(with_ghosts(""), {"run", "-o", "out", "--histories", "4096"}), HasSubstr(uncounted));
  Folder const folder;
  write_text(folder / "a.yaml", end_bench);
  json const found = answer({"ghosts", folder / "a.yaml", "--beam", "ETM/front"})[0];
  EXPECT_NEAR(number_behind(said, "h(10 Hz) = ") / found["strain"]["10"].get<double>(), 1, 0.05);
  EXPECT_NEAR(number_behind(said, "and bring ") / found["port"]["recoupled"].get<double>(), 1, 0.05);
  EXPECT_GT(number_behind(said, "h(10 Hz) = "), 1e-25);
}

// Controls: a scene that states how it treats ghosts, in each form, and one where nothing passes the end mirror.
TEST(UncountedGhosts, AreIgnoredOnlyOnRequest) {
  for (char const* line : {"ghosts: {order: 2}\n", "ghosts: {order: 0}\n", "ghosts: on\n", "ghosts: off\n"})
    EXPECT_THAT(said_of(with_ghosts(line)), Not(HasSubstr(uncounted))) << line;
  EXPECT_EQ(straytrace({"check", virgo_arm}).err, "");
  Folder const folder;
  write_text(folder / "a.yaml", with_ghosts("ghosts: never\n"));
  EXPECT_EQ(straytrace({"check", folder / "a.yaml"}).code, 2);
}

// The strain in the warning equals the missing noise: PSDs of independent routes add (eq. 10.1).
TEST(UncountedGhosts, AreTheNoiseThatIsMissing) {
  auto const strain = [](std::string const& line) {
    Folder const folder;
    write_text(folder / "a.yaml", with_ghosts(line));
    Words const words{"run",         folder / "a.yaml", "-o", folder / "out",
                      "--histories", "131072",          "-p", "sensor_brdf=1e-6 /sr"};
    return answer(words)["total_strain"][0]["value"].get<double>();
  };
  double const with = strain("ghosts: on\n"), without = strain("ghosts: off\n");
  double const missing = std::sqrt(with * with - without * without);
  EXPECT_NEAR(number_behind(said_of(with_ghosts("")), "h(10 Hz) = ") / missing, 1, 0.05);
  EXPECT_GT(with / without, 1.5) << "control: nothing is missing";
}

// Each number that stray light depends on, changed alone, is named; without changes none is.
TEST(OtherDetector, IsNamedByWhatDiffers) {
  std::string const begin = "interferometer:\n  override: true\n  preset: fabry-perot-michelson\n";
  struct Change {
    char const *from, *to, *said;
  } const changes[] = {
      {"arm_length: L", "arm_length: L + 50 m", "arm length 3050 m, not 3000 m"},
      {"mirror_mass: mirror_mass", "mirror_mass: 20 kg", "mass of a mirror 20 kg, not 42 kg"},
      {"end_transmission: transmission_end", "end_transmission: 0.4 %", "finesse of an arm 345.6, not 443.3"},
      {"signal_recycling_transmission: transmission_srm", "signal_recycling_transmission: 1",
       "Gamma, from signal recycling and finesse, 141.6, not 8.403"},
      {"arms: 2", "arms: 2\n  arm_power: 400 kW", "power in an arm 4e+05 W, not 6.5e+05 W"},
  };
  std::string const own = begin + R"(  arm_length: L
  mirror_mass: mirror_mass
  input_transmission: transmission_in
  end_transmission: transmission_end
  round_trip_loss: round_trip_loss
  signal_recycling_transmission: transmission_srm
  arms: 2
)";
  std::string const another = "'adv-lal' is a curve of Advanced Virgo, and the interferometer is another one";
  EXPECT_THAT(said_of(end_bench + own), Not(HasSubstr("another one"))) << "control: the same detector";
  for (Change const& c : changes) {
    std::string const scene = end_bench + edited(own, c.from, c.to);
    EXPECT_THAT(said_of(scene), AllOf(HasSubstr(another), HasSubstr(c.said), HasSubstr("library/detectors/adv.yaml")));
    EXPECT_THAT(said_of(scene + "noise: {override: true, band: [5 Hz, 1 kHz]}\n"), Not(HasSubstr("another one")))
        << "control: compared with nothing";
  }
}

// A curve that comes in later is compared as well, in the list of a motion file and by `scan --against`.
TEST(OtherDetector, IsReportedWhereverACurveIsNamed) {
  Folder const folder;
  std::string const bench = source_folder + "/examples/end_bench.yaml";
  ASSERT_EQ(straytrace({"trace", bench, "-o", folder / "a.h5", "--histories", "4096", "--quiet"}).code, 0);
  for (auto const& [curve, differs] : {std::pair{"et-d", true}, {"adv-lal", false}}) {
    auto const expected = differs ? ::testing::Matcher<std::string>(HasSubstr("is a curve of Einstein Telescope"))
                                  : ::testing::Matcher<std::string>(Not(HasSubstr("is a curve of")));
    write_text(folder / "other.yaml", std::string("straytrace: 1\nnoise: {compare: [") + curve + "]}\n");
    EXPECT_THAT(straytrace({"noise", folder / "a.h5", "--motion", folder / "other.yaml"}).err, expected) << curve;
    EXPECT_THAT(straytrace({"scan", folder / "a.h5", "--invert", "brdf(glass)", "--against", curve}).err, expected);
  }
}

// In a budget the run is listed with the noises of a detector, with or without a design curve.
TEST(OtherDetector, IsReportedInABudget) {
  Folder const folder;
  std::string const bench = source_folder + "/examples/end_bench.yaml";
  ASSERT_EQ(straytrace({"run", bench, "-o", folder / "a", "--histories", "4096", "--quiet"}).code, 0);
  auto const said = [&](char const* detector) { return straytrace({"budget", detector, folder / "a/run.h5"}).err; };
  EXPECT_THAT(said("aligo"), AllOf(HasSubstr("'aligo' is a budget of "), HasSubstr("arm length 3000 m, not 3995 m"),
                                   HasSubstr("give the detector of 'a/run.h5'")));
  EXPECT_THAT(said("adv"), Not(HasSubstr("is a budget of"))) << "control: the same detector";
  EXPECT_THAT(straytrace({"budget", folder / "a/run.h5"}).err, Not(HasSubstr("is a budget of"))) << "control: none";
}

}  // namespace
}  // namespace straytrace::testing::app_left_out
