// SPDX-License-Identifier: BSD-3-Clause
// filter = both {or both}    both = one {and one}    one = not one | ( filter ) | resolved | text | comparison
// text = via("NAME" {, "NAME"})    comparison = name sign number [unit]    name = share | h(number unit) | ...
#include "results/route_table/route_filter.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <sstream>
#include <stdexcept>

#include "base/input/document.hpp"
#include "base/text/pattern.hpp"
#include "base/text/words.hpp"
#include "base/units/quantity.hpp"
#include "results/text/columns.hpp"

namespace straytrace::results {
namespace {

using RouteTest = std::function<bool(std::size_t row)>;  // refers to the columns it was made for

struct ParsedFilter {
  RouteTest test;                       // empty where there are problems that end the reading
  RouteColumn const* column = nullptr;  // of parse_column()
  std::vector<FilterProblem> problems;
  std::vector<std::string> notes;
};

using FilterUnits = std::vector<std::pair<std::string, double>>;  // name and factor

struct FilterWord {
  enum class Kind : std::uint8_t { name, number, quoted, sign, stray, end };
  Kind kind = Kind::end;
  std::string text;  // as written; of quoted ones the content
  std::size_t begin = 0, width = 1;
};

class FilterWords {
 public:
  explicit FilterWords(std::string_view text) : text_(text) { read(); }

  FilterWord const& here() const { return here_; }
  FilterWord next();               // the current word; advances
  bool takes(std::string_view w);  // in any case; advances on a match
  // The longest of `units` directly behind the number just read; empty: none.
  std::string unit(FilterUnits const& units);
  // Of the number just read, with its decimals, where a decimal comma follows; otherwise empty.
  std::string with_comma(FilterWord const& number) const;

 private:
  void read();

  std::string_view text_;
  std::size_t at_ = 0;
  FilterWord here_;
};

bool is_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

std::size_t bytes_of_letter(std::string_view text, std::size_t at) {
  std::size_t end = at + 1;
  while (end < text.size() && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) ++end;
  return end - at;
}

FilterWord FilterWords::next() {
  FilterWord const word = here_;
  if (word.kind != FilterWord::Kind::end) read();
  return word;
}

bool FilterWords::takes(std::string_view w) {
  if (here_.kind == FilterWord::Kind::quoted || lower_case(here_.text) != w) return false;
  read();
  return true;
}

std::string FilterWords::unit(FilterUnits const& units) {
  std::string longest;
  std::size_t const begin = here_.begin;
  for (auto const& [name, factor] : units) {
    std::size_t const end = begin + name.size();
    bool const ends = end >= text_.size() || !is_name(name.back()) || !is_name(text_[end]);
    if (name.size() > longest.size() && text_.substr(begin, name.size()) == name && ends) longest = name;
  }
  if (longest.empty()) return longest;
  at_ = begin + longest.size();
  read();
  return longest;
}

std::string FilterWords::with_comma(FilterWord const& number) const {
  std::size_t const comma = number.begin + number.width;
  if (here_.text != "," || here_.begin != comma) return "";
  std::size_t const end = std::min(text_.find_first_not_of("0123456789", comma + 1), text_.size());
  return end > comma + 1 ? std::string(text_.substr(number.begin, end - number.begin)) : "";
}

void FilterWords::read() {
  static Pattern const number(R"([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)");
  using Kind = FilterWord::Kind;
  for (std::size_t blank = 1; blank > 0 && at_ < text_.size(); at_ += blank)
    blank = std::isspace(static_cast<unsigned char>(text_[at_])) ? 1 : typeset_space(text_.substr(at_));
  std::size_t const begin = at_;
  here_ = {Kind::end, "", begin, 1};
  if (begin >= text_.size()) return;
  std::string_view const rest = text_.substr(begin);
  char const c = rest[0];
  std::size_t width = 1;
  Kind kind = Kind::sign;
  if (c == '"' || c == '\'') {
    std::size_t const close = rest.find(c, 1);
    kind = close == std::string_view::npos ? Kind::stray : Kind::quoted;
    width = kind == Kind::quoted ? close + 1 : 1;
  } else if (std::size_t const digits = number.width_at_start(rest)) {
    kind = Kind::number;
    width = digits;
  } else if (is_name(c)) {
    kind = Kind::name;
    while (width < rest.size() && is_name(rest[width])) ++width;
  } else if (rest.starts_with("==") || rest.starts_with("!=") || rest.starts_with("<=") || rest.starts_with(">=")) {
    width = 2;
  } else if (std::string_view("<>(),").find(c) == std::string_view::npos) {
    kind = Kind::stray;
    width = bytes_of_letter(rest, 0);
  }
  std::size_t const inset = kind == Kind::quoted;
  here_ = {kind, std::string(rest.substr(inset, width - 2 * inset)), begin, width};
  at_ = begin + width;
}

std::string unit_names(FilterUnits const& units) {
  std::vector<std::string> names;
  for (auto const& u : units) names.push_back(u.first);
  return fmt::format("{}", fmt::join(names, ", "));
}

double factor_of(std::string const& name, FilterUnits const& units) {
  for (auto const& [unit, factor] : units)
    if (unit == name) return factor;
  return 1;
}

using Kind = FilterWord::Kind;
using Test = RouteTest;

constexpr int deepest = 64;
constexpr char const* text_names[] = {"via",  "route", "first",  "last",   "body",
                                      "port", "kind",  "status", "regime", "id"};

struct Broken {};

bool always(std::size_t /*row*/) { return true; }

std::vector<std::string> number_names(RouteColumns const& columns) {
  std::vector<std::string> all{"h"};
  for (RouteColumn const& c : columns.all())
    if (!c.is_text && !c.is_error() && c.unit != "1/√Hz") all.push_back(c.key);
  return all;
}

std::vector<std::string> listed_objects(std::string_view text) {
  std::string_view const between = between_objects;
  std::vector<std::string> all;
  while (!text.empty()) {
    std::size_t const end = std::min(text.find(between), text.size());
    all.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + between.size(), text.size()));
  }
  return all;
}

