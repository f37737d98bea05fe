// SPDX-License-Identifier: BSD-3-Clause
#include "base/math/rng.hpp"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "support/chi_square.hpp"

namespace straytrace {
namespace {

using Words = std::array<std::uint32_t, 4>;

// Philox as Rng calls it.
Words philox(Words counter, std::array<std::uint32_t, 2> key) {
  auto const w = r123::Philox4x32()({{counter[0], counter[1], counter[2], counter[3]}}, {{key[0], key[1]}});
  return {w[0], w[1], w[2], w[3]};
}

double number(std::uint32_t low, std::uint32_t high) {
  return (static_cast<double>(((std::uint64_t(high) << 32) | low) >> 12) + 0.5) * 0x1p-52;
}

// Known-answer vectors of Random123 (kat_vectors, philox4x32 with 10 rounds).
TEST(rng, philox_known_answers) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  constexpr std::uint32_t all = 0xffffffff;
  EXPECT_EQ(philox({all, all, all, all}, {all, all}), (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

// The counter of Rng: history low, history high, event, stream << 16 + call; the second pair of words comes first.
TEST(rng, the_address_is_the_counter) {
  Rng zero(0, 0, 0, Stream::source);
  EXPECT_EQ(zero.uniform(), number(0xbc57ac4c, 0x9b00dbd8));
  EXPECT_EQ(zero.uniform(), number(0x6627e8d5, 0xe169c58d));

  std::uint64_t const seed = 0x299f31d0a4093822ull, history = 0x85a308d3243f6a88ull;
  Rng rng(seed, history, 0x13198a2e, Stream::window);
  for (std::uint32_t call = 0; call < 3; ++call) {
    Words const w = philox({0x243f6a88, 0x85a308d3, 0x13198a2e, (4u << 16) + call}, {0xa4093822, 0x299f31d0});
    EXPECT_EQ(rng.uniform(), number(w[2], w[3]));
    EXPECT_EQ(rng.uniform(), number(w[0], w[1]));
  }
}

TEST(rng, the_numbers_of_the_streams_are_part_of_the_run_file) {
  EXPECT_EQ(int(Stream::source), 0);
  EXPECT_EQ(int(Stream::lobe), 1);
  EXPECT_EQ(int(Stream::direction), 2);
  EXPECT_EQ(int(Stream::connection), 3);
  EXPECT_EQ(int(Stream::window), 4);
  EXPECT_EQ(int(Stream::record), 5);
}

TEST(rng, open_interval_at_both_ends) {
  EXPECT_GT(number(0, 0), 0);
  EXPECT_LT(number(0xffffffff, 0xffffffff), 1);
  EXPECT_EQ(number(0xffffffff, 0xffffffff), 1 - 0x1p-53);
}

TEST(rng, same_address_same_numbers) {
  Rng a(7, 11, 13, Stream::lobe), b(7, 11, 13, Stream::lobe);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.uniform(), b.uniform());
}

TEST(rng, skips_numbers) {
  for (std::uint32_t count = 0; count < 7; ++count) {
    Rng jumps(7, 11, 13, Stream::record), walks = jumps;
    jumps.skip(count);
    for (std::uint32_t i = 0; i < count; ++i) walks.uniform();
    for (int i = 0; i < 3; ++i) EXPECT_EQ(jumps.uniform(), walks.uniform()) << count;
  }
}

TEST(rng, every_part_of_the_address_matters) {
  std::set<double> seen;
  std::size_t drawn = 0;
  for (std::uint64_t seed : {0ull, 1ull, 1ull << 32})
    for (std::uint64_t history : {0ull, 1ull, 1ull << 32, 1ull << 63})
      for (std::uint32_t event : {0u, 1u, 0xffffffffu})
        for (Stream s :
             {Stream::source, Stream::lobe, Stream::direction, Stream::connection, Stream::window, Stream::record}) {
          Rng rng(seed, history, event, s);
          for (int i = 0; i < 20; ++i, ++drawn) seen.insert(rng.uniform());
        }
  EXPECT_EQ(seen.size(), drawn);
}

// Pairs of successive numbers fill the square evenly; `number` is what is put to the test.
template <class Draw>
testing::ChiSquare evenness(Draw draw) {
  constexpr int side = 32, n = 400000;
  std::vector<double> counts(side * side), expected(side * side, double(n) / (side * side));
  for (int i = 0; i < n; ++i) {
    Rng rng(5, std::uint64_t(i / 4), std::uint32_t(i % 4), Stream::direction);
    double const x = draw(rng), y = draw(rng);
    ++counts[std::size_t(int(side * x) * side + int(side * y))];
  }
  return testing::chi_square(counts, expected, 500);
}

TEST(rng, uniform_over_histories_and_events) {
  EXPECT_TRUE(testing::passes(evenness([](Rng& r) { return r.uniform(); }), 1));
  EXPECT_FALSE(testing::passes(evenness([](Rng& r) { return 0.98 * r.uniform(); }), 1));
  EXPECT_FALSE(testing::passes(evenness([](Rng& r) { return std::pow(r.uniform(), 1.05); }), 1));
}

}  // namespace
}  // namespace straytrace
