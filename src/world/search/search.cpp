// SPDX-License-Identifier: BSD-3-Clause
#include "world/search/search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace straytrace::world {
namespace {

// A line in space, the same for both directions along it.
struct Line {
  Vec3 foot, dir;  // point nearest the origin of the world
};

Line line_of(SearchItem const& item) {
  Vec3 d = item.axis;
  double const largest = std::max({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)});
  double const lead = std::fabs(d.z) == largest ? d.z : std::fabs(d.y) == largest ? d.y : d.x;
  if (lead < 0) d = -d;
  return {item.reference - dot(item.reference, d) * d, d};
}

// Lines that are equal but for rounding share a name, nearly always. Irrational steps: no plain number lies on the
// border between two names.
using Name = std::array<long long, 6>;
Name name_of(Line const& l) {
  constexpr double turn = 1.2345678e-7, offset = 1.2345678e-4;  // rad, m
  auto const in = [](double x, double step) { return std::llround(x / step); };
  return {in(l.dir.x, turn),    in(l.dir.y, turn),    in(l.dir.z, turn),
          in(l.foot.x, offset), in(l.foot.y, offset), in(l.foot.z, offset)};
}

double distance_from(Line const& l, Vec3 p) {
  Vec3 const o = p - l.foot;
  return length(o - dot(o, l.dir) * l.dir);
}

struct Family {
  Line line;
  std::vector<SearchItem> items;
  std::vector<TubePart> parts;
  double deviation = 0;  // m, of the items' axes from the line
};

// Items whose axis is the line, within rounding errors.
Family family_along(std::vector<SearchItem const*> const& candidates) {
  Family f;
  f.line = line_of(*candidates.front());
  for (SearchItem const* item : candidates) {
    Vec3 const a = item->reference + item->extent.low * item->axis,
               b = item->reference + item->extent.high * item->axis;
    double const off = std::max(distance_from(f.line, a), distance_from(f.line, b));
    double const scale = length(a) + length(b) + item->extent.r_max;
    if (off > 1e-12 * scale || item->extent.r_max > 1e9) continue;
    double const z1 = dot(a - f.line.foot, f.line.dir), z2 = dot(b - f.line.foot, f.line.dir);
    f.deviation = std::max(f.deviation, off);
    f.items.push_back(*item);
    f.parts.push_back({std::min(z1, z2), std::max(z1, z2), item->extent.r_min, item->extent.r_max, item->ref,
                       item->plain_kind, item->plain});
  }
  return f;
}

// Whether the structure along a line pays off: many items, much longer than wide, and free space inside.
bool is_tube(Family const& f) {
  if (f.parts.size() < 8) return false;
  double low = infinity, high = -infinity, reach = 0;
  std::size_t open = 0;
  for (TubePart const& p : f.parts) {
    low = std::min(low, p.low);
    high = std::max(high, p.high);
    reach = std::max(reach, p.reach);
    open += p.clear > 0;
  }
  return high - low > 8 * reach && 2 * open >= f.parts.size();
}

constexpr std::size_t most_tubes = 8;  // every ray searches each

double largest_side(Box const& b) {
  Vec3 const size = b.upper - b.lower;
  return std::max({size.x, size.y, size.z});
}

constexpr double local_size = 200;  // m; a tree this wide widens its boxes by 12 um

// Cuts items into neighbourhoods: large ones of a wide region separately, the rest in halves until it is local.
void find_clusters(std::vector<SearchItem> items, std::vector<std::vector<SearchItem>>& out) {
  if (items.empty()) return;
  Box all, centres;
  for (SearchItem const& item : items) {
    all.add(item.box);
    centres.add(0.5 * (item.box.lower + item.box.upper));
  }
  double const width = largest_side(all);
  if (width <= local_size || items.size() <= 4) {
    out.push_back(std::move(items));
    return;
  }
  Vec3 const size = centres.upper - centres.lower, middle = 0.5 * (centres.lower + centres.upper);
  Vec3 const across = size.x >= size.y && size.x >= size.z ? Vec3{1, 0, 0}
                      : size.y >= size.z                   ? Vec3{0, 1, 0}
                                                           : Vec3{0, 0, 1};
  std::vector<SearchItem> large, below, above;
  for (SearchItem& item : items) {
    Vec3 const centre = 0.5 * (item.box.lower + item.box.upper);
    (largest_side(item.box) > 0.25 * width ? large
     : dot(centre - middle, across) < 0    ? below
                                           : above)
        .push_back(std::move(item));
  }
  bool const stuck = (below.empty() || above.empty()) && large.empty();
  if (stuck) {
    out.push_back(below.empty() ? std::move(above) : std::move(below));
    return;
  }
  if (!large.empty()) out.push_back(std::move(large));
  find_clusters(std::move(below), out);
  find_clusters(std::move(above), out);
}

}  // namespace