std::vector<std::string> values(RouteColumns const& columns, std::string const& name, std::size_t row) {
  std::string const& text = columns.find(name == "route" ? "sequence" : name)->texts[row];
  return name == "via" ? listed_objects(text) : std::vector{text};
}

bool fits(RouteColumns const& columns, std::string const& name, std::string const& pattern, std::size_t row) {
  auto const all = values(columns, name, row);
  return std::any_of(all.begin(), all.end(), [&](auto const& v) { return matches(pattern, v); });
}

class Filter {
 public:
  Filter(std::string_view text, RouteColumns& columns) : words_(text), columns_(columns) {}

  Test whole() {
    Test test = either();
    if (words_.here().kind != Kind::end) unexpected("join conditions with 'and' or 'or'");
    return test;
  }
  // The column that a sort names.
  RouteColumn const* column() {
    FilterWord const word = words_.next();
    std::string const name = lower_case(word.text);
    RouteColumn const* const c =
        word.kind == Kind::name && name != "h" ? columns_.find(name == "route" ? "sequence" : name) : nullptr;
    RouteColumn const* const found = name == "h" ? strain() : c && !c->is_error() ? c : nullptr;
    if (!found) unknown(word, name);
    if (words_.here().kind != Kind::end) unexpected("sort by one name");
    return found;
  }

  std::vector<FilterProblem> problems;
  std::vector<std::string> notes;

 private:
  void problem(FilterWord const& w, std::string what, std::string suggestion) {
    problems.push_back({w.begin, w.width, std::move(what), std::move(suggestion)});
  }
  [[noreturn]] void fail(FilterWord const& w, std::string what, std::string suggestion) {
    problem(w, std::move(what), std::move(suggestion));
    throw Broken{};
  }
  [[noreturn]] void unexpected(std::string suggestion) {
    FilterWord const& w = words_.here();
    if (w.kind == Kind::end) fail(w, "the condition ends too early", std::move(suggestion));
    if (w.text == "=") fail(w, "'=' is not a comparison", "write ==");
    if (w.text == "\"" || w.text == "'") fail(w, "a quotation is not closed", "add " + w.text);
    fail(w, "'" + w.text + "' is not expected here", std::move(suggestion));
  }
  std::vector<std::string> all_names() const {
    std::vector<std::string> all = number_names(columns_);
    all.insert(all.end(), std::begin(text_names), std::end(text_names));
    all.emplace_back("resolved");
    return all;
  }
  void refuse_decimal_comma(FilterWord const& number) {
    std::string const written = words_.with_comma(number);
    if (written.empty()) return;
    std::string pointed = written;
    pointed[pointed.find(',')] = '.';
    fail({number.kind, written, number.begin, written.size()}, "'" + written + "' has a decimal comma",
         "write " + pointed);
  }
  double value_of(FilterWord const& number) {
    refuse_decimal_comma(number);
    auto const value = is_number(number.text) ? leading_number(number.text) : std::nullopt;
    if (!value) fail(number, "'" + number.text + "' " + number_fault(number.text), "write for example 1e-25");
    return value->value;
  }
  void unknown(FilterWord const& word, std::string const& name) {
    problem(word, "'" + word.text + "' is not known",
            did_you_mean(name, all_names(), fmt::format("known are {}", fmt::join(all_names(), ", "))));
  }

