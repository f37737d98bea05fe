// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/files/unit_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <vector>

#include "base/units/quantity.hpp"

namespace straytrace::spectra {
namespace {

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

std::string renamed(std::string const& name) {
  if (name == "ct" || name == "counts") return "count";
  if (name == "inch") return "in";
  if (name == "strain") return "1";
  return name;
}

// Exponent without '^' behind a name, as in "s2", "s-1" and "Hz(1/2)", or with it; advances `at`.
std::string exponent(std::string_view text, std::size_t& at) {
  std::size_t from = at;
  if (text.substr(from).starts_with("**"))
    from += 2;
  else if (text.substr(from).starts_with('^'))
    from += 1;
  std::size_t end = from;
  if (end < text.size() && text[end] == '(') {
    end = text.find(')', end);
    if (end == text.npos || text.substr(from, end - from).find_first_not_of("(0123456789/-.") != text.npos) return "";
    ++end;
  } else {
    if (end < text.size() && text[end] == '-') ++end;
    while (end < text.size() && (is_digit(text[end]) || text[end] == '.')) ++end;
    if (end == from || !is_digit(text[end - 1])) return "";
  }
  at = end;
  return std::string(text.substr(from, end - from));
}

// "m / (s2 V)" -> "m/(s^2*V)".
std::string translated(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    char const c = text[at];
    if (c == ' ' || c == '.') {
      ++at;
      bool const between = !out.empty() && at < text.size() && (is_letter(text[at]) || text[at] == '(') &&
                           std::string_view("/*(").find(out.back()) == std::string_view::npos;
      if (between) out += '*';
    } else if (is_letter(c) || static_cast<unsigned char>(c) >= 0x80 || c == '%') {
      std::size_t const begin = at;
      while (at < text.size() &&
             (is_letter(text[at]) || static_cast<unsigned char>(text[at]) >= 0x80 || text[at] == '%'))
        ++at;
      std::string const name = renamed(std::string(text.substr(begin, at - begin)));
      std::string const power = exponent(text, at);
      out += power == "(1/2)" ? fmt::format("sqrt({})", name)
             : power.empty()  ? name
                              : fmt::format("{}^{}", name, power);
    } else {
      out += c;
      ++at;
    }
  }
  return out;
}

struct Factor {
  std::string name;
  double power;
};

// A unit that parse_unit reads, as factors.
class Factors {
 public:
  explicit Factors(std::string_view text) : text_(text) { product(1); }
  std::vector<Factor> found;

 private:
  bool take(char c) {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  void product(double power) {
    double sign = take('/') ? -1 : 1;
    term(sign * power);
    while (true) {
      if (take('*'))
        sign = 1;
      else if (take('/'))
        sign = -1;
      else
        return;
      term(sign * power);
    }
  }

  void term(double power) {
    std::size_t const first = found.size();
    if (take('(')) {
      product(power);
      take(')');
    } else {
      std::size_t const begin = at_;
      while (at_ < text_.size() && std::string_view("*/^() ").find(text_[at_]) == std::string_view::npos) ++at_;
      std::string const name(text_.substr(begin, at_ - begin));
      if (name == "sqrt" && take('(')) {
        product(power / 2);
        take(')');
      } else if (name != "1" && !name.empty()) {
        found.push_back({name, power});
      }
    }
    if (!take('^')) return;
    double const raised = exponent_value();
    for (std::size_t i = first; i < found.size(); ++i) found[i].power *= raised;
  }

  double exponent_value() {
    bool const bracket = take('(');
    double const above = number(), value = bracket && take('/') ? above / number() : above;
    if (bracket) take(')');
    return value;
  }

  double number() {
    double value = 1;
    auto const [end, code] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (code == std::errc()) at_ = std::size_t(end - text_.data());
    return value;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

std::string astropy_factor(Factor const& f) {
  std::string const name = f.name == "count" ? "ct" : f.name == "in" ? "inch" : f.name;
  double const power = std::abs(f.power);
  if (power == 1) return name;
  if (power == std::round(power)) return fmt::format("{}{:.0f}", name, power);
  return fmt::format("{}({:.0f}/2)", name, 2 * power);
}

bool is_single_name(std::string const& unit) {
  return !unit.empty() && std::ranges::all_of(unit, [](char c) { return is_letter(c) || c == '%'; });
}

std::string grouped(std::string const& unit) {
  return unit == "1" || is_single_name(unit) ? unit : fmt::format("({})", unit);
}

}  // namespace

std::optional<std::string> unit_of_file(std::string_view text) {
  std::string const plain(text.substr(0, text.find_last_not_of(' ') + 1));
  if (plain.empty() || plain == "dimensionless" || plain == "strain") return "1";
  if (parse_unit(plain)) return plain;
  std::string const other = translated(plain);
  if (parse_unit(other)) return other;
  return {};
}

std::string gwpy_unit(std::string_view unit) {
  Factors const factors(unit);
  std::vector<std::string> above, below;
  for (Factor const& f : factors.found)
    if (f.power != 0) (f.power > 0 ? above : below).push_back(astropy_factor(f));
  std::string const top = fmt::format("{}", fmt::join(above, " "));
  if (below.empty()) return top;
  std::string const bottom = fmt::format("{}", fmt::join(below, " "));
  return fmt::format("{} / {}", top.empty() ? "1" : top, below.size() > 1 ? fmt::format("({})", bottom) : bottom);
}

std::string asd_unit(std::string const& unit) { return unit + "/sqrt(Hz)"; }

std::string psd_unit(std::string const& unit) {
  std::string above, below;
  for (Factor const& f : Factors(unit).found) {
    double const power = 2 * std::abs(f.power);
    std::string const part = power == 1 ? f.name : fmt::format("{}^{:g}", f.name, power);
    if (f.power > 0) above += (above.empty() ? "" : "*") + part;
    if (f.power < 0) below += "/" + part;
  }
  return (above.empty() ? "1" : above) + below + "/Hz";
}

std::string ratio_unit(std::string const& above, std::string const& below) {
  if (above == below) return "1";
  return below == "1" ? above : fmt::format("{}/{}", above, grouped(below));
}

}  // namespace straytrace::spectra
