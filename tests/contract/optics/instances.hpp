// SPDX-License-Identifier: BSD-3-Clause
// For every type in LawTypes: laws with their parameters, and the angle, or offset, inside which their lobe is flat. A
// law without them does not compile here.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/math/rng.hpp"
#include "support/laws.hpp"

namespace straytrace::testing {

template <class List>
struct TypesOf;
template <class... T>
struct TypesOf<std::tuple<T...>> {
  using type = ::testing::Types<T...>;
};
using AllLaws = TypesOf<LawTypes>::type;

template <class Law>
std::vector<Law> const& instances();
// Largest eval cos/pdf over its mean. Lobes that are not even along a ring about the specular direction may do worse.
template <class Law>
inline constexpr double weight_limit = 3.2;

template <>
inline std::vector<Lambertian> const& instances() {
  static std::vector<Lambertian> const all{lambertian(0.1), lambertian(0.95)};
  return all;
}
inline double finest(Lambertian const&) { return 0.1; }

template <>
inline std::vector<PowerLaw> const& instances() {
  static std::vector<PowerLaw> const all{power_law(1e-3, 2, 5e-5), power_law(3e-9, 2.3986, 5e-5),
                                         power_law(1e-4, 3.1, 1e-2)};
  return all;
}
inline double finest(PowerLaw const& l) { return l.above; }

template <>
inline std::vector<Abg> const& instances() {
  static std::vector<Abg> const all{abg(0.0025, 0.001, 1.8), abg(1e-6, 1e-8, 2.5), abg(0.1, 0.5, 3)};
  return all;
}
inline double finest(Abg const& l) { return 1e-2 * std::pow(l.b, 1 / l.g); }

template <>
inline std::vector<Harvey> const& instances() {
  static std::vector<Harvey> const all{harvey(1, 0.01, -1.5), harvey(20, 1e-3, -2.7), harvey(0.5, 0.05, -2, 0.02)};
  return all;
}
inline double finest(Harvey const& l) { return 0.1 * std::fmin(l.width, l.across > 0 ? l.across : l.width); }
template <>
inline constexpr double weight_limit<Harvey> = 7;  // stretched

template <>
inline std::vector<Gaussian> const& instances() {
  static std::vector<Gaussian> const all{gaussian(50, 0.02), gaussian(0.2, 0.5)};
  return all;
}
inline double finest(Gaussian const& l) { return 0.1 * l.width; }

template <>
inline std::vector<Polynomial> const& instances() {
  static std::vector<Polynomial> const all{polynomial(0.005, 0.001, 0.002, 0, 0.2, 1),
                                           polynomial(0.01, 0, -0.005, 3, 0.1, 2)};
  return all;
}
inline double finest(Polynomial const& l) { return 0.1 * l.width; }
template <>
inline constexpr double weight_limit<Polynomial> = 4;  // the forward lobe of black paint

inline Roughness of_stack(Roughness law, RoughStack const& stack, Storage& storage) {
  law.stack = stack.tabulated(storage);
  law.prepare();
  return law;
}
template <>
inline std::vector<Roughness> const& instances() {
  PolarisationFactor const silicon{12.1, 0.01, 1};
  static Storage storage;
  static RoughStack const mirror{
      {{{2.07, 0}, 0.1285e-6}, {{1.45, 0}, 0.1834e-6}, {{2.07, 0}, 0.1285e-6}}, {1.45, 0}, 1.064e-6, 0.3};
  static std::vector<Roughness> const all{tabulated(Theory::harvey_shack, 1e-6, 2.1, 1e-3, 0.9, false),
                                          k_correlation(Theory::harvey_shack, 0.08, 20, 2.5),
                                          of_stack(k_correlation(Theory::rayleigh_rice, 5e-3, 5, 2), mirror, storage),
                                          k_correlation(Theory::rayleigh_rice, 5e-3, 50, 2.2, silicon)};
  return all;
}
inline double finest(Roughness const& l) { return 0.1 * (l.b > 0 ? 1 / l.b : l.first); }

template <>
inline std::vector<Dust> const& instances() {
  static std::vector<Dust> const all{dust(500, 1, 1.55, 0.01), dust(200, 0.1, 1.5, 0.02)};
  return all;
}
inline double finest(Dust const& l) { return 0.3 * l.smallest; }
template <>
inline constexpr double weight_limit<Dust> = 6;  // the glory of transparent grains

template <>
inline std::vector<Measured> const& instances() {
  static std::vector<Measured> const all{measured(0.02, 1, Beyond::power), measured(0.1, 0.5, Beyond::constant)};
  return all;
}
inline double finest(Measured const& l) { return l.first; }

template <>
inline std::vector<Microfacet> const& instances() {
  static std::vector<Microfacet> const all{microfacet(0.05, 0.3, 1), microfacet(0.3, 0.9, 0.9),
                                           microfacet(0.9, 0.5, 1)};
  return all;
}
inline double finest(Microfacet const& l) { return 0.1 * l.alpha; }

template <>
inline std::vector<Grooves> const& instances() {
  static std::vector<Grooves> const all{grooves(0.3, 0.05, 0.6, 1), grooves(0.8, 0.2, 0.9, 0.9)};
  return all;
}
inline double finest(Grooves const& l) { return 0.1 * l.along; }

}  // namespace straytrace::testing
