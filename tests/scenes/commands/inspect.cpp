// SPDX-License-Identifier: BSD-3-Clause
// straytrace inspect: numbers, provenance, picture, and messages with a place.
#include <nlohmann/json.hpp>

#include <cmath>

#include "scenes/program.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;

std::string scene_with(std::string const& materials) { return "straytrace: 1\nmaterials:\n" + materials; }

TEST(Inspect, ExamplesOfTheHelpRun) {
  Folder const folder;
  fs::create_directory_symlink(source_folder + "/examples", folder / "examples");
  Finished const help = straytrace({"inspect", "--help"});
  EXPECT_THAT(help.out, HasSubstr("straytrace inspect oxidised_steel"));
  EXPECT_THAT(help.out, HasSubstr("straytrace inspect test_mass examples/virgo_arm.yaml --format json"));
  Finished const preset = straytrace({"inspect", "oxidised_steel"}, {folder.path()});
  EXPECT_EQ(preset.code, 0) << preset.err;
  EXPECT_THAT(preset.out, HasSubstr("LIGO-L1100197"));
  EXPECT_THAT(preset.out, HasSubstr("9.4248e-03"));  // 3e-3 pi
  Finished const mass =
      straytrace({"inspect", "test_mass", "examples/virgo_arm.yaml", "--format", "json"}, {folder.path()});
  EXPECT_EQ(mass.code, 0) << mass.err;
  auto const law = nlohmann::json::parse(mass.out);
  EXPECT_EQ(law["laws"].size(), 2u);
  EXPECT_THAT(law["source"], HasSubstr("Gonzalez Castro"));
  double const sum = law["tis"][0]["scattered"].get<double>() + law["tis"][0]["reflect"].get<double>() +
                     law["tis"][0]["transmit"].get<double>() + law["tis"][0]["absorbed"].get<double>();
  EXPECT_NEAR(sum, 1, 1e-12);
}

// Harvey: BSDF at |beta - beta0| = l is b0 2^(s/2), TIS(0) is eq. 3.15. Case by parameter. Control: another slope.
TEST(Inspect, NumbersAreThoseOfTheLaw) {
  Folder const folder;
  write_text(folder / "a.yaml",
             "straytrace: 1\nparams: {slope: -1.5, case: 0}\nmaterials:\n"
             "  m: {scatter: {model: harvey, b0: 1 /sr, l: 0.01, s: slope}}\n"
             "  p: {preset: steel_ebonol, take: case}\n");
  auto const tis = [&](Words words) {
    words.insert(words.end(), {folder / "a.yaml", "--format", "json"});
    Finished const r = straytrace(words);
    EXPECT_EQ(r.code, 0) << r.err;
    return nlohmann::json::parse(r.out)["tis"][0]["scattered"].get<double>();
  };
  EXPECT_NEAR(tis({"inspect", "m"}) / 0.011310048, 1, 1e-3);
  EXPECT_GT(std::fabs(tis({"inspect", "m", "-p", "slope=-1.51"}) / 0.011310048 - 1), 1e-3);
  EXPECT_NEAR(tis({"inspect", "p"}), 1e-3 * M_PI, 1e-9);
  EXPECT_NEAR(tis({"inspect", "p", "-p", "case=2"}), 1e-2 * M_PI, 1e-9);
}

// Control: a source that is given is printed.
TEST(Inspect, ShowsParametersAndPlaceOfEachModel) {
  Folder const folder;
  write_text(folder / "a.yaml",
             "straytrace: 1\nparams: {slope: -1.5}\nmaterials:\n"
             "  m:\n    scatter:\n      - {model: harvey, b0: 0.1 /sr, l: 0.01, s: slope}\n"
             "      - {model: polynomial, diffuse: [[1e-3 /sr]], source: a paper}\n");
  Finished const r = straytrace({"inspect", "m", folder / "a.yaml"});
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("material m\n"
                               "  law 1: harvey, b0 0.1 /sr, l 0.01, s slope (a.yaml:6)\n"
                               "  law 2: polynomial, diffuse [[1e-3 /sr]] (a.yaml:7), source: a paper\n"));
  Finished const preset = straytrace({"inspect", "oxidised_steel"});
  EXPECT_THAT(preset.out, HasSubstr("material oxidised_steel\n  law 1: preset oxidised_steel, source: assumed"));
  EXPECT_THAT(straytrace({"inspect", "m", folder / "a.yaml", "--format", "json"}).out,
              HasSubstr("\"parameters\":\"b0 0.1 /sr, l 0.01, s slope\""));
}

TEST(Inspect, DrawsAPicture) {
  Folder const folder;
  Finished const r = straytrace({"inspect", "black_anodise", "--plot", folder / "law.png"}, {".", true});
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(text_of(folder / "law.png").substr(1, 3), "PNG");
  EXPECT_FALSE(fs::exists(folder / "law.png.json"));
}

