// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

#include "base/constants.hpp"
#include "trace/result.hpp"
#include "trace/tally/add_total.hpp"

namespace straytrace {

void Moments::add(double total, std::uint64_t history) { add_total(*this, total, history); }

namespace {

// Drops all but the largest, unordered.
void shorten(std::vector<double>& tail) {
  if (tail.size() <= tail_size) return;
  std::nth_element(tail.begin(), tail.begin() + tail_size, tail.end(), std::greater<>());
  tail.resize(tail_size);
}

}  // namespace

void Moments::add_score(double total, std::uint64_t history) {
  add(total, history);
  if (!(total > 0)) return;
  tail.push_back(total);
  if (tail.size() == 2 * tail_size) shorten(tail);
}

void Moments::close_block() {
  block_sum2 = sum * sum;
  shorten(tail);
  std::sort(tail.begin(), tail.end(), std::greater<>());
}

Moments merged(Moments const& left, Moments const& right) {
  Moments m = left;
  m.first_sum += right.first_sum;
  m.tail.resize(left.tail.size() + right.tail.size());
  std::merge(left.tail.begin(), left.tail.end(), right.tail.begin(), right.tail.end(), m.tail.begin(),
             std::greater<>());
  m.tail.resize(std::min(m.tail.size(), tail_size));
  m.sum += right.sum;
  m.sum2 += right.sum2;
  m.sum3 += right.sum3;
  m.sum4 += right.sum4;
  m.block_sum2 += right.block_sum2;
  m.scored += right.scored;
  if (right.largest > m.largest) {
    m.largest = right.largest;
    m.largest_history = right.largest_history;
  }
  return m;
}

std::uint64_t first_part(std::uint64_t blocks) {
  std::uint64_t const power = std::bit_floor(blocks);
  return blocks - power < power / 2 ? power / 2 : blocks == power ? 0 : power;
}

namespace {

// Exponent p of x^-p that the largest totals follow (Hill); the variance is finite above 3. Asked when they are the
// upper 1 % at most: further down they are no tail, and bounded distributions look like flat powers there.
double slope_of(std::vector<double> const& tail, std::uint64_t scored) {
  if (tail.size() < tail_size || scored < 100 * tail_size || std::isinf(tail[0])) return not_a_number;
  double logs = 0;
  for (double const x : tail) logs += std::log(x / tail.back());
  return logs > 0 ? 1 + double(tail_size - 1) / logs : infinity;
}

// Standard error of that exponent.
double error_of_slope(double slope) { return (slope - 1) / std::sqrt(double(tail_size)); }

// Mean of the first blocks less that of the rest, in standard errors from the spread of all blocks.
double difference_of_halves(Moments const& m, double blocks, double first) {
  double const rest = blocks - first, spread = (m.block_sum2 - m.sum * m.sum / blocks) / (blocks - 1);
  if (!(first > 0 && spread > 1e-12 * m.block_sum2)) return not_a_number;
  double const error = std::sqrt(spread * (1 / first + 1 / rest));
  return (m.first_sum / first - (m.sum - m.first_sum) / rest) / error;
}

constexpr double fewest = 100;  // scores, effective ones too

}  // namespace

std::string tail_objection(Estimate const& e) {
  if (double(e.scored) < fewest || e.effective_scores < fewest) return {};
  if (e.largest_share > 0.05) return fmt::format("one history carries {:.0f} % of the sum", 100 * e.largest_share);
  if (e.variance_of_variance > 0.1) return fmt::format("variance of variance is {:.2f}", e.variance_of_variance);
  // By two errors, not by chance: half of all good rows at the limit would be refused, those that met their tail.
  if (double const error = error_of_slope(e.tail_slope); e.tail_slope + 2 * error < 3)
    return fmt::format("the largest histories fall as slowly as x^-{:.2f} ± {:.2f}: too slowly for an error bar",
                       e.tail_slope, error);
  if (std::fabs(e.halves) > 5)
    return fmt::format("its first and second half differ by {:.0f} standard errors", std::fabs(e.halves));
  return {};
}

namespace {

// Why an estimate is not to be trusted, in words (estimators.md 13); empty when it is.
std::string objection(Estimate const& e, std::uint64_t blocks) {
  if (e.scored == 0) return "no history has scored";
  if (double(e.scored) < fewest)
    return e.scored == 1 ? "only 1 history has scored" : fmt::format("only {} histories have scored", e.scored);
  if (e.effective_scores < fewest) return fmt::format("only {:.0f} effective scores", e.effective_scores);
  if (std::string tail = tail_objection(e); !tail.empty()) return tail;
  if (blocks < 32)
    return fmt::format("only {} run (32 are needed)",
                       blocks == 1 ? "1 block of histories was" : fmt::format("{} blocks of histories were", blocks));
  return {};
}

}  // namespace

Estimate estimate(Moments const& m, std::uint64_t histories, std::uint64_t blocks) {
  Estimate e;
  e.scored = m.scored;
  double const n = double(histories), b = double(blocks);
  if (histories == 0 || m.scored == 0) {
    e.std_error = not_a_number;
    e.why_not = objection(e, blocks);
    return e;
  }
  e.mean = m.sum / n;
  double const spread = m.sum2 - m.sum * m.sum / n;  // of history totals
  double const history_error = n > 1 ? std::sqrt(std::fmax(spread, 0) / (n * (n - 1))) : not_a_number;
  if (blocks >= 32) {  // sum over blocks of (block sum - mean block sum)^2
    double const between = std::fmax(m.block_sum2 - m.sum * m.sum / b, 0);
    e.std_error = std::sqrt(between * b / (b - 1)) / n;
  } else {
    e.std_error = history_error;
  }
  if (spread * spread > 1e-10 * m.sum4) {  // below, equal totals: what is left is rounding
    double const mean = e.mean;
    double const fourth = m.sum4 - 4 * mean * m.sum3 + 6 * mean * mean * m.sum2 - 3 * n * mean * mean * mean * mean;
    e.variance_of_variance = std::fmax(fourth / (spread * spread) - 1 / n, 0);
  }
  e.effective_scores = m.sum2 > 0 ? m.sum * m.sum / m.sum2 : 0;
  e.largest_share = m.sum != 0 ? m.largest / std::fabs(m.sum) : 0;
  e.tail_slope = slope_of(m.tail, m.scored);
  if (blocks >= 32) e.halves = difference_of_halves(m, b, double(first_part(blocks)));
  e.why_not = objection(e, blocks);
  e.trusted = e.why_not.empty();
  return e;
}

}  // namespace straytrace
