// SPDX-License-Identifier: BSD-3-Clause
#include "scene/expression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <string>

#include "base/text/words.hpp"

namespace straytrace::scene {
namespace {

constexpr int deepest_expression = 64;
constexpr std::array<std::string_view, 3> amplitude_words{"peak", "pp", "rms"};
constexpr std::array<std::string_view, 11> function_names{"sqrt", "abs",   "min", "max", "sin",      "cos",
                                                          "tan",  "atan2", "exp", "log", "curvature"};

struct BrokenParameter {};

bool is_digit(char c) { return c >= '0' && c <= '9'; }
// Bytes of other alphabets count as letters, so that messages show whole words.
bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || static_cast<unsigned char>(c) >= 0x80;
}
bool is_function(std::string_view word) { return std::ranges::find(function_names, word) != function_names.end(); }
bool is_amplitude_word(std::string_view word) {
  return std::ranges::find(amplitude_words, word) != amplitude_words.end();
}

// Dimension-checked arithmetic. Every function throws ExpressionProblem if it cannot compute the result.

// A value and the bytes of the text it came from.
struct Operand {
  Value value;
  std::size_t begin = 0, end = 0;
  bool literal = false;  // a number as written, with or without a unit
};

[[noreturn]] void refuse(std::string what, std::string suggestion, std::size_t begin, std::size_t end) {
  throw ExpressionProblem{std::move(what), std::move(suggestion), begin, end};
}

Operand finite(Quantity const& q, std::size_t begin, std::size_t end, bool bare_zero = false) {
  if (!std::isfinite(q.si))
    refuse("the result is not a finite number", "check for a division by zero or an exponent that is too large", begin,
           end);
  return {{q, bare_zero}, begin, end, false};
}

// A bare 0 takes the dimension and kind of its neighbour.
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
  if (q.si < 0) refuse("the square root of a negative number", "check the sign of the argument", x.begin, x.end);
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
  auto const best = name == "min" ? std::ranges::min_element(x, less) : std::ranges::max_element(x, less);
  bool const all_bare = std::ranges::all_of(x, [](Operand const& a) { return a.value.bare_zero; });
  return finite(best->value.quantity, begin, end, all_bare);
}

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

// `curvature(R)` is 1/R, and 0 for R = 0, which means flat. [begin, end) are the bytes of the whole call.
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

// Grammar, binding from loose to tight; a unit belongs to the number right before it:
//   sum = product {(+|-) product}   product = signed {(*|/) signed}   signed = [-|+] power   power = primary [^ signed]
//   primary = number [unit] | name | function ( sum {, sum} ) | ( sum )
class Parser {
 public:
  Parser(std::string_view text, ParameterLookup const& lookup) : text_(text), lookup_(lookup) {}

  Value whole() {
    skip_spaces();
    if (at_ == text_.size()) refuse("the value is empty", "write a number", 0, text_.size());
    if (text_.ends_with("dB")) return decibel();
    Operand result = sum();
    skip_spaces();
    std::size_t const begin = at_;
    std::string_view const kind = word();
    if (is_amplitude_word(kind)) {
      if (result.value.quantity.amplitude != Amplitude::none)
        refuse("the kind of amplitude is stated twice", "keep one of peak, pp, rms", begin, at_);
      result.value.quantity.amplitude = kind == "peak" ? Amplitude::peak
                                        : kind == "pp" ? Amplitude::peak_to_peak
                                                       : Amplitude::rms;
      skip_spaces();
    } else {
      at_ = begin;
    }
    if (at_ < text_.size()) leftover();
    return result.value;
  }

