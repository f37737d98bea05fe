// SPDX-License-Identifier: BSD-3-Clause
// straytrace inspect of files of measured scatter, and such files in scenes.
#include <nlohmann/json.hpp>

#include <cmath>

#include "scenes/program.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;

std::string const dump = source_folder + "/examples/data/dump_bsdf.csv";

TEST(InspectScatter, AuditFitsAndJson) {
  Finished const text = straytrace({"inspect", dump});
  ASSERT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("polarisation in: s, out: both; noise floor: 2e-06 /sr"));
  EXPECT_THAT(text.out, HasSubstr("look: 42 of 163 points at or below it: upper limits"));
  EXPECT_THAT(text.out, HasSubstr("  scatter: {model: harvey, b0: "));
  auto const data = nlohmann::json::parse(straytrace({"inspect", dump, "--format", "json"}).out);
  EXPECT_EQ(data["points"].size(), 163u);
  EXPECT_EQ(data["audit"]["limits"], 42);
  // The points were made with l = 0.01 and s = -2.3. Control: s = -2.4.
  for (auto const& fit : data["fits"])
    if (fit["model"] == "harvey") {
      double const s = fit["parameters"][2]["value"], error = fit["parameters"][2]["error"];
      EXPECT_NEAR(s, -2.3, 5 * error);
      EXPECT_GT(std::fabs(s + 2.4), 5 * error);
    }
}

// The audit states what it checked of the angles. Control: a scan that turns back and repeats a direction.
TEST(InspectScatter, TheOrderOfAnglesIsStated) {
  EXPECT_THAT(
      straytrace({"inspect", dump}).out,
      HasSubstr("angles        ok: theta_s runs one way at each incidence; each direction was measured once\n"));
  Folder const folder;
  std::string rows =
      "# wavelength: 532 nm\n# angles: from_normal\n# noise_floor: none\ntheta_i [deg], theta_s [deg], brdf [1/sr]\n";
  for (int t : {10, 20, 30, 40, 30, 50, 60, 70, 80}) rows += "0, " + std::to_string(t) + ", 0.1\n";
  write_text(folder / "back.csv", rows);
  EXPECT_THAT(straytrace({"inspect", folder / "back.csv"}).out,
              HasSubstr("angles        look: theta_s turns back 2 times; 1 direction was measured twice\n"));
}

// The printed line can be pasted: its model has the total of the fit.
TEST(InspectScatter, FitsCanBePasted) {
  Folder const folder;
  auto const data = nlohmann::json::parse(straytrace({"inspect", dump, "--format", "json"}).out);
  for (auto const& fit : data["fits"]) {
    write_text(folder / "a.yaml",
               "straytrace: 1\nmaterials:\n  m:\n    scatter: " + fit["yaml"].get<std::string>() + "\n");
    Finished const r = straytrace({"inspect", "m", folder / "a.yaml", "--format", "json"});
    ASSERT_EQ(r.code, 0) << r.err;
    double const tis = nlohmann::json::parse(r.out)["tis"][0]["scattered"];
    EXPECT_NEAR(tis / fit["tis"].get<double>(), 1, 0.01) << fit["model"];
  }
}

TEST(InspectScatter, PictureAndConversion) {
  Folder const folder;
  Finished const r =
      straytrace({"inspect", dump, "--plot", folder / "dump.png", "--write", folder / "dump.ssdd"}, {".", true});
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(text_of(folder / "dump.png").substr(1, 3), "PNG");
  EXPECT_FALSE(fs::exists(folder / "dump.png.json"));
  Finished const back = straytrace({"inspect", folder / "dump.ssdd"});
  EXPECT_EQ(back.code, 0) << back.err;
  EXPECT_THAT(back.out, HasSubstr("SSDD, reflected, 1064 nm\n  polarisation in: s, out: both; noise floor: 2e-06 /sr"));
  EXPECT_THAT(back.out, HasSubstr("at or below it: upper limits"));
  Finished const bad = straytrace({"inspect", dump, "--write", folder / "dump.txt"});
  EXPECT_EQ(bad.code, 2);
  EXPECT_THAT(bad.err, HasSubstr("is not an SSDD file"));
}

Finished scene_with(Folder const& folder, std::string const& law) {
  write_text(folder / "a.yaml",
             "straytrace: 1\nmaterials:\n  m: {scatter: {model: table, beyond: constant, " + law + "}}\n");
  return straytrace({"inspect", "m", folder / "a.yaml"});
}

TEST(InspectScatter, AnyFormatInAScene) {
  Folder const folder;
  write_text(folder / "dump.bsdf", text_of(dump));  // the content decides, not the name
  Finished const csv = scene_with(folder, "file: dump.bsdf");
  EXPECT_EQ(csv.code, 0) << csv.err;
  EXPECT_THAT(csv.out, HasSubstr("wavelength: 1064 nm"));
  EXPECT_THAT(csv.err, HasSubstr("42 of 163 points are upper limits at the noise floor of 2e-06 /sr"));
  write_text(folder / "paint.abg",
             "NAME paint\nWAVE 1.064\n0 1e-3 0.01 2\n60 1e-3 0.01 2\nNAME rust\nWAVE 1.064\n0 0.1 1 0\n");
  Finished const abg = scene_with(folder, "file: paint.abg, entry: paint");
  EXPECT_EQ(abg.code, 0) << abg.err;
  auto const total = [&](std::string const& entry) {
    scene_with(folder, "file: paint.abg, entry: " + entry);
    auto const r = straytrace({"inspect", "m", folder / "a.yaml", "--format", "json"});
    return nlohmann::json::parse(r.out)["tis"][0]["scattered"].get<double>();
  };
  double const expected = 3.14159265 * 1e-3 * std::log(101);  // eq. 3.17: pi A ln(1 + 1/B)
  EXPECT_NEAR(total("paint") / expected, 1, 1e-3);
  EXPECT_GT(std::fabs(total("rust") / expected - 1), 1);  // negative control
  write_text(folder / "rgl.bsdf", std::string("tensor_file\0\1\0", 14));
  EXPECT_THAT(scene_with(folder, "file: rgl.bsdf").err, HasSubstr("rgl.bsdf: error: this is an RGL binary BSDF"));
}

