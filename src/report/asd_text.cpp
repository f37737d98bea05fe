// SPDX-License-Identifier: BSD-3-Clause
// h_asd.txt: the total over frequency, for other programs.
#include <fmt/format.h>

#include "base/message.hpp"
#include "report/band.hpp"
#include "report/csv.hpp"

namespace straytrace {

std::string asd_text(RunContent const& run) {
  if (!run.noise) throw InputError("this run has no noise yet; write: straytrace noise RUN_FILE");
  NoiseBudget const& b = *run.noise;
  std::string text = file_header(run) + "# one-sided strain ASD, mean over static phases\n# " +
                     reverse_words(run.trace->coupling.reverse_routes) + "\n";
  text += "# h_low, h_high: one standard error of the Monte Carlo\n";
  text += "# input_low, input_high: what stated brackets and uncertainties of materials and motion leave open\n";
  text += "# speckle_05, _50, _95: percentiles of one realisation of the static phases\n";
  text += "# coherent: linear sum of the ASDs of all routes, as if all were in phase: upper bound\n";
  text += "# resolved: 1, or 0 where the values are lower bounds\n";
  text += "# bound_share: part of h_mean^2 that is an upper bound (routes of kind edge)\n";
  text += "# design: " + (b.design.empty() ? "none" : b.design.front().name) + "; ratio = h_mean/design\n";
  text += b.unresolved.empty()
              ? "# unresolved: none\n"
              : "# LOWER BOUND: of these unresolved routes h holds what was seen, with an error as large:\n";
  for (std::string const& name : b.unresolved) text += "#   " + name + "\n";
  std::size_t bounds = 0;
  for (std::size_t i = 0; i < b.grid.size(); ++i) bounds += at_most(b.total, i);
  if (bounds > 0) text += fmt::format("# AT MOST: in {} of {} bins h is an upper bound\n", bounds, b.grid.size());
  text += "# units: frequency Hz, ratio 1, all others 1/sqrt(Hz)\n";
  text +=
      "# frequency_Hz h_mean h_low h_high input_low input_high speckle_05 speckle_50 speckle_95 resolved sigma "
      "phase_only amplitude_only coherent design ratio bound_share\n";
  for (std::size_t i = 0; i < b.grid.size(); ++i) {
    double const h = b.total.asd.at(i), s = b.total.sigma.at(i);
    double const design = b.design.empty() ? not_a_number : b.design.front().asd.at(i);
    auto const band = [&](std::vector<double> const& curve) { return curve.empty() ? not_a_number : curve.at(i); };
    NoiseBands const& d = b.bands;
    double const low = h < s ? 0 : h - s;  // nan stays nan: not resolved is not zero
    text += fmt::format("{:.9e} {:.9e} {:.9e} {:.9e}", b.grid.centre(i), h, low, h + s);
    for (auto const* curve : {&d.input_low, &d.input_high, &d.speckle_05, &d.speckle_50, &d.speckle_95})
      text += fmt::format(" {:.9e}", band(*curve));
    text += fmt::format(" {} {:.3e} {:.9e} {:.9e} {:.9e} {:.9e} {:.6e} {:.4g}\n", int(b.unresolved.empty()), s,
                        b.total.phase_asd.at(i), b.total.amplitude_asd.at(i), band(d.coherent), design, h / design,
                        b.total.bound_share.empty() ? 0 : b.total.bound_share.at(i));
  }
  return text;
}

}  // namespace straytrace