  Test either() {
    Test left = both();
    while (words_.takes("or")) left = [a = left, b = both()](std::size_t i) { return a(i) || b(i); };
    return left;
  }
  Test both() {
    Test left = one();
    while (words_.takes("and")) left = [a = left, b = one()](std::size_t i) { return a(i) && b(i); };
    return left;
  }
  Test one() {
    FilterWord const word = words_.here();
    if (++depth_ > deepest) fail(word, "the condition is nested too deeply", "remove brackets");
    Test test = inside(word);
    --depth_;
    return test;
  }
  Test inside(FilterWord const& word) {
    if (words_.takes("not")) return [a = one()](std::size_t i) { return !a(i); };
    if (words_.takes("(")) {
      Test inner = either();
      if (!words_.takes(")")) {
        if (words_.here().kind != Kind::end) unexpected("join conditions with 'and' or 'or'");
        fail(word, "a bracket is not closed", "add ')'");
      }
      return inner;
    }
    if (word.kind == Kind::number) fail(word, "a number comes first", "write the name first: scatters == 2");
    if (word.kind != Kind::name) unexpected("write a condition: scatters == 2");
    words_.next();
    return named(word, lower_case(word.text));
  }
  Test named(FilterWord const& word, std::string const& name) {
    if (name == "resolved") {
      RouteColumn const* const status = columns_.find("status");
      return [status](std::size_t i) { return status->texts[i] == "resolved"; };
    }
    if (name == "h") {
      RouteColumn const* const c = strain();
      return c ? compared(word, "h", *c) : skipped();
    }
    if (std::find(std::begin(text_names), std::end(text_names), name) != std::end(text_names)) return texts(name);
    auto const numbers = number_names(columns_);
    if (std::find(numbers.begin(), numbers.end(), name) == numbers.end()) {
      unknown(word, name);
      return skipped();
    }
    return compared(word, name, *columns_.find(name));
  }
  // The rest after an unknown name, so that reading continues.
  Test skipped() {
    if (words_.takes("("))
      while (words_.here().kind != Kind::end && !words_.takes(")")) words_.next();
    if (is_comparison(words_.here())) {
      words_.next();
      words_.next();
      while (words_.here().kind == Kind::stray || (words_.here().kind == Kind::name && !joins(words_.here())))
        words_.next();
    }
    return always;
  }
  static bool is_comparison(FilterWord const& w) {
    return w.kind == Kind::sign && w.text != "(" && w.text != ")" && w.text != ",";
  }
  static bool joins(FilterWord const& w) {
    std::string const word = lower_case(w.text);
    return word == "and" || word == "or" || word == "not";
  }

  RouteColumn const* strain() {
    if (!words_.takes("(")) unexpected("write h(30 Hz)");
    FilterWord const number = words_.here();
    if (number.kind != Kind::number) unexpected("write h(30 Hz)");
    words_.next();
    double const value = value_of(number);
    FilterUnits const units = frequency_units();
    std::string const unit = words_.unit(units);
    if (unit.empty() && words_.here().kind == Kind::name)
      fail(words_.here(), "'" + words_.here().text + "' is not a unit of a frequency", "write " + unit_names(units));
    if (unit.empty()) fail(number, "the frequency has no unit", "write h(" + number.text + " Hz)");
    if (!words_.takes(")")) unexpected("add ')'");
    try {
      return &columns_.strain(value * factor_of(unit, units));
    } catch (std::out_of_range const& known) {
      problem(number, "h is not known there", known.what());
      return nullptr;
    }
  }