TEST(Inspect, ReadsABsdfFile) {
  Finished const r = straytrace({"inspect", source_folder + "/examples/data/steel_bsdf.csv"});
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("laboratory CSV, reflected, 1064 nm"));
}

struct Bad {
  std::string materials, message;
};

TEST(Inspect, MistakesHaveAPlaceAndARemedy) {
  Folder const folder;
  write_text(folder / "negative.csv", "theta_i [deg], theta_s [deg], brdf [1/sr]\n5, 10, 1e-3\n5, 71, -2e-7\n");
  write_text(folder / "bare.csv", "theta_i, theta_s, brdf\n5, 10, 1e-3\n");
  write_text(folder / "no_angle.csv", "theta_i [deg], brdf [1/sr]\n5, 1e-3\n");
  write_text(folder / "one.csv", "theta_i [deg], theta_s [deg], brdf [1/sr]\n5, 10, 1e-3\n5, 10.1, 1e-3\n");
  write_text(folder / "text.csv", "theta_i [deg], theta_s [deg], brdf [1/sr]\n5, ten, 1e-3\n");
  write_text(folder / "psd.csv", "f [1/mm], s2 [nm^4]\n1, 100\n1, 90\n");
  std::string const table = "model: table, angles: from_normal, beyond: zero, wavelength: 1064 nm";
  for (Bad const& bad : {
           Bad{"  m: {scatter: {" + table + ", file: negative.csv}}\n",
               "negative.csv:3:8: error: BRDF -2e-07 /sr at 71 deg"},
           Bad{"  m: {scatter: {" + table + ", file: bare.csv}}\n",
               "bare.csv:1:1: error: column 'theta_i' is an angle and needs its unit"},
           Bad{"  m: {scatter: {" + table + ", file: no_angle.csv}}\n",
               "no_angle.csv:1:1: error: the direction of scatter"},
           Bad{"  m: {scatter: {" + table + ", file: one.csv}}\n", "do not cover a range of angles"},
           Bad{"  m: {scatter: {" + table + ", file: text.csv}}\n", "text.csv:2:4: error: 'ten' is not a number"},
           Bad{"  m: {scatter: {model: table, file: one.csv, angles: from_normal, beyond: zero}}\n",
               "the file does not declare wavelength of the measurement"},
           Bad{"  m: {scatter: {model: psd, file: psd.csv, dimension: 2d, sides: two, beyond: zero}}\n",
               "psd.csv:3:1: error: the frequency does not increase"},
           Bad{"  m: {scatter: {model: psd, file: psd.csv, dimension: 2d, sides: one, beyond: zero}}\n",
               "write 'sides: two'"},
           Bad{"  m: {scatter: {model: harvey, b0: 9 /sr, l: 0.5, s: -1}}\n",
               "material 'm' violates energy conservation"},
           Bad{"  m: {scatter: {model: harvey, b0: 1 /sr, tis: 1 %, l: 0.5, s: -1}}\n", "keep one of them"},
           Bad{"  m: {scatter: {model: harvy, l: 0.5}}\n", "did you mean 'harvey'?"},
           Bad{"  m: {scatter: {model: polynomial, diffuse: [[1e-3 /sr, 0 /sr], [1e-3 /sr, 0 /sr]]}}\n",
               "not reciprocal"},
           Bad{"  m: {scatter: {model: polynomial, diffuse: [[1e-3 /sr, -1e-2 /sr], [-1e-2 /sr, 0 /sr]]}}\n",
               "negative"},
           Bad{"  m: {scatter: {model: k-correlation, rms: 900 nm, b: 1 mm, c: 2}}\n", "too rough"},
           Bad{"  m: {scatter: {model: dust, level: 3000, reflectance: 1}}\n", "'level'"},
           Bad{"  m: {scatter: [{model: dust, diameter: 2 um, coverage: 1 %, reflectance: 1}, {model: lambertian, "
               "tis: 0.1 %}]}\n",
               "material 'm' violates energy conservation"},
           Bad{"  m: {scatter: {model: defects, coverage: 1 ppm, diameter: 1 um}}\n", "do not block light"},
           Bad{"  m: {scatter: {model: lambertian, tis: 1 %, weight: [[60 deg, 1], [30 deg, 2]]}}\n",
               "do not increase"},
           Bad{"  m: {preset: oxidized_steel}\n", "did you mean 'oxidised_steel'?"},
           Bad{"  m: {preset: oxidised_steel, bracket: [1e-2 /sr, 3e-3 /sr, 1e-3 /sr]}\n", "in this order"},
           Bad{"  m: {preset: oxidised_steel, uncertainty: 30}\n", "did you mean '30 %' or 'factor 30'?"},
           Bad{"  m: {scatter: {model: lambertian, tis: 1 %, uncertainty: 130 %}}\n", "write 'factor 2.3'"},
           Bad{"  m: {scatter: {model: lambertian, tis: 1 %}, uncertainty: factor 0.5}\n", "must be at least 1"},
       }) {
    write_text(folder / "a.yaml", scene_with(bad.materials));
    Finished const r = straytrace({"inspect", "m", folder / "a.yaml"});
    EXPECT_EQ(r.code, 2) << bad.materials;
    EXPECT_THAT(r.err, HasSubstr(bad.message)) << bad.materials;
    EXPECT_EQ(r.out, "");
  }
  EXPECT_THAT(straytrace({"inspect", "oxydised_steel"}).err, HasSubstr("did you mean 'oxidised_steel'?"));
  EXPECT_THAT(straytrace({"inspect", "test_mas", virgo_arm}).err, HasSubstr("did you mean 'test_mass'?"));
  EXPECT_THAT(straytrace({"inspect", "x", "--plot", folder / "none/a.png"}).err, HasSubstr("there is no folder"));
}

