// SPDX-License-Identifier: BSD-3-Clause
// One mistake in a motion file is one message, at its place, with what to write instead.
#include <cmath>

#include "motion/motion.hpp"
#include "spectra/files/series_file.hpp"
#include "support/scene_tables.hpp"

namespace straytrace::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

FileTexts files() {
  TimeSeries const record{"A", "um", 1000, 16, std::vector<double>(1600, 1.0)};
  std::string columns = "t [s],a [um],b [um]\n", broken = "t [s],a [um]\n";
  for (int i = 0; i < 64; ++i) {
    columns += std::to_string(1000 + i) + "," + std::to_string(i % 3) + ",1\n";
    broken += std::to_string(1000 + i + (i > 40 ? 5 : 0)) + "," + std::to_string(i % 3) + "\n";
  }
  return {{"asd.txt", "0.1 1e-6\n2000 1e-9\n"},
          {"five.txt", "# Hz m\n1 1\n10 five\n"},
          {"ragged.txt", "1 1\n10 1 3\n"},
          {"back.txt", "10 1\n1 1\n"},
          {"minus.txt", "1 1\n10 -1\n"},
          {"empty.txt", ""},
          {"one.txt", "1 1\n"},
          {"commas.txt", "10,5;1e-9\n20,5;1e-10\n"},
          {"three.txt", "10,5,1e-9\n20,5,1e-10\n"},
          {"csd.txt", "1 1 0 0 1\n2000 1 0 0 1\n"},
          {"coherent.txt", "1 1 2 0 1\n2000 1 0 0 1\n"},
          {"half.txt", "1 1 0\n50 1 0\n"},
          {"zero.txt", "1 1 0\n50 0 0\n"},
          {"record.hdf5", series_hdf5({&record, 1})},
          {"columns.csv", columns},
          {"gap.csv", broken}};
}

// Of `bodies` with m still and d as written.
std::string problems(std::string const& d) {
  Scene const scene = scene_of("bodies:\n  m: {motion: still}\n  d: " + d + "\n", files());
  read_motion(scene.root()["bodies"], {"m", "d"});
  return problems_of(scene);
}
std::string along_z(std::string const& spec) { return "{motion: {z: {" + spec + "}, others: still}}"; }

// `at`: what of the text is underlined from its first character on, or FILE:LINE:COLUMN, FILE: for a file as a whole.
struct Mistake {
  std::string written, at, what, remedy;
};

std::string place_of(Mistake const& m) {
  std::string const before = "  d: ";
  if (m.at.find(':') != m.at.npos) return m.at.ends_with(':') ? m.at : m.at + ":";
  std::size_t const at = m.written.find(m.at);
  EXPECT_NE(at, m.written.npos) << m.at;
  return "scene.yaml:4:" + std::to_string(before.size() + at + 1) + ":";
}

void expect_one(Mistake const& m) {
  std::string const got = problems(m.written);
  EXPECT_THAT(got, AllOf(StartsWith(place_of(m) + " error: "), HasSubstr(m.what), HasSubstr(m.remedy),
                         HasSubstr("\n1 error. Nothing was run.")))
      << m.written;
}

std::string const asd = "asd: asd.txt, columns: [Hz, m/sqrt(Hz)]";

