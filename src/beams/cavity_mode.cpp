// SPDX-License-Identifier: BSD-3-Clause
#include "beams/cavity_mode.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"

namespace straytrace::beams {
namespace {

constexpr double margin = 1e-9;  // of g1 g2 to 0 and 1: nearer, the spots are decided by rounding

}  // namespace

CavityMode cavity_mode(double length, double roc1, double roc2, double wavelength) {
  CavityMode m;
  m.g1 = 1 - length / roc1;
  m.g2 = 1 - length / roc2;
  double const product = m.g1 * m.g2;
  if (!(product > 0 && product < 1))
    throw NumericalError(fmt::format("the cavity is unstable: g1 g2 = {:.6g}, must lie between 0 and 1", product));
  if (product < margin || product > 1 - margin)
    throw NumericalError(fmt::format("the cavity is at the edge of stability: g1 g2 = {:.12g} is {} but for {:g}",
                                     product, product < 0.5 ? 0 : 1, margin));
  double const scale = wavelength * length / pi, sum = m.g1 + m.g2 - 2 * product;
  m.w1 = std::sqrt(scale * std::sqrt(m.g2 / (m.g1 * (1 - product))));
  m.w2 = std::sqrt(scale * std::sqrt(m.g1 / (m.g2 * (1 - product))));
  m.waist = std::sqrt(scale * std::sqrt(product * (1 - product) / (sum * sum)));
  m.waist_position = length * m.g2 * (1 - m.g1) / sum;
  m.gouy = std::acos(std::copysign(std::sqrt(product), m.g1));
  m.rayleigh = pi * m.waist * m.waist / wavelength;
  return m;
}

}  // namespace straytrace::beams
