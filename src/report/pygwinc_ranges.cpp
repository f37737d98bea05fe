// SPDX-License-Identifier: BSD-3-Clause
#include "report/pygwinc_ranges.hpp"

#include <fmt/format.h>

#include "base/constants.hpp"

namespace straytrace {
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
