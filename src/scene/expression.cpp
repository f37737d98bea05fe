// SPDX-License-Identifier: BSD-3-Clause
// Grammar, binding from loose to tight; a unit belongs to the number right before it:
//   sum = product {(+|-) product}   product = signed {(*|/) signed}   signed = [-|+] power   power = primary [^ signed]
//   primary = number [unit] | name | function ( sum {, sum} ) | ( sum )
#include "scene/expression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "scene/arithmetic.hpp"

namespace straytrace {
namespace {

constexpr int deepest_expression = 64;
constexpr std::array<std::string_view, 3> amplitude_words{"peak", "pp", "rms"};

struct BrokenParameter {};

bool is_digit(char c) { return c >= '0' && c <= '9'; }
// Bytes of other alphabets count as letters, so that messages show whole words.
bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || static_cast<unsigned char>(c) >= 0x80;
}
bool is_function(std::string_view word) {
  return std::find(function_names.begin(), function_names.end(), word) != function_names.end();
}
bool is_amplitude_word(std::string_view word) {
  return std::find(amplitude_words.begin(), amplitude_words.end(), word) != amplitude_words.end();
}

std::string joined(auto const& words) {
  std::string out;
  for (auto const& w : words) (out += out.empty() ? "" : ", ") += w;
  return out;
}

class Parser {
 public:
  Parser(std::string_view text, ParameterLookup const& lookup) : text_(text), lookup_(lookup) {}

  Value whole() {
    skip_spaces();
    if (at_ == text_.size()) refuse("nothing is written here", "write a number", 0, text_.size());
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
  [[noreturn]] static void refuse(std::string what, std::string suggestion, std::size_t begin, std::size_t end) {
    throw ExpressionProblem{std::move(what), std::move(suggestion), begin, end};
  }

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
      refuse("two numbers stand next to each other", "write one number without spaces, or an operator between them",
             begin, text_.size());
    std::string_view const next = word();
    std::size_t const end = next.empty() ? text_.size() : at_;
    std::vector<std::string> const kinds(amplitude_words.begin(), amplitude_words.end());
    std::string const near = nearest_word(next, kinds);
    refuse(fmt::format("cannot understand '{}' here", shortened(text_.substr(begin, end - begin))),
           near.empty() ? "write a number with a unit, or an expression of parameters with + - * / ^ and brackets"
                        : fmt::format("did you mean '{}'?", near),
           begin, end);
  }

  // A power ratio; the sign is kept: 37 dB is 10^3.7, -37 dB is 10^-3.7.
  Value decibel() {
    std::string_view number = text_.substr(at_, text_.size() - 2 - at_);
    while (!number.empty() && number.back() == ' ') number.remove_suffix(1);
    if (!is_number(number)) refuse("dB stands alone behind one number", "write for example '37 dB'", at_, text_.size());
    number.remove_prefix(number.front() == '+');
    double value = 0;
    std::from_chars(number.data(), number.data() + number.size(), value);
    double const ratio = std::pow(10, value / 10);
    if (!std::isfinite(ratio)) refuse("the number is too large", "write a value below 3000 dB", at_, text_.size());
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
      return result;
    }
    std::size_t const number_end = at_;
    skip_spaces();
    if (at_ < text_.size() && is_letter(text_[at_])) refuse_suffix(begin, number_end);
    return {{{value, dim::plain, {}}, value == 0}, begin, number_end, true};
  }

  // A word behind a bare number: an amplitude kind is read later, anything else is no unit.
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
    std::string const near = nearest_word(id, names);
    refuse(fmt::format("parameter '{}' is not defined", shortened(id)),
           near.empty() ? "write a number with its unit, or define the name under 'params'"
                        : fmt::format("did you mean '{}'?", near),
           begin, begin + id.size());
  }

  Operand function(std::string const& id, std::size_t begin) {
    if (!is_function(id)) {
      std::vector<std::string> const names(function_names.begin(), function_names.end());
      std::string const near = nearest_word(id, names);
      refuse(fmt::format("'{}' is not a function", shortened(id)),
             near.empty() ? "known functions: " + joined(names) : fmt::format("did you mean '{}'?", near), begin,
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

}  // namespace

std::optional<Value> evaluate_expression(std::string_view text, ParameterLookup const& lookup) {
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
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
  return !name.empty() && !is_digit(name.front()) && std::all_of(name.begin(), name.end(), ascii);
}

}  // namespace straytrace
