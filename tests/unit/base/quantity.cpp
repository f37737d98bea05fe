// SPDX-License-Identifier: BSD-3-Clause
// Units and dimensions, and the nearest word (docs/reference/scene.md).
#include "base/units/quantity.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/input/document.hpp"

namespace straytrace {
namespace {

// Relative deviation of a unit's factor; infinite when the text or its dimension is an error.
double deviation(std::string const& text, double factor, Dimension d) {
  auto const unit = parse_unit(text);
  if (!unit || !(unit->dimension == d)) return infinity;
  return std::abs(unit->si / factor - 1);
}

struct Case {
  char const* text;
  double factor;
  Dimension dimension;
};

TEST(Quantity, EveryUnitOfTheLanguage) {
  Dimension const sr{0, 0, 0, 0, 2}, count{0, 0, 0, 0, 0, 2}, volt{0, 0, 0, 0, 0, 0, 2};
  std::vector<Case> const cases{{"m", 1, dim::length},
                                {"km", 1e3, dim::length},
                                {"cm", 1e-2, dim::length},
                                {"mm", 1e-3, dim::length},
                                {"um", 1e-6, dim::length},
                                {"nm", 1e-9, dim::length},
                                {"in", 0.0254, dim::length},
                                {"rad", 1, dim::angle},
                                {"mrad", 1e-3, dim::angle},
                                {"urad", 1e-6, dim::angle},
                                {"deg", pi / 180, dim::angle},
                                {"arcmin", pi / 180 / 60, dim::angle},
                                {"arcsec", pi / 180 / 3600, dim::angle},
                                {"sr", 1, sr},
                                {"s", 1, dim::time},
                                {"ms", 1e-3, dim::time},
                                {"us", 1e-6, dim::time},
                                {"min", 60, dim::time},
                                {"h", 3600, dim::time},
                                {"Hz", 1, dim::frequency},
                                {"kHz", 1e3, dim::frequency},
                                {"mHz", 1e-3, dim::frequency},
                                {"W", 1, dim::power},
                                {"kW", 1e3, dim::power},
                                {"mW", 1e-3, dim::power},
                                {"kg", 1, dim::mass},
                                {"g", 1e-3, dim::mass},
                                {"count", 1, count},
                                {"V", 1, volt},
                                {"%", 1e-2, dim::plain},
                                {"ppm", 1e-6, dim::plain},
                                {"ppb", 1e-9, dim::plain},
                                {"\xc2\xb5m", 1e-6, dim::length},
                                {"\xce\xbcrad", 1e-6, dim::angle}};
  for (Case const& c : cases) {
    EXPECT_LT(deviation(c.text, c.factor, c.dimension), 1e-15) << c.text;
    EXPECT_GT(deviation(c.text, c.factor * 1.001, c.dimension), 1e-15) << c.text << ": negative control";
  }
}

TEST(Quantity, JoinedUnits) {
  EXPECT_LT(deviation("/sr", 1, dim::brdf), 1e-15);
  EXPECT_LT(deviation("1/sr", 1, dim::brdf), 1e-15);
  EXPECT_LT(deviation("m/sqrt(Hz)", 1, dim::displacement_asd), 1e-15);
  EXPECT_LT(deviation("nm/sqrt(Hz)", 1e-9, dim::displacement_asd), 1e-15);
  EXPECT_LT(deviation("um / sqrt( mHz )", 1e-6 / std::sqrt(1e-3), dim::displacement_asd), 1e-15);
  EXPECT_LT(deviation("um^2/Hz", 1e-12, dim::displacement_psd), 1e-14);
  EXPECT_LT(deviation("urad/Hz^(1/2)", 1e-6, dim::angle_asd), 1e-15);
  EXPECT_LT(deviation("urad/Hz^0.5", 1e-6, dim::angle_asd), 1e-15);
  EXPECT_LT(deviation("um/s^2/count", 1e-6, {2, 0, -4, 0, 0, -2, 0}), 1e-15);
  EXPECT_LT(deviation("um/(s^2*count)", 1e-6, {2, 0, -4, 0, 0, -2, 0}), 1e-15);
  EXPECT_LT(deviation("m*s^-1", 1, {2, 0, -2}), 1e-15);
  // Controls: the power density is not the amplitude density, and a division is not a product.
  EXPECT_EQ(deviation("m/Hz", 1, dim::displacement_asd), infinity);
  EXPECT_EQ(deviation("um*s^2/count", 1e-6, {2, 0, -4, 0, 0, -2, 0}), infinity);
}

TEST(Quantity, UnknownUnitsAreErrors) {
  for (char const* text : {"",  "metre", "M",   "hz", "m/", "m//s",   "sqrt(m", "sqrt(m))", "m^",  "m^0.3",
                           "1", "2 m",   "m m", "/",  "*m", "min(m)", "m^99",   "()",       "kkm", "m s"})
    EXPECT_EQ(parse_unit(text).has_value(), std::string_view(text) == "1") << text;
  EXPECT_FALSE(parse_unit(std::string(5000, '(')).has_value());
  EXPECT_FALSE(parse_unit("m/" + std::string(5000, '(')).has_value());
}

TEST(Quantity, LeadingUnitStopsWhereTheUnitEnds) {
  auto const length_of = [](std::string_view text) { return leading_unit(text) ? leading_unit(text)->length : 0; };
  EXPECT_EQ(length_of("m - L"), 1u);
  EXPECT_EQ(length_of(" m/sqrt(Hz) + a"), 11u);
  EXPECT_EQ(length_of(" /sr"), 4u);
  EXPECT_EQ(length_of(" m/L"), 2u);
  EXPECT_EQ(length_of(" m*sqrt(w)"), 2u);
  EXPECT_EQ(length_of("/2"), 0u);
  EXPECT_EQ(length_of(" m*min(a, b)"), 2u);
}

TEST(Quantity, DecimalUnitsGiveTheNearestDouble) {
  EXPECT_EQ(to_si(1064, *parse_unit("nm")), 1064e-9);
  EXPECT_EQ(to_si(5, *parse_unit("ppm")), 5e-6);
  EXPECT_EQ(to_si(0.2, *parse_unit("mm")), 0.2e-3);
  EXPECT_EQ(to_si(84, *parse_unit("cm")), 0.84);
  EXPECT_NE(1064 * 1e-9 + 1e-21, 1064e-9);  // the comparison sees one unit in the last place
}

TEST(Quantity, NamesForMessages) {
  EXPECT_EQ(described(dim::length), "a length");
  EXPECT_EQ(described(dim::angle), "an angle");
  EXPECT_EQ(described(dim::plain), "a plain number");
  EXPECT_EQ(described({2, 2, -2}), "a quantity in m*kg/s");
  EXPECT_EQ(described({0, 0, 1}), "a quantity in 1/sqrt(Hz)");
  EXPECT_EQ(accepted_units(dim::angle), "rad, mrad, urad, deg, arcmin, arcsec");
  EXPECT_EQ(with_unit("1e-4", dim::brdf), "1e-4 /sr");
  for (Dimension const d : {dim::length, dim::per_metre, dim::angle, dim::mass, dim::time, dim::frequency, dim::power,
                            dim::brdf, dim::displacement_asd, dim::displacement_psd, dim::angle_asd, dim::angle_psd,
                            Dimension{1, 3, -5, 0, 0, 2, 1}}) {
    auto const unit = parse_unit(example_unit(d));
    ASSERT_TRUE(unit.has_value()) << example_unit(d);
    EXPECT_EQ(unit->dimension, d) << example_unit(d);
  }
}

TEST(Quantity, PowersOfDimensions) {
  EXPECT_EQ(power_of(dim::length, 0.5), (Dimension{1}));
  EXPECT_FALSE(power_of(dim::length, 0.3).has_value());
  EXPECT_FALSE(power_of(dim::length, 1e9).has_value());
  EXPECT_FALSE(power_of(dim::length, not_a_number).has_value());
  EXPECT_EQ(times(dim::length, dim::time, -1), (Dimension{2, 0, -2}));
}

TEST(Words, NearestByEditDistance) {
  std::vector<std::string> const words{"height", "inner_radius", "dlc", "steel"};
  EXPECT_EQ(nearest_word("heigth", words), "height");
  EXPECT_EQ(nearest_word("dcl", words), "dlc");
  EXPECT_EQ(nearest_word("Steel", words), "steel");
  EXPECT_EQ(nearest_word("innerradius", words), "inner_radius");
  EXPECT_EQ(nearest_word("wall", words), "");
  EXPECT_EQ(nearest_word("", words), "");
  EXPECT_EQ(nearest_word(std::string(100000, 'x'), words), "");
}

}  // namespace
}  // namespace straytrace
