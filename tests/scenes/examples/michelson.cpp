// SPDX-License-Identifier: BSD-3-Clause
// Rings of a Michelson (E.2a, R4.02): mirrors of 2.2 m and 9.2 m, 0.25 um apart. The spots are
// magnified differently, so that fields sqrt(P/area) have contrast 0.9757; rays counted as amplitudes 0.9085.
#include <complex>

#include "results/receivers/receivers.hpp"
#include "scenes/benches.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing::app_michelson {
namespace {

constexpr double wavelength = 600e-9, pixel = 150e-6;
constexpr std::size_t side = 80;

double squared_radius(std::size_t i) {
  double const u = (double(i % side) - 0.5 * (side - 1)) * pixel, v = (double(i / side) - 0.5 * (side - 1)) * pixel;
  return u * u + v * v;
}

// I = a + b cos(2 pi (offset + curvature rho^2)/lambda) by least squares over a disc; contrast b/a, and what is left.
struct Rings {
  double contrast = 0, residual = 0;
};
Rings rings_of(std::vector<double> const& irradiance, double radius, double offset, double curvature) {
  double n = 0, c = 0, cc = 0, y = 0, yc = 0, yy = 0;
  for (std::size_t i = 0; i < irradiance.size(); ++i) {
    double const rho2 = squared_radius(i), value = irradiance[i];
    if (rho2 > radius * radius) continue;
    double const cosine = std::cos(2 * M_PI * (offset + curvature * rho2) / wavelength);
    n += 1, c += cosine, cc += cosine * cosine, y += value, yc += value * cosine, yy += value * value;
  }
  double const b = (yc - c * y / n) / (cc - c * c / n), a = (y - b * c) / n;
  return {b / a, yy - a * y - b * yc};
}

struct Michelson {
  Folder folder;
  RunFile run = traced_in(folder, "a.h5", {benches + "michelson.yaml"});
  ReceiverSums const& sums(std::size_t port) const { return run.trace.total.receivers.at(port); }
  double histories() const { return double(run.trace.total.histories); }
  std::vector<double> irradiance(std::size_t port) const {
    std::vector<double> out;
    for (auto const& e :
         field_map(run.about.receivers.at(port), sums(port), run.trace.total.histories, run.about.map_areas.at(port))
             .field)
      out.push_back(std::norm(e));
    return out;
  }
  double power(std::size_t port) const {  // interference included
    double sum = 0;
    for (double const i : irradiance(port)) sum += i * pixel * pixel;
    return sum;
  }
};

// Some 80 rays of each arm in a pixel leave the contrast of fields 0.003 low, as a root of what scatters is.
TEST(MichelsonRings, ContrastRadiiAndPowersE2a) {
  Michelson const m;
  std::vector<double> const seen = m.irradiance(0);
  ASSERT_EQ(seen.size(), side * side);
  EXPECT_NEAR(rings_of(seen, 1.4e-3, 0.5e-6, 0.48799).contrast, 0.9757, 0.01);
  EXPECT_LT(rings_of(seen, 1.4e-3, 0.5e-6, 0.48799 / 2).contrast, 0.5) << "control: one pass of the mirrors";
  std::vector<double> counted;  // control: the power of a pixel taken as its amplitude
  for (std::size_t i = 0; i < seen.size(); ++i) {
    std::complex<double> sum;
    for (auto const& [route, f] : m.sums(0).fields)
      sum += std::polar(f.power[i], std::atan2(f.imaginary[i], f.real[i]));
    counted.push_back(std::norm(sum));
  }
  EXPECT_NEAR(rings_of(counted, 1.4e-3, 0.5e-6, 0.48799).contrast, 0.9085, 0.02);

  // Rings as they are: the best offset and curvature, and from them the radii.
  double offset = 0, curvature = 0, best = 1e300;
  for (double o = 0.45e-6; o < 0.55e-6; o += 1e-9)
    for (double c = 0.47; c < 0.505; c += 2.5e-4)
      if (Rings const r = rings_of(seen, 1.8e-3, o, c); r.residual < best) best = r.residual, offset = o, curvature = c;
  double const bright[] = {0.4527, 1.1977, 1.6322, 1.9732, 2.2634, 2.5204, 2.7536, 2.9685},
               dark[] = {0.9054, 1.4315, 1.8107, 2.1233, 2.3954, 2.6396, 2.8630};  // mm
  auto const radius = [&](double order) { return 1e3 * std::sqrt((order * wavelength - offset) / curvature); };
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(radius(1.0 + double(i)), bright[i], 0.01) << i;
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(radius(1.5 + double(i)), dark[i], 0.01) << i;
  EXPECT_GT(std::fabs(radius(1.5) - bright[0]), 0.1) << "control: the other port";

  // Spots: a disc of even light has the mean square radius R^2/2.
  std::vector<double> spots;
  for (auto const& [route, f] : m.sums(0).fields) {
    double power = 0, moment = 0;
    for (std::size_t i = 0; i < f.power.size(); ++i) power += f.power[i], moment += f.power[i] * squared_radius(i);
    spots.push_back(1e3 * std::sqrt(2 * moment / power));
  }
  ASSERT_EQ(spots.size(), 2u);
  EXPECT_NEAR(std::fmin(spots[0], spots[1]), 4.3308, 0.01);
  EXPECT_NEAR(std::fmax(spots[0], spots[1]), 5.4106, 0.01);

  // Both ports together: the input. The detector alone: 1/4 + 1/4 and the beat of even discs over the smaller one.
  double const rx = 4.3308e-3, ry = 5.4106e-3, k = 2 * M_PI / wavelength;
  double const beat =
      (std::sin(k * (0.5e-6 + 0.48799 * rx * rx)) - std::sin(k * 0.5e-6)) / (k * 0.48799) / (2 * rx * ry);
  EXPECT_NEAR(m.power(0), 0.5 + beat, 0.02);
  EXPECT_NEAR(m.power(0) + m.power(1), 1, 0.035);  // seeds scatter by 0.004 and 0.007: rays of the pixels
  // Receivers count the sum without interference; a splitter with pi on each reflection would make both ports
  // bright in the middle (C3.1).
  std::vector<double> const back = m.irradiance(1);
  std::size_t const middle = side / 2 * side + side / 2;
  EXPECT_NEAR(seen[middle] / (seen[middle] + back[middle]), 0.75, 0.05);  // cos^2(pi 0.8333)
}

}  // namespace
}  // namespace straytrace::testing::app_michelson
