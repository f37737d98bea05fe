// SPDX-License-Identifier: BSD-3-Clause
// Measured motion: spectra and series of sensors.
#include <cmath>

#include "base/math/rng.hpp"
#include "motion/motion.hpp"
#include "motion/series_motion.hpp"
#include "spectra/files/series_file.hpp"
#include "support/recorded.hpp"
#include "support/scene_tables.hpp"

namespace straytrace::testing::noise_motion_files {
namespace {

using ::testing::HasSubstr;

struct Read {
  MotionSet motion;
  std::string problems;
};

// Motion along z of body a.
Read read(std::string const& z, FileTexts files = {}) {
  Scene const scene = scene_of("bodies:\n  a: {motion: {z: {" + z + "}, others: still}}\n", std::move(files));
  Read r;
  r.motion = read_motion(scene.root()["bodies"], {"a"});
  r.problems = problems_of(scene);
  return r;
}

double asd_at(Read const& r, double hz) { return std::sqrt(r.motion.inputs.at(0).spectrum.at(hz)); }

TEST(ReadMotionFiles, CountsWithACalibration) {  // eq. 11.3
  FileTexts const files = {{"raw.txt", "1 50\n100 50\n"}, {"power.txt", "1 2500\n100 2500\n"}};
  double const expected = 50 * 6.1e-6 / std::pow(2 * pi * 10, 2);
  for (char const* spec : {"asd: raw.txt, columns: [Hz, count/sqrt(Hz)], calibration: 6.1 um/s^2/count",
                           "asd: raw.txt, columns: [Hz, V/sqrt(Hz)], calibration: 6.1 um/s^2/V",
                           "asd: power.txt, columns: [Hz, count^2/Hz], calibration: 6.1 um/s^2/count"}) {
    Read const r = read(spec, files);
    ASSERT_EQ(r.problems, "") << spec;
    EXPECT_NEAR(asd_at(r, 10) / expected, 1, 1e-9) << spec;
  }
  EXPECT_THAT(read("asd: raw.txt, columns: [Hz, count/sqrt(Hz)]", files).problems,
              HasSubstr("calibration: 6.1 um/s^2/count"));
  EXPECT_THAT(read("asd: raw.txt, columns: [Hz, count/sqrt(Hz)], calibration: 6.1 um/s^2/V", files).problems,
              HasSubstr("nor is it with this calibration"));
  EXPECT_THAT(read("asd: raw.txt, columns: [Hz, count/sqrt(Hz)], calibration: 6.1 urad/count", files).problems,
              HasSubstr("not a unit of a motion"));  // an angle along z
  EXPECT_THAT(read("series: r.txt", {{"r.txt", "# t [s], z [count]\n0 1\n1 2\n2 1\n3 2\n"}}).problems,
              HasSubstr("\"count\" is not a unit of a motion"));  // the unit of the file, not the name of it
}

TEST(ReadMotionFiles, SensorWithAResponse) {
  FileTexts const files = {{"raw.txt", "1 50\n100 50\n"}, {"sensor.txt", "1 1 0\n10 0 2\n100 0 -4\n"}};
  std::string const file = "asd: raw.txt, columns: [Hz, count/sqrt(Hz)], ";
  Read const table = read(file + "calibration: {unit: um/s/count, file: sensor.txt, columns: [Hz, re, im]}", files);
  ASSERT_EQ(table.problems, "");
  EXPECT_NEAR(asd_at(table, 10) / (2 * 50e-6 / (2 * pi * 10)), 1, 1e-9);
  EXPECT_NEAR(asd_at(table, std::sqrt(1000)) / (std::sqrt(8) * 50e-6 / (2 * pi * std::sqrt(1000))), 1, 1e-4);
  Read const poles = read(file + "calibration: {unit: um/count, gain: 3, zeros: [10 Hz]}", files);
  ASSERT_EQ(poles.problems, "");
  EXPECT_NEAR(asd_at(poles, 10) / (std::sqrt(2) * 150e-6), 1, 1e-4);
  EXPECT_THAT(
      read("asd: raw.txt, columns: [Hz, count/sqrt(Hz)], calibration: {unit: um/count, file: short.txt, columns: "
           "[Hz, re, im]}",
           {{"raw.txt", "1 50\n100 50\n"}, {"short.txt", "2 1 0\n10 1 0\n"}})
          .problems,
      HasSubstr("the chain covers 2 Hz to 10 Hz"));
}

// --- series
// -----------------------------------------------------------------------------------------------------------

TimeSeries noise_of(double rate, std::size_t samples, double asd, std::string unit) {
  TimeSeries s{"ACC", std::move(unit), 1e9, rate, {}};
  Rng rng(7, 1, 0, Stream::source);
  for (std::size_t i = 0; i < samples; ++i)
    s.samples.push_back(asd * std::sqrt(rate / 2) * std::sqrt(-2 * std::log(rng.uniform())) *
                        std::cos(2 * pi * rng.uniform()));
  return s;
}

TEST(ReadMotionFiles, AccelerometerRecord) {  // 11.3; mean over a band of 2000 lines: 5 standard errors
  TimeSeries const record = noise_of(128, 128 * 600, 1e-4, "m/s^2");
  FileTexts const files = {{"acc.hdf5", series_hdf5({&record, 1})}};
  Read const r = read("series: acc.hdf5, highpass: 0.5 Hz", files);
  ASSERT_EQ(r.problems, "");
  MotionInput const& input = r.motion.inputs.at(0);
  double ratio = 0;
  int n = 0;
  for (double f = 5; f < 50; f *= 1.0005, ++n)
    ratio += input.spectrum.at(f) / std::pow(1e-4 / std::pow(2 * pi * f, 2), 2);
  EXPECT_NEAR(ratio / n, 1, 5 / std::sqrt(45.0 * 600));  // bandwidth times duration
  EXPECT_GT(std::fabs(ratio / n * 2 - 1), 0.5);          // control: two-sided
  ASSERT_TRUE(input.recorded);
  EXPECT_EQ(input.recorded->unit, "m");
  EXPECT_EQ(input.recorded->start, 1e9);
  EXPECT_EQ(input.recorded->samples.size(), record.samples.size());
  double square = 0;
  for (double x : input.recorded->samples) square += x * x / double(record.samples.size());
  EXPECT_NEAR(square / input.spectrum.total(), 1, 0.15);  // the same motion in both forms: few lines near 0.5 Hz
}

// Displacement with a known answer: an oscillation well above the high pass, in phase.
TEST(ReadMotionFiles, IntegrationKeepsThePhase) {  // 11.3
  double const rate = 200, f = 3;
  for (int derivatives : {0, 1, 2}) {
    TimeSeries readings{"s", "", 0, rate, {}};
    for (int i = 0; i < 60000; ++i) {
      double const w = 2 * pi * f, t = i / rate, v[] = {std::sin(w * t), w * std::cos(w * t), -w * w * std::sin(w * t)};
      readings.samples.push_back(v[derivatives] * 1e-6 / 4 + 3e-6 * (derivatives > 0) * (1 + t));  // an offset drifts
    }
    TimeSeries const x = as_displacement(readings, {4, false, derivatives, {}}, derivatives > 0 ? 0.2 : 0);
    double worst = 0;
    for (std::size_t i = 20000; i < 40000; ++i)
      worst = std::max(worst, std::fabs(x.samples[i] - 1e-6 * std::sin(2 * pi * f * double(i) / rate)));
    EXPECT_LT(worst, derivatives == 0 ? 1e-18 : 1e-10) << derivatives;
  }
}

TEST(ReadMotionFiles, LineKeepsItsPower) {  // a line between the frequencies of the periodogram
  TimeSeries readings{"s", "um", 0, 64, {}};
  for (int i = 0; i < 64 * 800; ++i) readings.samples.push_back(std::sin(2 * pi * 5.003 * i / 64));
  FileTexts const files = {{"x.hdf5", series_hdf5({&readings, 1})}};
  Read const r = read("series: x.hdf5, scale: 3, segment: 100 s", files);
  ASSERT_EQ(r.problems, "");
  EXPECT_NEAR(r.motion.inputs.at(0).spectrum.power(4.9, 5.1) / 0.5e-12, 1, 1e-3);
  EXPECT_EQ(r.motion.inputs.at(0).gains.at(0).value, 3.0);
  EXPECT_NEAR(r.motion.inputs.at(0).recorded->samples[10], 1e-6 * std::sin(2 * pi * 50.03 / 64), 1e-21);
}

// R4.04: a tone, and the same tone as a sampled series, turn the phase of a path alike. z = 118 rad; 1e-12 relative.
TEST(ReadMotionFiles, ToneAndItsSamplesR4_04) {
  double const rate = 512, f = 5, phase_sensitivity = 4 * pi / 1064e-9, start = 1234567890;
  TimeSeries samples{"POSITION", "um", start, rate, {}};
  for (int i = 0; i < 4096; ++i) samples.samples.push_back(10 * std::sin(2 * pi * std::fmod(f * i / rate, 1) + pi / 6));
  Read const series = read("series: x.hdf5", {{"x.hdf5", series_hdf5({&samples, 1})}}),
             tone = read("sine: {amplitude: 10 um peak, frequency: 5 Hz, phase: 30 deg}");
  ASSERT_EQ(series.problems + tone.problems, "");
  Gain const &of_series = series.motion.inputs.at(0).gains.at(0), &of_tone = tone.motion.inputs.at(0).gains.at(0);
  TimeSeries const& recorded = *series.motion.inputs[0].recorded;
  EXPECT_EQ(recorded.start, start);
  double worst = 0, control = 0;
  for (std::size_t i = 0; i < recorded.samples.size(); ++i) {
    double const turn = 2 * pi * std::fmod(f * double(i) / rate, 1),
                 phase = phase_sensitivity * of_series.value.real() * recorded.samples[i];
    worst = std::max(worst, std::fabs(phase - phase_sensitivity * std::imag(of_tone.value * std::polar(1.0, turn))));
    control =
        std::max(control, std::fabs(phase - phase_sensitivity * std::real(of_tone.value * std::polar(1.0, turn))));
  }
  EXPECT_LT(worst, 1e-12 * phase_sensitivity * 10e-6);
  EXPECT_GT(control, 1);  // cosine for sine
}

TEST(ReadMotionFiles, OneRecordIsOneMotion) {
  TimeSeries const record = noise_of(16, 2000, 1e-6, "m");
  FileTexts const files = {{"x.hdf5", series_hdf5({&record, 1})}};
  Scene const scene = scene_of(
      "bodies:\n  a: {motion: {z: {series: x.hdf5}, others: still}}\n  b: {motion: {z: {series: x.hdf5, scale: 0.5}, "
      "others: still}}\n",
      files);
  MotionSet const m = read_motion(scene.root()["bodies"], {"a", "b"});
  ASSERT_EQ(problems_of(scene), "");
  ASSERT_EQ(m.inputs.size(), 1u);
  std::vector<PhaseSensitivity> const phase_sensitivities = {{BodyId{0}, {0, 0, 1, 0, 0, 0}},
                                                             {BodyId{1}, {0, 0, -2, 0, 0, 0}}};
  EXPECT_EQ(m.sensitivity(0, phase_sensitivities, 1), 0);
}

TEST(ReadMotionFiles, RequiredKeysOfARecord) {
  TimeSeries const record = noise_of(16, 2000, 1e-6, "m/s^2");
  FileTexts const files = {{"x.hdf5", series_hdf5({&record, 1})}, {"x.txt", "0 1\n1 2\n2 4\n"}};
  EXPECT_THAT(read("series: x.hdf5", files).problems, HasSubstr("add 'highpass: 0.05 Hz'"));
  EXPECT_THAT(read("series: x.hdf5, highpass: 0.01 Hz", files).problems, HasSubstr("needs segments of 400 s"));
  EXPECT_THAT(read("series: x.hdf5, highpass: 1 MHz", files).problems, HasSubstr("removes all of a record of"));
  EXPECT_THAT(read("series: x.hdf5, highpass: 1 Hz, segment: 500 s", files).problems, HasSubstr("lasts 125 s"));
  EXPECT_THAT(read("series: x.hdf5, highpass: 1 Hz, channel: other", files).problems, HasSubstr("other"));
  EXPECT_THAT(read("series: x.hdf5, highpass: 1 Hz, unit: V", files).problems, HasSubstr("add the motion per unit"));
  EXPECT_THAT(read("series: none.hdf5, highpass: 1 Hz", files).problems, HasSubstr("cannot read file"));
  EXPECT_THAT(read("series: x.txt, highpass: 1 Hz", files).problems, HasSubstr("'unit'"));
  EXPECT_THAT(read("series: x.hdf5, highpass: 1 Hz, resonance: {frequency: 1 Hz, quality: 3}", files).problems,
              HasSubstr("a link of a chain"));
  EXPECT_EQ(read("series: x.hdf5, highpass: 1 Hz, unit: um/s^2", files).problems, "");
}

}  // namespace
}  // namespace straytrace::testing::noise_motion_files
