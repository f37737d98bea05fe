// SPDX-License-Identifier: BSD-3-Clause
#include "world/axial_tree.hpp"

#include <algorithm>

namespace straytrace {

void AxialTree::build(std::vector<Item> items) {
  nodes_.clear();
  walls_.clear();
  items_.clear();
  double low = infinity, high = -infinity;
  for (Item& item : items) {
    double const pad = 1e-9 + 1e-14 * std::max(std::fabs(item.low), std::fabs(item.high));  // m
    item.low -= pad;
    item.high += pad;
    low = std::min(low, item.low);
    high = std::max(high, item.high);
  }
  for (Item const& item : items)
    if (item.high - item.low > 0.1 * (high - low))
      walls_.push_back(item.surface);
    else
      items_.push_back(item);
  std::sort(items_.begin(), items_.end(), [](Item const& a, Item const& b) {
    double const x = a.low + a.high, y = b.low + b.high;
    return x != y ? x < y : a.surface < b.surface;
  });
  if (!items_.empty()) split(0, items_.size());
}

void AxialTree::split(std::size_t first, std::size_t last) {
  constexpr std::size_t leaf_size = 2;
  std::size_t const index = nodes_.size();
  Node node;
  node.first = std::uint32_t(first);
  node.count = std::uint32_t(last - first);
  for (std::size_t i = first; i < last; ++i) {
    node.low = std::min(node.low, items_[i].low);
    node.high = std::max(node.high, items_[i].high);
    node.clear = std::min(node.clear, items_[i].clear);
    node.reach = std::max(node.reach, items_[i].reach);
  }
  nodes_.push_back(node);
  if (last - first <= leaf_size) return;
  std::size_t const middle = (first + last) / 2;
  split(first, middle);
  nodes_[index].count = 0;
  nodes_[index].first = std::uint32_t(nodes_.size());
  split(middle, last);
}

}  // namespace straytrace
