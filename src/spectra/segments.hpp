// SPDX-License-Identifier: BSD-3-Clause
// Windowed transforms of overlapping segments: what all averaged spectra are made of. Inside the room.
#pragma once

#include <span>
#include <vector>

#include "spectra/fourier.hpp"
#include "spectra/welch.hpp"

namespace straytrace {

class Segments {
 public:
  // Throws InputError as welch() says.
  Segments(std::size_t samples, double rate, WelchSettings const&);

  std::size_t count() const { return count_; }
  std::size_t lines() const { return settings_.segment / 2 + 1; }
  double hz(std::size_t line) const { return double(line) * rate_ / double(settings_.segment); }
  std::size_t begin(std::size_t segment) const { return segment * step_; }
  double noise_bandwidth() const { return rate_ * square_ / (sum_ * sum_); }
  // |X|^2 times this is a one-sided PSD: 1/(rate sum w^2), twice that for each frequency with a negative counterpart.
  double density(std::size_t line) const;
  bool is_real_line(std::size_t line) const { return line == 0 || 2 * line == settings_.segment; }
  // Independent segments that average as well as these: neighbours share samples (Welch 1967).
  double effective() const;
  // Lines of a segment, detrended and windowed; valid until the next call.
  Complexes const& transform(std::span<double const> samples, std::size_t segment);

 private:
  WelchSettings settings_;
  double rate_, sum_ = 0, square_ = 0;
  std::size_t step_, count_;
  std::vector<double> weights_, part_;
  Fourier fourier_;
};

}  // namespace straytrace
