// SPDX-License-Identifier: BSD-3-Clause
#include "noise/wrapped/class_covariances.hpp"

namespace straytrace {
namespace {

constexpr std::size_t most_kept = std::size_t{1} << 23;  // numbers: 64 MB

}  // namespace

std::vector<double> const& ClassCovariances::line_powers(MotionClass const& motion, std::size_t c, double spacing,
                                                         std::size_t count) {
  std::vector<double>& power = power_[c];
  for (std::size_t k = power.size(); k < count; ++k) {
    double const line = static_cast<double>(k);
    power.push_back(k == 0 ? 0 : motion.reference.power((line - 0.5) * spacing, (line + 0.5) * spacing));
  }
  return power;
}

std::vector<double> ClassCovariances::lines(std::span<MotionClass const> classes, std::span<double const> kappa,
                                            double highest, double spacing) {
  std::vector<double> out(static_cast<std::size_t>(highest / spacing + 0.5) + 1);
  std::size_t const last = out.size() - 1;  // cut off at `highest`
  for (std::size_t c = 0; c < classes.size(); ++c) {
    if (kappa[c] == 0 || !classes[c].gaussian()) continue;
    std::vector<double> const& one = line_powers(classes[c], c, spacing, last);
    for (std::size_t k = 1; k < last; ++k) out[k] += kappa[c] * one[k];
    if (last > 0)
      out[last] += kappa[c] * classes[c].reference.power((static_cast<double>(last) - 0.5) * spacing, highest);
  }
  return out;
}

Covariance const& ClassCovariances::of_class(Band& band, std::span<MotionClass const> classes, std::size_t c,
                                             double highest, LagGrid const& lags) {
  if (band[c].at.empty()) {
    std::vector<double> only(classes.size());
    only[c] = 1;
    band[c] = covariance(lines(classes, only, highest, lags.spacing), lags);
    kept_ += band[c].at.size();
  }
  return band[c];
}

Covariance ClassCovariances::sum(std::span<MotionClass const> classes, std::span<double const> kappa, double highest,
                                 LagGrid const& lags) {
  bool const other_lines = lags.spacing != spacing_;
  if (other_lines) power_.assign(classes.size(), {});
  if (other_lines || kept_ > most_kept) {
    bands_.clear();
    kept_ = 0;
  }
  spacing_ = lags.spacing;
  auto const moving = [&](std::size_t c) { return kappa[c] != 0 && classes[c].gaussian(); };
  std::size_t together = 0;
  for (std::size_t c = 0; c < classes.size(); ++c) together += moving(c);
  if (together > few) return covariance(lines(classes, kappa, highest, lags.spacing), lags);
  Band& band = bands_[{highest, lags.samples}];
  band.resize(classes.size());
  Covariance r{0, std::vector<double>(lags.size())};
  for (std::size_t c = 0; c < classes.size(); ++c) {
    if (!moving(c)) continue;
    Covariance const& one = of_class(band, classes, c, highest, lags);
    r.at_zero += kappa[c] * one.at_zero;
    for (std::size_t i = 0; i < r.at.size(); ++i) r.at[i] += kappa[c] * one.at[i];
  }
  return r;
}

}  // namespace straytrace
