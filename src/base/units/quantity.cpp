// SPDX-License-Identifier: BSD-3-Clause
#include "base/units/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

#include "base/math/constants.hpp"
#include "base/text/words.hpp"

namespace straytrace {
namespace {

struct Unit {
  std::string_view name;
  double factor;
  Dimension dimension;
};

constexpr Dimension solid_angle{0, 0, 0, 0, 2}, counts{0, 0, 0, 0, 0, 2}, voltage{0, 0, 0, 0, 0, 0, 2};

constexpr std::array units{
    Unit{"m", 1, dim::length},
    Unit{"km", 1e3, dim::length},
    Unit{"cm", 1e-2, dim::length},
    Unit{"mm", 1e-3, dim::length},
    Unit{"um", 1e-6, dim::length},
    Unit{"nm", 1e-9, dim::length},
    Unit{"pm", 1e-12, dim::length},
    Unit{"in", 0.0254, dim::length},
    Unit{"rad", 1, dim::angle},
    Unit{"mrad", 1e-3, dim::angle},
    Unit{"urad", 1e-6, dim::angle},
    Unit{"nrad", 1e-9, dim::angle},
    Unit{"deg", pi / 180, dim::angle},
    Unit{"arcmin", pi / 10800, dim::angle},
    Unit{"arcsec", pi / 648000, dim::angle},
    Unit{"sr", 1, solid_angle},
    Unit{"s", 1, dim::time},
    Unit{"ms", 1e-3, dim::time},
    Unit{"us", 1e-6, dim::time},
    Unit{"min", 60, dim::time},
    Unit{"h", 3600, dim::time},
    Unit{"Hz", 1, dim::frequency},
    Unit{"kHz", 1e3, dim::frequency},
    Unit{"mHz", 1e-3, dim::frequency},
    Unit{"MHz", 1e6, dim::frequency},
    Unit{"W", 1, dim::power},
    Unit{"kW", 1e3, dim::power},
    Unit{"mW", 1e-3, dim::power},
    Unit{"uW", 1e-6, dim::power},
    Unit{"nW", 1e-9, dim::power},
    Unit{"MW", 1e6, dim::power},
    Unit{"kg", 1, dim::mass},
    Unit{"g", 1e-3, dim::mass},
    Unit{"count", 1, counts},
    Unit{"V", 1, voltage},
    Unit{"%", 1e-2, dim::plain},
    Unit{"ppm", 1e-6, dim::plain},
    Unit{"ppb", 1e-9, dim::plain},
};

// Units of sensors, for data files only: in scenes N, T and A are names of parameters.
constexpr std::array sensor_units{Unit{"N", 1, {2, 2, -4}},
                                  Unit{"kN", 1e3, {2, 2, -4}},
                                  Unit{"Pa", 1, {-2, 2, -4}},
                                  Unit{"mPa", 1e-3, {-2, 2, -4}},
                                  Unit{"uPa", 1e-6, {-2, 2, -4}},
                                  Unit{"T", 1, {-4, 0, 2, 0, 0, 0, 2}},
                                  Unit{"nT", 1e-9, {-4, 0, 2, 0, 0, 0, 2}},
                                  Unit{"pT", 1e-12, {-4, 0, 2, 0, 0, 0, 2}},
                                  Unit{"A", 1, {4, 2, -6, 0, 0, 0, -2}},
                                  Unit{"mV", 1e-3, voltage},
                                  Unit{"uV", 1e-6, voltage}};

struct Meant {
  std::string_view written, unit;
};
constexpr std::array spellings{
    Meant{"metre", "m"},    Meant{"metres", "m"},    Meant{"meter", "m"},      Meant{"meters", "m"},
    Meant{"sec", "s"},      Meant{"second", "s"},    Meant{"seconds", "s"},    Meant{"micron", "um"},
    Meant{"microns", "um"}, Meant{"degree", "deg"},  Meant{"degrees", "deg"},  Meant{"inch", "in"},
    Meant{"inches", "in"},  Meant{"hour", "h"},      Meant{"hours", "h"},      Meant{"hertz", "Hz"},
    Meant{"watt", "W"},     Meant{"watts", "W"},     Meant{"percent", "%"},    Meant{"counts", "count"},
    Meant{"volt", "V"},     Meant{"volts", "V"},     Meant{"minute", "min"},   Meant{"minutes", "min"},
    Meant{"radian", "rad"}, Meant{"radians", "rad"}, Meant{"steradian", "sr"}, Meant{"\xc2\xb0", "deg"},
};

template <class List>
Unit const* find_in(List const& list, std::string_view name) {
  auto const hit = std::ranges::find_if(list, [&](Unit const& u) { return u.name == name; });
  return hit == list.end() ? nullptr : &*hit;
}
Unit const* find_unit(std::string_view name) { return find_in(units, name); }

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Reads a unit expression; every function moves `at_` past the part that it understood.
class UnitReader {
 public:
  explicit UnitReader(std::string_view text, bool sensors = false) : text_(text), sensors_(sensors) {}

