// SPDX-License-Identifier: BSD-3-Clause
#include "scene/arithmetic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace straytrace {
namespace {

[[noreturn]] void refuse(std::string what, std::string suggestion, std::size_t begin, std::size_t end) {
  throw ExpressionProblem{std::move(what), std::move(suggestion), begin, end};
}

Operand finite(Quantity const& q, std::size_t begin, std::size_t end, bool bare_zero = false) {
  if (!std::isfinite(q.si))
    refuse("the result is not a finite number", "check for a division by zero or an exponent that is too large", begin,
           end);
  return {{q, bare_zero}, begin, end, false};
}

// A bare 0 takes over dimension and kind of what it stands next to.
void adapt(Operand& a, Operand const& b) {
  if (a.value.bare_zero && !b.value.bare_zero) {
    a.value.quantity.dimension = b.value.quantity.dimension;
    a.value.quantity.amplitude = b.value.quantity.amplitude;
  }
}

std::string slice(std::string_view text, std::size_t begin, std::size_t end) {
  return std::string(text.substr(begin, end - begin));
}

// "L - 50" -> "L - 50 m": the unit that makes both sides agree.
std::string agreeing(Operand const& a, Operand const& b, std::string_view text) {
  Dimension const da = a.value.quantity.dimension, db = b.value.quantity.dimension;
  if (b.literal && db == dim::plain)
    return fmt::format("write '{}{}'", slice(text, a.begin, b.begin), with_unit(slice(text, b.begin, b.end), da));
  if (a.literal && da == dim::plain)
    return fmt::format("write '{}{}'", with_unit(slice(text, a.begin, a.end), db), slice(text, a.end, b.end));
  return "give both sides the same dimension";
}

Amplitude combined(Operand const& a, Operand const& b) {
  Amplitude const x = a.value.quantity.amplitude, y = b.value.quantity.amplitude;
  if (x != Amplitude::none && y != Amplitude::none)
    refuse("cannot multiply or divide one amplitude by another", "drop 'peak', 'pp' or 'rms' from one of them", a.begin,
           b.end);
  return x == Amplitude::none ? y : x;
}

Dimension product_dimension(Operand const& a, Operand const& b, int sign) {
  auto const d = times(a.value.quantity.dimension, b.value.quantity.dimension, sign);
  if (!d) refuse("the power of a unit becomes too large", "check the expression", a.begin, b.end);
  return *d;
}

bool needs_plain(std::string_view name) { return name == "exp" || name == "log"; }
bool needs_angle(std::string_view name) { return name == "sin" || name == "cos" || name == "tan"; }

Operand root(Operand const& x, std::size_t begin, std::size_t end) {
  Quantity const& q = x.value.quantity;
  if (q.si < 0) refuse("the square root of a negative number", "check the sign of what is inside", x.begin, x.end);
  auto const d = power_of(q.dimension, 0.5);
  if (!d)
    refuse(fmt::format("cannot take the square root of {}", described(q.dimension)), "check the units", x.begin, x.end);
  return finite({std::sqrt(q.si), *d, {}}, begin, end, x.value.bare_zero);
}

Operand inverse_radius(Operand const& x, std::size_t begin, std::size_t end) {
  Quantity const& q = x.value.quantity;
  if (q.dimension != dim::length && !x.value.bare_zero)
    refuse(fmt::format("curvature() takes a length, got {}", described(q.dimension)),
           "write the radius of curvature, for example curvature(1.4 km)", x.begin, x.end);
  return finite({q.si == 0 ? 0 : 1 / q.si, dim::per_metre, {}}, begin, end);
}

Operand elementary(std::string_view name, Operand const& x, std::size_t begin, std::size_t end) {
  Quantity const& q = x.value.quantity;
  bool const allowed = q.dimension == dim::plain || (needs_angle(name) && q.dimension == dim::angle);
  if (!allowed)
    refuse(fmt::format("{}() takes {}, got {}", name,
                       needs_plain(name) ? "a plain number" : "an angle or a plain number", described(q.dimension)),
           "divide by a quantity of the same dimension first", x.begin, x.end);
  double const v = name == "sin"   ? std::sin(q.si)
                   : name == "cos" ? std::cos(q.si)
                   : name == "tan" ? std::tan(q.si)
                   : name == "exp" ? std::exp(q.si)
                                   : std::log(q.si);
  return finite({v, dim::plain, {}}, begin, end);
}

// min, max and atan2: arguments of one dimension.
Operand of_equals(std::string_view name, std::span<Operand const> arguments, std::size_t begin, std::size_t end) {
  std::vector<Operand> x(arguments.begin(), arguments.end());
  for (Operand const& a : arguments)
    for (Operand& b : x) adapt(b, a);
  for (Operand const& a : x)
    if (a.value.quantity.dimension != x[0].value.quantity.dimension ||
        a.value.quantity.amplitude != x[0].value.quantity.amplitude)
      refuse(fmt::format("{}() compares {} with {}", name, described(x[0].value.quantity.dimension),
                         described(a.value.quantity.dimension)),
             "give all arguments the same dimension", a.begin, a.end);
  if (name == "atan2")
    return finite({std::atan2(x[0].value.quantity.si, x[1].value.quantity.si), dim::angle, {}}, begin, end);
  auto const less = [](Operand const& a, Operand const& b) { return a.value.quantity.si < b.value.quantity.si; };
  auto const best =
      name == "min" ? std::min_element(x.begin(), x.end(), less) : std::max_element(x.begin(), x.end(), less);
  bool const all_bare = std::all_of(x.begin(), x.end(), [](Operand const& a) { return a.value.bare_zero; });
  return finite(best->value.quantity, begin, end, all_bare);
}

}  // namespace

