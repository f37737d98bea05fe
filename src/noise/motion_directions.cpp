// SPDX-License-Identifier: BSD-3-Clause
#include "noise/motion_directions.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace straytrace {

MotionDirections::MotionDirections(MotionSet const& motion) : motion_(motion) {
  for (std::size_t i = 0; i < motion.inputs.size(); ++i) add_columns(i);
}

void MotionDirections::add_columns(std::size_t input) {
  std::vector<Gain> const& gains = motion_.inputs[input].gains;
  std::size_t const first = columns_.size();
  for (Gain const& g : gains)
    for (bool const imaginary : {false, true}) {
      bool const there = std::any_of(columns_.begin() + std::ptrdiff_t(first), columns_.end(), [&](Column const& c) {
        return c.transfer == g.transfer.get() && c.imaginary == imaginary;
      });
      if (!there && (!imaginary || g.value.imag() != 0)) columns_.push_back({input, g.transfer.get(), imaginary});
    }
  for (std::size_t c = first; c < columns_.size(); ++c)
    for (std::size_t k = 0; k < gains.size(); ++k) {
      Gain const& g = gains[k];
      if (g.transfer.get() != columns_[c].transfer) continue;
      if (of_body_.size() <= g.body.value) of_body_.resize(g.body.value + 1);
      of_body_[g.body.value].push_back({c, k, g.axis, columns_[c].imaginary ? g.value.imag() : g.value.real()});
    }
}

MotionDirections::Gains MotionDirections::of(std::span<Lever const> levers) const {
  std::vector<std::tuple<std::size_t, std::size_t, double>> terms;  // column, gain: the order of the sum
  for (Lever const& lever : levers)
    if (lever.body.value < of_body_.size())
      for (Entry const& e : of_body_[lever.body.value]) terms.emplace_back(e.column, e.gain, lever.d[e.axis] * e.value);
  std::stable_sort(terms.begin(), terms.end(), [](auto const& a, auto const& b) {
    return std::tie(std::get<0>(a), std::get<1>(a)) < std::tie(std::get<0>(b), std::get<1>(b));
  });
  Gains out;
  for (auto const& [column, gain, value] : terms) {
    if (out.empty() || out.back().first != column) out.emplace_back(column, 0);
    out.back().second += value;
  }
  return out;
}

double MotionDirections::root_power(std::size_t input, double low, double high, bool everywhere) const {
  MotionInput const& in = motion_.inputs[input];
  if (in.drift) return 0;
  bool const tone = in.tone_frequency > 0, inside = in.tone_frequency >= low && in.tone_frequency < high;
  if (everywhere) return std::sqrt(tone ? 0.5 : in.spectrum.total());
  return std::sqrt((tone ? (inside ? 0.5 : 0) : in.spectrum.power(low, high)) / (high - low));
}

std::vector<std::complex<double>> MotionDirections::to_inputs(FrequencyGrid const& grid, std::size_t bin,
                                                              bool everywhere) const {
  std::vector<std::complex<double>> out;
  for (Column const& column : columns_) {
    double const hz = motion_.inputs[column.input].tone_frequency;
    std::complex<double> factor = root_power(column.input, grid.edges[bin], grid.edges[bin + 1], everywhere);
    if (column.transfer && hz == 0 && !everywhere) factor *= (*column.transfer)(grid.centre(bin));
    if (column.imaginary) factor *= std::complex<double>(0, 1);
    out.push_back(factor);
  }
  return out;
}

}  // namespace straytrace
