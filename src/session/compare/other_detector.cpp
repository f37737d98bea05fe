// SPDX-License-Identifier: BSD-3-Clause
#include "session/compare/other_detector.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <vector>

#include "base/files/embedded.hpp"
#include "noise/fundamental/design.hpp"

namespace straytrace {
namespace {

struct Compared {
  char const *name, *unit;
  double DetectorNumbers::*number;
  double tolerance;  // relative
};
constexpr Compared all_compared[] = {
    {"arm length", " m", &DetectorNumbers::arm_length, 0.01},
    {"power in an arm", " W", &DetectorNumbers::arm_power, 0.1},
    {"mass of a mirror", " kg", &DetectorNumbers::mirror_mass, 0.1},
    {"finesse of an arm", "", &DetectorNumbers::finesse, 0.1},
    {"Gamma, from signal recycling and finesse,", "", &DetectorNumbers::gain, 0.1},
};

// What is not known differs from nothing.
std::vector<std::string> differences(DetectorNumbers const& own, DetectorNumbers const& curve) {
  std::vector<std::string> all;
  for (Compared const& c : all_compared) {
    double const a = own.*c.number, b = curve.*c.number;
    if (std::fabs(a - b) > c.tolerance * std::fabs(b))
      all.push_back(fmt::format("{} {:.4g}{}, not {:.4g}{}", c.name, a, c.unit, b, c.unit));
  }
  return all;
}

std::string remedy(std::string const& detector) {
  std::string const file = fmt::format("library/detectors/{}.yaml", detector);
  if (embedded_file(file).empty())
    return "give the interferometer these numbers, or compare with a curve of its own detector";
  return fmt::format("take the interferometer of '{}', or compare with a curve of your own detector", file);
}

}  // namespace

std::optional<OtherDetector> other_detector(std::string const& curve, Interferometer const& interferometer) {
  DetectorNumbers const own = interferometer.numbers();
  std::vector<std::string> least;
  std::string detector, title;
  for (std::string const& name : detectors_of_design(curve)) {
    IfoFile const file = read_ifo(name);
    std::vector<std::string> const found = differences(own, file.detector.numbers());
    if (found.empty()) return {};
    if (!least.empty() && found.size() >= least.size()) continue;
    least = found;
    detector = name;
    title = file.title;
  }
  if (least.empty()) return {};
  return OtherDetector{fmt::format("'{}' is a curve of {}, and the interferometer is another one: {}", curve, title,
                                   fmt::join(least, "; ")),
                       remedy(detector)};
}

std::optional<OtherDetector> other_detector(IfoFile const& budget, std::string const& detector, std::string const& run,
                                            Interferometer const& interferometer) {
  std::vector<std::string> const found = differences(interferometer.numbers(), budget.detector.numbers());
  if (found.empty()) return {};
  return OtherDetector{
      fmt::format("'{}' is a budget of {}, and the interferometer of '{}' is another one: {}", detector,
                  budget.title.empty() ? "one detector" : budget.title, run, fmt::join(found, "; ")),
      fmt::format("give the detector of '{}', or project the run with the interferometer of '{}'", run, detector)};
}

void warn_of_other_detector(Model const& model, Node const& place) {
  if (!model.detector) return;
  for (DesignCurve const& curve : model.design)
    if (auto const other = other_detector(curve.name, *model.detector)) place.warning(other->what, other->suggestion);
}

}  // namespace straytrace
