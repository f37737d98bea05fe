// SPDX-License-Identifier: BSD-3-Clause
#include "trace/result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <functional>
#include <iterator>
#include <stdexcept>

#include "base/math/constants.hpp"
#include "trace/tally/block_sink.hpp"

namespace straytrace::trace {

char const* name_of(BalanceTerm balance_term) {
  static constexpr char const* names[] = {"absorbed", "escaped", "truncated", "roulette", "sampling"};
  return names[static_cast<int>(balance_term)];
}

namespace {
struct ByPriority {  // the largest first
  bool operator()(ScoreAddress const& a, ScoreAddress const& b) const {
    if (a.priority != b.priority) return a.priority > b.priority;
    if (a.history != b.history) return a.history < b.history;
    if (a.event != b.event) return a.event < b.event;
    return a.connection < b.connection;
  }
};
}  // namespace

std::size_t records_kept(std::uint64_t blocks) {
  return std::clamp<std::size_t>(2 * blocks, records_per_class, most_records);
}

void drop_smallest(ClassSums& sums) {
  std::erase_if(sums.kept, [&](ScoreAddress const& a) { return a.priority < sums.threshold; });
  if (sums.kept.size() <= records_per_class) return;
  auto const first_dropped = sums.kept.begin() + records_per_class;
  std::nth_element(sums.kept.begin(), first_dropped, sums.kept.end(), ByPriority());
  sums.threshold = std::max(sums.threshold, first_dropped->priority);
  sums.kept.resize(records_per_class);
}

void keep_largest(ClassSums& sums) {
  drop_smallest(sums);
  std::sort(sums.kept.begin(), sums.kept.end(), ByPriority());
}

namespace {

// The first `most` of two sorted lists together; of equal ones those of `a` come first.
template <class T, class Before>
std::vector<T> first_of_both(std::vector<T> const& a, std::vector<T> const& b, std::size_t most, Before const& before) {
  std::vector<T> all(std::min(a.size() + b.size(), most));
  auto i = a.begin(), j = b.begin();
  for (T& next : all) next = j == b.end() || (i != a.end() && !before(*j, *i)) ? *i++ : *j++;
  return all;
}

void merge(Moments& into, Moments const& from) {
  into.first_sum += from.first_sum;
  if (!from.tail.empty()) into.tail = first_of_both(into.tail, from.tail, tail_size, std::greater<>());
  into.sum += from.sum;
  into.sum2 += from.sum2;
  into.sum3 += from.sum3;
  into.sum4 += from.sum4;
  into.block_sum2 += from.block_sum2;
  into.scored += from.scored;
  if (from.largest > into.largest) {
    into.largest = from.largest;
    into.largest_history = from.largest_history;
  }
}

// Adds fields of scores; the sum over the first blocks keeps its value in `into`.
void merge_scores(Moments& into, Moments const& from) {
  double const first = into.first_sum;
  merge(into, from);
  into.first_sum = first;
}

// keep_largest() of the records of both, which are sorted.
void merge_records(ClassSums& into, ClassSums const& from, std::size_t most) {
  into.kept = first_of_both(into.kept, from.kept, most + 1, ByPriority());
  double const threshold = std::max(into.threshold, from.threshold);
  auto const below =
      std::ranges::partition_point(into.kept, [&](ScoreAddress const& a) { return a.priority >= threshold; });
  into.kept.erase(below, into.kept.end());
  into.threshold = threshold;
  if (into.kept.size() <= most) return;
  into.threshold = std::max(threshold, into.kept[most].priority);
  into.kept.resize(most);
}

void merge_class(ClassSums& into, ClassSums const& from, std::size_t records) {
  into.port = from.port;
  merge_scores(into.moments, from.moments);
  for (int r = 0; r < replica_count; ++r) into.replica_sum[r] += from.replica_sum[r];
  merge_records(into, from, records);
  into.off_list += from.off_list;
  into.phase_sensitivities.add(from.phase_sensitivities);
}

void add_to(std::vector<double>& into, std::vector<double> const& from) {
  into.resize(std::max(into.size(), from.size()));
  for (std::size_t i = 0; i < from.size(); ++i) into[i] += from[i];
}

void merge_receiver(ReceiverSums& into, ReceiverSums const& from) {
  merge_scores(into.power, from.power);
  for (auto const map : {&ReceiverSums::image, &ReceiverSums::angles, &ReceiverSums::quadrants}) {
    add_to((into.*map).sum, (from.*map).sum);
    add_to((into.*map).sum2, (from.*map).sum2);
  }
  for (auto const& [route, field] : from.fields)
    for (auto const part : {&FieldSums::power, &FieldSums::real, &FieldSums::imaginary})
      add_to(into.fields[route].*part, field.*part);
}

// Moves the border between the first blocks and the rest to where it lies after `more` blocks have been added.
void move_border(BlockSums& sums, std::uint64_t more) {
  std::uint64_t const border = first_part(sums.blocks + more);
  if (border == first_part(sums.blocks)) return;
  auto const move = [&](Moments& m) { m.first_sum = border == sums.blocks ? m.sum : not_a_number; };
  for (auto& [route, c] : sums.classes) move(c.moments);
  for (ReceiverSums& r : sums.receivers) move(r.power);
}

}  // namespace

Moments merged(Moments const& left, Moments const& right) {
  Moments both = left;
  merge(both, right);
  return both;
}

BlockSums merged(BlockSums left, BlockSums const& right) {
  if (left.blocks == 0 && left.classes.empty()) return right;
  move_border(left, right.blocks);
  // Bins scored only on the right have nothing before the border, unless it lies inside the right.
  double const before_border = first_part(left.blocks + right.blocks) > left.blocks ? not_a_number : 0;
  left.histories += right.histories;
  left.blocks += right.blocks;
  std::size_t const records = records_kept(left.blocks);
  left.bounces += right.bounces;
  left.rays += right.rays;
  left.lost += right.lost;
  for (auto const& [route, sums] : right.classes) {
    auto const [place, is_new] = left.classes.try_emplace(route);
    if (is_new) place->second.moments.first_sum = before_border;
    merge_class(place->second, sums, records);
  }
  left.receivers.resize(std::max(left.receivers.size(), right.receivers.size()));
  for (std::size_t i = 0; i < right.receivers.size(); ++i) merge_receiver(left.receivers[i], right.receivers[i]);
  merge(left.emitted, right.emitted);
  left.window_variance += right.window_variance;
  for (int f = 0; f < balance_term_count; ++f) merge(left.energy_balance[f], right.energy_balance[f]);
  for (auto const list : {&BlockSums::arrived, &BlockSums::absorbed}) {
    std::vector<Moments>& into = left.*list;
    std::vector<Moments> const& from = right.*list;
    into.resize(std::max(into.size(), from.size()));
    for (std::size_t g = 0; g < from.size(); ++g) merge(into[g], from[g]);
  }
  return left;
}

void SumTree::add(unsigned level, std::uint64_t index, BlockSums sums) {
  std::uint64_t const first = index << level, end = (index + 1) << level;
  auto const next = nodes_.lower_bound({first, 0});
  bool twice = next != nodes_.end() && next->first.first < end;
  if (next != nodes_.begin()) {
    auto const [start, height] = std::prev(next)->first;
    twice = twice || start + (std::uint64_t(1) << height) > first;
  }
  if (twice) throw std::logic_error("block counted twice");
  if (auto other = take_sibling(level, index))
    add(level + 1, index / 2, merged_siblings(index, std::move(sums), std::move(*other)));
  else
    nodes_.emplace(std::pair{first, level}, std::move(sums));
}

std::optional<BlockSums> SumTree::take_sibling(unsigned level, std::uint64_t index) {
  auto const sibling = nodes_.find({(index ^ 1) << level, level});
  if (sibling == nodes_.end()) return {};
  std::optional<BlockSums> sums = std::move(sibling->second);
  nodes_.erase(sibling);
  return sums;
}

BlockSums merged_siblings(std::uint64_t index, BlockSums sums, BlockSums sibling) {
  return index & 1 ? merged(std::move(sibling), sums) : merged(std::move(sums), sibling);
}

namespace {

// How many numbers below n are `rest` modulo replica_count.
std::uint64_t below(std::uint64_t n, std::uint64_t rest) {
  return n / replica_count + (n % replica_count > rest ? 1 : 0);
}

}  // namespace

BlockSums SumTree::total() const {
  BlockSums all;
  for (auto const& [place, sums] : nodes_) all = merged(std::move(all), sums);
  std::vector<BlockRange> const ranges = done();
  for (std::uint64_t r = 0; r < replica_count; ++r) {
    all.replica_blocks[r] = 0;
    for (BlockRange const& range : ranges) all.replica_blocks[r] += below(range.end, r) - below(range.first, r);
  }
  return all;
}

std::vector<BlockRange> SumTree::done() const {
  std::vector<BlockRange> ranges;
  for (auto const& [place, sums] : nodes_) {
    std::uint64_t const first = place.first, end = first + (std::uint64_t(1) << place.second);
    if (!ranges.empty() && ranges.back().end == first)
      ranges.back().end = end;
    else
      ranges.push_back({first, end});
  }
  return ranges;
}

std::vector<BlockRange> SumTree::missing(BlockRange of) const {
  std::vector<BlockRange> gaps;
  for (BlockRange const& range : done()) {
    if (range.end <= of.first) continue;
    if (range.first >= of.end) break;
    if (range.first > of.first) gaps.push_back({of.first, range.first});
    of.first = range.end;
  }
  if (of.first < of.end) gaps.push_back(of);
  return gaps;
}

BlockRange Slice::blocks(std::uint64_t all) const {
  auto const border = [&](std::uint64_t n) { return all / of * n + all % of * n / of; };
  return {border(number - 1), border(number)};
}

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
  std::ranges::sort(tail, std::greater<>());
}

