// SPDX-License-Identifier: BSD-3-Clause
#include "motion/motion_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/constants.hpp"
#include "base/document.hpp"

namespace straytrace {
namespace {

constexpr double edge = 0.02;           // relative, half a bin of the usual grid
constexpr double slowest = 0.1;         // Hz: below the microseism hardly any speed is left
constexpr double largest_over_rms = 4;  // of a Gaussian speed

// "below 5 Hz and above 100 Hz"; nothing when the file holds the whole band.
std::string missing_part(Band const& have, Band const& noise) {
  bool const below = have.low > noise.low * (1 + edge), above = have.high < noise.high * (1 - edge);
  std::string text = below ? fmt::format("below {:.4g} Hz", have.low) : "";
  if (above) text += fmt::format("{}above {:.4g} Hz", below ? " and " : "", have.high);
  return text;
}

}  // namespace

Band joined(Band a, std::span<Band const> others) {
  for (bool grew = true; grew;) {
    grew = false;
    for (Band const& b : others) {
      if (b.low > a.high * (1 + edge) || b.high < a.low * (1 - edge)) continue;
      grew = grew || b.low < a.low || b.high > a.high;
      a = {std::min(a.low, b.low), std::max(a.high, b.high)};
    }
  }
  return a;
}

double reach_of_missing(MotionFile const& file, double wavelength) {
  double const f = file.covered.low;
  if (!(f > slowest) || f < file.known.low) return 0;
  double const speed = 2 * pi * file.asd_low * f * f * std::sqrt(1 / slowest - 1 / f);
  return largest_over_rms * 2 * speed / wavelength;
}

std::vector<Problem> warnings_of_gaps(std::span<MotionFile const> files, Band noise, double wavelength) {
  std::vector<Problem> all;
  std::set<std::string> told;
  for (MotionFile const& file : files) {
    std::string const missing = missing_part(file.covered, noise);
    double const reach = reach_of_missing(file, wavelength);
    bool const slow = reach > noise.low, begins_above = file.covered.low > noise.low * (1 + edge);
    if ((missing.empty() && !slow) || !told.insert(file.name).second) continue;
    std::string what = fmt::format(
        "'{}' holds the motion of '{}' from {:.4g} Hz to {:.4g} Hz, and the noise is asked "
        "from {:.4g} Hz to {:.4g} Hz",
        file.name, file.coordinate, file.known.low, file.known.high, noise.low, noise.high);
    if (!missing.empty()) what += fmt::format(": {} it is taken as still", missing);
    if (slow)
      what += fmt::format(
          "{} motion below {:.4g} Hz changes how fringes wrap: going on as f^-2 it would put noise up "
          "to about {:.2g} Hz",
          missing.empty() ? ": missing" : "; the missing", file.covered.low, reach);
    else if (begins_above)
      what += "; slow motion that is missing also changes how fringes wrap";
    all.push_back({file.place, std::move(what),
                   "give a file that holds it, add a model for the rest in a list, [{...}, {power-law: ...}], choose "
                   "'band' in 'noise' inside it, or write 'beyond: zero' beside the file where there is no motion",
                   Severity::warning, std::max(1u, code_points(file.name))});
  }
  return all;
}

}  // namespace straytrace