TEST(MotionMessages, OfSpectra) {
  std::string const columns = ", columns: [Hz, m/sqrt(Hz)]";
  for (Mistake const& m : {
           Mistake{"petersen: low", "{petersen", "the kind of motion is missing", "did you mean 'peterson'?"},
           Mistake{asd + ", drift: 1 um/h", "{asd", "both 'asd' and 'drift'", "write a list"},
           Mistake{asd + ", skale: 2", "skale", "unknown key 'skale'", "did you mean 'scale'?"},
           Mistake{asd + ", uncertainty: 30", "30", "at most 100 %", "did you mean '30 %' or 'factor 30'?"},
           Mistake{asd + ", beyond: nothing", "nothing", "'beyond' cannot be \"nothing\"", "zero"},
           Mistake{"asd: none.txt" + columns, "none.txt", "cannot read file 'none.txt'", "relative to the file"},
           Mistake{"asd: five.txt" + columns, "five.txt:3:4", "'five' is not a number", "columns of numbers"},
           Mistake{"asd: ragged.txt" + columns, "ragged.txt:2:1", "has 3 numbers, the lines before have 2", "columns"},
           Mistake{"asd: back.txt" + columns, "back.txt:2:1", "does not increase", "increasing frequency"},
           Mistake{"asd: minus.txt" + columns, "minus.txt:2:1", "negative value", "columns of numbers"},
           Mistake{"asd: empty.txt" + columns, "empty.txt:", "no numbers in it", "columns of numbers"},
           Mistake{"asd: one.txt" + columns, "one.txt:", "fewer than two rows", "columns of numbers"},
           Mistake{"asd: commas.txt" + columns, "commas.txt:1:1", "has decimal commas", "columns of numbers"},
           Mistake{"asd: three.txt" + columns, "three.txt", "has 3 columns, and 'columns' names two", "not commas"},
           Mistake{"asd: asd.txt, columns: [Hz, V/sqrt(Hz)]", "V/sqrt", "not a unit of a motion spectrum",
                   "calibration: 6.1 um/s^2/count"},
           Mistake{"power-law: {asd: 1e-9 m/sqrt(Hz), at: 1 Hz, exponent: 0, from: 3 Hz, to: 1 Hz}", "{asd",
                   "has 'to' below 'from'", "'from' below 'to'"},
           Mistake{"line: {at: 1 Hz, width: 0.1 Hz, rms: 1 um peak}", "1 um peak", "no peak value", "um rms"},
           Mistake{"sine: {amplitude: 1 um, frequency: 3 Hz}", "1 um", "does not say which amplitude", "'1 um peak'"},
           Mistake{"sine: 3 Hz", "3 Hz", "'sine' needs a table of keys", "write"},
           Mistake{"drift: 2 um", "2 um", "is a speed", "for example"},
           Mistake{"drift: 2 um/h, uncertainty: 30 %", "uncertainty", "unknown key 'uncertainty'", "known keys"},
       })
    expect_one({along_z(m.written), m.at, m.what, m.remedy});
}

TEST(MotionMessages, OfRecords) {
  std::string const rest = ", highpass: 0.1 Hz, segment: 10 s, unit: um";
  for (Mistake const& m : {
           Mistake{"series: none.hdf5, span: 1..2, calibration: 1 um/count" + rest, "none.hdf5", "cannot read file",
                   "relative to the file"},
           Mistake{"series: empty.txt" + rest, "empty.txt", "no numbers in it", "columns of numbers"},
           Mistake{"series: columns.csv", "columns.csv", "it has 2 channels", "name one, for example channel: a;"},
           Mistake{"series: columns.csv, channel: c", "columns.csv", "no channel 'c'", "did you mean 'a'?"},
           Mistake{"series: columns.csv, channel: a, span: yesterday", "yesterday", "neither a GPS time nor UTC",
                   "1234567890..1234567950"},
           Mistake{"series: columns.csv, channel: a, span: 9..3", "9..3", "ends before it begins",
                   "earlier time first"},
           Mistake{"series: columns.csv, channel: a, span: 9000..9999", "columns.csv", "1000", "span: "},
           Mistake{"series: gap.csv", "gap.csv:43:1", "a gap of 6 s", "for example span: 1000..1040"},
           Mistake{"series: record.hdf5, segment: 900 s", "900 s", "the record lasts 100 s", "shorter segment"},
           Mistake{"series: record.hdf5, resonance: {frequency: 1 Hz, quality: 3}", "{frequency", "a link of a chain",
                   "through: {resonance"},
       })
    expect_one({along_z(m.written), m.at, m.what, m.remedy});
}

