// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <span>

#include "base/constants.hpp"
#include "signal/shapes.hpp"

namespace straytrace {
namespace {

// From `period` [s] to the next line: acceleration PSD in dB relative to 1 (m/s^2)^2/Hz = a + b log10(period).
struct Piece {
  double period, a, b;
};
constexpr Piece low_noise[] = {{0.10, -162.36, 5.64},   {0.17, -166.70, 0},      {0.40, -170.00, -8.30},
                               {0.80, -166.40, 28.90},  {1.24, -168.60, 52.48},  {2.40, -159.98, 29.81},
                               {4.30, -141.10, 0},      {5.00, -71.36, -99.77},  {6.00, -97.26, -66.49},
                               {10.0, -132.18, -31.57}, {12.0, -205.27, 36.16},  {15.6, -37.65, -104.33},
                               {21.9, -114.37, -47.10}, {31.6, -160.58, -16.28}, {45.0, -187.50, 0},
                               {70.0, -216.47, 15.70},  {101, -185.00, 0},       {154, -168.34, -7.61},
                               {328, -217.43, 11.90},   {600, -258.28, 26.60},   {10000, -346.88, 48.75}};
constexpr Piece high_noise[] = {{0.10, -108.73, -17.23}, {0.22, -150.34, -80.50}, {0.32, -122.31, -23.87},
                                {0.80, -116.85, 32.51},  {3.80, -108.48, 18.08},  {4.60, -74.66, -32.95},
                                {6.30, 0.66, -127.18},   {7.90, -93.37, -22.42},  {15.4, 73.54, -162.98},
                                {20.0, -151.52, 10.01},  {354.8, -206.66, 31.63}};
constexpr double end_hz = 10;  // of the models

double displacement(std::span<Piece const> model, double hz) {
  if (hz > end_hz) return displacement(model, end_hz) * std::pow(end_hz / hz, 2);
  double const period = 1 / hz;
  Piece const* piece = &model.front();
  for (Piece const& p : model)
    if (p.period <= period) piece = &p;
  return std::pow(10, (piece->a + piece->b * std::log10(period)) / 20) / std::pow(2 * pi * hz, 2);
}

}  // namespace

double peterson_asd(GroundModel model, double hz) {
  if (model == GroundModel::low) return displacement(low_noise, hz);
  if (model == GroundModel::high) return displacement(high_noise, hz);
  return std::sqrt(displacement(low_noise, hz) * displacement(high_noise, hz));
}

}  // namespace straytrace
