// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/mesh/bvh8.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "geometry/mesh/triangle_mesh.hpp"

namespace straytrace::geometry {
namespace {

double half_area(Box const& b) {
  Vec3 const d = b.upper - b.lower;
  return d.x >= 0 ? d.x * d.y + d.y * d.z + d.z * d.x : 0;
}

// A binary tree down to single items first.
struct Binary {
  Box box;
  std::uint32_t first = 0, count = 0;
  std::uint32_t left = 0, right = 0;  // 0: one item
};

// Cost of a binary subtree as at most i children of a wide node: the best cut is found from the bottom
// up (Ylitie et al. 2017, section 4). share[i]: how many of them its left half gets; 0: as for i - 1.
struct Cut {
  float cost[9];
  std::uint8_t share[9];
  bool leaf;
};

class Builder {
 public:
  Builder(std::span<Box const> boxes, Bvh8Settings const& settings) : boxes_(boxes), settings_(settings) {
    settings_.leaf_size = std::clamp(settings_.leaf_size, 1u, 16u);
    settings_.pack = std::max(settings_.pack, 1u);
    if (boxes.size() >= 1u << Bvh8::first_bits) throw std::length_error("a tree can have at most 2^27 boxes");
  }

  Bvh8 build() {
    place_origin();
    for (bool const balanced : {false, true}) {  // halves by number when the heuristic made the tree too deep
      balanced_ = balanced;
      tree_.nodes.clear();
      grow();
      find_cuts();
      if (binary_.empty() || widen(0, 1)) break;
    }
    tree_.order = std::move(order_);
    return std::move(tree_);
  }

 private:
  // Local coordinates, in double, and how much boxes grow.
  void place_origin() {
    Box all;
    for (Box const& b : boxes_) all.add(b);
    if (boxes_.empty()) return;
    tree_.origin = 0.5 * (all.lower + all.upper);
    Vec3 const half = all.upper - tree_.origin, other = tree_.origin - all.lower;
    tree_.largest = std::max({half.x, half.y, half.z, other.x, other.y, other.z});
    double const far = std::max({std::fabs(tree_.origin.x), std::fabs(tree_.origin.y), std::fabs(tree_.origin.z)});
    pad_ = settings_.growth * tree_.largest + 0x1p-45 * far;
    Vec3 const pad{pad_, pad_, pad_};
    tree_.root = {all.lower - tree_.origin - pad, all.upper - tree_.origin + pad};
  }

  void grow() {
    binary_.clear();
    order_.resize(boxes_.size());
    std::iota(order_.begin(), order_.end(), 0u);
    centres_.resize(boxes_.size());
    for (std::size_t i = 0; i < boxes_.size(); ++i) centres_[i] = 0.5 * (boxes_[i].lower + boxes_[i].upper);
    if (boxes_.empty()) return;
    std::vector<std::uint32_t> open{add(0, std::uint32_t(boxes_.size()))};
    while (!open.empty()) {
      std::uint32_t const at = open.back();
      open.pop_back();
      std::uint32_t const first = binary_[at].first, count = binary_[at].count, middle = split(binary_[at]);
      if (middle == first) continue;
      std::uint32_t const left = add(first, middle - first), right = add(middle, first + count - middle);
      binary_[at].left = left;
      binary_[at].right = right;
      open.push_back(right);
      open.push_back(left);
    }
  }

  std::uint32_t add(std::uint32_t first, std::uint32_t count) {
    Binary node;
    node.first = first;
    node.count = count;
    for (std::uint32_t i = first; i < first + count; ++i) node.box.add(boxes_[order_[i]]);
    binary_.push_back(node);
    return std::uint32_t(binary_.size() - 1);
  }

  double packs(std::uint32_t count) const {
    return double((count + settings_.pack - 1) / settings_.pack * settings_.pack);
  }

  // Orders the items of the node and returns where the second half begins; the first item: the node stays a leaf.
  std::uint32_t split(Binary const& node) {
    if (node.count == 1) return node.first;
    Box centres;
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) centres.add(centres_[order_[i]]);
    Plane best;
    if (!balanced_)
      for (int axis = 0; axis < 3; ++axis) try_axis(node, centres, axis, best);
    if (best.axis < 0) return halve(node, centres);
    auto const from = order_.begin() + node.first, to = from + node.count;
    auto const middle =
        std::stable_partition(from, to, [&](std::uint32_t i) { return bin(centres, best.axis, i) < best.bin; });
    return std::uint32_t(middle - order_.begin());
  }

