// SPDX-License-Identifier: BSD-3-Clause
// Paths as directions in the space of the independent inputs of the motion.
#pragma once

#include <Eigen/Dense>

#include <span>
#include <vector>

#include "motion/motion.hpp"
#include "noise/noise.hpp"

namespace straytrace {

// A column is what an input does through one transfer function; the two quadratures of a tone are columns of their own.
class MotionDirections {
 public:
  explicit MotionDirections(MotionSet const& motion);

  Eigen::Index inputs() const { return Eigen::Index(motion_.inputs.size()); }
  Eigen::Index columns() const { return Eigen::Index(columns_.size()); }
  Eigen::VectorXd of(std::span<Lever const>) const;  // d(phase)/d(column), rad/m
  // Columns to inputs, each in the root of its power in the bin (`everywhere`: at all frequencies).
  Eigen::MatrixXcd to_inputs(FrequencyGrid const&, std::size_t bin, bool everywhere) const;
  double tone_power(Eigen::MatrixXd const& second_moments) const;  // of the phase by tones, rad^2
  bool drifts(Eigen::MatrixXd const& second_moments) const;

 private:
  struct Column {
    std::size_t input;
    TransferFunction const* transfer;
    bool imaginary;
  };
  void add_column(std::size_t input, TransferFunction const* transfer, bool imaginary);
  double root_power(std::size_t input, double low, double high, bool everywhere) const;

  MotionSet const& motion_;
  std::vector<Column> columns_;
};

}  // namespace straytrace