TEST(MotionMessages, OfMatricesAndChains) {
  std::string const csd = "csd: csd.txt, form: cross, units: [m, m], member: ", columns = ", columns: [Hz, re, im]}";
  for (Mistake const& m : {
           Mistake{"csd: csd.txt, form: crss, units: [m, m], member: 1", "crss", "'form' cannot be \"crss\"",
                   "did you mean 'cross'?"},
           Mistake{"csd: csd.txt, form: cross, units: [m, V], member: 1", "V]", "the reading of a sensor", "in 'm'"},
           Mistake{csd + "3", "3}", "a matrix with 2 units has no member 3", "unit of each"},
           Mistake{"csd: five.txt, form: cross, units: [m, m], member: 1", "five.txt:3:4", "'five' is not a number",
                   "has 5 columns"},
           Mistake{"csd: asd.txt, form: cross, units: [m, m], member: 1", "asd.txt:1:1", "has 2 numbers, not 5",
                   "has 5 columns"},
           Mistake{"csd: commas.txt, form: cross, units: [m, m], member: 1", "commas.txt:1:1", "has decimal commas",
                   "has 5 columns"},
           Mistake{"csd: coherent.txt, form: cross, units: [m, m], member: 1", "coherent.txt:1:1",
                   "at 1 Hz: the matrix is not positive semidefinite", "coherences are at most 1"},
           Mistake{"from: n", "n}", "body 'n' is not defined", "did you mean"},
           Mistake{"from: m, through: {resonanse: {frequency: 1 Hz, quality: 3}}", "{resonanse",
                   "the kind of this link of a chain is missing", "did you mean 'resonance'?"},
           Mistake{asd + ", through: {file: half.txt" + columns, "{file", "the chain covers 1 Hz to 50 Hz",
                   "beyond: hold"},
           Mistake{"from: m, through: {file: commas.txt" + columns, "commas.txt:1:1", "has decimal commas", "Hz"},
           Mistake{"from: m, through: {file: zero.txt" + columns, "zero.txt:2:1", "zero has no logarithm",
                   "remove the line"},
           Mistake{"from: m, through: {file: none.txt" + columns, "none.txt", "cannot read file", "relative"},
           Mistake{"from: m, through: {zeros: [1 Hz]}", "{zeros", "'gain'", "gain: 1"},
       })
    expect_one({along_z(m.written), m.at, m.what, m.remedy});
}

TEST(MotionMessages, OfBodies) {
  for (Mistake const& m : {
           Mistake{"{motion: quiet}", "quiet", "'motion' cannot be \"quiet\"", "motion: still"},
           Mistake{"{motion: stil}", "stil}", "'motion' cannot be \"stil\"", "did you mean 'still'?"},
           Mistake{"{motion: [still]}", "[still]", "'motion' cannot be a list", "motion: still"},
           Mistake{"{}", "{}", "body 'd' has no 'motion'", "motion: still"},
           Mistake{"{motoin: still}", "motoin", "unknown key 'motoin'", "did you mean 'motion'?"},
           Mistake{"{motion: {z: still, others: stil}}", "stil}", "'others' cannot be \"stil\"",
                   "did you mean 'still'?"},
           Mistake{"{motion: {z: {peterson: low}, y: still}}", "{z", "along x", "x: still"},
           Mistake{"{motion: {z: {peterson: low}}}", "{z", "along x and y", "x: still"},
           Mistake{"still", "still", "body 'd' is a table", "{motion: still}"},
           Mistake{"{motion: {others: still, q: still}}", "q", "unknown key 'q'", "did you mean"},
           Mistake{
               "{motion: {suspended: {from: m, vertical: w, stages: {frequency: 1 Hz, quality: 9}}, others: still}}",
               "w,", "'vertical' cannot be \"w\"", "x, y, z"},
           Mistake{"{motion: still, modes: {bend: {shape: {}}}}", "{shape", "has no 'motion'", "motion: still"},
           Mistake{"{motion: still, modes: {bend: {shape: {}, motoin: still}}}", "motoin", "unknown key 'motoin'",
                   "did you mean 'motion'?"},
       })
    expect_one(m);
}

// All mistakes at once, also those after an entry that cannot be read.
TEST(MotionMessages, AllAtOnce) {
  std::string const got = problems(along_z(
      "asd: none.txt, columns: [Hz, m/sqrt(Hz)], uncertainty: 30, resonance: {frequency: 3}, through: {pendulum: "
      "{quality: "
      "3}}"));
  EXPECT_THAT(got, AllOf(HasSubstr("cannot read file"), HasSubstr("at most 100 %"), HasSubstr("without a unit"),
                         HasSubstr("key 'quality'"), HasSubstr("key 'frequency'")));
}

}  // namespace
}  // namespace straytrace::testing
