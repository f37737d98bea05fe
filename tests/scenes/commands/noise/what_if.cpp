// SPDX-License-Identifier: BSD-3-Clause
// straytrace noise --set and straytrace sensitivity: other inputs of a run, against traces of them
// (docs/theory/decisions.md, eq. D.1 to D.6).
#include "session/decide/what_if.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <map>

#include "base/every_module.hpp"
#include "base/files/read_write.hpp"
#include "base/math/rng.hpp"
#include "noise/bands/elasticity.hpp"
#include "results/results.hpp"
#include "scenes/program.hpp"
#include "session/open_run.hpp"

namespace straytrace::testing::app_what_if {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

struct Asd {
  double value, sigma;
};

// h at 10 Hz of a summary.
Asd h_of(Finished const& done, double hz) {
  Json const j = Json::parse(done.out);
  for (auto const& h : j.at("total_strain"))
    if (h.at("frequency_Hz") == hz) return {h.at("value"), h.at("sigma")};
  return {not_a_number, not_a_number};
}

Asd at_10_hz(Finished const& done) { return h_of(done, 10); }

struct WhatIf : ::testing::Test {
  static inline Folder const folder;
  static std::string run_of(std::string const& name, Words more) {
    std::string const run = folder / (name + "/run.h5");
    if (std::filesystem::exists(run)) return run;
    Words words{"run", written_arm, "-o", folder / name, "--histories", "65536", "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    Finished const done = straytrace(words);
    EXPECT_EQ(done.code, 0) << done.err;
    return run;
  }
  static std::string run() { return run_of("run", {}); }
  static Finished noise(Words settings, std::string const& of = run()) {
    Words words{"noise", of, "--quiet", "--format", "json"};
    for (std::string const& s : settings) words.insert(words.end(), {"--set", s});
    return straytrace(words);
  }
};

// `scale` of a measured BSDF is a strength: exactly the factor of the whole material. Control: the run as it was.
TEST_F(WhatIf, ScaleOfAMeasuredBsdfNeedsNoTrace) {
  std::string scene = read_text(written_arm);
  std::string const law = "{model: lambertian, brdf: 1e-2 /sr}";
  scene.replace(scene.find(law), law.size(), "{model: table, file: steel.csv, beyond: constant, scale: 1}");
  write_text(folder / "steel.csv", read_text(source_folder + "/examples/data/steel_bsdf.csv"));
  write_text(folder / "measured.yaml", scene);
  Finished const traced =
      straytrace({"run", folder / "measured.yaml", "-o", folder / "measured", "--histories", "65536", "--quiet"});
  ASSERT_EQ(traced.code, 0) << traced.err;
  std::string const run = folder / "measured/run.h5";
  Finished const set = noise({"baffle_steel.scale=0.5"}, run);
  ASSERT_EQ(set.code, 0) << set.err;
  EXPECT_NEAR(at_10_hz(set).value / at_10_hz(noise({"baffle_steel=x0.5"}, run)).value, 1, 1e-9);
  EXPECT_LT(at_10_hz(set).value, 0.8 * at_10_hz(noise({}, run)).value);
}

// Another seed with ten times the BRDF: h ~ beta^(1/2) for one scatter on a baffle, and the rest of the polynomial.
// Control: the run as it was is many errors away.
TEST_F(WhatIf, StrengthIsThatOfATraceWithIt) {
  Asd const set = at_10_hz(noise({"baffle_steel=x10"})), plain = at_10_hz(noise({})),
            traced = at_10_hz(
                noise({}, run_of("bright", {"-p", "materials.baffle_steel.scatter.brdf=0.1/sr", "--seed", "7"})));
  double const sigma = std::hypot(set.sigma, traced.sigma);
  EXPECT_LT(std::fabs(set.value - traced.value), 4.5 * sigma) << set.value << " " << traced.value;
  EXPECT_GT(std::fabs(plain.value - traced.value), 20 * sigma) << "control";
  for (char const* same : {"baffle_steel.brdf=0.1/sr", "materials.baffle_steel.scatter.brdf=x10"})
    EXPECT_NEAR(at_10_hz(noise({same})).value / set.value, 1, 1e-9) << same;
}

TEST_F(WhatIf, MotionAndResponseAreProjectedAnew) {
  Finished const as_run = noise({}), louder = noise({"tube.motion=x2"});
  double const plain = at_10_hz(as_run).value;
  EXPECT_LT(at_10_hz(louder).value, plain);  // on the shelf, eq. D.4
  EXPECT_GT(h_of(louder, 30).value, 1.5 * h_of(as_run, 30).value);
  Finished const heavy = noise({"interferometer.mirror_mass=84kg"});
  EXPECT_LT(at_10_hz(heavy).value, plain);
  EXPECT_EQ(at_10_hz(noise({"mirror_mass=x2"})).value, at_10_hz(heavy).value);
  EXPECT_GT(plain, at_10_hz(noise({"baffle_steel=black"})).value);
}

TEST_F(WhatIf, WrongSettingsAreAllNamed) {
  Finished const done = noise({"bafle_steel=x2", "baffle_steel=x", "rim=48cm", "tube.motion=3 m", "test_mass=x1e6",
                               "baffle_steel", "test_mass.brdf=2e-3/sr", "interferometer.mirror_mass=100"});
  EXPECT_EQ(done.code, 2);
  for (char const* message :
       {"there is no material or value 'bafle_steel'", "did you mean 'baffle_steel'?",
        "'params.rim' changes where light goes", "the motion of a body takes a factor", "would scatter",
        "'baffle_steel' sets nothing", "'x' is not a factor", "'mirror_mass' is a mass, got",
        "the scene has no value 'test_mass.brdf'", "'test_mass' has materials.test_mass."})
    EXPECT_THAT(done.err, HasSubstr(message));
  Finished const several = noise({"materials.exponent=3"});
  EXPECT_EQ(several.code, 2);
  EXPECT_THAT(several.err, HasSubstr("names 2 values of the scene"));
  Finished const bright = noise({"test_mass=x100"});  // 9e-4 of the light, of which the mirror leaves 75 ppm
  EXPECT_EQ(bright.code, 2);
  EXPECT_THAT(bright.err, HasSubstr("that it reflects and transmits"));
  EXPECT_EQ(noise({"test_mass=x8"}).code, 0) << "control";
  Finished const place = noise({"params.rim=48cm"});
  EXPECT_EQ(place.code, 2);
  EXPECT_THAT(place.err, HasSubstr("'params.rim' changes where light goes"));
  Finished const kept = straytrace({"noise", run(), "--set", "baffle_steel=x2", "-o", folder / "kept"});
  EXPECT_EQ(kept.code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "kept"));
}

// What the user wrote is named, with a remedy for it.
TEST_F(WhatIf, RemediesFitWhatIsWrong) {
  for (auto const& [setting, says] : {std::pair{"baffle_steel.brdf=5 m", "--set baffle_steel.brdf=5 m: 'brdf' is"},
                                      {"bafle_steel.brdf=1e-3/sr", "did you mean 'baffle_steel.brdf'?"},
                                      {"tubee.motion=x2", "did you mean 'tube.motion'?"},
                                      {"interferometer.mirror_mas=2 kg", "did you mean 'interferometer.mirror_mass'?"},
                                      {"interferometer.power=2 W", "'interferometer' has interferometer."}}) {
    Finished const done = noise({setting});
    EXPECT_EQ(done.code, 2) << setting;
    EXPECT_THAT(done.err, HasSubstr(says));
    EXPECT_THAT(done.err, ::testing::Not(HasSubstr("command line"))) << setting;
  }
}

// A thousand times the motion has a spectrum, ten thousand times is beyond the samples of any.
TEST_F(WhatIf, MotionOfAnyStrengthHasAnAnswer) {
  EXPECT_GT(at_10_hz(noise({"tube.motion=x1000"})).value, 0);
  Finished const most = noise({"tube.motion=x1e4"});
  EXPECT_EQ(most.code, 3);
  EXPECT_THAT(most.err, HasSubstr("the motion is too strong"));
  EXPECT_THAT(most.err, HasSubstr("check the unit of the motion"));
}

// Control: WrongSettingsAreAllNamed.
TEST_F(WhatIf, WrongFilesAndSettingsAreAllNamed) {
  Finished const done = straytrace({"noise", run(), "--motion", folder / "absent.yaml", "--response",
                                    folder / "none.yaml", "--set", "bafle_steel=x2"});
  EXPECT_EQ(done.code, 2);
  for (char const* says : {"absent.yaml", "none.yaml", "'bafle_steel'"}) EXPECT_THAT(done.err, HasSubstr(says));
  Finished const words = straytrace({"sensitivity", run(), "--only", "shap", "--step", "3 m", "--at", "10", "--plot",
                                     folder / "tornado.gif", "--csv", "."});
  EXPECT_EQ(words.code, 2);
  for (char const* says : {"did you mean 'shape'?", "'3 m' is not a step", "'10' is not a frequency",
                           "end it with .png", "'.' is a folder"})
    EXPECT_THAT(words.err, HasSubstr(says));
  EXPECT_FALSE(std::filesystem::exists(folder / "tornado.gif"));
  Finished const places = straytrace({"sensitivity", run(), "--trace", "rmi,rmo", "--only", "strength"});
  EXPECT_EQ(places.code, 2);
  for (char const* says : {"'rmi'", "'rmo'", "leaves out what --trace names"}) EXPECT_THAT(places.err, HasSubstr(says));
}

// An option without effect is an error. Control: --only with what --trace names, TracedRimsHaveTheirClosedForm.
TEST_F(WhatIf, SensitivityRejectsOptionsWithoutEffect) {
  for (Words const& words :
       {Words{"--step", "3%"}, Words{"--only", "traced"}, Words{"--only", "strength", "--trace", "rim"}}) {
    Words all{"sensitivity", run()};
    all.insert(all.end(), words.begin(), words.end());
    Finished const done = straytrace(all);
    EXPECT_EQ(done.code, 2) << words.front();
    EXPECT_THAT(done.err, HasSubstr(words.size() == 4 ? "leaves out what --trace names" : "nothing is traced"));
  }
}

// The elasticity is the slope of what --set gives: a central difference over 2 % either way.
TEST_F(WhatIf, SensitivityIsTheSlope) {
  Finished const done = straytrace(
      {"sensitivity", run(), "--at", "10Hz", "--only", "strength,motion,response", "--quiet", "--format", "json"});
  ASSERT_EQ(done.code, 0) << done.err;
  Json const j = Json::parse(done.out);
  std::vector<double> const hz = j.at("frequency");
  std::size_t const bin =
      std::size_t(std::ranges::min_element(hz, {}, [](double f) { return std::fabs(std::log(f / 10)); }) - hz.begin());
  auto const of = [&](std::string const& name) {
    for (Json const& in : j.at("inputs"))
      if (in.at("name") == name) return in.at("elasticity").at(bin).get<double>();
    return not_a_number;
  };
  auto const slope = [&](std::string const& name) {
    return std::log(at_10_hz(noise({name + "=x1.02"})).value / at_10_hz(noise({name + "=x0.98"})).value) /
           std::log(1.02 / 0.98);
  };
  EXPECT_NEAR(of("material baffle_steel"), slope("baffle_steel"), 3e-3);
  EXPECT_NEAR(of("motion of tube"), slope("tube.motion"), 3e-2);
  EXPECT_NEAR(of("interferometer.mirror_mass"), slope("mirror_mass"), 3e-2);
  EXPECT_GT(std::fabs(of("material baffle_steel") - of("motion of tube")), 0.1) << "control";
  EXPECT_THAT(j.at("next").get<std::string>(), HasSubstr("No input states a standard deviation"));
}

// Case A11: light from a mirror to annuli and back, of a law theta^-n at both ends, with the density theta^(1 - 2 n) of
// eq. 8.1: d ln C/dn = -2 <ln theta> = 19.1735, so e = n/2 times that (eq. D.7). Controls: one vertex alone; traces at
// both ends of 2 % of n, which do not evaluate the laws at vertices, agree.
TEST_F(WhatIf, ShapeOfALawHasTheClosedFormOfA11) {
  std::string const run = folder / "annuli/run.h5";
  Finished const made = straytrace({"run", source_folder + "/tests/scenes/et_hf_backscatter.yaml", "-o",
                                    folder / "annuli", "--histories", "131072", "--quiet"});
  ASSERT_EQ(made.code, 0) << made.err;
  std::string const place = "materials.mirror.scatter.exponent";
  Finished const done = straytrace(
      {"sensitivity", run, "--trace", place, "--step", "2%", "--only", "shape,traced", "--quiet", "--format", "json"});
  ASSERT_EQ(done.code, 0) << done.err;
  Json const j = Json::parse(done.out);
  std::map<std::string, Asd> found;
  for (Json const& in : j.at("inputs"))
    if (in.at("name") == place)
      found[in.at("class")] = {in.at("elasticity").at(100), in.at("elasticity_sigma").at(100)};
  double const exact = 0.5 * 2.3986 * 19.1735;
  Asd const shape = found.at("shape"), traced = found.at("traced");
  EXPECT_LT(shape.sigma, 0.05);
  EXPECT_LT(std::fabs(shape.value - exact), 4 * shape.sigma + 1e-3 * exact) << shape.value;
  EXPECT_LT(std::fabs(traced.value - exact), 4 * traced.sigma + 1e-3 * exact) << traced.value;
  EXPECT_GT(std::fabs(shape.value - exact / 2), 20 * shape.sigma) << "control";
  Asd const steeper = at_10_hz(noise({place + "=2.45"}, run)), plain = at_10_hz(noise({}, run));
  EXPECT_NEAR(std::log(steeper.value / plain.value), exact * (2.45 / 2.3986 - 1), 0.01);
  Finished const wider = noise({"mirror.above=20 urad"}, run);
  EXPECT_EQ(wider.code, 2);
  EXPECT_THAT(wider.err, HasSubstr("'mirror' would scatter most where the run kept no path"));
  Finished const flat = noise({place + "=1"}, run);  // grows 10^5 times more at 1 rad than at the annuli
  EXPECT_EQ(flat.code, 2);
  EXPECT_THAT(flat.err, HasSubstr("'mirror' would scatter most where the run kept no path"));
}

// Two rings before a mirror with a point-like spot: the derivative with respect to their rim is an integral over the
// rims (eq. D.17), with the shadow of the near ring on the far one. Control: without the shadow.
TEST_F(WhatIf, TracedRimsHaveTheirClosedForm) {
  std::string scene = edited(text_of(et_hf), "  rings: 1500", "  rings: 2\n  rim: 50 cm");
  scene = edited(scene, "inner_radius: R_t/sqrt(step), outer_radius: R_t*sqrt(step)",
                 "inner_radius: rim, outer_radius: 70 cm");
  write_text(folder / "rings.yaml", edited(scene, "from: near*sqrt(step), ratio: step", "from: 100 m, to: 120 m"));
  Finished const made =
      straytrace({"run", folder / "rings.yaml", "-o", folder / "rings", "--histories", "262144", "--quiet"});
  ASSERT_EQ(made.code, 0) << made.err;
  Finished const done = straytrace({"sensitivity", folder / "rings/run.h5", "--trace", "rim", "--step", "2%", "--only",
                                    "traced", "--quiet", "--format", "json"});
  ASSERT_EQ(done.code, 0) << done.err;
  Json const in = Json::parse(done.out).at("inputs").at(0);
  double const e = in.at("elasticity").at(100), sigma = in.at("elasticity_sigma").at(100);
  double const rim = 0.5, near = 100, far = 120, power = 2 - 2 * 2.3986;
  auto const lit = [&](double from, double to) { return (std::pow(to, power) - std::pow(from, power)) / power; };
  double const all = lit(rim / near, 0.7 / near) / (near * near) + lit(rim / far, rim / near) / (far * far);
  auto const elasticity = [&](bool shadow) {
    double const behind = shadow ? 1 / (far * far) : 0;
    return -0.5 *
           (std::pow(rim / near, power) * (1 / (near * near) - behind) + std::pow(rim / far, power) / (far * far)) /
           all;
  };
  EXPECT_LT(sigma, 0.03);
  EXPECT_LT(std::fabs(e - elasticity(true)), 4 * sigma + 2e-3) << e;
  EXPECT_GT(std::fabs(e - elasticity(false)), 10 * sigma) << "control";
}

// All light of a bench behind the end mirror passes it twice, scattered or as a ghost: e = 1 (eq. 1.1, 5.4). Controls:
// a ghost of one coating of its lens; the glass of the sensor, which a part of the light meets once, has at most 1/2.
TEST_F(WhatIf, TransmissionOfAMirrorActsOnAllLightBehindIt) {
  std::string const run = folder / "bench/run.h5";
  Finished const made = straytrace(
      {"run", source_folder + "/examples/end_bench.yaml", "-o", folder / "bench", "--histories", "65536", "--quiet"});
  ASSERT_EQ(made.code, 0) << made.err;
  Finished const done = straytrace({"sensitivity", run, "--only", "strength,shape", "--quiet", "--format", "json"});
  ASSERT_EQ(done.code, 0) << done.err;
  std::map<std::string, double> found;
  Json const j = Json::parse(done.out);
  for (Json const& in : j.at("inputs")) found[in.at("name")] = in.at("elasticity").at(20);
  EXPECT_NEAR(found.at("materials.test_mass.specular.transmit"), 1, 1e-3);
  EXPECT_LT(found.at("materials.lens.specular.reflect"), 0.5) << "control";
  EXPECT_LT(found.at("material glass"), 0.5) << "control";
  EXPECT_GT(found.at("material glass"), 0.2);
  EXPECT_THAT(j.at("next").get<std::string>(), HasSubstr("Measure next: material glass"));
}

// Sliders of a page in node: per setting, the PSD over that as traced.
std::vector<std::vector<double>> on_a_page(Json const& asked, Folder const& folder) {
  std::string const page = source_folder + "/data/page/", base = text_of(page + "base.js");
  std::size_t const typed = base.find("function typedArray(");
  write_text(folder / "page.js", base.substr(typed, base.find("\n}\n", typed) + 3 - typed) +
                                     text_of(page + "what_if.js") +
                                     "const {w, settings} = JSON.parse(require('fs').readFileSync(process.argv[2]));\n"
                                     "const state = new WhatIf(w);\n"
                                     "console.log(JSON.stringify(settings.map(s => state.curve(s).psd)));\n");
  write_text(folder / "asked.json", asked.dump());
  std::string const command =
      "node " + folder / "page.js" + " " + folder / "asked.json" + " > " + folder / "answers.json";
  EXPECT_EQ(std::system(command.c_str()), 0);
  return Json::parse(text_of(folder / "answers.json"), nullptr, false).get<std::vector<std::vector<double>>>();
}

// One table of 50 settings of the sliders for both: the polynomial of the page (eq. D.8), and what --set computes from
// the couplings. Control: one scatter more on a material in the page.
TEST_F(WhatIf, PageAndProgramAgreeOnRandomSettings) {
  Finished const made = straytrace({"trace", written_arm, "-o", folder / "page.h5", "--histories", "4096", "--quiet"});
  ASSERT_EQ(made.code, 0) << made.err;
  OpenRun opened(folder / "page.h5");
  Model model = model_of(opened.file);
  for (ProjectionModel* const m : {&opened.model, static_cast<ProjectionModel*>(&model)}) {  // few bins, weak motion
    m->noise.grid.edges = {9, 11, 27, 33, 90, 110};
    for (MotionInput& in : m->motion.inputs)
      for (Gain& g : in.gains) g.value *= 1e-4;
  }
  model.traced.meets_light.assign(model.motion.bodies.size(), false);  // no slider moves a body
  CouplingTable const& light = opened.file.trace.coupling;
  NoiseBudget const budget = opened.model.project(light);
  PathTable const table = path_table(light, &budget, &opened.model.motion, {});
  WhatIfTerms const terms = what_if_terms(model, light, budget, table, 1);
  ASSERT_EQ(terms.none, "");
  Json page = what_if_json(terms, budget, table), settings = Json::array();
  std::vector<std::vector<double>> program;
  for (std::uint64_t n = 0; n < 50; ++n) {
    std::vector<double> strengths;
    for (std::size_t m = 0; m < terms.materials.size(); ++m)
      strengths.push_back(std::pow(10, 1.5 * Rng(1, n, std::uint32_t(m), Stream::source).uniform() - 1));
    settings.push_back({{"strengths", strengths}, {"body", -1}, {"factor", 1}});
    auto const factor = [&](std::vector<PathStep> const& steps) {
      double product = 1;
      for (std::size_t m = 0; m < strengths.size(); ++m) {
        auto const& all = opened.model.traced.materials;
        auto const own = std::ranges::find(all, terms.materials[m].name, &MaterialSpread::name);
        product *= std::pow(strengths[m], scatters_on(*own, steps));
      }
      return product;
    };
    NoiseTrace const total = opened.model.project(scaled_couplings(light, factor).table).total;
    program.emplace_back();
    for (std::size_t i = 0; i < budget.grid.size(); ++i) program.back().push_back(total.psd(i) / budget.total.psd(i));
  }
  auto const largest = [&](Json const& of_page) {
    double most = 0;
    auto const answers = on_a_page({{"w", of_page}, {"settings", settings}}, folder);
    for (std::size_t n = 0; n < answers.size(); ++n)
      for (std::size_t i = 0; i < answers[n].size(); ++i)
        most = std::max(most, std::fabs(answers[n][i] / program[n][i] - 1));
    return answers.size() == program.size() ? most : infinity;
  };
  EXPECT_LT(largest(page), 3e-6);  // rows `other` are divided by kept paths, and shares are 32-bit numbers
  for (Json& exponents : page["exponents"]) exponents[0] = exponents[0].get<int>() + 1;
  EXPECT_GT(largest(page), 0.1) << "control";
}

}  // namespace
}  // namespace straytrace::testing::app_what_if
