// SPDX-License-Identifier: BSD-3-Clause
// Paths as directions in the space of the independent inputs of the motion.
#pragma once

#include <complex>
#include <span>
#include <utility>
#include <vector>

#include "motion/motion.hpp"
#include "noise/noise.hpp"

namespace straytrace {

// A column is what an input does through one transfer function; the two quadratures of a tone are columns of their own.
class MotionDirections {
 public:
  explicit MotionDirections(MotionSet const& motion);

  std::size_t inputs() const { return motion_.inputs.size(); }
  std::size_t input(std::size_t column) const { return columns_[column].input; }
  // d(phase)/d(column), rad/m; columns that do not move these levers are left out, the others ascend.
  using Gains = std::vector<std::pair<std::size_t, double>>;
  Gains of(std::span<Lever const>) const;
  // What each column does to its input, in the root of its power in the bin (`everywhere`: at all frequencies).
  std::vector<std::complex<double>> to_inputs(FrequencyGrid const&, std::size_t bin, bool everywhere) const;
  bool tone(std::size_t column) const { return motion_.inputs[input(column)].tone_frequency > 0; }
  bool drifts(std::size_t column) const { return motion_.inputs[input(column)].drift; }

 private:
  struct Column {
    std::size_t input;
    TransferFunction const* transfer;
    bool imaginary;
  };
  struct Entry {  // what one gain of a column's input does to a body
    std::size_t column, gain;
    int axis;
    double value;
  };
  void add_columns(std::size_t input);
  double root_power(std::size_t input, double low, double high, bool everywhere) const;

  MotionSet const& motion_;
  std::vector<Column> columns_;
  std::vector<std::vector<Entry>> of_body_;
};

}  // namespace straytrace
