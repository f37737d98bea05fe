// SPDX-License-Identifier: BSD-3-Clause
// Commissioning commands on records made here, whose truth is known: kinds of witnesses, several of them, measured
// against predicted (R6.01 to R6.08).
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <sstream>

#include "scenes/answers.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing::app_commission {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

std::string const example = source_folder + "/examples/data/swinging_baffle.hdf5";

void write_record(std::string const& file, std::string const& columns, double start, double rate, double seconds,
                  std::vector<std::function<double(double)>> const& values) {
  std::string text = columns + "\n";
  for (int i = 0; i < int(rate * seconds); ++i) {
    text += fmt::format("{:.6f}", start + i / rate);
    for (auto const& v : values) text += fmt::format(",{:.12g}", v(i / rate));
    text += "\n";
  }
  write_text(file, text);
}

// Noise of one-sided ASD `asd` at this rate; nearly Gaussian.
class Noise {
 public:
  Noise(double asd, double rate) : scale_(asd * std::sqrt(rate / 2)) {}
  double operator()() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) {
      state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
      sum += double(state_ >> 11) / 9007199254740992.0;
    }
    return sum * scale_;
  }

 private:
  std::uint64_t state_ = 1;
  double scale_;
};

// A motion and its derivatives: x, v, a.
double motion(double t, int derivative) {
  double const w = 2 * M_PI * 1.14, u = 2 * M_PI * 0.9, turn = derivative * M_PI / 2;
  return 3.5e-6 * std::pow(w, derivative) * std::sin(w * t + 0.3 + turn) +
         0.8e-6 * std::pow(u, derivative) * std::sin(u * t + 1 + turn);
}

// rad rms for W = 1: 4 pi/lambda times what high passes (f/c)^4/(1 + (f/c)^4) at half a corner and at it leave of
// the motion, their difference (eq. 11.3); sines have rms A/sqrt(2).
double unseen_phase(double corner) {
  auto const rms = [&](double amplitude, double hz) {
    auto const kept = [&](double c) { return 1 / (1 + std::pow(c / hz, 4)); };
    return amplitude / std::sqrt(2.0) * (kept(corner / 2) - kept(corner));
  };
  return 4 * M_PI / 1064e-9 * std::hypot(rms(3.5e-6, 1.14), rms(0.8e-6, 0.9));
}