// At 532 nm in a scene of 1064 nm: a warning with the factor, (532/1064)^4 = 1/16; scaled only on request.
TEST(InspectScatter, OtherWavelength) {
  Folder const folder;
  std::string rows =
      "# wavelength: 532 nm\n# angles: from_normal\n# noise_floor: none\ntheta_i [deg], theta_s [deg], brdf [1/sr]\n";
  for (int t = 1; t < 89; ++t) rows += "0, " + std::to_string(t) + ", 0.1\n";
  write_text(folder / "green.csv", rows);
  Finished const plain = scene_with(folder, "file: green.csv");
  EXPECT_EQ(plain.code, 0) << plain.err;
  EXPECT_THAT(plain.err, HasSubstr("was measured at 532 nm, the scene is at 1064 nm; nothing is scaled"));
  EXPECT_THAT(plain.err, HasSubstr("0.0625 times as much at 2 times the offset"));
  EXPECT_THAT(plain.out, HasSubstr("3.1416e-01"));
  Finished const scaled = scene_with(folder, "file: green.csv, scaling: smooth");
  EXPECT_EQ(scaled.code, 0) << scaled.err;
  EXPECT_THAT(scaled.out, HasSubstr("1.9635e-02"));  // pi 0.1/16
  EXPECT_THAT(scene_with(folder, "file: green.csv, wavelength: 633 nm").err,
              HasSubstr("declares wavelength 532 nm, but 633 nm"));
}

// A BSDF of 0.1 /sr has a total of 0.1 pi. A file that states 0.5 gives a warning; one that states 0.314 does not.
TEST(InspectScatter, StatedTotals) {
  Folder const folder;
  for (std::string const stated : {"0.314", "0.5"}) {
    std::string text =
        "# wavelength: 1064 nm\nSource Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\nScatterType "
        "BRDF\n"
        "SampleRotation 1\n0\nAngleOfIncidence 1\n0\nScatterAzimuth 2\n0 180\nScatterRadial 10\n"
        "0 10 20 30 40 50 60 70 80 90\nMonochrome\nDataBegin\nTIS " +
        stated + "\n";
    for (int i = 0; i < 20; ++i) text += "0.1 ";
    write_text(folder / "a.bsdf", text + "\nDataEnd\n");
    bool const wrong = stated == "0.5";
    Finished const scene = scene_with(folder, "file: a.bsdf");
    EXPECT_EQ(scene.code, 0) << scene.err;
    EXPECT_EQ(scene.err.find("states a total of 0.5 at 0 deg, its own values integrate to 0.31") != std::string::npos,
              wrong)
        << scene.err;
    Finished const audit = straytrace({"inspect", folder / "a.bsdf"});
    EXPECT_THAT(audit.out, HasSubstr("Zemax tabular BSDF, reflected, 1064 nm"));
    EXPECT_EQ(audit.out.find("stated TIS    look: 0.5 at 0 deg") != std::string::npos, wrong) << audit.out;
  }
}

TEST(InspectScatter, MistakesInScenes) {
  Folder const folder;
  std::string bright = "# wavelength: 1064 nm\n# angles: from_normal\ntheta_i [deg], theta_s [deg], brdf [1/sr]\n";
  for (int t = 1; t < 89; ++t) bright += "0, " + std::to_string(t) + ", 0.5\n";
  write_text(folder / "bright.csv", bright);
  EXPECT_THAT(scene_with(folder, "file: bright.csv").err, HasSubstr("violates energy conservation"));
  write_text(folder / "bare.csv", bright.substr(bright.find("theta_i")));
  Finished const bare = scene_with(folder, "file: bare.csv");
  EXPECT_EQ(bare.code, 2);
  EXPECT_THAT(bare.err, HasSubstr("bare.csv: error: the file does not declare wavelength and angles"));
  write_text(
      folder / "through.ssdd",
      "VERSION 0.2\nDATA_TYPE btdf\nCOLOR_MODEL spectrum\nWAVELENGTH_LIST 1064\nPARAM_TYPE "
      "specular_coordinate_system\nPARAM0_LIST 0\nPARAM2_LIST 1 10 60\nPARAM3_LIST 0\nDATA ascii\n1e-2\n1e-3\n1e-4\n");
  EXPECT_THAT(scene_with(folder, "file: through.ssdd").err, HasSubstr("write 'through: yes'"));
  EXPECT_EQ(scene_with(folder, "file: through.ssdd, through: yes").code, 0);
}

}  // namespace
}  // namespace straytrace::testing
