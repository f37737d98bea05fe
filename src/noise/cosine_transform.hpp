// SPDX-License-Identifier: BSD-3-Clause
// Sums of cosines on points half a step off the origin: an even record of 2m points from m numbers.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace straytrace {

//   x_n = sum over k < m of a_k cos(pi k (n + 1/2) / m),   0 <= n < m
//
// Either way by one real transform of m numbers (J. Makhoul, IEEE Trans. ASSP 28 (1980) 27). m is a multiple of 4.
class CosineTransform {
 public:
  explicit CosineTransform(std::size_t m);
  ~CosineTransform();
  void values(std::vector<double> const& amplitudes, std::vector<double>& x) const;  // missing amplitudes are zero
  void amplitudes(std::vector<double> const& x, std::vector<double>& a) const;

  static CosineTransform const& of(std::size_t m);  // kept, one set per thread: making one takes longer than using it

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

}  // namespace straytrace