  Test texts(std::string const& name) {
    std::string const example = "write " + name + "(\"*\")";
    if (!words_.takes("(")) unexpected(example);
    std::vector<std::string> patterns;
    do {
      if (words_.here().kind != Kind::quoted) unexpected(example);
      if (name == "kind") refuse_unknown_kind(words_.here());
      patterns.push_back(words_.next().text);
    } while (words_.takes(","));
    if (!words_.takes(")")) unexpected("add ')'");
    for (std::string const& p : patterns) report_unmatched(name, p);
    return [&columns = columns_, name, patterns](std::size_t i) {
      return std::any_of(patterns.begin(), patterns.end(), [&](auto const& p) { return fits(columns, name, p, i); });
    };
  }
  void refuse_unknown_kind(FilterWord const& word) {
    std::vector<std::string> const kinds(class_kind_names.begin(), class_kind_names.end());
    if (std::ranges::any_of(kinds, [&](auto const& kind) { return matches(word.text, kind); })) return;
    problem(word, fmt::format("no route is of the kind '{}'", word.text),
            did_you_mean(word.text, kinds, fmt::format("kinds are {}", fmt::join(kinds, ", "))));
  }
  void report_unmatched(std::string const& name, std::string const& pattern) {
    std::vector<std::string> seen;
    for (std::size_t i = 0; i < columns_.rows(); ++i) {
      if (fits(columns_, name, pattern, i)) return;
      for (std::string const& v : values(columns_, name, i))
        if (std::find(seen.begin(), seen.end(), v) == seen.end() && seen.size() < 1000) seen.push_back(v);
    }
    std::string const near = name == "route" ? "" : nearest_word(pattern, seen);
    notes.push_back(fmt::format("no route has {}(\"{}\"){}", name, pattern,
                                near.empty() ? "" : "; did you mean \"" + near + "\"?"));
  }

  Test compared(FilterWord const& word, std::string const& name, RouteColumn const& c) {
    std::string const unit_shown = c.units.empty() || !c.needs_unit ? "" : " " + c.units.front().first;
    std::string const shown = name == "h" ? "h(30 Hz) > 1e-25" : name + " > 1" + unit_shown;
    if (!is_comparison(words_.here())) {
      if (words_.here().text == "=") unexpected("");
      fail(word, "'" + word.text + "' needs a comparison", "write for example " + shown);
    }
    std::string const sign = words_.next().text;
    FilterWord const number = words_.here();
    if (number.kind != Kind::number) unexpected("write for example " + shown);
    words_.next();
    double const limit = value_of(number) * factor_of(unit_behind(number, name, c), c.units);
    return ordered(c, sign, c.whole ? limit : six_digits(limit));
  }
  std::string unit_behind(FilterWord const& number, std::string const& name, RouteColumn const& c) {
    std::string const unit = words_.unit(c.units);
    FilterWord const& w = words_.here();
    if (!unit.empty()) return unit;
    if ((w.kind == Kind::name && !joins(w)) || w.text == "%" || w.text == "/") {
      problem(w, "'" + w.text + "' is not a unit of " + name,
              c.units.empty() ? "leave it out: " + name + " is a plain number" : "write " + unit_names(c.units));
      while (words_.here().kind == Kind::stray || (words_.here().kind == Kind::name && !joins(words_.here())))
        words_.next();
    } else if (c.needs_unit) {
      problem(number, name + " needs a unit", "write " + number.text + " " + c.units.front().first);
    }
    return unit;
  }
  static Test ordered(RouteColumn const& c, std::string const& sign, double x) {
    auto const test = [&c](auto compare) {
      return [&c, compare](std::size_t i) {
        double const value = c.whole ? c.numbers[i] : six_digits(c.numbers[i]);
        return !std::isnan(value) && compare(value);
      };
    };
    if (sign == "<") return test([x](double v) { return v < x; });
    if (sign == "<=") return test([x](double v) { return v <= x; });
    if (sign == ">") return test([x](double v) { return v > x; });
    if (sign == ">=") return test([x](double v) { return v >= x; });
    if (sign == "!=") return test([x](double v) { return v != x; });
    return test([x](double v) { return v == x; });
  }

