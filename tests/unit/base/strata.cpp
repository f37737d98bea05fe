// SPDX-License-Identifier: BSD-3-Clause
// Numbers that are dealt to the histories of a block (docs/theory/sampling.md, Strata).
#include "base/math/strata.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace straytrace::testing::strata {
namespace {

constexpr std::array pairs{Dealt::direction, Dealt::source, Dealt::end, Dealt::end_direction, Dealt::second_direction};

constexpr std::size_t axes = 2 * pairs.size() + 1;
using Point = std::array<double, axes>;

// Of a history, before and after dealing.
Point random_point(std::uint64_t seed, std::uint64_t history) {
  Rng rng(seed, history, 0, Stream::source);
  Point p;
  for (double& x : p) x = rng.uniform();
  return p;
}
Point dealt_point(std::uint64_t seed, std::uint64_t history, std::uint64_t block_size) {
  Point p = random_point(seed, history);
  Strata const strata(seed, history, block_size);
  for (std::size_t i = 0; i < pairs.size(); ++i) strata.deal(pairs[i], p[2 * i], p[2 * i + 1]);
  p.back() = strata.deal(Dealt::second_choice, p.back());
  return p;
}

// The fullest of `columns` x `rows` boxes over two axes.
std::size_t most_in_a_box(std::vector<Point> const& points, std::size_t a, std::size_t b, std::size_t columns,
                          std::size_t rows) {
  std::vector<std::size_t> count(columns * rows);
  for (Point const& p : points) ++count[std::size_t(p[a] * double(columns)) * rows + std::size_t(p[b] * double(rows))];
  return *std::ranges::max_element(count);
}

// Every history has a cell of its own on each axis, for each size of a block. Control: random numbers share cells.
TEST(strata, one_history_in_each_cell) {
  for (std::uint64_t const size : {8u, 64u, 512u, 4096u})
    for (std::uint64_t const block : {0u, 7u}) {
      std::vector<Point> dealt, random;
      for (std::uint64_t n = block * size; n < (block + 1) * size; ++n) {
        dealt.push_back(dealt_point(3, n, size));
        random.push_back(random_point(3, n));
      }
      for (std::size_t axis = 0; axis < axes; ++axis) {
        EXPECT_EQ(most_in_a_box(dealt, axis, axis == 0, size, 1), 1u) << size << " " << axis;
        if (size > 8) {
          EXPECT_GT(most_in_a_box(random, axis, axis == 0, size, 1), 1u) << "control";
        }
      }
    }
}

// The direction is a (0, 2)-sequence: any 256 consecutive histories that start at a multiple of 256 have one in each of
// 2^a x 2^(8-a) boxes; those of the other pairs at most two. Control: random numbers.
TEST(strata, consecutive_histories_fill_the_square) {
  std::vector<Point> dealt, random;
  for (std::uint64_t n = 4096 + 512; n < 4096 + 768; ++n) {
    dealt.push_back(dealt_point(5, n, 4096));
    random.push_back(random_point(5, n));
  }
  for (std::size_t columns = 1; columns <= 256; columns *= 2)
    EXPECT_EQ(most_in_a_box(dealt, 0, 1, columns, 256 / columns), 1u) << columns;
  for (std::size_t kind = 0; kind < pairs.size(); ++kind) {
    EXPECT_LE(most_in_a_box(dealt, 2 * kind, 2 * kind + 1, 16, 16), 2u);
    EXPECT_GT(most_in_a_box(random, 2 * kind, 2 * kind + 1, 16, 16), 2u) << "control";
  }
}

// Over blocks, the numbers of one history are uniform and independent: 8 x 8 boxes of each two axes. Control: the
// histories of one block, which avoid each other.
TEST(strata, numbers_of_one_history_are_independent) {
  constexpr std::size_t blocks = 64 * 100;
  for (std::uint64_t const place : {0u, 77u, 4095u}) {
    std::vector<Point> points;
    for (std::uint64_t block = 0; block < blocks; ++block)
      points.push_back(dealt_point(11, block * 4096 + place, 4096));
    for (std::size_t a = 0; a < axes; ++a)
      for (std::size_t b = 0; b < a; ++b) {
        std::vector<std::uint64_t> count(64);
        for (Point const& p : points) ++count[std::size_t(p[a] * 8) * 8 + std::size_t(p[b] * 8)];
        double chi2 = 0;
        for (auto const n : count) chi2 += std::pow(double(n) - 100, 2) / 100;
        EXPECT_LT(std::fabs(chi2 - 63), 5 * std::sqrt(2 * 63.0)) << a << " " << b;
      }
  }
  std::vector<std::uint64_t> count(64);
  for (std::uint64_t n = 0; n < 4096; ++n) {
    Point const p = dealt_point(11, n, 4096);
    ++count[std::size_t(p[0] * 8) * 8 + std::size_t(p[1] * 8)];
  }
  for (auto const n : count) EXPECT_EQ(n, 64u) << "control";
}

// A smooth integrand: means of blocks scatter 30 times less than those of random numbers, about the same mean.
TEST(strata, blocks_agree) {
  auto const spread = [](auto const& point_of) {
    double sum = 0, squares = 0;
    for (std::uint64_t block = 0; block < 200; ++block) {
      double mean = 0;
      for (std::uint64_t n = 0; n < 512; ++n) {
        Point const p = point_of(block * 512 + n);
        mean += std::exp(p[0] - p[1]) * (1 + p[2] * p[3]) / 512;
      }
      sum += mean, squares += mean * mean;
    }
    double const mean = sum / 200;
    return std::pair(mean, std::sqrt(squares / 200 - mean * mean));
  };
  double const exact = (std::exp(1) - 1) * (1 - std::exp(-1)) * 1.25;
  auto const [dealt, scatter] = spread([](std::uint64_t n) { return dealt_point(2, n, 512); });
  auto const [random, control] = spread([](std::uint64_t n) { return random_point(2, n); });
  EXPECT_LT(std::fabs(dealt - exact), 5 * scatter / std::sqrt(200.0));
  EXPECT_LT(std::fabs(random - exact), 5 * control / std::sqrt(200.0));
  EXPECT_LT(30 * scatter, control) << scatter << " " << control;
}

TEST(strata, open_interval) {
  for (double const x : {0x1p-53, 1 - 0x1p-53})
    for (std::uint64_t n = 0; n < 4096; ++n) {
      double u = x, v = x;
      Strata(1, n, 4096).deal(Dealt::direction, u, v);
      for (double const y : {u, v}) {
        EXPECT_GT(y, 0);
        EXPECT_LT(y, 1);
      }
    }
}

}  // namespace
}  // namespace straytrace::testing::strata
