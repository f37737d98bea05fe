// SPDX-License-Identifier: BSD-3-Clause
#include "noise/motion_directions.hpp"

#include <algorithm>
#include <cmath>

namespace straytrace {

MotionDirections::MotionDirections(MotionSet const& motion) : motion_(motion) {
  for (std::size_t i = 0; i < motion.inputs.size(); ++i)
    for (Gain const& g : motion.inputs[i].gains)
      for (bool const imaginary : {false, true})
        if (!imaginary || g.value.imag() != 0) add_column(i, g.transfer.get(), imaginary);
}

void MotionDirections::add_column(std::size_t input, TransferFunction const* transfer, bool imaginary) {
  auto const same = std::find_if(columns_.begin(), columns_.end(), [&](Column const& c) {
    return c.input == input && c.transfer == transfer && c.imaginary == imaginary;
  });
  if (same == columns_.end()) columns_.push_back({input, transfer, imaginary});
}

Eigen::VectorXd MotionDirections::of(std::span<Lever const> levers) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(columns());
  for (std::size_t c = 0; c < columns_.size(); ++c)
    for (Gain const& g : motion_.inputs[columns_[c].input].gains)
      for (Lever const& lever : levers)
        if (lever.body == g.body && g.transfer.get() == columns_[c].transfer)
          out[Eigen::Index(c)] += lever.d[g.axis] * (columns_[c].imaginary ? g.value.imag() : g.value.real());
  return out;
}

double MotionDirections::root_power(std::size_t input, double low, double high, bool everywhere) const {
  MotionInput const& in = motion_.inputs[input];
  if (in.drift) return 0;
  bool const tone = in.tone_frequency > 0, inside = in.tone_frequency >= low && in.tone_frequency < high;
  if (everywhere) return std::sqrt(tone ? 0.5 : in.spectrum.total());
  return std::sqrt((tone ? (inside ? 0.5 : 0) : in.spectrum.power(low, high)) / (high - low));
}

Eigen::MatrixXcd MotionDirections::to_inputs(FrequencyGrid const& grid, std::size_t bin, bool everywhere) const {
  Eigen::MatrixXcd out = Eigen::MatrixXcd::Zero(inputs(), columns());
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    Column const& column = columns_[c];
    double const hz = motion_.inputs[column.input].tone_frequency;
    std::complex<double> factor = root_power(column.input, grid.edges[bin], grid.edges[bin + 1], everywhere);
    if (column.transfer && hz == 0 && !everywhere) factor *= (*column.transfer)(grid.centre(bin));
    if (column.imaginary) factor *= std::complex<double>(0, 1);
    out(Eigen::Index(column.input), Eigen::Index(c)) = factor;
  }
  return out;
}

double MotionDirections::tone_power(Eigen::MatrixXd const& moments) const {
  double sum = 0;
  for (std::size_t c = 0; c < columns_.size(); ++c)
    if (motion_.inputs[columns_[c].input].tone_frequency > 0) sum += 0.5 * moments(Eigen::Index(c), Eigen::Index(c));
  return sum;
}

bool MotionDirections::drifts(Eigen::MatrixXd const& moments) const {
  for (std::size_t c = 0; c < columns_.size(); ++c)
    if (motion_.inputs[columns_[c].input].drift && moments(Eigen::Index(c), Eigen::Index(c)) > 0) return true;
  return false;
}

}  // namespace straytrace
