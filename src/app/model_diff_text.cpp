// SPDX-License-Identifier: BSD-3-Clause
// What differs between two models, for people: readable numbers, and one line for what many instances do.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/model_diff.hpp"
#include "base/constants.hpp"

namespace straytrace {
namespace {

struct Unit {
  Dimension dimension;
  double factor;
  char const* name;
};
constexpr double degree = 0.017453292519943295;
// Of one dimension the largest first; the last one is for all that is smaller.
constexpr std::array<Unit, 15> units{
    Unit{dim::length, 1e3, "km"}, {dim::length, 1, "m"},     {dim::length, 1e-2, "cm"},   {dim::length, 1e-3, "mm"},
    {dim::length, 1e-6, "um"},    {dim::length, 1e-9, "nm"}, {dim::angle, degree, "deg"}, {dim::angle, 1e-3, "mrad"},
    {dim::angle, 1e-6, "urad"},   {dim::power, 1e6, "MW"},   {dim::power, 1e3, "kW"},     {dim::power, 1, "W"},
    {dim::power, 1e-3, "mW"},     {dim::power, 1e-6, "uW"},  {dim::mass, 1, "kg"}};

Unit const* unit_for(Quantity const& q) {
  Unit const* best = nullptr;
  for (Unit const& u : units)
    if (u.dimension == q.dimension && (!best || std::fabs(q.si) < best->factor)) best = &u;
  return best;
}

std::string in_unit(double si, Unit const& u, int digits) {
  return fmt::format("{:.{}g} {}", si / u.factor, digits, u.name);
}

// "49.5 cm -> 48 cm": as many digits as tell them apart.
std::string change(Difference const& d) {
  if (!d.was || !d.is || d.was->dimension != d.is->dimension) return d.before + " -> " + d.after;
  Quantity const larger = std::fabs(d.was->si) > std::fabs(d.is->si) ? *d.was : *d.is;
  Unit const* const unit = unit_for(larger);
  auto const text = [&](Quantity const& q, std::string const& as_given, int digits) {
    std::string out =
        unit ? in_unit(q.si, *unit, digits) : with_unit(fmt::format("{:.{}g}", q.si, digits), q.dimension);
    if (!unit && q.dimension == dim::angle) return as_given;  // in rad
    out += q.amplitude == Amplitude::peak ? " peak" : q.amplitude == Amplitude::rms ? " rms" : "";
    out += q.amplitude == Amplitude::peak_to_peak ? " pp" : "";
    return out + (as_given.ends_with(" (default)") ? " (default)" : "");
  };
  for (int digits = 5; digits < 17; digits += 3)
    if (std::string const a = text(*d.was, d.before, digits), b = text(*d.is, d.after, digits); a != b)
      return a + " -> " + b;
  return d.before + " -> " + d.after;
}

// A number that is there once.
std::string alone(std::string const& text, std::optional<Quantity> const& q) {
  Unit const* const unit = q ? unit_for(*q) : nullptr;
  return unit ? in_unit(q->si, *unit, 5) : text;
}

std::string in_words(Difference const& d) {
  if (d.before.empty()) return d.key.empty() ? "is new" : "now " + alone(d.after, d.is);
  if (d.after.empty()) return d.key.empty() ? "is gone" : "no longer given, was " + alone(d.before, d.was);
  return change(d);
}

constexpr std::size_t most_lines = 3;  // of one key of a group

bool same_key(Difference const& a, Difference const& b) {
  return a.section == b.section && a.name == b.name && a.key == b.key;
}

// "60 instances, by 1.2 mm to 3.4 m; the first: 55.2 m -> 55.1 m"
std::string many(std::vector<Difference>::const_iterator first, std::vector<Difference>::const_iterator last) {
  std::size_t instances = 0;
  double least = infinity, most = 0;
  bool numbers = true;
  for (auto d = first; d != last; ++d) {
    instances += d->instances;
    numbers = numbers && d->was && d->is;
    if (!d->was || !d->is) continue;
    least = std::min(least, std::fabs(d->is->si - d->was->si));
    most = std::max(most, std::fabs(d->is->si - d->was->si));
  }
  std::string text = fmt::format("{} instances", instances);
  if (Unit const* const u = numbers ? unit_for({most, first->was->dimension}) : nullptr)
    text += fmt::format(", by {} to {}", in_unit(least, *u, 3), in_unit(most, *u, 3));
  return text + "; the first: " + in_words(*first);
}

}  // namespace

std::string difference_text(std::vector<Difference> const& parameters, std::vector<Difference> const& all) {
  if (all.empty()) return "no physical difference between the models\n";
  std::string text = parameters.empty() ? "" : "parameters\n", section;
  for (Difference const& p : parameters) text += fmt::format("  {}: {}\n", p.key, in_words(p));
  std::vector<Difference> sorted = all;  // lines of one key together, where its first stood
  for (auto d = sorted.begin(); d != sorted.end(); ++d)
    d = std::prev(std::stable_partition(d, sorted.end(), [key = *d](Difference const& o) { return same_key(o, key); }));
  for (auto d = sorted.cbegin(); d != sorted.cend();) {
    if (d->section != section) text += (section = d->section) + "\n";
    std::string const named = d->name + (d->name.empty() || d->key.empty() ? "" : " ") + d->key;
    std::string const what = named.empty() ? section : named;
    auto const last = std::find_if(d, sorted.cend(), [&](Difference const& o) { return !same_key(o, *d); });
    if (std::size_t(last - d) > most_lines) {
      text += fmt::format("  {}: {}\n", what, many(d, last));
      d = last;
    }
    for (; d != last; ++d)
      text += fmt::format("  {}: {}{}\n", what, in_words(*d),
                          d->instances > 1 ? fmt::format(" ({} instances)", d->instances) : "");
  }
  return text;
}

}  // namespace straytrace
