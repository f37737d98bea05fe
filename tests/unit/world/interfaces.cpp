// SPDX-License-Identifier: BSD-3-Clause
// `specular` and `media` of a scene: what is read, and the errors with their reasons (8.1, C2.6).
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "base/every_module.hpp"
#include "optics/coating/specular.hpp"
#include "scene/scene.hpp"
#include "world/build/read_parts.hpp"

namespace straytrace::world_interfaces {
namespace {

struct Built {
  World world;
  Registry names;
  std::string problems;  // empty: none
  Optic const& optic(std::string const& name) const { return world.view().optics[names.materials.at(name)]; }
  Amplitudes amplitudes(std::string const& name, double cos_i, double n_in = 1, double n_out = 1) const {
    return specular_amplitudes(world.view().interfaces, optic(name), cos_i, n_in, n_out, true);
  }
};

// `text`: the top-level tables materials and media, and beams when they matter.
Built built(std::string const& text, FileTexts files = {}) {
  files["a.yaml"] = "straytrace: 1\n" + text;
  Scene const scene = read_scene("a.yaml", {}, &files);
  Built b;
  read_media(scene, b.world, b.names);
  read_materials(scene, b.world, b.names);
  try {
    scene.throw_if_problems();
  } catch (InputError const& e) {
    b.problems = e.what();
  }
  return b;
}
Built material(std::string const& text, std::string const& more = "", FileTexts const& files = {}) {
  return built(more + "materials: {m: {" + text + "}}\n", files);
}
::testing::AssertionResult rejected(Built const& b, std::string const& words) {
  if (b.problems.find(words) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "'" << words << "' is not in: " << b.problems;
}

TEST(WorldInterfaces, FixedShares) {
  Built const b = material("specular: {reflect: 30 %, transmit: 69 %}");
  EXPECT_EQ(b.problems, "");
  EXPECT_EQ(b.optic("m").reflect, 0.3);
  EXPECT_EQ(b.optic("m").transmit, 0.69);
  EXPECT_NEAR(b.amplitudes("m", 0.4).transmittance(), 0.69, 1e-15);
}

TEST(WorldInterfaces, WordsAndIndices) {
  Built const b = built(
      "materials:\n  glass: {specular: fresnel}\n  dump: {specular: absorber}\n  sic: {specular: {index: "
      "silicon_carbide}}\n  metal: {specular: {index: 0.25, extinction: 7}}\n");
  EXPECT_EQ(b.problems, "");
  EXPECT_NEAR(b.amplitudes("glass", 1, 1, 1.45003).reflectance(), 0.033740, 1e-6);
  EXPECT_EQ(b.amplitudes("dump", 1).reflectance(), 0);
  EXPECT_NEAR(b.amplitudes("sic", 1).reflectance(), 0.19526, 1e-5);
  EXPECT_NEAR(b.amplitudes("metal", 1).reflectance(), (0.5625 + 49) / (1.5625 + 49), 1e-14);
}

// (HL)^5 H on 1.45 in blocks; MgF2 on a body; at the wavelength of the beams; thickness in nm; a table between media.
TEST(WorldInterfaces, Films) {
  std::string const hr =
      "specular: {film: {layers: [[2.07, quarter], {repeat: 5, layers: [[1.45, quarter], [2.07, "
      "quarter]]}]}}";
  EXPECT_NEAR(1 - material(hr).amplitudes("m", 1, 1, 1.45).reflectance(), 3.777e-2, 5e-6);
  std::string const beams = "beams: {b: {wavelength: 1550 nm}}\n";
  EXPECT_NEAR(1 - material(hr, beams).amplitudes("m", 1, 1, 1.45).reflectance(), 3.777e-2, 5e-6);
  std::string detuned = hr;
  detuned.insert(detuned.find("layers"), "design: 1064 nm, ");
  EXPECT_GT(1 - material(detuned, beams).amplitudes("m", 1, 1, 1.45).reflectance(), 0.1);
  EXPECT_NEAR(material("specular: {index: 1.52, film: {layers: [[1.38, quarter]]}}").amplitudes("m", 1).reflectance(),
              0.012601, 5e-7);
  EXPECT_NEAR(
      material("specular: {index: 1.52, film: {layers: [[1.38, 192.7536 nm]]}}").amplitudes("m", 1).reflectance(),
      0.012601, 5e-7);
  Built const table = material("specular: {film: {between: [vacuum, fused_silica], layers: [[2.07, quarter, 1e-5]]}}");
  EXPECT_EQ(table.problems, "");
  double const n = table.world.view().interfaces.visit(table.optic("m").interface, [](auto const& i) {
    if constexpr (std::is_same_v<std::decay_t<decltype(i)>, Film>) {
      EXPECT_GT(i.passing.size, 4u);
      return i.back_index;
    }
    return 0.0;
  });
  EXPECT_NEAR(n, 1.44963, 1e-5);
}

TEST(WorldInterfaces, CoatingTables) {
  Built const inline_table = material(
      "specular: {coating: {angle: [0 deg, 45 deg, 90 deg], reflect_s: [1 %, 4 %, 1], reflect_p: [1 %, 5e-3, "
      "1], transmit: [0.9, 0.9, 0]}}");
  EXPECT_EQ(inline_table.problems, "");
  EXPECT_NEAR(norm(inline_table.amplitudes("m", std::sqrt(0.5)).rs), 0.04, 1e-12);
  EXPECT_NEAR(norm(inline_table.amplitudes("m", std::sqrt(0.5)).rp), 0.005, 1e-12);
  EXPECT_EQ(inline_table.optic("m").laws, 0);
  FileTexts const files{
      {"ar.csv", "# measured\nangle [deg], reflect [%], absorb [%]\n8, 0.5, 60\n60, 1, 60\n90, 100, 0\n"}};
  Built const file = material("specular: {coating: {file: ar.csv, source: me}}", "", files);
  EXPECT_EQ(file.problems, "");
  EXPECT_NEAR(file.amplitudes("m", 1).reflectance(), 0.005, 1e-12);  // held below 8 deg
  ASSERT_EQ(file.optic("m").laws, 1);                                // Lambertian unless a law is given
  EXPECT_NEAR(scatter_albedo(file.world.view().laws, file.optic("m"), 1), 0.395, 1e-6);
}

// R3.24: a table in angle and wavelength. The wavelength of the beams picks, linear between two of the table; the
// control takes the nearest one. Other angles at each wavelength; a unit other than nm.
TEST(WorldInterfaces, CoatingTablesInWavelength) {
  std::string const table =
      "specular: {coating: {wavelength: [1000 nm, 1000 nm, 1.2 um, 1.2 um, 1.2 um], angle: [0 deg, 90 deg, 0 deg, 60 "
      "deg, 90 deg], reflect: [1 %, 1, 3 %, 20 %, 1], transmit: [0.9, 0, 0.5, 0.4, 0]}}";
  auto const at = [&](std::string const& wavelength) {
    return material(table, "beams: {b: {wavelength: " + wavelength + "}}\n");
  };
  EXPECT_EQ(at("1000 nm").problems, "");
  EXPECT_NEAR(at("1 um").amplitudes("m", 1).reflectance(), 0.01, 1e-12);
  EXPECT_NEAR(at("1200 nm").amplitudes("m", 1).transmittance(), 0.5, 1e-12);
  Built const between = at("1050 nm");
  EXPECT_NEAR(between.amplitudes("m", 1).reflectance(), 0.015, 1e-9);
  EXPECT_NEAR(between.amplitudes("m", 1).transmittance(), 0.8, 1e-9);
  EXPECT_GT(std::fabs(at("1000 nm").amplitudes("m", 1).reflectance() - 0.015), 1e-9);
  double const sixty = at("1000 nm").amplitudes("m", 0.5).reflectance();
  EXPECT_NEAR(between.amplitudes("m", 0.5).reflectance(), 0.75 * sixty + 0.25 * 0.2, 1e-9);
  for (int i = 0; i <= 100; ++i) {  // mixing makes no light
    Amplitudes const a = between.amplitudes("m", i / 100.0);
    EXPECT_LE(a.reflectance() + a.transmittance(), 1 + 1e-12);
  }
  EXPECT_TRUE(rejected(at("1550 nm"), "the table covers 1000 to 1200 nm"));
  FileTexts const files{{"c.csv",
                         "wavelength [nm], angle [deg], reflect [%]\n532, 0, 50\n532, 90, 100\n1064, 0, 10\n"
                         "1064, 90, 100\n"},
                        {"d.csv",
                         "wavelength [nm], angle [deg], reflect [%]\n532, 0, 50\n532, 90, 110\n1064, 0, 10\n"
                         "1064, 90, 100\n"},
                        {"e.csv", "wavelength, angle [deg], reflect [%]\n532, 0, 50\n532, 90, 100\n"},
                        {"f.csv",
                         "wavelength [nm], angle [deg], reflect [%]\n532, 0, 50\n532, 90, 100\n1064, 0, 10\n"
                         "1064, 80, 100\n"}};
  auto const of_file = [&](std::string const& name) {
    return material("specular: {coating: {file: " + name + "}}", "", files);
  };
  EXPECT_NEAR(of_file("c.csv").amplitudes("m", 1).reflectance(), 0.1, 1e-12);
  EXPECT_TRUE(rejected(of_file("d.csv"), "d.csv:3"));  // a wavelength that is not used is checked as well
  EXPECT_TRUE(rejected(of_file("e.csv"), "wavelength [nm]"));
  EXPECT_TRUE(rejected(of_file("f.csv"), "to 80 deg at 1064 nm"));
}

TEST(WorldInterfaces, MicrofacetLaw) {
  Built const b = material("scatter: {model: microfacet, roughness: 0.3, reflectance: 50 %}");
  EXPECT_EQ(b.problems, "");
  EXPECT_NEAR(scatter_albedo(b.world.view().laws, b.optic("m"), 1), 0.5 * 0.877358, 1e-4);
  EXPECT_TRUE(rejected(material("scatter: {model: microfacet, roughness: 0.3}"), "reflectance"));
  EXPECT_TRUE(rejected(material("scatter: {model: microfacet, roughness: 1.3, reflectance: 50 %}"), "roughness"));
  EXPECT_TRUE(
      rejected(material("specular: {reflect: 60 %}, scatter: {model: microfacet, roughness: 0.3, reflectance: 50 %}"),
               "violates energy conservation"));
}

TEST(WorldInterfaces, GroovesLaw) {
  std::string const good = "model: grooves, across: 0.3, along: 0.03, reflectance: 50 %";
  Built const b = material("scatter: {" + good + ", lay: around}");
  EXPECT_EQ(b.problems, "");
  EXPECT_EQ(b.optic("m").lay, Lay::around);
  EXPECT_EQ(material("scatter: {" + good + ", lay: [0, 2, 0]}").optic("m").lay_direction.y, 1);
  EXPECT_TRUE(rejected(material("scatter: {" + good + "}"), "lay: around"));
  EXPECT_TRUE(rejected(material("scatter: {" + good + ", lay: arround}"), "did you mean"));
  EXPECT_TRUE(rejected(material("scatter: {" + good + ", lay: along, through: yes}"), "does not take 'through'"));
  EXPECT_TRUE(rejected(material("scatter: {model: grooves, across: 0.1, along: 0.2, reflectance: 0.5, lay: along}"),
                       "'along' is larger than 'across'"));
  EXPECT_TRUE(
      rejected(material("scatter: [{" + good + ", lay: around}, {" + good + ", lay: along}]"), "have one direction"));
  EXPECT_TRUE(rejected(material("specular: {reflect: 60 %}, scatter: {" + good + ", lay: along}"),
                       "violates energy conservation"));
}

TEST(WorldInterfaces, SteelPreset) {
  Built const b = material("specular: {coating: tube_steel}");
  EXPECT_EQ(b.problems, "");
  WorldView const v = b.world.view();
  for (double degrees : {0.0, 45.0, 70.0, 80.0, 86.5, 89.977, 89.999}) {
    double const cosine = std::cos(degrees * pi / 180), s = scatter_albedo(v.laws, b.optic("m"), cosine);
    SpecularShares const share = specular_shares(v.interfaces, b.optic("m"), cosine, 1, 1, true, s);
    EXPECT_LE(share.reflect + s, 1 + 1e-12) << degrees;
    EXPECT_NEAR(s, prescribed_scatter(v.interfaces, b.optic("m"), cosine), 2e-3) << degrees;
  }
  Built const lobe = material("specular: {coating: tube_steel}, scatter: {model: lambertian, tis: 3 %}");
  EXPECT_EQ(lobe.problems, "");
  EXPECT_NEAR(scatter_albedo(lobe.world.view().laws, lobe.optic("m"), 1), 0.395, 1e-6);
}

// requirements 8.1: entries of the original whose shares exceed 1 are errors, the others are read.
TEST(WorldInterfaces, MaterialsOfTheOriginal) {
  struct Entry {
    std::string reflect, transmit, scatter;
    bool accepted;
  };
  for (Entry const& e : {Entry{"1", "0", "1e-6", false},        // Mirror
                         Entry{"1 - 1e-6", "0", "1e-6", true},  // what it should be
                         Entry{"0.5", "1", "5e-4", false},      // NBK7
                         Entry{"0.5", "0.5", "0", true},        // BeamSplitter
                         Entry{"0.95", "0", "0.05", true},      // Tube
                         Entry{"0.71", "0", "0.247", true},     // Aluminium
                         Entry{"0.999996", "4e-6", "0", true},  // end mirror
                         Entry{"0.5", "0", "0.6", false}}) {    // steel at 87 deg with the offset: 1.0 and more
    Built const b = material("specular: {reflect: " + e.reflect + ", transmit: " + e.transmit +
                             "}, scatter: {model: lambertian, tis: " + e.scatter + "}");
    if (e.accepted)
      EXPECT_EQ(b.problems, "") << e.reflect;
    else
      EXPECT_TRUE(rejected(b, "violates energy conservation")) << e.reflect;
  }
}

TEST(WorldInterfaces, Media) {
  Built const b = built(
      "media:\n  a: {index: 1.5, absorption: 0.5 ppm/cm}\n  b: {preset: fused_silica, absorption: 1e-3 /m, source: x}\n"
      "beams: {arm: {wavelength: 1550 nm}}\n");
  EXPECT_EQ(b.problems, "");
  EXPECT_EQ(b.names.media.at("a").index, 1.5);
  EXPECT_NEAR(b.names.media.at("a").absorption, 5e-5, 1e-18);
  EXPECT_NEAR(b.names.media.at("b").index, 1.4440, 1e-4);
  EXPECT_EQ(b.names.media.at("b").absorption, 1e-3);
}

TEST(WorldInterfaces, Errors) {
  EXPECT_TRUE(rejected(material("specular: fresnell"), "interface 'fresnell' is not defined"));
  EXPECT_TRUE(rejected(material("specular: {reflect: 1 %, index: 1.5}"), "two descriptions"));
  EXPECT_TRUE(rejected(material("specular: {reflekt: 1 %}"), "reflekt"));
  EXPECT_TRUE(rejected(material("specular: {extinction: 2}"), "'extinction' needs 'index'"));
  EXPECT_TRUE(rejected(material("specular: {index: fused_silca}"), "fused_silca"));
  EXPECT_TRUE(rejected(material("specular: {film: {layers: [[1.38]]}}"), "a layer is a list"));
  EXPECT_TRUE(rejected(material("specular: {film: {}}"), "needs its layers"));
  EXPECT_TRUE(rejected(material("specular: {film: {layers: [[1.38, 200]]}}"), "is a length"));
  EXPECT_TRUE(rejected(material("specular: {coating: tube_stel}"), "did you mean 'tube_steel'"));
  std::string const angles = "specular: {coating: {angle: [0 deg, 60 deg, 90 deg], ";
  EXPECT_TRUE(rejected(material(angles + "reflect: [0.5, 0.5, 1], transmit: [0.4, 0.6, 0]}}"),
                       "the coating violates energy conservation"));
  EXPECT_TRUE(rejected(material(angles + "reflect_s: [0.5, 0.5, 1]}}"), "one polarisation only"));
  EXPECT_TRUE(rejected(material(angles + "reflect: [0.5, 1]}}"), "needs 3 values"));
  EXPECT_TRUE(rejected(material("specular: {coating: {angle: [0 deg, 80 deg], reflect: [0, 1]}}"), "end at 90 deg"));
  EXPECT_TRUE(rejected(material("specular: {coating: {angle: [0 deg, 95 deg, 90 deg], reflect: [0, 1, 1]}}"),
                       "does not come after"));
  FileTexts const files{{"x.csv", "angle [deg], reflect\n0, 0.5\n60; 1\n90, 1\n"}, {"y.csv", "angle, reflect\n0, 1\n"}};
  EXPECT_TRUE(rejected(material("specular: {coating: {file: x.csv}}", "", files), "x.csv:3"));
  FileTexts const both{{"z.csv", "angle, reflekt\n0, half\n90, 1\n"}};
  for (char const* says : {"z.csv:1:1: error: column 'angle' is an angle and needs its unit",
                           "z.csv:1:8: error: unknown column 'reflekt'", "z.csv:2:4: error: 'half' is not a number"})
    EXPECT_TRUE(rejected(material("specular: {coating: {file: z.csv}}", "", both), says));
  EXPECT_TRUE(rejected(material("specular: {coating: {file: y.csv}}", "", files), "needs its unit"));
  FileTexts const watts{{"w.csv", "angle [deg], reflect [W]\n0, 1\n90, 1\n"}};
  EXPECT_TRUE(rejected(material("specular: {coating: {file: w.csv}}", "", watts),
                       "w.csv:1:14: error: column 'reflect' is a plain number, its unit is a power"));
  EXPECT_TRUE(rejected(material("specular: {coating: tube_steel}, scatter: [{model: lambertian, tis: 1 %}, {model: "
                                "lambertian, tis: 1 %}]"),
                       "states the total scatter"));
  EXPECT_TRUE(rejected(built("media: {a: {index: 1.5, preset: bk7}}\n"), "both set the index"));
  EXPECT_TRUE(rejected(built("media: {a: {preset: silicon}}\n"), "known from 1360 nm"));
  EXPECT_TRUE(rejected(built("media: {a: {preset: fused_silca}}\n"), "did you mean 'fused_silica'"));
}

TEST(WorldInterfaces, Gratings) {
  std::string const orders = "orders: [{order: 0, reflect: 5 %, transmit: 1 %}, {order: -1, reflect: 90 %}]";
  Built const b = material("specular: {grating: {density: 600 /mm, grooves: [0, 2, 0], " + orders + "}}");
  EXPECT_EQ(b.problems, "");
  EXPECT_TRUE(b.optic("m").diffracts);
  SpecularShares const s = specular_shares(b.world.view().interfaces, b.optic("m"), 0.5, 1, 1, true);
  EXPECT_NEAR(s.reflect, 0.95, 1e-15);
  EXPECT_NEAR(s.transmit, 0.01, 1e-15);
  EXPECT_NEAR(b.amplitudes("m", 0.5).reflectance(), 0.05, 1e-15);
  auto const wrong = [&](std::string const& keys) { return material("specular: {grating: {" + keys + "}}"); };
  std::string const lines = "density: 600 /mm, grooves: around, ";
  EXPECT_TRUE(
      rejected(wrong("grooves: around, " + orders), "a.yaml:2:37: error: a grating needs 'density' or 'period'"));
  EXPECT_TRUE(rejected(wrong("density: 600 /mm, period: 1 um, grooves: around, " + orders), "both set the distance"));
  EXPECT_TRUE(rejected(wrong("density: 600 /mm, " + orders), "'grooves' (their direction) is missing"));
  EXPECT_TRUE(rejected(wrong("density: 600 /mm, grooves: along, " + orders), "along"));
  EXPECT_TRUE(rejected(wrong(lines), "needs the efficiencies of its orders"));
  EXPECT_TRUE(rejected(wrong(lines + "orders: [{order: 0.5, reflect: 1 %}]"), "order 0.5 is not a whole number"));
  EXPECT_TRUE(
      rejected(wrong(lines + "orders: [{order: 1, reflect: 1 %}, {order: 1, transmit: 1 %}]"), "is there twice"));
  EXPECT_TRUE(rejected(wrong(lines + "orders: [{order: 0, reflect: 60 %}, {order: 1, transmit: 50 %}]"),
                       "its orders carry 1.1 of the light"));
  EXPECT_TRUE(
      rejected(material("specular: {grating: {" + lines + orders + "}}, scatter: {model: lambertian, tis: 5 %}"),
               "violates energy conservation"));
  EXPECT_TRUE(rejected(material("specular: {grating: {" + lines + orders + "}, reflect: 1 %}"), "two descriptions"));
}

TEST(WorldInterfaces, RoughInterfaces) {
  std::string const film = "specular: {film: {layers: [[2.07, quarter], [1.45, quarter]]BETWEEN}}, ";
  auto const with = [&](std::string const& keys, std::string const& between = ", between: [vacuum, fused_silica]") {
    std::string text = film;
    text.replace(text.find("BETWEEN"), 7, between);
    return material(text + "scatter: {model: k-correlation, rms: 0.2 nm, b: 10 um, c: 2, " + keys + "}");
  };
  for (char const* how : {"interfaces: correlated", "interfaces: uncorrelated", "interfaces: 0.3"})
    EXPECT_EQ(with(how).problems, "");
  EXPECT_EQ(with("interfaces: correlated, substrate: fused_silica", "").problems, "");
  EXPECT_TRUE(rejected(with("interfaces: correlated", ""), "the body behind the film is not known here"));
  EXPECT_TRUE(rejected(with("interfaces: 1.5"), "1.5"));
  EXPECT_TRUE(rejected(with("interfaces: correlated, index: 1.5"), "both give the factor Q"));
  EXPECT_TRUE(rejected(with("interfaces: correlated, theory: harvey-shack"), "is of first order"));
  EXPECT_TRUE(rejected(with("substrate: 1.45"), "'substrate' needs 'interfaces'"));
  EXPECT_TRUE(rejected(material("scatter: {model: k-correlation, rms: 0.2 nm, b: 10 um, c: 2, interfaces: correlated}"),
                       "needs the layers of the coating"));
}

}  // namespace
}  // namespace straytrace::world_interfaces