// Missing CAD, mesh and data files: the nearest name of their folder. Control: a name that nothing is near to.
TEST(Inspect, MissingFilesNameTheNearest) {
  Folder const folder;
  std::string const data = source_folder + "/examples/data/";
  for (auto const& [wrong, right] : {std::pair("cad_bnch.step", "cad_bench.step"), {"dump_bsd.csv", "dump_bsdf.csv"}})
    EXPECT_THAT(straytrace({"inspect", data + wrong}).err, HasSubstr("did you mean '" + data + right + "'?"));
  EXPECT_THAT(straytrace({"inspect", folder / "none.obj"}).err, HasSubstr("\n  check the name and the folder"));
  fs::create_directory(folder / "cad");
  fs::copy_file(source_folder + "/examples/holder.obj", folder / "cad/holder.obj");
  std::string const head = "straytrace: 1\nscene:\n  - {name: holder, body: b, units: mm, material: m, file: ";
  write_text(folder / "a.yaml", head + "cad/holdr.obj}\n");
  EXPECT_THAT(straytrace({"check", folder / "a.yaml"}).err,
              HasSubstr("did you mean 'cad/holder.obj'? names are relative to the file that contains them"));
  write_text(folder / "a.yaml", head + "cad/lens.step}\n");
  Finished const far = straytrace({"check", folder / "a.yaml"});
  EXPECT_THAT(far.err, HasSubstr("names are relative to the file that contains them"));
  EXPECT_THAT(far.err, Not(HasSubstr("did you mean 'cad/")));
}

// A picture needs an ending that tells its format. Control: motion can be written as CSV.
TEST(Inspect, PicturesNeedAKnownEnding) {
  Folder const folder;
  std::string const examples = source_folder + "/examples/";
  for (std::string const& what : {std::string("black_anodise"), examples + "data/cad_bench.step",
                                  examples + "data/dump_bsdf.csv", examples + "storm.yaml"}) {
    Finished const r = straytrace({"inspect", what, "--plot", folder / "dump"});
    EXPECT_EQ(r.code, 2) << what;
    EXPECT_THAT(r.err, HasSubstr("dump' does not have a known ending\n  end it with ")) << what;
    EXPECT_EQ(r.out, "");
    EXPECT_FALSE(fs::exists(folder / "dump")) << what;
  }
  Finished const curves = straytrace({"inspect", examples + "storm.yaml", "--plot", folder / "motion.csv"});
  EXPECT_EQ(curves.code, 0) << curves.err;
  EXPECT_TRUE(fs::exists(folder / "motion.csv"));
}

// What check finds wrong with a model; control: a list of materials alone.
TEST(Inspect, ModelsAreCheckedWhole) {
  Folder const folder;
  std::string const material = "straytrace: 1\nmaterials: {m: {scatter: {model: lambertian, tis: 1 %}}}\n";
  for (std::string const wrong :
       {"scene: []\n", "interferometer: {preset: fabry-perot-michelson, arm_length: 3 kg}\n"}) {
    write_text(folder / "a.yaml", material + wrong);
    Finished const shown = straytrace({"inspect", "m", folder / "a.yaml"});
    EXPECT_EQ(shown.code, 2) << wrong;
    EXPECT_EQ(shown.out + shown.err, straytrace({"check", folder / "a.yaml"}).err);
  }
  write_text(folder / "a.yaml", material);
  EXPECT_EQ(straytrace({"inspect", "m", folder / "a.yaml"}).code, 0);
}

// Clear grains on a perfect mirror scatter all light at grazing: the error of their quadrature must not create light.
TEST(Inspect, DustOnAPerfectMirrorCreatesNoLight) {
  Folder const folder;
  for (std::string const size : {"level: 500", "diameter: 2 um, coverage: 1 %", "diameter: 20 um, coverage: 10 ppm"}) {
    write_text(folder / "a.yaml", scene_with("  m: {scatter: {model: dust, reflectance: 1, " + size + "}}\n"));
    Finished const r = straytrace({"inspect", "m", folder / "a.yaml"});
    EXPECT_EQ(r.code, 0) << size << r.err;
  }
}

}  // namespace
}  // namespace straytrace::testing