std::vector<SearchItem> SearchTree::take_tubes(std::vector<SearchItem> const& items) {
  std::map<Name, std::vector<SearchItem const*>> lines;
  for (SearchItem const& item : items) lines[name_of(line_of(item))].push_back(&item);
  std::vector<Family> tubes;
  for (auto const& [name, candidates] : lines)
    if (candidates.size() >= 8)
      if (Family f = family_along(candidates); is_tube(f)) tubes.push_back(std::move(f));
  std::ranges::sort(tubes, [](Family const& a, Family const& b) {
    return a.parts.size() != b.parts.size() ? a.parts.size() > b.parts.size()
                                            : a.parts.front().ref.surface < b.parts.front().ref.surface;
  });
  if (tubes.size() > most_tubes) tubes.resize(most_tubes);
  std::vector<std::uint32_t> taken;
  for (Family const& f : tubes) {
    tubes_.add(f.line.foot, f.line.dir, f.deviation, f.parts);
    for (TubePart const& p : f.parts) taken.push_back(p.ref.surface);
  }
  std::ranges::sort(taken);
  std::vector<SearchItem> left;
  for (SearchItem const& item : items)
    if (!std::ranges::binary_search(taken, item.ref.surface)) left.push_back(item);
  return left;
}

void SearchTree::add_tree(Bvh8 const& tree) {
  clusters_.push_back(
      {tree.origin, tree.largest, tree.root, std::uint32_t(nodes_.size()), std::uint32_t(tree.nodes.size())});
  nodes_.insert(nodes_.end(), tree.nodes.begin(), tree.nodes.end());
}

void SearchTree::add_cluster(std::vector<SearchItem> const& content) {
  std::vector<Box> boxes;
  for (SearchItem const& item : content) boxes.push_back(item.box);
  Bvh8Settings settings;
  settings.leaf_size = settings.pack = simd::lanes;
  settings.traversal_cost = 4;  // half of a pack
  Bvh8 tree = build_bvh8(boxes, settings);
  tree.rename_leaves([&](std::uint32_t first, std::uint32_t count) {
    SurfacePack& pack = packs_.emplace_back();
    for (std::uint32_t i = 0; i < count; ++i)
      pack.set(int(i), content[tree.order[first + i]], tree.origin, tree.largest);
    return std::uint32_t(packs_.size() - 1);
  });
  add_tree(tree);
}

void SearchTree::build(std::vector<SearchItem> const& items) {
  *this = {};
  std::vector<std::vector<SearchItem>> clusters;
  find_clusters(take_tubes(items), clusters);
  std::vector<Box> all;
  for (auto const& content : clusters) {
    Box& whole = all.emplace_back();
    for (SearchItem const& item : content) whole.add(item.box);
    add_cluster(content);
  }
  if (all.size() < 2) return;
  Bvh8Settings single;
  single.leaf_size = 1;
  Bvh8 over = build_bvh8(all, single);
  over.rename_leaves([&](std::uint32_t first, std::uint32_t) { return over.order[first]; });
  add_tree(over);
}

namespace {

float outward(double x, float towards) { return std::nextafter(float(x), towards); }

}  // namespace

void SurfacePack::set(int lane, SearchItem const& item, Vec3 origin, double largest, double widen) {
  constexpr float far = std::numeric_limits<float>::infinity();
  Vec3 const from = item.reference - origin;
  double const where[3] = {from.x, from.y, from.z}, along[3] = {item.axis.x, item.axis.y, item.axis.z};
  double const reach = std::max({std::fabs(from.x), std::fabs(from.y), std::fabs(from.z), largest});
  // The rounded axis and centre: heights and radii change by less than 2^-23 of the coordinates.
  double const pad = 0x1p-18 * reach * widen;
  for (int k = 0; k < 3; ++k) {
    centre[k][lane] = float(where[k]);
    axis[k][lane] = float(along[k]);
  }
  double const inner = std::max(item.extent.r_min - pad, 0.0), outer = item.extent.r_max + pad;
  low[lane] = outward(item.extent.low - pad, -far);
  high[lane] = outward(item.extent.high + pad, far);
  inner2[lane] = inner > 0 ? outward(inner * inner, -far) : 0;
  outer2[lane] = outward(outer * outer, far);
  ref[lane] = item.ref;
}

}  // namespace straytrace::world
