// SPDX-License-Identifier: BSD-3-Clause
#include "scene/limits.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace straytrace {
namespace {

constexpr double rounding = 1e-12;  // relative: a lens may be exactly as wide as its sphere

struct Rule {
  std::string_view key, in_words;
  int sign;  // +1: the value is not below the bound
};
constexpr std::array rules{Rule{"above", "more than", 1}, Rule{"at_least", "at least", 1},
                           Rule{"at_most", "at most", -1}};

bool keeps(Rule const& rule, double value, double bound) {
  double const over = rule.sign * (value - bound);
  return rule.key == "above" ? over > 0 : over >= -rounding * std::fabs(bound);
}

// In a unit that people use, with four digits, rounded so that what is printed is allowed.
std::string readable(double si, Dimension d, int sign) {
  double const unit = d == dim::length && std::fabs(si) < 1 ? 1e-3 : d == dim::angle ? pi / 180 : 1;
  double const x = si / unit;
  double const step = x == 0 ? 1 : std::pow(10, std::floor(std::log10(std::fabs(x))) - 3);
  std::string const number = fmt::format("{:.6g}", x == 0 ? 0 : sign * std::ceil(sign * x / step - 1e-9) * step);
  return unit == 1e-3 ? number + " mm" : with_unit(number, d);
}

}  // namespace

bool within_limits(Node const& entry, std::string const& name, Node const& part,
                   std::shared_ptr<Scope const> const& scope) {
  Node const limits = part["limits"];
  if (limits.kind() != Node::Kind::table) return true;
  for (auto const& [parameter, limit] : limits.items()) {
    auto const value = find_parameter(scope.get(), parameter).value;
    if (!value || limit.kind() != Node::Kind::table) continue;  // reported already
    for (Rule const& rule : rules) {
      if (!limit.has(rule.key)) continue;
      Node const written = limit[rule.key];
      Quantity const bound = Node(written.data(), scope, limit.document()).as_quantity();
      double const is = value->quantity.si;
      if (!std::isfinite(bound.si) || keeps(rule, is, bound.si)) continue;
      Node const given = entry[parameter];
      std::string const least = readable(bound.si, bound.dimension, rule.sign);
      (given ? given : entry)
          .problem(fmt::format("'{}' of '{}' must be {} {} here, it is {}", parameter, name, rule.in_words, least,
                               readable(is, bound.dimension, 1)),
                   limit.word("because", "change it or what else the part is given"));
      return false;
    }
  }
  return true;
}

}  // namespace straytrace
