// SPDX-License-Identifier: BSD-3-Clause
#include "scene/repeat.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scene/axes.hpp"

namespace straytrace {
namespace {

int read_axis(Node const& repeat) {
  std::string const axis = repeat.choice("along", axes);
  auto const hit = std::find(axes.begin(), axes.end(), axis);
  return hit == axes.end() ? -1 : static_cast<int>(hit - axes.begin());
}

std::vector<double> by_pitch(Node const& repeat, std::size_t count) {
  double const from = repeat.number("from", dim::length, 0), pitch = repeat.number("pitch", dim::length);
  if (pitch <= 0) {
    repeat["pitch"].problem("'pitch' must be positive", "write the distance of neighbours, for example '5 m'");
    return {};
  }
  if (std::isnan(from) || std::isnan(pitch)) return {};
  std::vector<double> offsets(count);
  for (std::size_t i = 0; i < count; ++i) offsets[i] = from + static_cast<double>(i) * pitch;
  return offsets;
}

std::vector<double> by_ends(Node const& repeat, std::size_t count) {
  double const from = repeat.number("from", dim::length), to = repeat.number("to", dim::length);
  if (from > to) {
    repeat["to"].problem("'to' lies before 'from'", "write the smaller position as 'from'");
    return {};
  }
  if (count == 1 && from < to) {
    repeat["count"].problem("one instance cannot stand both at 'from' and at 'to'",
                            "write 'count: 2' or more, or leave out 'repeat' and use 'at'");
    return {};
  }
  if (std::isnan(from) || std::isnan(to)) return {};
  std::vector<double> offsets(count, from);
  for (std::size_t i = 1; i < count; ++i)
    offsets[i] = i + 1 == count ? to : from + (to - from) * (static_cast<double>(i) / static_cast<double>(count - 1));
  return offsets;
}

// As many as `count` says, or as are needed for the shadow of the last one to reach `to` (the second form of eq. 8.16).
std::size_t shadow_count(Node const& repeat, double origin, double from, double ratio) {
  if (!repeat.has("to")) return repeat.whole("count", required, 1, most_instances);
  if (repeat.has("count")) {
    repeat["count"].problem("'count' and 'to' say the same thing twice", "keep one of them");
    return 0;
  }
  double const to = repeat.number("to", dim::length);
  if (std::isnan(origin + from + to + ratio)) return 0;
  double const steps = std::log((to - origin) / (from - origin)) / std::log(ratio);
  if (steps > 0 && steps <= most_instances) return std::size_t(std::ceil(steps * (1 - 1e-12)));
  repeat["to"].problem("no progression with this ratio leads from 'from' to 'to'",
                       "write a 'to' beyond 'from' as seen from 'origin', and a ratio above 1; or 'count' instead");
  return 0;
}

// Distances from `origin` in geometric progression: the shadow rule of baffles (physics.md eq. 8.16).
std::vector<double> by_ratio(Node const& repeat) {
  double const origin = repeat.number("origin", dim::length, 0), from = repeat.number("from", dim::length);
  double const ratio = repeat.number("ratio", dim::plain, required, 1e-3, 1e3);
  for (char const* key : {"count", "to"}) repeat.has(key);
  if (from == origin) {
    repeat["from"].problem("the progression starts at its own origin", "write another position as 'from'");
    return {};
  }
  std::size_t const count = shadow_count(repeat, origin, from, ratio);
  if (std::isnan(origin) || std::isnan(from) || std::isnan(ratio)) return {};
  std::vector<double> offsets(count);
  for (std::size_t i = 0; i < count; ++i)
    offsets[i] = origin + (from - origin) * std::pow(ratio, static_cast<double>(i));
  return offsets;
}

std::vector<double> by_list(Node const& repeat) {
  std::vector<Node> const positions = repeat.list("at");
  if (positions.empty() || positions.size() > most_instances) {
    repeat["at"].problem("'at' needs between 1 and 1000000 positions", "write for example 'at: [50 m, 75 m, 120 m]'");
    return {};
  }
  std::vector<double> offsets;
  for (Node const& p : positions) offsets.push_back(p.as_number(dim::length));
  bool const bad = std::any_of(offsets.begin(), offsets.end(), [](double z) { return std::isnan(z); });
  return bad ? std::vector<double>{} : offsets;
}

}  // namespace

Repeat read_repeat(Node const& entry) {
  Node const repeat = entry.table("repeat");
  if (!entry.has("repeat")) return {};
  Repeat result;
  result.offsets.clear();
  if (!repeat) return result;
  if (repeat.has("table")) {
    result = read_offset_table(repeat["table"]);
  } else {
    result.axis = read_axis(repeat);
    if (repeat.has("at")) {
      result.offsets = by_list(repeat);
    } else if (repeat.has("ratio")) {
      result.offsets = by_ratio(repeat);
    } else {
      std::size_t const count = repeat.whole("count", required, 1, most_instances);
      result.offsets = repeat.has("pitch") ? by_pitch(repeat, count) : by_ends(repeat, count);
    }
    if (result.axis < 0) result.offsets.clear();
  }
  repeat.refuse_unknown("this form of 'repeat'");
  return result;
}

}  // namespace straytrace