  std::size_t at() const { return at_; }
  void skip_spaces() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }
  bool take(char c) {
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  // term {(* | /) term}; a leading '/' stands for 1/.
  std::optional<Quantity> product(int depth) {
    if (depth > 8) return {};
    skip_spaces();
    Quantity result{1, {}, {}};
    bool const inverse = take('/');
    if (inverse) skip_spaces();
    if (auto const first = term(depth, inverse); !first || !join(result, *first, inverse ? -1 : 1)) return {};
    for (;;) {
      std::size_t const before = at_;
      skip_spaces();
      int const sign = take('*') ? 1 : take('/') ? -1 : 0;
      skip_spaces();
      auto const next = sign == 0 ? std::optional<Quantity>{} : term(depth, true);
      if (!next || !join(result, *next, sign)) {
        at_ = before;
        return result;
      }
    }
  }

 private:
  static bool join(Quantity& into, Quantity const& next, int sign) {
    auto const d = times(into.dimension, next.dimension, sign);
    if (!d) return false;
    into.dimension = *d;
    into.si = sign > 0 ? into.si * next.si : into.si / next.si;
    return true;
  }

  std::optional<Quantity> term(int depth, bool brackets) {
    if (brackets && take('(')) {
      auto const inner = product(depth + 1);
      skip_spaces();
      if (!inner || !take(')')) return {};
      return raised(*inner);
    }
    std::string const name = read_name();
    if (name == "sqrt") {
      if (!take('(')) return {};
      auto const inner = product(depth + 1);
      skip_spaces();
      if (!inner || !take(')')) return {};
      auto const d = power_of(inner->dimension, 0.5);
      if (!d) return {};
      return Quantity{std::sqrt(inner->si), *d, {}};
    }
    Unit const* unit = find_unit(name);
    if (!unit && sensors_) unit = find_in(sensor_units, name);
    if (!unit || (at_ < text_.size() && text_[at_] == '(')) return {};
    return raised({unit->factor, unit->dimension, {}});
  }

  // Both code points of the micro sign are read as u.
  std::string read_name() {
    std::string name;
    if (take('%')) return "%";
    while (at_ < text_.size()) {
      std::string_view const rest = text_.substr(at_);
      if (rest.starts_with("\xc2\xb5") || rest.starts_with("\xce\xbc")) {
        name += 'u';
        at_ += 2;
      } else if (is_letter(rest[0]) || (!name.empty() && is_digit(rest[0]))) {
        name += rest[0];
        ++at_;
      } else {
        break;
      }
    }
    return name;
  }

  std::optional<Quantity> raised(Quantity base) {
    std::size_t const before = at_;
    skip_spaces();
    if (!take('^')) {
      at_ = before;
      return base;
    }
    skip_spaces();
    bool const bracket = take('(');
    auto exponent = real();
    if (exponent && bracket && take('/')) {
      auto const below = real();
      exponent = below && *below != 0 ? std::optional(*exponent / *below) : std::nullopt;
    }
    if (!exponent || (bracket && !take(')'))) return {};
    auto const d = power_of(base.dimension, *exponent);
    if (!d) return {};
    return Quantity{std::pow(base.si, *exponent), *d, {}};
  }

  std::optional<double> real() {
    double value = 0;
    char const* begin = text_.data() + at_;
    auto const [end, code] = std::from_chars(begin, text_.data() + text_.size(), value, std::chars_format::fixed);
    if (code != std::errc() || !(std::abs(value) < 100)) return {};
    at_ += static_cast<std::size_t>(end - begin);
    return value;
  }

  std::string_view text_;
  bool sensors_;
  std::size_t at_ = 0;
};

constexpr std::array<std::int8_t Dimension::*, 7> bases{&Dimension::metre,  &Dimension::kilogram,  &Dimension::second,
                                                        &Dimension::radian, &Dimension::steradian, &Dimension::count,
                                                        &Dimension::volt};

// Limit of half powers, far below the range of the counter.
constexpr double largest_power = 100;

}  // namespace

std::optional<Quantity> parse_unit(std::string_view written) {
  std::string const spaced = with_plain_spaces(written);
  std::string_view text = spaced;
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  UnitReader reader(text);
  reader.skip_spaces();
  if (reader.take('1')) {
    if (reader.at() == text.size()) return Quantity{1, {}, {}};
    text.remove_prefix(reader.at());
    auto const after = text.find_first_not_of(' ');
    if (after == std::string_view::npos || text[after] != '/') return {};
  }
  UnitReader whole(text, true);
  auto const unit = whole.product(0);
  if (!unit || whole.at() != text.size()) return {};
  return unit;
}

std::optional<LeadingUnit> leading_unit(std::string_view text) {
  UnitReader reader(text);
  auto const unit = reader.product(0);
  if (!unit) return {};
  return LeadingUnit{*unit, reader.at()};
}

bool is_unit_name(std::string_view name) { return find_unit(name) != nullptr; }

std::string likely_unit(std::string_view written) {
  auto const same = [](std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
      return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
    });
  };
  for (Meant const& m : spellings)
    if (same(m.written, written)) return std::string(m.unit);
  for (Unit const& u : units)
    if (same(u.name, written)) return std::string(u.name);
  return {};
}