Words fit_words(std::string const& witness, Words more = {}) {
  Words all{"fit", "--target", example + "::h", "--witness", witness, "--band", "20 Hz..85 Hz"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

// R6.05, R6.07: an accelerometer or a velocity meter is integrated; W = 1.3 comes out.
TEST(FitWitness, VelocityAndAccelerationAreIntegratedR6_07) {
  Folder const folder;
  std::string const h = folder / "h.csv";
  Noise noise(5e-23, 256);
  write_record(h, "time [s],h [strain]", 1000, 256, 50,
               {[&](double t) { return noise() + 2e-21 * std::sin(1 + 1.3 * 4 * M_PI / 1064e-9 * motion(t, 0)); }});
  for (int const derivative : {1, 2}) {
    std::string const file = folder / fmt::format("{}.csv", derivative);
    write_record(file, derivative == 1 ? "time [s],v [m/s]" : "time [s],a [m/s^2]", 1000, 64, 50,
                 {[&](double t) { return motion(t, derivative); }});
    Words const words{"fit", "--target", h, "--witness", file, "--band", "20 Hz..85 Hz", "--multiplicity", "1..2"};
    auto const with = [&](std::string const& corner) {
      Words all = words;
      all.insert(all.end(), {"--corner", corner});
      return all;
    };
    Json const fit = answer(with("0.15 Hz"));
    EXPECT_EQ(fit["verdict"], "found") << derivative;
    EXPECT_NEAR(fit["paths"][0]["multiplicity"]["value"].get<double>(), 1.3, 0.002 * 1.3) << derivative;
    EXPECT_THAT(straytrace(with("0.6 Hz")).out, HasSubstr("that is motion and not sensor noise, the amplitude is"));
    EXPECT_THAT(straytrace(with("0.25 Hz")).out, Not(HasSubstr("below --corner"))) << "control: all motion is above";
    Json const high = answer(with("0.6 Hz"))["paths"][0];
    EXPECT_NEAR(
        high["unseen_phase_rad"].get<double>() / high["multiplicity"]["value"].get<double>() / unseen_phase(0.6), 1,
        0.02);
    EXPECT_THAT(straytrace(with("0.15 Hz")).out, HasSubstr("fewer than six periods of half of it"));
    EXPECT_THAT(error_text(words), HasSubstr("write --corner"));
    EXPECT_THAT(error_text(with("0.1 Hz")), HasSubstr("fewer than six periods"));
  }
  EXPECT_THAT(error_text(fit_words(example + "::x", {"--corner", "0.1 Hz"})), HasSubstr("is not integrated"));
}

// An angle: theta = (4 pi/lambda) L angle, so W is the lever arm L; here the witness turns by x/5 cm.
TEST(FitWitness, AngleGivesALeverArmR6_07) {
  Folder const folder;
  std::string const file = folder / "tilt.csv";
  write_record(file, "time [s],tilt [urad]", 1187000000, 64, 40, {[](double t) {
                 double const x =
                     4e-6 * std::sin(2 * M_PI * 1.14 * t + 0.3) + 0.3e-6 * std::sin(2 * M_PI * 0.31 * t + 1);
                 return 1e6 * x / 0.05;
               }});
  Json const fit = answer(fit_words(file, {"--multiplicity", "5 cm..10 cm"}));
  EXPECT_EQ(fit["verdict"], "found");
  EXPECT_NEAR(fit["paths"][0]["multiplicity"]["value"].get<double>(), 1.3 * 0.05, 0.02 * 1.3 * 0.05);
  EXPECT_THAT(straytrace(fit_words(file, {"--multiplicity", "5 cm..10 cm"})).out, HasSubstr(" m, searched from"));
  EXPECT_THAT(error_text(fit_words(file)), HasSubstr("lever arm"));
  EXPECT_THAT(error_text(fit_words(file, {"--multiplicity", "1..2"})), HasSubstr("--multiplicity"));
  EXPECT_THAT(error_text(fit_words(file, {"--multiplicity", "5 cm..10 cm", "--witness2", example + "::x"})),
              HasSubstr("two of one kind"));
  EXPECT_THAT(error_text({"fit", "--target", example + "::h", "--witness", example + "::h", "--band", "20 Hz..85 Hz"}),
              HasSubstr("not a unit of motion"));
}

// Two routes of a run together, each compared with its prediction, and an axis that the witness does not measure.
TEST(FitWitness, SeveralPathsOfARunAreFittedTogetherR6_07) {
  Folder const folder;
  std::string const run = folder / "run.h5";
  ASSERT_EQ(straytrace({"trace", virgo_arm, "--histories", "131072", "--seed", "3", "-o", run}).code, 0);
  auto const words = [&](Words more) {
    Words all = fit_words(example + "::x", {"--body", "tube"});
    all.insert(all.begin() + 1, run);
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  Json const both = answer(words({"--path", "3", "--path", "4", "--multiplicity", "0.6..2"}));
  ASSERT_EQ(both["paths"].size(), 2u);
  EXPECT_EQ(both["paths"][0]["prediction"]["rank"], 3);
  EXPECT_EQ(both["paths"][1]["prediction"]["rank"], 4);
  double const first = both["paths"][0]["multiplicity"]["value"], second = both["paths"][1]["multiplicity"]["value"];
  EXPECT_LT(std::min(std::fabs(first - 1.3), std::fabs(second - 1.3)), 0.02) << "one of them is what was put in";
  std::vector<std::string> const names = both["parameters"];
  for (char const* name : {"amplitude 1", "amplitude 2", "multiplicity 1", "multiplicity 2"})
    EXPECT_THAT(names, ::testing::Contains(name)) << "one covariance";
  EXPECT_EQ(both["correlation"].size(), names.size());
  EXPECT_THAT(error_text(words({"--path", "3", "--axis", "ry"})), HasSubstr("write --axis x, y or z"));
}

// R6.09: the ghost of a plate that picks off, traced and found in a record of G sin(phi): f_r = (G/T)^2, T = lambda/(4
// pi L) of an arm so heavy and dark that no radiation pressure counts. Control: with the pressure of 100 kW less field
// does.
TEST(FitGhost, PickOffComesBackWithItsFractionR6_09) {
  Folder const folder;
  std::string const scene =
      "straytrace: 1\n"
      "materials:\n"
      "  glass: {specular: {reflect: 4 ppm, transmit: 999000 ppm}, scatter: {model: lambertian, tis: 1 ppm}}\n"
      "  face: {specular: {reflect: 0 ppm, transmit: 1000000 ppm}}\n"
      "bodies: {plate: {motion: {z: {peterson: low}, others: still}}, bench: {motion: still}}\n"
      "scene:\n"
      "  - {name: entry, shape: {disk: {outer_radius: 1 m}}, at: [0 m, 0 m, 1 m], facing: [0, 0, -1], body: bench,"
      " material: face}\n"
      "  - {name: pick_off, shape: {disk: {outer_radius: 1 m}}, at: [0 m, 0 m, 3 m], facing: [0, 0, -1], body: plate,"
      " material: glass}\n"
      "beams: {laser: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], radius: 50 mm, lit: yes}}\n"
      "ports: {P: {beam: laser, at: entry}}\n"
      "interferometer: {preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42000 kg, input_transmission:"
      " 1.4 %, arm_power: 1 W}\n"
      "ghosts: {order: 1}\n";
  write_text(folder / "light.yaml", scene);
  write_text(folder / "heavy.yaml", edited(edited(scene, "42000 kg", "42 kg"), "1 W", "100 kW"));
  double const gain = 2e-3 * 1064e-9 / (4 * M_PI * 3000);
  Noise noise(1e-15, 256);
  std::string const record = folder / "h.csv";
  write_record(record, "time [s],h [strain],x [m]", 1000, 256, 24,
               {[&](double t) { return noise() + gain * std::sin(1 + 4 * M_PI * motion(t, 0) / 1064e-9); },
                [](double t) { return motion(t, 0); }});
  auto const fitted = [&](std::string const& name) {
    std::string const run = folder / (name + ".h5");
    EXPECT_EQ(straytrace({"trace", folder / (name + ".yaml"), "--histories", "4096", "-o", run}).code, 0);
    return answer({"fit", run, "--target", record + "::h", "--witness", record + "::x", "--band", "25 Hz..52 Hz",
                   "--free", "multiplicity"});
  };
  Json const light = fitted("light");
  EXPECT_EQ(light["verdict"], "found");
  Json const &path = light["paths"][0], &ratio = path["prediction"]["measured_over_predicted"];
  EXPECT_FALSE(path["prediction"].contains("speckle")) << "a ghost is one field";
  EXPECT_NEAR(path["prediction"]["recoupled_fraction"]["value"].get<double>(), 4e-6, 4e-9);
  EXPECT_NEAR(ratio["value"].get<double>(), 1, 4 * ratio["sigma"].get<double>());
  EXPECT_LT(ratio["sigma"].get<double>(), 0.03);
  EXPECT_NEAR(path["multiplicity"]["value"].get<double>(), 1, 0.002);
  EXPECT_LT(fitted("heavy")["paths"][0]["prediction"]["measured_over_predicted"]["value"].get<double>(), 0.5);
}

// R2.40: `fit edge` finds ratio and motion of two bodies together.
TEST(FitEdge, FreeRatioR2_40) {
  Folder const folder;
  auto const one = [](double t) { return 7e-6 * std::sin(2 * M_PI * 0.9 * t + 0.3); };
  auto const two = [](double t) { return 5e-6 * std::sin(2 * M_PI * 0.55 * t + 0.9); };
  std::string const file = folder / "two.csv";
  Noise noise(3e-23, 400);
  write_record(
      file, "time [s],h [strain],x [m],y [m]", 1000, 400, 20,
      {[&](double t) { return noise() + 2e-21 * std::sin(0.5 * t + 4 * M_PI * (one(t) - 0.8 * two(t)) / 1064e-9); },
       one, two});
  Json const fit = answer({"fit", "edge", "--target", file + "::h", "--witness", file + "::x", "--witness2",
                           file + "::y", "--band", "12 Hz..110 Hz", "--ratio", "0.5..1.1", "--factor", "0.7..1.4"});
  double const ratio = fit["ratio"]["value"], sigma = fit["ratio"]["sigma"];
  EXPECT_NEAR(ratio, 0.8, 3 * sigma);
  EXPECT_LT(sigma, 0.1);
  EXPECT_NEAR(fit["effective_motion"]["value"].get<double>(), 1, 3 * fit["effective_motion"]["sigma"].get<double>());
}

// eq. 7.1: f = 2 |v|/lambda. A velocity and an acceleration that are integrated give the fringes of the motion, without
// the ends of the record, where integration makes up to four times as many. Control: those ends.
TEST(Fringes, IntegratedMotionHasNoFringesOfItsEnds) {
  Folder const folder;
  double const w = 2 * M_PI * 0.7, a = 5e-6, truth = 2 * a * w / 1064e-9;
  std::string const file = folder / "x.csv";
  write_record(
      file, "time [s],v [m/s],a [m/s^2]", 1000, 64, 64,
      {[&](double t) { return a * w * std::cos(w * t); }, [&](double t) { return -a * w * w * std::sin(w * t); }});
  auto const largest = [&](std::string const& channel, std::string const& corner, Words more = {}) {
    Words words{"fringes", "--wavelength", "1064 nm", "--channel", file + "::" + channel, "--corner", corner};
    words.insert(words.end(), more.begin(), more.end());
    Finished const f = straytrace(words);
    EXPECT_EQ(f.code, 0) << f.err;
    std::string const& out = f.out;
    std::istringstream row(out.substr(out.find('\n', out.find("----")) + 1));
    double median = 0, most = 0, top = 0;
    row >> median >> most >> top;
    return top;
  };
  for (std::string const channel : {"v", "a"}) {
    EXPECT_NEAR(largest(channel, "0.1 Hz"), truth, 0.01 * truth) << channel;
    EXPECT_NEAR(largest(channel, "0.1 Hz", {"--gps", "1001..1063"}), truth, 0.01 * truth) << channel;
  }
  EXPECT_THAT(error_text({"fringes", "--wavelength", "1064 nm", "--channel", file + "::v", "--corner", "0.05 Hz"}),
              HasSubstr("fewer than six periods"));
}

TEST(Fit, ConstantRecordsAreErrorsR6_06) {
  Folder const folder;
  std::string const file = folder / "still.csv";
  write_record(file, "time [s],h [strain],x [m]", 1000, 256, 20,
               {[](double t) { return 1e-21 * std::sin(200 * t); }, [](double) { return 1e-6; }});
  EXPECT_THAT(error_text({"fit", "--target", file + "::h", "--witness", file + "::x", "--band", "20 Hz..60 Hz"}),
              HasSubstr("'x' is constant"));
}

}  // namespace
}  // namespace straytrace::testing::app_commission
