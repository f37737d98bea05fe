// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cmath>

#include "base/constants.hpp"
#include "trace/result.hpp"

namespace straytrace {

void Moments::add(double total, std::uint64_t history) {
  if (total == 0) return;
  double const square = total * total;
  sum += total;
  sum2 += square;
  sum3 += square * total;
  sum4 += square * square;
  ++scored;
  if (std::fabs(total) > largest) {
    largest = std::fabs(total);
    largest_history = history;
  }
}

Moments merged(Moments const& left, Moments const& right) {
  Moments m = left;
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

namespace {

// Why an estimate is not to be trusted, in words (estimators.md 13); empty when it is.
std::string objection(Estimate const& e, std::uint64_t blocks) {
  if (e.scored == 0) return "no history has scored";
  if (e.scored < 100) return fmt::format("only {} histories have scored", e.scored);
  if (e.effective_scores < 100) return fmt::format("worth only {:.0f} equal scores", e.effective_scores);
  if (e.largest_share > 0.05) return fmt::format("one history carries {:.0f} % of the sum", 100 * e.largest_share);
  if (e.variance_of_variance > 0.1) return fmt::format("variance of variance is {:.2f}", e.variance_of_variance);
  if (blocks < 32) return fmt::format("only {} blocks of histories were run (32 are needed)", blocks);
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
  e.why_not = objection(e, blocks);
  e.trusted = e.why_not.empty();
  return e;
}

}  // namespace straytrace