 private:
  void skip_spaces() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n')) ++at_;
  }
  char peek() {
    skip_spaces();
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char c) {
    if (peek() != c) return false;
    ++at_;
    return true;
  }
  std::string_view word() {
    std::size_t const begin = at_;
    while (at_ < text_.size() && (is_letter(text_[at_]) || (at_ > begin && is_digit(text_[at_])))) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  [[noreturn]] void leftover() {
    std::size_t const begin = at_;
    if (text_[at_] == ',') refuse("a comma inside a number", "write a decimal point: 1.5, not 1,5", begin, begin + 1);
    bool const point = text_[at_] == '.' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1]);
    if (is_digit(text_[at_]) || point)
      refuse("two numbers without an operator between them",
             "write one number without spaces, or an operator between them", begin, text_.size());
    std::string_view const next = word();
    std::size_t const end = next.empty() ? text_.size() : at_;
    std::vector<std::string> const kinds(amplitude_words.begin(), amplitude_words.end());
    refuse(fmt::format("cannot understand '{}' here", shortened(text_.substr(begin, end - begin))),
           did_you_mean(next, kinds,
                        "write a number with a unit, or an expression of parameters with + - * / ^ and brackets"),
           begin, end);
  }

  // A power ratio; the sign is kept: 37 dB is 10^3.7, -37 dB is 10^-3.7.
  Value decibel() {
    std::string_view number = text_.substr(at_, text_.size() - 2 - at_);
    while (!number.empty() && number.back() == ' ') number.remove_suffix(1);
    if (!is_number(number)) refuse("dB must follow a single number", "write for example '37 dB'", at_, text_.size());
    number.remove_prefix(number.front() == '+');
    double value = 0;
    std::from_chars(number.data(), number.data() + number.size(), value);
    double const ratio = std::pow(10, value / 10);
    if (!std::isfinite(ratio)) refuse("the number is too large", "write a value below 3000 dB", at_, text_.size());
    if (ratio == 0) refuse("the number is too small", "write a value above -3000 dB", at_, text_.size());
    return {{ratio, dim::plain, {}}, false};
  }

  Operand sum() {
    if (++depth_ > deepest_expression)
      refuse("the expression is nested too deeply", "split it into parameters", at_, std::min(at_ + 1, text_.size()));
    Operand left = product();
    for (char c = peek(); c == '+' || c == '-'; c = peek()) {
      ++at_;
      Operand const right = product();
      left = add(left, right, c == '+' ? 1 : -1, text_);
    }
    --depth_;
    return left;
  }

  Operand product() {
    Operand left = signed_power();
    for (char c = peek(); c == '*' || c == '/'; c = peek()) {
      ++at_;
      Operand const right = signed_power();
      left = c == '*' ? multiply(left, right, text_) : divide(left, right, text_);
    }
    return left;
  }

  Operand signed_power() {
    skip_spaces();
    std::size_t const begin = at_;
    bool const minus = peek() == '-';
    if (!minus && peek() != '+') return power();
    ++at_;
    if (++depth_ > deepest_expression) refuse("the expression is nested too deeply", "remove signs", begin, at_);
    Operand inner = signed_power();
    --depth_;
    if (minus) inner.value.quantity.si = -inner.value.quantity.si;
    inner.begin = begin;
    return inner;
  }

  Operand power() {
    Operand base = primary();
    if (peek() != '^') return base;
    ++at_;
    if (++depth_ > deepest_expression) refuse("the expression is nested too deeply", "use brackets", at_ - 1, at_);
    Operand const exponent = signed_power();
    --depth_;
    return raise(base, exponent, text_);
  }

  Operand primary() {
    char const c = peek();
    std::size_t const begin = at_;
    if (is_digit(c) || (c == '.' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1]))) return number();
    if (is_letter(c)) return name();
    if (take('(')) {
      Operand inner = sum();
      if (!take(')')) refuse("a bracket is not closed", "add ')'", begin, begin + 1);
      return {inner.value, begin, at_, false};
    }
    if (at_ >= text_.size()) refuse("the expression ends too early", "add what follows the operator", 0, text_.size());
    leftover();
  }

  Operand number() {
    std::size_t const begin = at_;
    double value = 0;
    auto const [end, code] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    at_ = static_cast<std::size_t>(end - text_.data());
    if (code != std::errc() || !std::isfinite(value))
      refuse("the number is outside the range of double precision", "write a number between 1e-307 and 1e308", begin,
             at_);
    if (auto const unit = leading_unit(text_.substr(at_))) {
      at_ += unit->length;
      Operand const result{{{to_si(value, unit->unit), unit->unit.dimension, {}}, false}, begin, at_, true};
      if (!std::isfinite(result.value.quantity.si)) refuse("the number is too large", "check the exponent", begin, at_);
      if (result.value.quantity.si == 0 && value != 0)
        refuse("the number is too small", "check the exponent", begin, at_);
      return result;
    }
    std::size_t const number_end = at_;
    skip_spaces();
    if (at_ < text_.size() && is_letter(text_[at_])) refuse_suffix(begin, number_end);
    return {{{value, dim::plain, {}}, value == 0}, begin, number_end, true};
  }

  // A word after a bare number: an amplitude kind is read later, anything else is not a unit.
  void refuse_suffix(std::size_t begin, std::size_t number_end) {
    std::size_t const start = at_;
    std::string const suffix(word());
    std::size_t const stop = at_;
    at_ = start;
    if (is_amplitude_word(suffix)) return;
    std::string const digits(text_.substr(begin, number_end - begin)), meant = likely_unit(suffix);
    std::string const what = fmt::format("'{}' is not a unit", shortened(suffix));
    if (lookup_.find(suffix).known)
      refuse(fmt::format("an operator is missing before '{}'", suffix), fmt::format("write '{}*{}'", digits, suffix),
             begin, stop);
    if (!meant.empty()) refuse(what, fmt::format("write '{} {}'", digits, meant), start, stop);
    refuse(what, "known units: " + all_unit_names(), start, stop);
  }

  Operand name() {
    std::size_t const begin = at_;
    std::string const id(word());
    if (peek() == '(' && (is_function(id) || !lookup_.find(id).known)) return function(id, begin);
    if (auto const unit = leading_unit(id); unit && unit->length == id.size())
      refuse(fmt::format("unit '{}' has no number before it", id), fmt::format("write '1 {}'", id), begin,
             begin + id.size());
    auto const found = lookup_.find(id);
    if (found.known && !found.value) throw BrokenParameter{};
    if (found.known) return {*found.value, begin, begin + id.size(), false};
    if (id == "nan" || id == "inf" || id == "infinity")
      refuse(fmt::format("'{}' is not a finite number", id), "write a number", begin, at_);
    std::vector<std::string> const names = lookup_.names();
    refuse(fmt::format("parameter '{}' is not defined", shortened(id)),
           did_you_mean(id, names, "write a number with its unit, or define the name under 'params'"), begin,
           begin + id.size());
  }

  // count(baffles/*): what the brackets hold is a name, not an expression.
  Operand call_of_name(std::string const& id, std::size_t begin) {
    take('(');
    skip_spaces();
    std::size_t const start = at_, close = std::min(text_.find(')', at_), text_.size());
    if (close == text_.size()) refuse("a bracket is not closed", "add ')'", begin, at_);
    std::string_view name = text_.substr(start, close - start);
    while (!name.empty() && name.back() == ' ') name.remove_suffix(1);
    at_ = close + 1;
    try {
      return {lookup_.called(id, name), begin, at_, false};
    } catch (ExpressionProblem& p) {
      p.begin = start;
      p.end = start + name.size();
      throw;
    }
  }

  Operand function(std::string const& id, std::size_t begin) {
    if (std::ranges::find(lookup_.calls, id) != lookup_.calls.end()) return call_of_name(id, begin);
    if (!is_function(id)) {
      std::vector<std::string> names(function_names.begin(), function_names.end());
      names.insert(names.end(), lookup_.calls.begin(), lookup_.calls.end());
      refuse(fmt::format("'{}' is not a function", shortened(id)),
             did_you_mean(id, names, "known functions: " + fmt::format("{}", fmt::join(names, ", "))), begin,
             begin + id.size());
    }
    take('(');
    std::vector<Operand> arguments;
    if (peek() != ')') {
      do {
        arguments.push_back(sum());
      } while (take(','));
    }
    if (!take(')')) refuse("a bracket is not closed", "add ')'", begin, at_);
    return call(id, arguments, begin, at_);
  }

  std::string_view text_;
  ParameterLookup const& lookup_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