  FilterWords words_;
  RouteColumns& columns_;
  int depth_ = 0;
};

ParsedFilter parse_filter(std::string_view text, RouteColumns& columns) {
  Filter filter(text, columns);
  ParsedFilter parsed;
  try {
    parsed.test = filter.whole();
  } catch (Broken const&) {
  }
  return {std::move(parsed.test), nullptr, std::move(filter.problems), std::move(filter.notes)};
}

ParsedFilter parse_column(std::string_view key, RouteColumns& columns) {
  Filter filter(key, columns);
  ParsedFilter parsed;
  try {
    parsed.column = filter.column();
  } catch (Broken const&) {
  }
  return {nullptr, parsed.column, std::move(filter.problems), {}};
}

std::vector<std::string> words_in(std::string_view text) {
  std::istringstream in(lower_case(text));
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

// Conditions hold signs, brackets, quotes or one of these words.
bool is_condition(std::string_view text, std::vector<std::string> const& words) {
  return text.find_first_of("()<>=!\"'") != std::string_view::npos ||
         std::any_of(words.begin(), words.end(),
                     [](std::string const& w) { return w == "resolved" || w == "not" || w == "and" || w == "or"; });
}

// Plain words, looked for in route, body, port and kind.
bool has_words(std::vector<std::string> const& words, RouteColumns const& columns, std::size_t row) {
  std::vector<std::string> texts;
  for (char const* key : {"sequence", "body", "port", "kind"})
    texts.push_back(lower_case(columns.find(key)->texts[row]));
  return std::all_of(words.begin(), words.end(), [&](std::string const& w) {
    return std::any_of(texts.begin(), texts.end(), [&](auto const& text) { return text.find(w) != std::string::npos; });
  });
}

}  // namespace

std::vector<std::pair<std::string, double>> frequency_units() {
  FilterUnits units;
  for (char const* name : {"Hz", "kHz", "MHz", "mHz"}) units.emplace_back(name, parse_unit(name)->si);
  return units;
}

FilterAnswer filtered(std::string_view text, RouteColumns& columns) {
  auto const words = words_in(text);
  ParsedFilter parsed;
  if (words.empty())
    parsed.test = [](std::size_t) { return true; };
  else if (!is_condition(text, words))
    parsed.test = [&](std::size_t i) { return has_words(words, columns, i); };
  else
    parsed = parse_filter(text, columns);
  FilterAnswer answer{{}, std::move(parsed.problems), std::move(parsed.notes)};
  for (std::size_t i = 0; answer.problems.empty() && i < columns.rows(); ++i)
    if (parsed.test(i)) answer.rows.push_back(i);
  return answer;
}

FilterAnswer sorted_by(std::string_view key, std::vector<std::size_t> rows, RouteColumns& columns) {
  ParsedFilter const parsed = parse_column(key, columns);
  if (!parsed.problems.empty()) return {{}, parsed.problems, {}};
  RouteColumn const& c = *parsed.column;
  auto const before = [&](std::size_t a, std::size_t b) {
    if (c.is_text) return c.texts[a] < c.texts[b];
    double const x = c.numbers[a], y = c.numbers[b];
    if (std::isnan(x) || std::isnan(y)) return !std::isnan(x) && std::isnan(y);
    return c.key == "rank" ? x < y : x > y;
  };
  std::stable_sort(rows.begin(), rows.end(), before);
  return {std::move(rows), {}, {}};
}

InputError error_in_filter(std::string const& option, std::string const& text, FilterProblem const& p) {
  std::size_t const column = width_of(text.substr(0, p.begin));
  std::size_t const wide = std::max<std::size_t>(1, width_of(text.substr(std::min(p.begin, text.size()), p.width)));
  std::string const drawn = fmt::format("error: {}, column {}: {}\n  {}\n  {}{} {}", option, column + 1, p.what, text,
                                        std::string(column, ' '), std::string(wide, '^'), p.suggestion);
  Place const place{0, 1, std::uint32_t(column + 1)};
  return InputError({{place, p.what, p.suggestion, Severity::error, std::uint32_t(wide)}}, drawn, {option});
}

}  // namespace straytrace::results