std::string all_unit_names() {
  std::string out;
  for (Unit const& u : units) (out += out.empty() ? "" : " ") += u.name;
  return out;
}

double to_si(double value, Quantity const& unit) {
  double const inverse = std::round(1 / unit.si);
  bool const whole = unit.si < 1 && std::abs(unit.si * inverse - 1) < 1e-15;
  return whole ? value / inverse : value * unit.si;
}

std::optional<Dimension> times(Dimension a, Dimension b, int sign) {
  Dimension result;
  for (auto const base : bases) {
    int const sum = a.*base + sign * b.*base;
    if (std::abs(sum) > largest_power) return {};
    result.*base = static_cast<std::int8_t>(sum);
  }
  return result;
}

std::optional<Dimension> power_of(Dimension d, double exponent) {
  Dimension result;
  for (auto const base : bases) {
    double const power = d.*base * exponent;
    if (!(std::abs(power) <= largest_power) || power != std::round(power)) return {};
    result.*base = static_cast<std::int8_t>(power);
  }
  return result;
}

// Names of dimensions in messages.

namespace {

struct Named {
  Dimension dimension;
  std::string_view name, example, accepted;
};

constexpr Dimension area{4};

constexpr std::array named{
    Named{dim::plain, "plain number", "", "a plain number, %, ppm, ppb"},
    Named{dim::length, "length", "m", "m, km, cm, mm, um, nm, in"},
    Named{dim::angle, "angle", "deg", "rad, mrad, urad, deg, arcmin, arcsec"},
    Named{dim::mass, "mass", "kg", "kg, g"},
    Named{dim::time, "time", "s", "s, ms, us, min, h"},
    Named{dim::frequency, "frequency", "Hz", "Hz, kHz, MHz, mHz"},
    Named{dim::power, "power", "W", "W, kW, MW, mW, uW, nW"},
    Named{area, "area", "m^2", "m^2, cm^2, mm^2"},
    Named{dim::brdf, "BRDF (1/sr)", "1/sr", "1/sr"},
    Named{dim::per_metre, "curvature (1/m)", "1/m", "1/m, 1/km, 1/cm, 1/mm"},
    Named{{0, 0, 0, 0, 2}, "solid angle", "sr", "sr"},
    Named{{-2, -2, 6}, "length per power", "m/W", "m/W, m/mW, nm/W, nm/mW"},
    Named{{0, 0, 0, 0, 0, 2}, "number of counts", "count", "count"},
    Named{{0, 0, 0, 0, 0, 0, 2}, "voltage", "V", "V"},
    Named{{2, 0, -2}, "speed", "m/s", "m/s, mm/s, um/s, nm/s"},
    Named{{2, 0, -4}, "acceleration", "m/s^2", "m/s^2, mm/s^2, um/s^2, nm/s^2"},
    Named{dim::displacement_asd, "displacement density (m/sqrt(Hz))", "m/sqrt(Hz)",
          "m/sqrt(Hz), mm/sqrt(Hz), um/sqrt(Hz), nm/sqrt(Hz)"},
    Named{dim::displacement_psd, "displacement power density (m^2/Hz)", "m^2/Hz", "m^2/Hz, um^2/Hz, nm^2/Hz"},
    Named{dim::angle_asd, "angle density (rad/sqrt(Hz))", "rad/sqrt(Hz)", "rad/sqrt(Hz), mrad/sqrt(Hz), urad/sqrt(Hz)"},
    Named{dim::angle_psd, "angle power density (rad^2/Hz)", "rad^2/Hz", "rad^2/Hz, urad^2/Hz"},
};

Named const* find(Dimension d) {
  for (Named const& n : named)
    if (n.dimension == d) return &n;
  return nullptr;
}

std::string powered(std::string_view symbol, int halves) {
  if (halves == 2) return std::string(symbol);
  if (halves == 1) return fmt::format("sqrt({})", symbol);
  return fmt::format("{}^{:g}", symbol, halves / 2.0);
}

std::string si_symbols(Dimension d) {
  if (d.second % 2 != 0) {  // a density per root hertz reads better than root seconds
    Dimension rest = d;
    rest.second = static_cast<std::int8_t>(d.second - 1);
    return fmt::format("{}/sqrt(Hz)", si_symbols(rest));
  }
  std::array<std::pair<std::string_view, int>, 7> const parts{{{"m", d.metre},
                                                               {"kg", d.kilogram},
                                                               {"s", d.second},
                                                               {"rad", d.radian},
                                                               {"sr", d.steradian},
                                                               {"count", d.count},
                                                               {"V", d.volt}}};
  std::string above, below;
  for (auto const& [symbol, halves] : parts) {
    if (halves > 0) (above += above.empty() ? "" : "*") += powered(symbol, halves);
    if (halves < 0) below += fmt::format("/{}", powered(symbol, -halves));
  }
  return (above.empty() ? "1" : above) + below;
}

}  // namespace

std::string name_of(Dimension d) {
  Named const* hit = find(d);
  return hit ? std::string(hit->name) : si_symbols(d);
}

std::string example_unit(Dimension d) {
  Named const* hit = find(d);
  return hit ? std::string(hit->example) : si_symbols(d);
}

std::string accepted_units(Dimension d) {
  Named const* hit = find(d);
  return hit ? std::string(hit->accepted) : si_symbols(d);
}

std::string described(Dimension d) {
  Named const* hit = find(d);
  if (!hit) return fmt::format("a quantity in {}", si_symbols(d));
  bool const vowel = std::string_view("aeiou").find(hit->name.front()) != std::string_view::npos;
  return fmt::format("{} {}", vowel ? "an" : "a", hit->name);
}

std::string with_unit(std::string const& number, Dimension d) {
  std::string unit = example_unit(d);
  if (unit.starts_with("1/")) unit.erase(0, 1);
  return unit.empty() ? number : number + " " + unit;
}

}  // namespace straytrace
