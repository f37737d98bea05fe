// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "base/constants.hpp"
#include "trace/result.hpp"
#include "trace/tally/block_sink.hpp"

namespace straytrace {

char const* name_of(Fate fate) {
  static constexpr char const* names[] = {"absorbed", "escaped", "limit", "window", "sampling"};
  return names[static_cast<int>(fate)];
}

bool before(ScoreAddress const& a, ScoreAddress const& b) {
  if (a.priority != b.priority) return a.priority > b.priority;
  if (a.history != b.history) return a.history < b.history;
  if (a.event != b.event) return a.event < b.event;
  return a.connection < b.connection;
}

std::size_t records_kept(std::uint64_t blocks) {
  return std::clamp<std::size_t>(2 * blocks, records_per_class, most_records);
}

void keep_largest(ClassSums& sums, std::size_t most) {
  std::erase_if(sums.kept, [&](ScoreAddress const& a) { return a.priority < sums.threshold; });
  std::sort(sums.kept.begin(), sums.kept.end(), before);
  if (sums.kept.size() <= most) return;
  sums.threshold = std::max(sums.threshold, sums.kept[most].priority);
  sums.kept.resize(most);
}

namespace {

// Scores with what only they have: the sum over the first blocks stays as it is set in `into`.
void merge_scores(Moments& into, Moments const& from) {
  double const first = into.first_sum;
  into = merged(into, from);
  into.first_sum = first;
}

void merge_class(ClassSums& into, ClassSums const& from, std::size_t records) {
  into.port = from.port;
  merge_scores(into.moments, from.moments);
  for (int r = 0; r < replica_count; ++r) into.replica_sum[r] += from.replica_sum[r];
  into.kept.insert(into.kept.end(), from.kept.begin(), from.kept.end());
  into.off_list += from.off_list;
  into.threshold = std::max(into.threshold, from.threshold);
  keep_largest(into, records);
  into.levers.add(from.levers);
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

BlockSums merged(BlockSums left, BlockSums const& right) {
  if (left.blocks == 0 && left.classes.empty()) return right;
  move_border(left, right.blocks);
  // What only the right has scored in has nothing before the border, unless that lies inside the right.
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
  left.emitted = merged(left.emitted, right.emitted);
  left.window_variance += right.window_variance;
  for (int f = 0; f < fate_count; ++f) left.ledger[f] = merged(left.ledger[f], right.ledger[f]);
  for (auto const list : {&BlockSums::arrived, &BlockSums::absorbed}) {
    std::vector<Moments>& into = left.*list;
    std::vector<Moments> const& from = right.*list;
    into.resize(std::max(into.size(), from.size()));
    for (std::size_t g = 0; g < from.size(); ++g) into[g] = merged(into[g], from[g]);
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
  auto const sibling = nodes_.find({(index ^ 1) << level, level});
  if (sibling == nodes_.end()) {
    nodes_.emplace(std::pair{first, level}, std::move(sums));
    return;
  }
  BlockSums other = std::move(sibling->second);
  nodes_.erase(sibling);
  add(level + 1, index / 2, index & 1 ? merged(std::move(other), sums) : merged(std::move(sums), other));
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

}  // namespace straytrace