// With spaces in place of the no-break and thin spaces of typeset text; every byte keeps its place.
std::string spaced_in_place(std::string_view text) {
  std::string out(text);
  for (std::size_t at = out.find_first_of("\xc2\xe2"); at < out.size(); ++at)
    if (std::size_t const bytes = typeset_space(std::string_view(out).substr(at)); bytes > 0)
      out.replace(at, bytes, bytes, ' ');
  return out;
}

constexpr std::string_view typeset_minus = "\xe2\x88\x92";

}  // namespace

std::optional<Value> evaluate_expression(std::string_view written, ParameterLookup const& lookup) {
  std::string const spaced = spaced_in_place(written);
  std::string_view text = spaced;
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  if (std::size_t const at = text.find(typeset_minus); at != text.npos)
    refuse(fmt::format("'{}' (U+2212) is not the minus sign of the keyboard", typeset_minus), "write an ASCII '-'", at,
           at + typeset_minus.size());
  try {
    return Parser(text, lookup).whole();
  } catch (BrokenParameter const&) {
    return {};
  }
}

bool is_reserved_word(std::string_view word) {
  return is_unit_name(word) || is_function(word) || is_amplitude_word(word) || word == "dB" || word == "nan" ||
         word == "inf";
}

bool is_parameter_name(std::string_view name) {
  auto const ascii = [](char c) { return static_cast<unsigned char>(c) < 0x80 && (is_letter(c) || is_digit(c)); };
  return !name.empty() && !is_digit(name.front()) && std::ranges::all_of(name, ascii);
}

}  // namespace straytrace::scene