Operand add(Operand const& left, Operand const& right, int sign, std::string_view text) {
  Operand a = left, b = right;
  adapt(a, right);
  adapt(b, left);
  Quantity const &p = a.value.quantity, &q = b.value.quantity;
  if (p.dimension != q.dimension) {
    std::string const x = described(p.dimension), y = described(q.dimension);
    refuse(sign > 0 ? fmt::format("cannot add {} to {}", y, x) : fmt::format("cannot subtract {} from {}", y, x),
           agreeing(a, b, text), a.begin, b.end);
  }
  if (p.amplitude != q.amplitude)
    refuse("cannot add two amplitudes of different kinds", "state both as peak, both as pp or both as rms", a.begin,
           b.end);
  return finite({p.si + sign * q.si, p.dimension, p.amplitude}, a.begin, b.end, a.value.bare_zero && b.value.bare_zero);
}

Operand multiply(Operand const& a, Operand const& b, std::string_view) {
  return finite({a.value.quantity.si * b.value.quantity.si, product_dimension(a, b, 1), combined(a, b)}, a.begin,
                b.end);
}

Operand divide(Operand const& a, Operand const& b, std::string_view text) {
  if (b.value.quantity.si == 0)
    refuse("division by zero", fmt::format("check '{}'", shortened(slice(text, b.begin, b.end))), a.begin, b.end);
  return finite({a.value.quantity.si / b.value.quantity.si, product_dimension(a, b, -1), combined(a, b)}, a.begin,
                b.end);
}

Operand raise(Operand const& a, Operand const& b, std::string_view) {
  Quantity const &p = a.value.quantity, &q = b.value.quantity;
  if (q.dimension != dim::plain)
    refuse(fmt::format("an exponent must be a plain number, got {}", described(q.dimension)),
           "write brackets around the base if the unit belongs to it, for example '(2 m)^2'", b.begin, b.end);
  if (p.amplitude != Amplitude::none)
    refuse("cannot raise an amplitude to a power", "drop 'peak', 'pp' or 'rms'", a.begin, b.end);
  auto const d = power_of(p.dimension, q.si);
  if (!d)
    refuse(fmt::format("cannot raise {} to this power", described(p.dimension)),
           "use whole or half powers of quantities with a unit", a.begin, b.end);
  return finite({std::pow(p.si, q.si), *d, {}}, a.begin, b.end);
}

Operand call(std::string_view name, std::span<Operand const> arguments, std::size_t begin, std::size_t end) {
  bool const many = name == "min" || name == "max";
  std::size_t const wanted = name == "atan2" ? 2 : 1;
  if (many ? arguments.empty() : arguments.size() != wanted)
    refuse(fmt::format("{}() takes {} argument{}, got {}", name, many ? "at least 1" : std::to_string(wanted),
                       wanted == 1 ? "" : "s", arguments.size()),
           "check the commas", begin, end);
  if (many || name == "atan2") return of_equals(name, arguments, begin, end);
  Operand const& x = arguments[0];
  if (name == "abs") {
    Quantity q = x.value.quantity;
    q.si = std::abs(q.si);
    return finite(q, begin, end, x.value.bare_zero);
  }
  if (x.value.quantity.amplitude != Amplitude::none)
    refuse(fmt::format("{}() of an amplitude has no meaning", name), "drop 'peak', 'pp' or 'rms'", x.begin, x.end);
  if (name == "sqrt") return root(x, begin, end);
  if (name == "curvature") return inverse_radius(x, begin, end);
  return elementary(name, x, begin, end);
}

}  // namespace straytrace
