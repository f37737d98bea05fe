// SPDX-License-Identifier: BSD-3-Clause
// Comparisons of tests that remember what they compared, so that docs/theory/validation.md can show what was obtained:
// the macros of GoogleTest, doing what they did. Every test that the page names includes this file; recorded.cpp prints
// the comparisons of each test that passed (ctest -V) and writes them to build/validation.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <source_location>
#include <type_traits>

namespace straytrace::testing {

// |value/expected - 1|. Compared with a limit it is recorded as its two numbers.
struct Deviation {
  double value, expected;
  operator double() const { return std::fabs(value / expected - 1); }
};
inline Deviation deviation(double value, double expected) { return {value, expected}; }

namespace recorded {

enum class Kind { near, mean, below, above, equal };

struct Comparison {
  Kind kind;
  char const* file;
  unsigned line;
  char const *what, *against;  // text of the source
  double obtained, expected;   // expected: the limit of below and above
  double allowed = 0;          // near: the tolerance; mean: one standard error; otherwise not used
};

// Records a comparison that holds; a failed one gives no result.
void record(Comparison const& c);

struct Site {
  char const* file;
  unsigned line;

 protected:
  template <class A, class B>
  void compared(Kind kind, char const* a, char const* b, A const& x, B const& y) const {
    constexpr bool numbers = std::is_convertible_v<A, double> && std::is_convertible_v<B, double> &&
                             !std::is_same_v<A, bool> && !std::is_same_v<A, char> && std::is_trivially_copyable_v<A> &&
                             std::is_trivially_copyable_v<B>;  // JSON converts too
    if constexpr (std::is_same_v<A, Deviation>) {
      if (kind == Kind::below)
        return record({Kind::near, file, line, a, b, x.value, x.expected, double(y) * std::fabs(x.expected)});
    }
    if constexpr (numbers) record({kind, file, line, a, b, static_cast<double>(x), static_cast<double>(y)});
  }
  template <class T>
  static T const& plain(T const& x) {
    return x;
  }
  static double plain(Deviation const& x) { return x; }
};

struct Near : Site {
  ::testing::AssertionResult operator()(char const* a, char const* b, char const* t, double x, double y,
                                        double tolerance) const {
    auto const r = ::testing::internal::DoubleNearPredFormat(a, b, t, x, y, tolerance);
    if (r) record({Kind::near, file, line, a, b, x, y, tolerance});
    return r;
  }
};

#define STRAYTRACE_RECORDED(Name, helper, kind)                                                         \
  struct Name : Site {                                                                                  \
    template <class A, class B>                                                                         \
    ::testing::AssertionResult operator()(char const* a, char const* b, A const& x, B const& y) const { \
      auto const r = ::testing::internal::helper(a, b, plain(x), plain(y));                             \
      if (r) compared(kind, a, b, x, y);                                                                \
      return r;                                                                                         \
    }                                                                                                   \
  };
STRAYTRACE_RECORDED(Less, CmpHelperLT, Kind::below)
STRAYTRACE_RECORDED(LessEqual, CmpHelperLE, Kind::below)
STRAYTRACE_RECORDED(Greater, CmpHelperGT, Kind::above)
STRAYTRACE_RECORDED(GreaterEqual, CmpHelperGE, Kind::above)
STRAYTRACE_RECORDED(Equal, EqHelper::Compare, Kind::equal)
STRAYTRACE_RECORDED(DoubleEqual, CmpHelperFloatingPointEQ<double>, Kind::equal)
#undef STRAYTRACE_RECORDED

}  // namespace recorded

// A Monte-Carlo mean that was found to agree with theory.
inline void record_mean(char const* what, double mean, double std_error, double expected,
                        std::source_location const& at = std::source_location::current()) {
  recorded::record({recorded::Kind::mean, at.file_name(), at.line(), what, "expected", mean, expected, std_error});
}

}  // namespace straytrace::testing

#undef EXPECT_NEAR
#undef ASSERT_NEAR
#undef EXPECT_LT
#undef EXPECT_LE
#undef EXPECT_GT
#undef EXPECT_GE
#undef EXPECT_EQ
#undef EXPECT_DOUBLE_EQ
#define STRAYTRACE_AT(Name) (::straytrace::testing::recorded::Name{{__FILE__, __LINE__}})
#define EXPECT_NEAR(a, b, tolerance) EXPECT_PRED_FORMAT3(STRAYTRACE_AT(Near), a, b, tolerance)
#define ASSERT_NEAR(a, b, tolerance) ASSERT_PRED_FORMAT3(STRAYTRACE_AT(Near), a, b, tolerance)
#define EXPECT_LT(a, b) EXPECT_PRED_FORMAT2(STRAYTRACE_AT(Less), a, b)
#define EXPECT_LE(a, b) EXPECT_PRED_FORMAT2(STRAYTRACE_AT(LessEqual), a, b)
#define EXPECT_GT(a, b) EXPECT_PRED_FORMAT2(STRAYTRACE_AT(Greater), a, b)
#define EXPECT_GE(a, b) EXPECT_PRED_FORMAT2(STRAYTRACE_AT(GreaterEqual), a, b)
#define EXPECT_EQ(a, b) EXPECT_PRED_FORMAT2(STRAYTRACE_AT(Equal), a, b)
#define EXPECT_DOUBLE_EQ(a, b) EXPECT_PRED_FORMAT2(STRAYTRACE_AT(DoubleEqual), a, b)
