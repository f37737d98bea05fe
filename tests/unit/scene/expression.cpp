// SPDX-License-Identifier: BSD-3-Clause
// Quantities and expressions of docs/reference/scene.md, read through the tables as every room reads them.
#include <cmath>

#include "unit/scene/support.hpp"

namespace straytrace::test {
namespace {

using ::testing::HasSubstr;

// Relative deviation from the expected value; infinite for an error.
double deviation(std::string const& text, Dimension d, double expected, std::string const& params = "") {
  double const v = value_of(text, d, params);
  if (std::isnan(v)) return infinity;
  return expected == 0 ? std::abs(v) : std::abs(v / expected - 1);
}

constexpr double close = 4e-16;  // two roundings

TEST(Expression, QuantitiesAsWritten) {
  EXPECT_LT(deviation("50 m", dim::length, 50), close);
  EXPECT_LT(deviation("60cm", dim::length, 0.6), close);
  EXPECT_LT(deviation("0.2 mm", dim::length, 2e-4), close);
  EXPECT_LT(deviation(".5 m", dim::length, 0.5), close);
  EXPECT_LT(deviation("-3.5e2 mm", dim::length, -0.35), close);
  EXPECT_LT(deviation("3 \xc2\xb5m", dim::length, 3e-6), close);
  EXPECT_LT(deviation("1e-8 /sr", dim::brdf, 1e-8), close);
  EXPECT_LT(deviation("2e-11 m/sqrt(Hz)", dim::displacement_asd, 2e-11), close);
  EXPECT_LT(deviation("6.1 um/s^2/count", {2, 0, -4, 0, 0, -2, 0}, 6.1e-6), close);
  EXPECT_LT(deviation("30 %", dim::plain, 0.3), close);
  EXPECT_LT(deviation("300 ppm", dim::plain, 3e-4), close);
  EXPECT_LT(deviation("2 ppb", dim::plain, 2e-9), close);
  EXPECT_LT(deviation("37 dB", dim::plain, std::pow(10, 3.7)), close);
  EXPECT_LT(deviation("-37 dB", dim::plain, std::pow(10, -3.7)), close);
  EXPECT_LT(deviation("'12 deg'", dim::angle, 12 * pi / 180), close);
  // Controls: the sign of the decibel and the size of the prefix matter.
  EXPECT_GT(deviation("37 dB", dim::plain, std::pow(10, -3.7)), close);
  EXPECT_GT(deviation("3 um", dim::length, 3e-3), close);
}

// As copied from typeset text. The place of a later mistake counts code points.
TEST(Expression, TypesetCharacters) {
  EXPECT_DOUBLE_EQ(value_of("5\xc2\xa0km", dim::length), 5000);
  EXPECT_DOUBLE_EQ(value_of("2*(5\xe2\x80\xafkm\xc2\xa0- 1 km)\xc2\xa0", dim::length), 8000);
  EXPECT_NEAR(value_of("-10\xc2\xa0"
                       "dB",
                       dim::plain),
              0.1, 1e-12);
  EXPECT_DOUBLE_EQ(value_of("5\xe2\x80\x89km\xe2\x80\x87", dim::length), 5000);
  EXPECT_THAT(error_text_of("5\xe2\x80\x89"
                            "000 m",
                            dim::length),
              HasSubstr("two numbers without an operator"));
  EXPECT_THAT(error_text_of("5\xc2\xa0kn", dim::length),
              ::testing::AllOf(HasSubstr("3:14:"), HasSubstr("'kn' is not a unit")));
  EXPECT_THAT(error_text_of("1 m + \xe2\x88\x92"
                            "3 m",
                            dim::length),
              ::testing::AllOf(HasSubstr("(U+2212)"), HasSubstr("3:18:"), HasSubstr("^ write an ASCII '-'"),
                               HasSubstr("\n1 error.")));
  EXPECT_DOUBLE_EQ(value_of("1 m + -3 m", dim::length), -2);  // control
}

TEST(Expression, OnlyZeroMayBeBare) {
  for (Dimension const d : {dim::length, dim::angle, dim::brdf, dim::plain}) {
    EXPECT_EQ(value_of("0", d), 0);
    EXPECT_EQ(value_of("-0.0", d), 0);
    EXPECT_EQ(value_of("a", d, "a: 0"), 0);
  }
  EXPECT_TRUE(std::isnan(value_of("1", dim::length)));
  EXPECT_TRUE(std::isnan(value_of("a", dim::length, "a: 1")));
  EXPECT_LT(deviation("'max(0, 3 m)'", dim::length, 3), close);
  EXPECT_LT(deviation("L - 0", dim::length, 3, "L: 3 m"), close);
}

TEST(Expression, Arithmetic) {
  std::string const params = "L: 3 km, w: 2 cm, n: 4, a: 30 deg";
  EXPECT_LT(deviation("L - 50 m", dim::length, 2950, params), close);
  EXPECT_LT(deviation("w/2", dim::length, 0.01, params), close);
  EXPECT_LT(deviation("sqrt(2)*w", dim::length, std::sqrt(2) * 0.02, params), close);
  EXPECT_LT(deviation("1 - 5 ppm", dim::plain, 1 - 5e-6, params), close);
  EXPECT_LT(deviation("1 - 5 ppm - 20 ppm", dim::plain, 1 - 25e-6, params), close);
  EXPECT_LT(deviation("2 + 3*4", dim::plain, 14, params), close);
  EXPECT_LT(deviation("(2 + 3)*4", dim::plain, 20, params), close);
  EXPECT_LT(deviation("-2^2", dim::plain, -4, params), close);
  EXPECT_LT(deviation("2^-1", dim::plain, 0.5, params), close);
  EXPECT_LT(deviation("2^3^2", dim::plain, 512, params), close);
  EXPECT_LT(deviation("8/2/2", dim::plain, 2, params), close);
  EXPECT_LT(deviation("L/n/w", dim::plain, 3000 / 4 / 0.02, params), close);
  EXPECT_LT(deviation("sqrt(w*w)", dim::length, 0.02, params), close);
  EXPECT_LT(deviation("(w^2)^0.5", dim::length, 0.02, params), close);
  EXPECT_LT(deviation("\"min(L, 1 m)\"", dim::length, 1, params), close);
  EXPECT_LT(deviation("\"atan2(1 m, 1 m)\"", dim::angle, pi / 4, params), close);
  EXPECT_LT(deviation("sin(a)", dim::plain, 0.5, params), close);
  EXPECT_LT(deviation("cos(60 deg)", dim::plain, 0.5, params), 1e-15);
  EXPECT_LT(deviation("tan(a)*L", dim::length, std::tan(pi / 6) * 3000, params), close);
  EXPECT_LT(deviation("log(exp(2))", dim::plain, 2, params), close);
  EXPECT_LT(deviation("abs(-3 m)", dim::length, 3, params), close);
  EXPECT_LT(deviation("curvature(L)", dim::per_metre, 1 / 3000.0, params), close);
  EXPECT_EQ(value_of("curvature(0)", dim::per_metre), 0);
  EXPECT_LT(deviation("'3 m*min(n, 2)'", dim::length, 6, params), close) << "min is a function here, not a minute";
  // Controls: precedence and association.
  EXPECT_GT(deviation("2 + 3*4", dim::plain, 20, params), close);
  EXPECT_GT(deviation("8/2/2", dim::plain, 8, params), close);
}

TEST(Expression, ParametersInAnyOrder) {
  EXPECT_LT(deviation("a", dim::length, 7, "a: b + 1 m, b: 2*c, c: 3 m"), close);
  std::string const circle = errors_of("params: {a: b, b: c + 1 m, c: a}\n");
  EXPECT_THAT(circle, HasSubstr("parameter 'a' depends on itself (a -> b -> c -> a)"));
  EXPECT_THAT(circle, HasSubstr("1 error. Nothing was run."));
  EXPECT_EQ(errors_of("params: {a: b, b: c + 1 m, c: 2 m}\n"), "");
}

TEST(Expression, DimensionsAreChecked) {
  std::string const params = "L: 3 km, t: 3 s, a: 1 deg";
  EXPECT_THAT(error_text_of("L - 50", dim::length, params), HasSubstr("cannot subtract a plain number from a length"));
  EXPECT_THAT(error_text_of("L - 50", dim::length, params), HasSubstr("^^^^^^ write 'L - 50 m'"));
  EXPECT_THAT(error_text_of("50 + L", dim::length, params), HasSubstr("write '50 m + L'"));
  EXPECT_THAT(error_text_of("L + t", dim::length, params), HasSubstr("cannot add a time to a length"));
  EXPECT_THAT(error_text_of("sin(L)", dim::plain, params),
              HasSubstr("sin() takes an angle or a plain number, got a length"));
  EXPECT_THAT(error_text_of("exp(a)", dim::plain, params), HasSubstr("exp() takes a plain number, got an angle"));
  EXPECT_THAT(error_text_of("\"min(L, t)\"", dim::length, params), HasSubstr("min() compares a length with a time"));
  EXPECT_THAT(error_text_of("2^L", dim::plain, params), HasSubstr("an exponent must be a plain number"));
  EXPECT_THAT(error_text_of("L^0.3", dim::plain, params), HasSubstr("cannot raise a length to this power"));
  EXPECT_THAT(error_text_of("L", dim::angle, params), HasSubstr("'x' is an angle, got \"L\" (a length)"));
  EXPECT_THAT(error_text_of("2*3", dim::angle, params), HasSubstr("'x' is an angle, got \"2*3\" (a plain number)"));
  EXPECT_THAT(error_text_of("55", dim::angle), HasSubstr("'x' is an angle, got \"55\" without a unit"));
  EXPECT_THAT(error_text_of("55", dim::angle),
              HasSubstr("write '55 deg' (accepted: rad, mrad, urad, deg, arcmin, arcsec)"));
  EXPECT_THAT(error_text_of("5 m", dim::plain), HasSubstr("'x' is a plain number, got \"5 m\" (a length)"));
}

TEST(Expression, ErrorsStateARemedy) {
  struct Case {
    char const *text, *what, *remedy;
  };
  std::vector<Case> const cases{
      {"5 metre", "'metre' is not a unit", "write '5 m'"},
      {"5 hz", "'hz' is not a unit", "write '5 Hz'"},
      {"5 zorks", "'zorks' is not a unit", "known units: m km"},
      {"2 L", "an operator is missing before 'L'", "write '2*L'"},
      {"aperure", "parameter 'aperure' is not defined", "did you mean 'aperture'?"},
      {"m", "unit 'm' has no number before it", "write '1 m'"},
      {"2*m", "unit 'm' has no number before it", "write '1 m'"},
      {"\"1,5 m\"", "a comma inside a number", "write a decimal point"},
      {"1 000 m", "two numbers without an operator between them", "without spaces"},
      {"(1 m", "a bracket is not closed", "add ')'"},
      {"sqrt(2", "a bracket is not closed", "add ')'"},
      {"1 +", "the expression ends too early", "add what follows"},
      {"\"\"", "the value is empty", "write a number"},
      {"1 m)", "cannot understand ')' here", "write a number"},
      {"asin(1)", "'asin' is not a function", "did you mean 'sin'?"},
      {"sqrt()", "sqrt() takes 1 argument, got 0", "check the commas"},
      {"\"sqrt(1, 2)\"", "sqrt() takes 1 argument, got 2", "check the commas"},
      {"1/0", "division by zero", "check '0'"},
      {"sqrt(-1)", "the square root of a negative number", "check the sign"},
      {"log(0)", "the result is not a finite number", "check for"},
      {"exp(1e9)", "the result is not a finite number", "check for"},
      {"1e999", "outside the range of double precision", "write a number"},
      {"1e-999", "outside the range of double precision", "write a number"},
      {"1e-320 nm", "the number is too small", "check the exponent"},
      {"-1e5 dB", "the number is too small", "write a value above"},
      {"nan", "'nan' is not a finite number", "write a number"},
      {"inf", "'inf' is not a finite number", "write a number"},
      {".inf", "cannot understand '.inf' here", "write a number"},
      {".nan", "cannot understand '.nan' here", "write a number"},
      {"0x10", "'x10' is not a unit", "known units"},
      {"2*3 dB", "dB must follow a single number", "write for example '37 dB'"},
      {"L rms", "is a length, not an amplitude", "remove the word"},
  };
  for (Case const& c : cases) {
    std::string const said = error_text_of(c.text, dim::length, "L: 3 m, aperture: 1 m");
    EXPECT_THAT(said, HasSubstr(c.what)) << c.text;
    EXPECT_THAT(said, HasSubstr(c.remedy)) << c.text;
    EXPECT_THAT(said, HasSubstr("1 error. Nothing was run.")) << c.text;
  }
}

Quantity amplitude_of(std::string const& text, std::string* said = nullptr) {
  Scene const scene = scene_of("params: {a: 2 um rms}\ntrace: {x: " + text + "}\n");
  Quantity const q = scene.table("trace").amplitude("x", dim::length);
  try {
    scene.throw_if_problems();
  } catch (InputError const& e) {
    if (said) *said = e.what();
  }
  return q;
}

TEST(Expression, AmplitudesNameTheirKind) {
  EXPECT_EQ(amplitude_of("10 um peak").amplitude, Amplitude::peak);
  EXPECT_EQ(amplitude_of("10 um pp").amplitude, Amplitude::peak_to_peak);
  EXPECT_EQ(amplitude_of("10 um rms").amplitude, Amplitude::rms);
  EXPECT_EQ(amplitude_of("10 um rms").si, 10e-6);
  EXPECT_EQ(amplitude_of("2*a").amplitude, Amplitude::rms);
  EXPECT_EQ(amplitude_of("0").si, 0);
  std::string said;
  EXPECT_TRUE(std::isnan(amplitude_of("10 um", &said).si));
  EXPECT_THAT(said, HasSubstr("\"10 um\" does not say which amplitude it is"));
  EXPECT_THAT(said, HasSubstr("^^^^^ write '10 um peak', '10 um pp' or '10 um rms'"));
  for (char const* text : {"10 um peek", "a + 10 um peak", "a*a", "a peak", "sqrt(a)", "10 s peak"}) {
    said.clear();
    EXPECT_TRUE(std::isnan(amplitude_of(text, &said).si)) << text;
    EXPECT_NE(said, "") << text;
  }
}

TEST(Expression, NamesThatBelongToTheLanguage) {
  for (char const* name :
       {"m", "h", "g", "V", "in", "ppm", "sqrt", "min", "peak", "dB", "1a", "a-b", "\xc3\xa4", "a b"})
    EXPECT_THAT(errors_of(std::string("params: {") + name + ": 1 m}\n"), HasSubstr("name a parameter")) << name;
  EXPECT_EQ(errors_of("params: {M: 1 m, H: 2, lambda: 1064 nm, a_b2: 3}\n"), "");
}

TEST(Expression, DepthIsLimited) {
  std::string const deep = std::string(60, '(') + "1" + std::string(60, ')');
  EXPECT_LT(deviation(deep, dim::plain, 1), close);
  for (char const c : {'(', '-', '+'}) EXPECT_NE(error_text_of("0 + " + std::string(200000, c) + "1", dim::plain), "");
  std::string powers = "1";
  for (int i = 0; i < 20000; ++i) powers += "^1";
  EXPECT_NE(error_text_of(powers, dim::plain), "");
  std::string roots;
  for (int i = 0; i < 20000; ++i) roots += "sqrt(";
  EXPECT_NE(error_text_of("1 m/" + roots, dim::plain), "");
  std::string sum = "1";
  for (int i = 0; i < 20000; ++i) sum += "+1";
  EXPECT_LT(deviation(sum, dim::plain, 20001), close) << "length alone is not depth";
  std::string chain = "params:\n";
  for (int i = 0; i < 5000; ++i) chain += "  p" + std::to_string(i) + ": p" + std::to_string(i + 1) + "\n";
  EXPECT_THAT(errors_of(chain + "  p5000: 1 m\n"), HasSubstr("depend on each other in a row"));
}

}  // namespace
}  // namespace straytrace::test
