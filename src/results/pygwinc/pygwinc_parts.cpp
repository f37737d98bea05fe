// SPDX-License-Identifier: BSD-3-Clause
#include "results/pygwinc/pygwinc_parts.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/math/constants.hpp"
#include "noise/fundamental/surroundings.hpp"

namespace straytrace {
namespace {

WireMaterial read_wire(IfoTree& t, std::string const& name) {
  std::string const at = "Suspension." + name + ".";
  WireMaterial m;
  m.density = t.number(at + "Rho");
  m.heat_capacity = t.number(at + "C");
  m.conductivity = t.number(at + "K");
  m.expansion = t.number(at + "Alpha");
  m.modulus_slope = t.number(at + "dlnEdT");
  m.loss = t.number(at + "Phi");
  m.young = t.number(at + "Y");
  m.surface_depth = t.number(at + "Dissdepth", 0.0);
  return m;
}

// The fibre of the last stage, unless the stage states wires of its own.
void read_fibre(IfoTree& t, SuspensionStage& s) {
  std::string const kind = t.word("Suspension.FiberType", "Round");
  if (kind == "Ribbon") {
    if (std::isnan(s.wire_radius)) s.wire_radius = t.number("Suspension.Ribbon.Width");
    s.ribbon_thickness = t.number("Suspension.Ribbon.Thickness");
    return;
  }
  if (std::isnan(s.wire_radius)) s.wire_radius = t.number("Suspension.Fiber.Radius");
  if (kind == "Tapered") {
    s.end_radius = t.number("Suspension.Fiber.EndRadius");
    s.end_length = t.number("Suspension.Fiber.EndLength");
  } else if (kind != "Round") {
    t.problem("Suspension.FiberType", fmt::format("'{}' is not a kind of fibre", kind),
              "write Round, Ribbon or Tapered");
  }
}

}  // namespace

SuspensionChain read_suspension(IfoTree& t, double arm_length) {
  SuspensionChain chain;
  std::vector<std::string> const places = t.elements("Suspension.Stage");  // from the test mass to the top
  double const given = t.number("Suspension.Temp", false);
  double above = given;
  for (std::size_t i = places.size(); i-- > 0;) {
    std::string const at = places[i] + ".";
    bool const last = i == 0;
    SuspensionStage s;
    s.mass = t.number(at + "Mass");
    s.length = t.number(at + "Length");
    s.wires = t.number(at + "NWires");
    s.wire_radius = t.number(at + "WireRadius", !last);
    s.dilution = t.number(at + "Dilution", false);
    s.vertical_spring = t.number(at + "K", false);
    s.blade = t.number(at + "Blade", false);
    s.temperature = t.number(at + "Temp", given);
    if (std::isnan(s.temperature)) s.temperature = t.number("Suspension.Temp");
    s.upper_temperature = std::isnan(above) ? s.temperature : above;
    above = s.temperature;
    std::string const wire = t.word(at + "WireMaterial", last ? "Silica" : "C70Steel");
    s.upper = read_wire(t, t.word(at + "WireMaterialUpper", wire));
    s.lower = read_wire(t, t.word(at + "WireMaterialLower", wire));
    std::string const blade = t.word(at + "BladeMaterial", "MaragingSteel");
    if (std::isfinite(s.vertical_spring)) s.blades = read_wire(t, blade);
    if (last) read_fibre(t, s);
    chain.stages.push_back(s);
  }
  constexpr double earth_radius = 6.3781e6;  // m: mirrors hang towards its centre
  chain.vertical_coupling = t.number("Suspension.VHCoupling.theta", arm_length / earth_radius);
  return chain;
}

SubstrateMaterial read_substrate(IfoTree& t) {
  std::string const at = "Materials.Substrate.";
  SubstrateMaterial m;
  m.temperature = t.number(at + "Temp");
  m.young = t.number(at + "MirrorY");
  m.poisson = t.number(at + "MirrorSigma");
  m.density = t.number(at + "MassDensity");
  m.expansion = t.number(at + "MassAlpha");
  m.heat_capacity = t.number(at + "MassCM");
  m.conductivity = t.number(at + "MassKappa");
  m.index = t.number(at + "RefractiveIndex");
  m.loss = t.number(at + "c2");
  m.loss_exponent = t.number(at + "MechanicalLossExponent");
  m.surface_loss = t.number(at + "Alphas");
  m.index_slope = t.number(at + "dndT", false);
  return m;
}

CoatingMaterial read_coating(IfoTree& t, std::string const& end) {  // "lown", "highn"
  std::string const at = "Materials.Coating.";
  CoatingMaterial m;
  m.young = t.number(at + "Y" + end);
  m.poisson = t.number(at + "Sigma" + end);
  m.index = t.number(at + "Index" + end);
  m.heat_capacity = t.number(at + "CV" + end);
  m.conductivity = t.number(at + "ThermalDiffusivity" + end);
  m.expansion = t.number(at + "Alpha" + end);
  m.index_slope = t.number(at + "Beta" + end);
  m.loss = t.number(at + "Phi" + end);
  m.loss_slope = t.number(at + "Phi" + end + "_slope", 0.0);
  for (char const* what : {"PET", "lossB", "lossS"})  // experimental options of pygwinc
    if (std::string const path = at + what + end; t.has(path))
      t.problem(path, fmt::format("'{}' is not taken into account", path),
                "leave it out: losses are equal in bulk and shear, and there is no photo-elastic effect");
  return m;
}

std::vector<GasSpecies> read_gas(IfoTree& t) {
  std::vector<GasSpecies> all;
  auto const species = [&](std::string const& name, std::string const& at, char const* tube, char const* chamber) {
    GasSpecies g{name, t.number(at + tube), 0, t.number(at + "mass"), t.number(at + "polarizability")};
    g.chamber_pressure = t.number(at + chamber, g.tube_pressure);
    all.push_back(g);
  };
  std::string const at = "Infrastructure.ResidualGas.";
  if (t.has(at + "pressure")) species("gas", at, "pressure", "pressure");  // older files: one gas
  for (char const* name : {"H2", "N2", "H2O", "O2"})
    if (t.has(at + name)) species(name, at + name + ".", "BeamtubePressure", "ChamberPressure");
  return all;
}

Ground read_ground(IfoTree& t) {
  std::string const at = "Seismic.";
  Ground g;
  g.platform = t.word(at + "PlatformMotion", "BSC");
  if (std::isnan(platform_asd(g.platform, 1)))
    t.problem(at + "PlatformMotion", fmt::format("'{}' is not a motion of a platform", g.platform),
              fmt::format("write one of: {}", fmt::join(platform_names(), ", ")));
  if (!t.has(at + "LowFrequencyLevel")) return g;
  g.level = t.number(at + "LowFrequencyLevel");
  g.knee = t.number(at + "KneeFrequency");
  g.abruptness = t.number(at + "Gamma");
  g.density = t.number(at + "Rho");
  g.height = t.number(at + "TestMassHeight");
  g.rayleigh_speed = t.number(at + "RayleighWaveSpeed");
  g.p_speed = t.number(at + "pWaveSpeed", 2.4 * g.rayleigh_speed);  // files before 2021 do not say
  g.s_speed = t.number(at + "sWaveSpeed", 1.2 * g.rayleigh_speed);
  g.p_level = t.number(at + "pWaveLevel", false);
  g.s_level = t.number(at + "sWaveLevel", false);
  g.subtraction = t.number(at + "Omicron", 1.0);
  g.steeper = t.word(at + "Site") == "LLO";
  return g;
}

std::optional<Squeezer> read_squeezer(IfoTree& t) {
  std::string const type = t.word("Squeezer.Type", "Freq Independent");
  if (type != "None" && type != "Freq Independent" && type != "Freq Dependent")
    t.problem("Squeezer.Type", fmt::format("'{}' is not a kind of squeezing", type),
              "write None, Freq Independent or Freq Dependent");
  Squeezer q;
  q.decibels = t.number("Squeezer.AmplitudedB", 0.0);
  if (type == "None" || q.decibels == 0) return std::nullopt;
  q.anti_decibels = t.number("Squeezer.AntiAmplitudedB", false);
  q.angle = t.number("Squeezer.SQZAngle", 0.0);
  q.loss = t.number("Squeezer.InjectionLoss", 0.0);
  q.phase_noise = t.number("Squeezer.LOAngleRMS", 0.0);
  if (type != "Freq Dependent") return q;
  std::vector<std::string> places = t.elements("Squeezer.FilterCavity");
  if (places.empty()) places.push_back("Squeezer.FilterCavity");
  for (std::string const& place : places) {
    std::string const at = place + ".";
    q.cavities.push_back({t.number(at + "L"), t.number(at + "fdetune"), t.number(at + "Ti"), t.number(at + "Te"),
                          t.number(at + "Lrt"), t.number(at + "Rot", 0.0)});
  }
  return q;
}

namespace {

struct Range {
  double low, high;
  bool with_low, with_high;
  bool holds(double x) const { return (with_low ? x >= low : x > low) && (with_high ? x <= high : x < high); }
  std::string words() const {
    std::string const first = fmt::format("{} {:g}", with_low ? "from" : "above", low);
    if (high == infinity) return first;
    return fmt::format("{} {} {:g}", first, !with_high ? "and below" : with_low ? "to" : "and up to", high);
  }
};

constexpr Range positive{0, infinity, false, false}, not_negative{0, infinity, true, false};
constexpr Range transmission{0, 1, false, false}, share{0, 1, true, false}, yield{0, 1, false, true};
constexpr Range kelvin{0, 1e4, false, true}, poisson{-1, 0.5, false, false}, index{1, 10, true, true};

struct Rule {
  std::string_view end;  // of the path, from a dot on
  Range range;
};

// The first that fits.
constexpr Rule rules[] = {
    {"Laser.Wavelength", {0, 1e-4, false, true}},
    {"Laser.Power", positive},
    {"Laser.ArmPower", positive},
    {"ETM.Transmittance", share},
    {"ITM.Transmittance", transmission},
    {"Transmittance", yield},  // recycling mirrors: 1 is no mirror
    {"CavityLength", not_negative},
    {"Optics.Loss", {0, 0.1, true, true}},
    {"BSLoss", share},
    {"SRCloss", share},
    {"coupling", yield},
    {"PhotoDetectorEfficiency", yield},
    {"AmplitudedB", {0, 60, true, true}},
    {"AntiAmplitudedB", {0, 100, true, true}},
    {"InjectionLoss", {0, 1, true, true}},
    {"LOAngleRMS", {0, pi / 2, true, true}},
    {"L", positive},
    {"Ti", transmission},
    {"Te", share},
    {"Lrt", share},
    {"MassRadius", positive},
    {"MassThickness", positive},
    {"Temp", kelvin},
    {"Mass", positive},
    {"mass", positive},
    {"polarizability", not_negative},
    {"pressure", not_negative},
    {"BeamtubePressure", not_negative},
    {"ChamberPressure", not_negative},
    {"Length", positive},
    {"NWires", {1, 100, true, true}},
    {"WireRadius", positive},
    {"Dilution", positive},
    {"Blade", positive},
    {"K", positive},
    {"Rho", positive},
    {"C", positive},
    {"Y", positive},
    {"Phi", share},
    {"Dissdepth", not_negative},
    {"Radius", positive},
    {"EndRadius", positive},
    {"EndLength", positive},
    {"Width", positive},
    {"Thickness", positive},
    {"MirrorY", positive},
    {"MirrorSigma", poisson},
    {"MassDensity", positive},
    {"MassCM", positive},
    {"MassKappa", positive},
    {"RefractiveIndex", index},
    {"c2", not_negative},
    {"Alphas", not_negative},
    {"Yhighn", positive},
    {"Ylown", positive},
    {"Sigmahighn", poisson},
    {"Sigmalown", poisson},
    {"Indexhighn", index},
    {"Indexlown", index},
    {"CVhighn", positive},
    {"CVlown", positive},
    {"ThermalDiffusivityhighn", positive},
    {"ThermalDiffusivitylown", positive},
    {"Phihighn", share},
    {"Philown", share},
    {"CoatingThicknessLown", {0, 0.5, false, false}},
    {"CoatingThicknessCap", not_negative},
    {"LowFrequencyLevel", not_negative},
    {"KneeFrequency", positive},
    {"Gamma", not_negative},
    {"RayleighWaveSpeed", positive},
    {"pWaveSpeed", positive},
    {"sWaveSpeed", positive},
    {"pWaveLevel", not_negative},
    {"sWaveLevel", not_negative},
    {"Omicron", positive},
    {"AirPressure", positive},
    {"AirDensity", positive},
    {"AdiabaticIndex", positive},
    {"SoundSpeed", positive},
};

bool fits(std::string_view path, std::string_view end) {
  return path == end || (path.size() > end.size() && path.ends_with(end) && path[path.size() - end.size() - 1] == '.');
}

}  // namespace

std::string out_of_range(std::string_view path, double value) {
  if (path.find(".CoatLayerOpticalThickness.") != path.npos) return positive.holds(value) ? "" : positive.words();
  for (Rule const& rule : rules)
    if (fits(path, rule.end)) return rule.range.holds(value) ? "" : rule.range.words();
  return "";
}

}  // namespace straytrace
