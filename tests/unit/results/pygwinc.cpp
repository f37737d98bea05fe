// SPDX-License-Identifier: BSD-3-Clause
// Detectors and budgets in the layouts of pygwinc (docs/reference/budget.md).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "io/hdf5/read_write.hpp"
#include "noise/fundamental/budget.hpp"
#include "results/pygwinc/pygwinc_ifo.hpp"
#include "results/results.hpp"

namespace straytrace {
namespace {

using ::testing::HasSubstr;

class TemporaryFile {
 public:
  TemporaryFile(std::string const& name, std::string const& content)
      : path_(std::filesystem::temp_directory_path() / (std::to_string(::getpid()) + name)) {
    std::ofstream(path_, std::ios::binary) << content;
  }
  TemporaryFile(TemporaryFile const&) = delete;
  TemporaryFile& operator=(TemporaryFile const&) = delete;
  ~TemporaryFile() { std::filesystem::remove(path_); }
  std::string name() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

std::string complaint(std::string const& yaml, std::vector<std::string> const& overrides = {}) {
  TemporaryFile const file("ifo.yaml", yaml);
  try {
    read_ifo(file.name(), overrides);
  } catch (InputError const& e) {
    return e.what();
  }
  return "";
}

TEST(Ifo, EveryPresetIsWhole) {
  for (std::string const& name : ifo_presets()) {
    IfoFile const ifo = read_ifo(name);
    Detector const& d = ifo.detector;
    EXPECT_GT(d.circulating_power(), 1e4) << name;
    EXPECT_TRUE(d.suspension && d.substrate && d.coating && d.ground && !d.gas.empty()) << name;
    std::span<std::string const> const designs = built_in_designs();
    EXPECT_NE(std::find(designs.begin(), designs.end(), ifo.compare), designs.end()) << name << ": " << ifo.compare;
  }
  EXPECT_THAT(ifo_presets(), ::testing::IsSupersetOf({"adv", "aligo", "kagra", "et-hf", "et-lf", "ce"}));
}

TEST(Ifo, NumbersOfTheTable) {  // docs/theory/sensitivity.md: w from eq. 6.3, arm power from eq. 6.11
  Detector const et = read_ifo("et-hf").detector, adv = read_ifo("adv").detector, lf = read_ifo("et-lf").detector;
  EXPECT_NEAR(et.spots().input, 120.5e-3, 1e-4);
  EXPECT_NEAR(et.circulating_power() / 3.0593e6, 1, 1e-3);
  EXPECT_NEAR(adv.spots().input, 48.65e-3, 1e-5);
  EXPECT_NEAR(adv.spots().end, 58.02e-3, 1e-5);
  EXPECT_NEAR(lf.spots().end, 89.9e-3, 1e-4);
  EXPECT_EQ(read_ifo("ce").detector.mirror_mass, 320);
}

TEST(Ifo, MissingDataAreListedAtOnce) {
  std::string const said = complaint("Infrastructure: {Length: 3000}\nOptics: {Loss: 1e-5}\n");
  for (char const* key :
       {"Laser.Wavelength", "the power of the light", "Optics.ITM.Transmittance", "Optics.ETM.Transmittance",
        "Optics.Curvature.ITM", "Suspension.Stage", "Materials.MassRadius"})
    EXPECT_THAT(said, HasSubstr(key));
  EXPECT_THAT(said, HasSubstr("Nothing was run"));
  EXPECT_THAT(said, ::testing::Not(HasSubstr("Infrastructure.Length")));
}

TEST(Ifo, PlacesAndSuggestions) {
  EXPECT_THAT(complaint("extends: aligo\nLaser:\n  Power: 25 W\n"), HasSubstr("ifo.yaml:3:10: error: 'Laser.Power'"));
  EXPECT_THAT(complaint("extends: aligo\nLaser: {Pwer: 25}\n"), HasSubstr("did you mean 'Laser.Power'?"));
  EXPECT_THAT(complaint("extends: alego\n"), HasSubstr("did you mean 'aligo'?"));
  EXPECT_THAT(complaint("- 1\n"), HasSubstr("not a description of an interferometer"));
  EXPECT_THAT(complaint("a: [1\n"), HasSubstr("this is not YAML"));
  EXPECT_THAT(complaint("extends: aligo\nOptics: {Curvature: {ITM: 100}}\n"), HasSubstr("not stable"));
  EXPECT_THAT(complaint("extends: aligo\nOptics: {ITM: {Transmittance: 1.4}}\n"), HasSubstr("out of range"));
  EXPECT_THAT(complaint("extends: aligo\nLaser: {Power: 25, ArmPower: 1e5}\n"), HasSubstr("both"));
  EXPECT_THAT(complaint("extends: aligo\nMaterials: {Coating: {PETlown: 0.177}}\n"), HasSubstr("photo-elastic"));
  EXPECT_THAT(complaint("extends: aligo\n", {"Laser.Pwer=2"}), HasSubstr("did you mean 'Laser.Power'?"));
  EXPECT_EQ(complaint("extends: aligo\nLaser: {Power: .nan, ArmPower: 1e5}\n"), "");
}

// A flow table splits at the comma; the later key without a value was dropped, and the budget was that of 2 W.
TEST(Ifo, DecimalCommasAreErrors) {
  std::string const flow = complaint("extends: aligo\nLaser: {Power: 2,5}\n");
  EXPECT_THAT(flow, HasSubstr("ifo.yaml:2:16: error: '2,5' has a decimal comma"));
  EXPECT_THAT(flow, HasSubstr("write 2.5"));
  EXPECT_THAT(flow, HasSubstr("1 error."));
  EXPECT_THAT(complaint("extends: aligo\nLaser:\n  Power: 2,5\n"), HasSubstr("'2,5' has a decimal comma"));
  EXPECT_THAT(complaint("extends: aligo\n", {"Laser.Power=2,5"}), HasSubstr("'2,5' has a decimal comma"));
  EXPECT_THAT(complaint("extends: aligo\nLaser: {Power: x,5}\n"), HasSubstr("is a number, got \"x\""));
  EXPECT_THAT(complaint("extends: aligo\nLaser: {Power: 1e-999}\n"), HasSubstr("is a number, got \"1e-999\""));
  EXPECT_EQ(complaint("extends: aligo\nLaser: {Power: 2.5, Wavelength: 1.064e-6}\n"), "");
}

TEST(Ifo, KeysWithoutValuesAndTablesAsValues) {
  EXPECT_THAT(complaint("extends: aligo\nLaser: {Power: 25, Foo: }\n"), HasSubstr("unknown key 'Laser.Foo'"));
  EXPECT_THAT(complaint("extends: aligo\nLaser: {Power: }\n"), HasSubstr("'Laser.Power' has no value"));
  EXPECT_THAT(complaint("extends: aligo\nLaser:\n"), HasSubstr("'Laser' has no value"));
  for (std::string const& said :
       {complaint("extends: aligo\nLaser: 5\n"), complaint("extends: aligo\n", {"Laser=3"})}) {
    EXPECT_THAT(said, HasSubstr("'Laser' is a table, not a value"));
    EXPECT_THAT(said, HasSubstr("give a key of it, for example Laser."));
  }
  EXPECT_THAT(complaint("extends: aligo\n? [a, b]\n: 1\n? [c]\n: 2\n"), HasSubstr("a key must be plain text"));
  EXPECT_THAT(complaint("extends: aligo\n", {"Lasr=3"}), HasSubstr("unknown key 'Lasr'"));  // no table either
}

// Nine tables of nine aliases each are 9^7 values; an alias inside its own list has no end.
TEST(Ifo, AliasesExpandWithinALimit) {
  std::string bomb = "extends: aligo\na: &a [x, x, x, x, x, x, x, x, x]\n";
  for (char c = 'b'; c <= 'g'; ++c) {
    bomb += std::string(1, c) + ": &" + c + " [";
    for (int i = 0; i < 9; ++i) bomb += std::string(i > 0 ? ", *" : "*") + char(c - 1);
    bomb += "]\n";
  }
  EXPECT_THAT(complaint(bomb), HasSubstr("more than 10000 values"));
  EXPECT_THAT(complaint("extends: aligo\na: &a [*a]\n"), HasSubstr("error"));
  EXPECT_EQ(complaint("extends: aligo\nOptics: {ITM: {Transmittance: &t 0.014}, SRM: {Transmittance: *t}}\n"), "");
}

TEST(Ifo, AScene) {
  std::string const said = complaint("straytrace: 1\ntitle: An arm\nbeams: {}\n");
  EXPECT_THAT(said, HasSubstr("this is a scene, not a detector"));
  EXPECT_THAT(said, HasSubstr("1 error."));
}

// The quadrature in which the arms do not appear would make noise of rounding; a wrong length alone is one problem.
TEST(Ifo, BlindReadouts) {
  for (char const* angle : {"0", "3.141592653589793"})
    EXPECT_THAT(complaint(std::string("extends: aligo\nOptics: {Quadrature: {dc: ") + angle + "}}\n"),
                HasSubstr("ifo.yaml:2:27: error: at 'Optics.Quadrature.dc'"));
  EXPECT_EQ(complaint("extends: aligo\nOptics: {Quadrature: {dc: 0.1}}\n"), "");
  EXPECT_EQ(complaint("extends: et-lf\nOptics: {Quadrature: {dc: 0}}\n"), "");  // detuned: it sees them
  EXPECT_THAT(complaint("extends: aligo\n", {"Infrastructure.Length=0"}), ::testing::Not(HasSubstr("not stable")));
  EXPECT_THAT(complaint("extends: aligo\n", {"Optics.Curvature.ITM=0"}), HasSubstr("not stable"));
}

TEST(Ifo, UnknownKeysOfCompleteFilesAreAccepted) {
  TemporaryFile const file("whole.yaml", read_ifo("aligo").yaml + "\nInfrastructureOfTheFuture: {PipR: 0.5, l0: 1}\n");
  EXPECT_EQ(read_ifo(file.name()).detector.arm_length, 3995);
}

TEST(Ifo, OverridesAndCurves) {
  TemporaryFile const file(
      "own.yaml",
      "extends: adv\nLaser: {ArmPower: 1e5}\nSuspension: {Stage: [{Mass: 40, Length: 1, NWires: 4}]}\n"
      "Curves:\n  - {name: dark, file: dark.txt, kind: displacement}\n");
  IfoFile const ifo = read_ifo(file.name(), {"Optics.SRM.Transmittance=0.4"});
  EXPECT_EQ(ifo.detector.arm_power, 1e5);
  EXPECT_EQ(ifo.detector.signal_recycling, 0.4);
  EXPECT_EQ(ifo.detector.suspension->stages.size(), 1u);  // a list replaces a list
  ASSERT_EQ(ifo.curves.size(), 1u);
  EXPECT_TRUE(ifo.curves[0].displacement);
}

TEST(Ifo, OneGasOfOlderFiles) {
  std::string const at = "Infrastructure.ResidualGas.";
  std::vector<GasSpecies> const gas =
      read_ifo("aligo", {at + "pressure=5e-8", at + "mass=3.35e-27", at + "polarizability=7.8e-31"}).detector.gas;
  ASSERT_EQ(gas.size(), 5u);
  EXPECT_EQ(gas[0].tube_pressure, 5e-8);
  EXPECT_EQ(gas[0].chamber_pressure, 5e-8);
}

BudgetFile made() {
  return {{10, 20, 40},
          {"Total",
           "all",
           {5, 6, 7},
           {{"A", "first", {1, 2, 3}, {{"A/1", "route", {1, 1, 1}, {}}}}, {"B", "", {4, 4, 4}, {}}}},
          "Infrastructure: {Length: 3000}\n"};
}

TEST(BudgetFile, ThereAndBack) {
  TemporaryFile const file("budget.hdf5", budget_file_bytes(made(), {{"program", "test"}}));
  ASSERT_TRUE(is_budget_file(read_file(file.name()), file.name()));
  BudgetFile const back = read_budget_file(file.name());
  EXPECT_EQ(back.hz, made().hz);
  EXPECT_EQ(back.ifo, made().ifo);
  EXPECT_EQ(back.total.psd, made().total.psd);
  ASSERT_EQ(back.total.parts.size(), 2u);
  EXPECT_EQ(back.total.parts[0].psd, made().total.parts[0].psd);
  ASSERT_EQ(back.total.parts[0].parts.size(), 1u);
  EXPECT_EQ(back.total.parts[0].parts[0].name, "A:1");  // a slash would be a group
}

TEST(BudgetFile, RulesOfVersion2) {  // docs/reference/run_file.md
  hdf5::Reader const in(budget_file_bytes(made(), {}));
  EXPECT_EQ(in.attribute_text("/", "SCHEMA"), "GWINC noise budget");
  EXPECT_EQ(in.attribute_count("/", "SCHEMA_VERSION"), 2u);
  for (char const* path : {"/Total", "/Total/budget/A", "/Total/budget/B"}) {
    EXPECT_TRUE(in.has(std::string(path) + "/PSD"));
    EXPECT_THAT(in.attribute_text(path, "style"), HasSubstr("label"));
  }
  EXPECT_NE(in.attribute_text("/", "plot_style"), "");
}

TEST(BudgetFile, Version1) {
  hdf5::Writer out;
  out.array("/Freq", std::vector<double>{1, 2}, "Hz");
  out.group("/traces", "");
  out.array("/traces/Total", std::vector<double>{3, 4}, "1/Hz");
  out.array("/traces/Quantum", std::vector<double>{1, 1}, "1/Hz");
  out.group("/traces/Thermal", "");
  out.array("/traces/Thermal/Total", std::vector<double>{2, 3}, "1/Hz");
  out.array("/traces/Thermal/Coating", std::vector<double>{2, 3}, "1/Hz");
  TemporaryFile const file("v1.hdf5", out.bytes());
  BudgetFile const back = read_budget_file(file.name());
  EXPECT_EQ(back.total.psd, (std::vector<double>{3, 4}));
  ASSERT_EQ(back.total.parts.size(), 2u);
  EXPECT_EQ(back.total.parts[1].parts[0].name, "Coating");
}

template <class Fill>
std::string complaint_about(Fill const& fill) {
  hdf5::Writer out;
  fill(out);
  TemporaryFile const file("bad.hdf5", out.bytes());
  try {
    read_budget_file(file.name());
  } catch (InputError const& e) {
    return e.what();
  }
  return "";
}

TEST(BudgetFile, Damaged) {
  std::vector<double> const two{1, 2};
  EXPECT_THAT(complaint_about([&](hdf5::Writer& out) { out.array("/Something", two, ""); }),
              HasSubstr("'/Freq' is missing"));
  EXPECT_THAT(complaint_about([&](hdf5::Writer& out) {
                out.array("/Freq", two, "Hz");
                out.group("/One", "");
                out.group("/Two", "");
              }),
              HasSubstr("the total must be the only one"));
  EXPECT_THAT(complaint_about([&](hdf5::Writer& out) {
                out.array("/Freq", two, "Hz");
                out.group("/Total", "");
                out.array("/Total/PSD", std::vector<double>{1}, "1/Hz");
              }),
              HasSubstr("1 values for 2 frequencies"));
}

}  // namespace
}  // namespace straytrace