std::uint64_t first_part(std::uint64_t blocks) {
  std::uint64_t const power = std::bit_floor(blocks);
  return blocks - power < power / 2 ? power / 2 : blocks == power ? 0 : power;
}

namespace {

// Exponent p of x^-p that the largest totals follow (Hill); the variance is finite above 3. Used when they are at
// most the upper 1 %: further down there is no tail, and bounded distributions look like flat powers.
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
  // Two errors below the limit: otherwise half of all good rows at the limit would be rejected by chance.
  if (double const error = error_of_slope(e.tail_slope); e.tail_slope + 2 * error < 3)
    return fmt::format("the largest histories fall as slowly as x^-{:.2f} ± {:.2f}: too slowly for an error bar",
                       e.tail_slope, error);
  if (std::fabs(e.halves) > 5)
    return fmt::format("its first and second half differ by {:.0f} standard errors", std::fabs(e.halves));
  return {};
}

namespace {

// Why an estimate is unreliable, in words (docs/theory/errors.md); empty when it is.
std::string objection(Estimate const& e, std::uint64_t blocks) {
  if (e.scored == 0) return "no history has scored";
  if (double(e.scored) < fewest)
    return e.scored == 1 ? "only 1 history has scored" : fmt::format("only {} histories have scored", e.scored);
  if (e.effective_scores < fewest) {
    double const rounded = std::round(e.effective_scores);
    return fmt::format("only {:.0f} effective score{}", rounded, rounded == 1 ? "" : "s");
  }
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
  if (spread * spread > 1e-10 * m.sum4) {  // below, equal totals: the rest is rounding
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

Estimate estimate_of_light(Moments const& m, std::uint64_t histories, std::uint64_t blocks) {
  Estimate e = estimate(m, histories, blocks);
  if (e.scored > 0) e.std_error = std::max(e.std_error, m.largest / double(histories));
  return e;
}

}  // namespace straytrace::trace