  struct Plane {
    int axis = -1, bin = 0;
    double cost = infinity;
  };
  static constexpr int bins = 32;
  int bin(Box const& centres, int axis, std::uint32_t i) const {
    double const low = component(centres.lower, axis), high = component(centres.upper, axis);
    return std::min(int(bins * ((component(centres_[i], axis) - low) / (high - low))), bins - 1);
  }
  void try_axis(Binary const& node, Box const& centres, int axis, Plane& best) const {
    if (!(component(centres.upper, axis) > component(centres.lower, axis))) return;
    std::array<Box, bins> box;
    std::array<std::uint32_t, bins> count{};
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      int const b = bin(centres, axis, order_[i]);
      box[std::size_t(b)].add(boxes_[order_[i]]);
      ++count[std::size_t(b)];
    }
    std::array<double, bins> above{};  // cost of bins b and up
    Box sum;
    std::uint32_t items = 0;
    for (std::size_t b = bins - 1; b > 0; --b) {
      sum.add(box[b]);
      items += count[b];
      above[b] = half_area(sum) * packs(items);
    }
    sum = {};
    items = 0;
    for (std::size_t b = 1; b < bins; ++b) {
      sum.add(box[b - 1]);
      items += count[b - 1];
      double const cost = half_area(sum) * packs(items) + above[b];
      if (items > 0 && items < node.count && cost < best.cost) best = {axis, int(b), cost};
    }
  }
  std::uint32_t halve(Binary const& node, Box const& centres) {
    Vec3 const d = centres.upper - centres.lower;
    int const axis = d.x >= d.y && d.x >= d.z ? 0 : d.y >= d.z ? 1 : 2;
    auto const from = order_.begin() + node.first, middle = from + node.count / 2;
    std::nth_element(from, middle, from + node.count, [&](std::uint32_t a, std::uint32_t b) {
      double const x = component(centres_[a], axis), y = component(centres_[b], axis);
      return x != y ? x < y : a < b;
    });
    return node.first + node.count / 2;
  }

  void find_cuts() {
    cuts_.assign(binary_.size(), Cut{});
    for (std::size_t n = binary_.size(); n-- > 0;) {  // children come after their parents
      Binary const& node = binary_[n];
      Cut& cut = cuts_[n];
      auto const area = float(balanced_ ? 1 : half_area(node.box));
      bool const fits = node.count <= settings_.leaf_size;
      float const as_leaf = fits ? area * float(packs(node.count)) : std::numeric_limits<float>::infinity();
      cut.leaf = node.left == 0;
      for (float& cost : cut.cost) cost = as_leaf;
      if (cut.leaf) continue;
      Cut const &left = cuts_[node.left], &right = cuts_[node.right];
      for (int i = 2; i <= 8; ++i) {
        cut.cost[i] = std::numeric_limits<float>::infinity();
        for (int k = 1; k < i; ++k)
          if (float const cost = left.cost[std::min(k, 7)] + right.cost[std::min(i - k, 7)]; cost < cut.cost[i]) {
            cut.cost[i] = cost;
            cut.share[i] = std::uint8_t(k);
          }
      }
      float const as_node = area * float(settings_.traversal_cost) + cut.cost[8];
      cut.leaf = as_leaf <= as_node;
      cut.cost[1] = cut.leaf ? as_leaf : as_node;
      for (int i = 2; i <= 7; ++i)
        if (cut.cost[i - 1] <= cut.cost[i]) {
          cut.cost[i] = cut.cost[i - 1];
          cut.share[i] = 0;
        }
    }
  }

  void gather(std::uint32_t at, int slots, std::vector<std::uint32_t>& children) const {
    Binary const& node = binary_[at];
    Cut const& cut = cuts_[at];
    while (slots > 1 && slots < 8 && cut.share[slots] == 0) --slots;
    if (slots == 1 || node.left == 0) return children.push_back(at);
    gather(node.left, cut.share[slots], children);
    gather(node.right, slots - cut.share[slots], children);
  }

  // Writes the eight-wide node for a binary one; false: too deep.
  bool widen(std::uint32_t at, int depth) {
    if (depth > Bvh8::depth_limit) return false;
    std::vector<std::uint32_t> children;
    if (cuts_[at].leaf)
      children.push_back(at);
    else
      gather(at, 8, children);
    std::size_t const number = tree_.nodes.size();
    tree_.nodes.emplace_back();
    for (std::size_t i = 0; i < 8; ++i) {
      set_bounds(tree_.nodes[number], i, i < children.size() ? binary_[children[i]].box : Box{});
      if (i >= children.size()) continue;
      Binary const& c = binary_[children[i]];
      bool const leaf = cuts_[children[i]].leaf;
      tree_.nodes[number].child[i] =
          leaf ? Bvh8::leaf_mark | (c.count - 1) << Bvh8::first_bits | c.first : std::uint32_t(tree_.nodes.size());
      if (!leaf && !widen(children[i], depth + 1)) return false;
    }
    return true;
  }

  static float outward(double x, float towards) {
    float const f = float(x);
    return (towards > 0 ? double(f) < x : double(f) > x) ? std::nextafter(f, towards) : f;
  }
  void set_bounds(Bvh8::Node& node, std::size_t i, Box const& box) const {
    constexpr float far = std::numeric_limits<float>::infinity();
    bool const empty = box.lower.x > box.upper.x;
    for (int k = 0; k < 3; ++k) {
      double const origin = component(tree_.origin, k);
      node.bound[k][i] = empty ? far : outward(component(box.lower, k) - origin - pad_, -far);
      node.bound[3 + k][i] = empty ? -far : outward(component(box.upper, k) - origin + pad_, far);
    }
  }

  std::span<Box const> boxes_;
  Bvh8Settings settings_;
  std::vector<Vec3> centres_;
  std::vector<std::uint32_t> order_;
  std::vector<Binary> binary_;
  std::vector<Cut> cuts_;
  Bvh8 tree_;
  double pad_ = 0;  // m
  bool balanced_ = false;
};

}  // namespace

Bvh8 build_bvh8(std::span<Box const> boxes, Bvh8Settings const& settings) { return Builder(boxes, settings).build(); }

}  // namespace straytrace::geometry
