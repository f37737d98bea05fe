// SPDX-License-Identifier: BSD-3-Clause
#include "base/input/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>

#include "base/input/document.hpp"
#include "base/text/words.hpp"

namespace straytrace {
namespace {

// Replaces a value whose problem is recorded already.
Node silent(Node const& like) {
  auto data = std::make_shared<NodeData>();
  data->place = like.place();
  return {std::move(data), like.scope(), like.document()};
}

std::string kind_name(Node::Kind kind) {
  switch (kind) {
    case Node::Kind::scalar:
      return "a single value";
    case Node::Kind::list:
      return "a list";
    case Node::Kind::table:
      return "a table of keys";
    case Node::Kind::none:
      break;
  }
  return "nothing";
}

std::string listed(std::span<std::string const> words) {
  std::string out;
  for (std::size_t i = 0; i < words.size() && i < 40; ++i) out += (i ? ", " : "") + words[i];
  return words.size() > 40 ? out + ", ..." : out;
}

}  // namespace

Node::Kind Node::kind() const { return data_ ? data_->kind : Kind::none; }

Place Node::place() const { return data_ ? data_->place : Place{}; }

std::string const& Node::text() const {
  static std::string const empty;
  return data_ ? data_->text : empty;
}

bool Node::has(std::string_view key) const {
  if (kind() != Kind::table) return false;
  data_->asked.try_emplace(std::string(key));
  NodeData::Entry const* entry = data_->find(key);
  if (entry) entry->value->known = true;
  return entry != nullptr;
}

Node Node::operator[](std::string_view key) const {
  if (!data_) return {nullptr, scope_, document_};
  if (data_->kind == Kind::none) return *this;
  if (data_->kind != Kind::table) {
    problem(fmt::format("'{}' needs a table with the key '{}', got {}", data_->label, key, kind_name(data_->kind)),
            fmt::format("write '{{{}: ...}}'", key));
    return silent(*this);
  }
  if (!has(key)) return {nullptr, scope_, document_};
  return {data_->find(key)->value, scope_, document_};
}

std::vector<std::pair<std::string, Node>> Node::items() const {
  std::vector<std::pair<std::string, Node>> out;
  if (kind() == Kind::scalar || kind() == Kind::list)
    problem(fmt::format("'{}' needs a table of keys, got {}", data_->label, kind_name(data_->kind)),
            "write '{name: value}'");
  if (kind() != Kind::table) return out;
  data_->listed = true;
  for (NodeData::Entry const& e : data_->entries) {
    e.value->known = true;
    out.emplace_back(e.key, Node(e.value, scope_, document_));
  }
  return out;
}

Place Node::key_place(std::string_view key) const {
  NodeData::Entry const* entry = kind() == Kind::table ? data_->find(key) : nullptr;
  return entry ? entry->place : place();
}

void Node::missing(std::string_view key, std::string_view nature, std::string const& suggestion) const {
  std::string const in = data_ && !data_->label.empty() ? fmt::format(" in '{}'", data_->label) : "";
  lack(key, fmt::format("key '{}' ({}) is missing{}", key, nature, in), suggestion);
}

void Node::lack(std::string_view key, std::string what, std::string suggestion) const {
  if (!document_) return;
  Problem const problem{place(), std::move(what), std::move(suggestion)};
  document_->add(problem);
  if (data_) data_->missing.emplace(key, problem);
}

std::string Node::word(std::string_view key, std::string_view fallback) const {
  Node const value = (*this)[key];
  if (data_) data_->note(key, {.form = KeyRequest::Form::word, .word = std::string(fallback)});
  if (value.data_) return value.as_word();
  if (fallback.empty()) missing(key, "text", fmt::format("add '{}: ...'", key));
  return std::string(fallback);
}

std::string Node::as_word() const {
  if (data_) data_->read.form = KeyRequest::Form::word;
  if (kind() == Kind::list || kind() == Kind::table)
    problem(fmt::format("'{}' is a single text, got {}", data_->label, kind_name(kind())),
            fmt::format("write '{}: text'", data_->label));
  return text();
}

std::string Node::choice(std::string_view key, std::span<std::string_view const> choices,
                         std::string_view fallback) const {
  std::vector<std::string> const words(choices.begin(), choices.end());
  Node const value = (*this)[key];
  if (data_) data_->note(key, {.form = KeyRequest::Form::choice, .choices = words, .word = std::string(fallback)});
  if (!value.data_) {
    if (fallback.empty())
      missing(key, "a choice", fmt::format("add '{}: {}' (accepted: {})", key, words.front(), listed(words)));
    return std::string(fallback);
  }
  if (!value) return {};
  std::string const word = value.as_word();
  if (value.kind() != Kind::scalar || std::ranges::find(words, word) != words.end()) return word;
  std::string const near = nearest_word(word, words);
  value.problem(fmt::format("'{}' cannot be \"{}\"", key, shortened(word)),
                near.empty() ? "write one of: " + listed(words)
                             : fmt::format("did you mean '{}'? (accepted: {})", near, listed(words)));
  return {};
}

bool Node::flag(std::string_view key, bool fallback) const {
  Node const value = (*this)[key];
  if (data_) data_->note(key, {.form = KeyRequest::Form::flag, .word = fallback ? "on" : "off"});
  if (!value) return fallback;
  bool const scalar = value.kind() == Kind::scalar;
  std::string const word = scalar ? value.as_word() : "";
  if (word == "on" || word == "yes" || word == "true") return true;
  if (word == "off" || word == "no" || word == "false") return false;
  value.problem(fmt::format("'{}' is a switch, got {}", key,
                            scalar ? fmt::format("\"{}\"", shortened(word)) : kind_name(value.kind())),
                "write on or off (also yes, no, true, false)");
  return fallback;
}

Node Node::table(std::string_view key) const {
  Node const value = (*this)[key];
  if (data_) data_->note(key, {.form = KeyRequest::Form::table});
  if (!value || value.kind() == Kind::table) return value;
  value.problem(fmt::format("'{}' needs a table of keys, got {}", key, kind_name(value.kind())),
                fmt::format("write '{}: {{name: value}}'", key));
  return silent(value);
}

std::vector<Node> Node::list(std::string_view key) const {
  Node const value = (*this)[key];
  if (data_) data_->note(key, {.form = KeyRequest::Form::list});
  return value.as_list();
}

std::vector<Node> Node::as_list() const {
  std::vector<Node> out;
  if (kind() == Kind::none) return out;
  if (data_->read.form == KeyRequest::Form::named) data_->read.form = KeyRequest::Form::list;
  if (kind() != Kind::list) return {*this};
  for (auto const& element : data_->elements) out.emplace_back(element, scope_, document_);
  return out;
}

void Node::refuse_unknown(std::string_view what) const {
  if (kind() != Kind::table) return;
  data_->role = what;
  refuse_keys(what, false);
}

void Node::refuse_misspelt(std::string_view what) const {
  if (kind() == Kind::table) refuse_keys(what, true);
}

// The keys that no reader requested, or only those that are like a missing one.
void Node::refuse_keys(std::string_view what, bool only_misspelt) const {
  std::vector<std::string> known, missing;
  for (auto const& [key, how] : data_->asked) known.push_back(key);
  for (auto const& [key, problem] : data_->missing) missing.push_back(key);
  int reported = 0;
  for (NodeData::Entry const& e : data_->entries) {
    if (e.value->known || ++reported > 100) continue;  // limits the messages of hostile input
    std::string near = nearest_word(e.key, missing);
    if (near.empty() && only_misspelt) continue;
    if (near.empty())
      near = nearest_word(e.key, known);
    else
      document_->withdraw(data_->missing.at(near));
    std::string const suggestion = !near.empty()   ? fmt::format("did you mean '{}'?", near)
                                   : known.empty() ? "remove it"
                                                   : "known keys: " + listed(known);
    document_->add(
        {e.place, fmt::format("unknown key '{}' in {}", shortened(e.key), what), suggestion, Severity::error, e.width});
  }
}

void Node::problem(std::string what, std::string suggestion) const {
  if (document_)
    document_->add({place(), std::move(what), std::move(suggestion), Severity::error, data_ ? data_->width : 1});
}

void Node::warning(std::string what, std::string suggestion) const {
  if (document_)
    document_->add({place(), std::move(what), std::move(suggestion), Severity::warning, data_ ? data_->width : 1});
}

bool Node::healthy() const { return !document_ || document_->healthy(); }

std::string Node::data_file(std::string const& name) const {
  return document_ ? document_->data_file(*this, name) : "";
}

void Node::file_problem(std::string const& name, std::uint32_t line, std::uint32_t column, std::string what,
                        std::string suggestion) const {
  if (!document_) return;
  document_->add({document_->place_in_file(*this, name, line, column), std::move(what), std::move(suggestion)});
}

std::string nearest_word(std::string_view word, std::span<std::string const> words) {
  constexpr std::size_t longest = 64;
  std::size_t const n = word.size();
  if (n == 0 || n > longest) return {};
  auto const lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(1, (n + 1) / 3) + 1;
  for (std::string const& other : words) {
    std::size_t const m = other.size();
    if (m == 0 || m > longest || std::max(m, n) - std::min(m, n) >= best_distance) continue;
    // Edit distance with transpositions of neighbours; rows i-2, i-1 and i of the table.
    std::array<std::array<std::size_t, longest + 1>, 3> row{};
    for (std::size_t j = 0; j <= m; ++j) row[0][j] = j;
    for (std::size_t i = 1; i <= n; ++i) {
      auto &now = row[i % 3], &up = row[(i + 2) % 3], &upper = row[(i + 1) % 3];
      now[0] = i;
      for (std::size_t j = 1; j <= m; ++j) {
        bool const same = lower(word[i - 1]) == lower(other[j - 1]);
        now[j] = std::min({up[j] + 1, now[j - 1] + 1, up[j - 1] + (same ? 0 : 1)});
        bool const swapped =
            i > 1 && j > 1 && lower(word[i - 1]) == lower(other[j - 2]) && lower(word[i - 2]) == lower(other[j - 1]);
        if (swapped) now[j] = std::min(now[j], upper[j - 2] + 1);
      }
    }
    if (row[n % 3][m] < best_distance) {
      best_distance = row[n % 3][m];
      best = other;
    }
  }
  return best;
}

std::string did_you_mean(std::string_view word, std::span<std::string const> words, std::string otherwise) {
  std::string const near = nearest_word(word, words);
  return near.empty() ? otherwise : fmt::format("did you mean '{}'?", near);
}

// Numeric readers of Node.

namespace {

std::string units_hint(Dimension d) { return d == dim::plain ? "" : fmt::format(" (accepted: {})", accepted_units(d)); }

// "1 m", or a plain number inside the range.
std::string example(Dimension d, double low, double high) {
  if (d != dim::plain) return with_unit("1", d);
  return fmt::format("{:g}", 1 < low ? low : 1 > high ? high : 1);
}

// A bound in the unit of the value, if that is a number with one, otherwise in the unit of examples.
std::string bound(double si, Dimension d, std::string_view value) {
  if (si == 0) return "0";
  if (auto const number = leading_number(value))
    if (auto const unit = parse_unit(number->rest); !number->rest.empty() && unit && unit->dimension == d)
      return fmt::format("{:g} {}", si / unit->si, number->rest);
  auto const unit = parse_unit(example_unit(d));
  return with_unit(fmt::format("{:g}", unit ? si / unit->si : si), d);
}

constexpr double largest_factor = 1e6;
constexpr char const* factor_example = "write 'factor 1.5': from 1/1.5 to 1.5 times";

double read_factor(Node const& value, std::string_view text, double fallback) {
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  if (!is_number(text)) {
    value.problem(fmt::format("'factor' needs a plain number, got \"{}\"", shortened(text)), factor_example);
    return fallback;
  }
  double const factor = std::stod(std::string(text));
  if (factor >= 1 && factor <= largest_factor) return factor;
  value.problem(factor < 1 ? "a factor of uncertainty must be at least 1"
                           : fmt::format("a factor of uncertainty must be at most {:g}", largest_factor),
                factor_example);
  return fallback;
}

}  // namespace

bool is_number(std::string_view text) {
  double value = 0;
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  auto const [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  return code == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

std::optional<LeadingNumber> leading_number(std::string_view text) {
  std::string const spaced = with_plain_spaces(text);
  std::size_t const first = spaced.find_first_not_of(' '), last = spaced.find_last_not_of(' ');
  if (first == spaced.npos) return {};
  std::string_view inner = std::string_view(spaced).substr(first, last + 1 - first);
  if (inner.starts_with('+')) inner.remove_prefix(1);
  LeadingNumber out;
  auto const [end, code] = std::from_chars(inner.data(), inner.data() + inner.size(), out.value);
  if (code != std::errc() || !std::isfinite(out.value)) return {};
  inner.remove_prefix(std::size_t(end - inner.data()));
  out.rest = inner.substr(std::min(inner.find_first_not_of(' '), inner.size()));
  return out;
}

std::string number_fault(std::string_view text) {
  if (std::string const space = space_in_number(text); !space.empty())
    return fmt::format("has a no-break space ({}) between its digits", space);
  if (is_number(text)) return "is outside the range of double precision in its unit";
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  auto const [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  return code == std::errc::result_out_of_range && end == text.data() + text.size()
             ? "is outside the range of double precision, 1e-307 to 1e308"
             : "is not a number";
}

std::uint32_t code_points(std::string_view utf8) {
  std::uint32_t n = 0;
  for (char const c : utf8) n += (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  return n;
}

std::string shortened(std::string_view text) {
  if (code_points(text) <= 60) return std::string(text);
  std::size_t end = 57;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;
  return std::string(text.substr(0, end)) + "...";
}

Problem dimension_problem(NodeData const& data, Quantity const& got, Dimension d) {
  std::string const text = shortened(data.text);
  std::string what = fmt::format("'{}' is {}, got \"{}\"", data.label, described(d), text), remedy;
  if (got.dimension != dim::plain) {
    what += fmt::format(" ({})", described(got.dimension));
    remedy = fmt::format("write {}, for example '{}'{}", described(d), example(d, -infinity, infinity), units_hint(d));
  } else if (is_number(data.text)) {
    what += " without a unit";
    remedy = fmt::format("write '{}'{}", with_unit(text, d), units_hint(d));
  } else {
    what += " (a plain number)";
    remedy = fmt::format("give it a unit, for example '{}'{}", with_unit("1", d), units_hint(d));
  }
  return {data.place, std::move(what), std::move(remedy), Severity::error, data.width};
}

std::optional<Quantity> Node::evaluated(Dimension d) const {
  if (kind() == Kind::none) return {};
  if (kind() != Kind::scalar) {
    problem(fmt::format("'{}' is {}, got {}", data_->label, described(d),
                        kind() == Kind::list ? "a list" : "a table of keys"),
            fmt::format("write one value, for example '{}'", example(d, -infinity, infinity)));
    return {};
  }
  auto const value = document_->evaluate(*data_, scope_.get());
  if (!value) return {};
  Quantity q = value->quantity;
  if (value->bare_zero) q.dimension = d;
  if (q.dimension == d) return q;
  document_->add(dimension_problem(*data_, q, d));
  return {};
}

bool Node::within(double si, Dimension d, double low, double high) const {
  if (si >= low && si <= high) return true;
  auto const shown = [&](double limit) { return bound(limit, d, text()); };
  std::string const range = !std::isfinite(high)  ? fmt::format("at least {}", shown(low))
                            : !std::isfinite(low) ? fmt::format("at most {}", shown(high))
                                                  : fmt::format("between {} and {}", shown(low), shown(high));
  std::string is;
  if (auto const from = document_->origin(text(), scope_.get()))
    is = fmt::format("it is {}{}: ", shown(si), from->empty() ? "" : fmt::format(" ({})", *from));
  problem(fmt::format("'{}' must be {}, got \"{}\"", data_->label, range, shortened(text())),
          is + fmt::format("write a value {}", range));
  return false;
}

double Node::number(std::string_view key, Dimension d, double fallback, double low, double high) const {
  Node const value = (*this)[key];
  if (data_)
    data_->note(key,
                {.form = KeyRequest::Form::number, .dimension = d, .fallback = fallback, .low = low, .high = high});
  if (value.data_) return value.as_number(d, low, high);
  if (std::isnan(fallback))
    missing(key, described(d), fmt::format("add '{}: {}'{}", key, example(d, low, high), units_hint(d)));
  return fallback;
}

double Node::as_number(Dimension d, double low, double high) const {
  if (data_) data_->read = {.form = KeyRequest::Form::number, .dimension = d, .low = low, .high = high};
  auto const q = evaluated(d);
  if (!q) return not_a_number;
  if (q->amplitude != Amplitude::none) {
    problem(fmt::format("'{}' is {}, not an amplitude, got \"{}\"", data_->label, described(d), shortened(text())),
            "remove the word peak, pp or rms");
    return not_a_number;
  }
  return within(q->si, d, low, high) ? q->si : not_a_number;
}

std::uint64_t Node::whole(std::string_view key, double fallback, double low, double high) const {
  double const x = number(key, dim::plain, fallback, low, high);
  if (data_) data_->note(key, {.form = KeyRequest::Form::whole, .fallback = fallback, .low = low, .high = high});
  if (std::isnan(x)) return 0;
  if (x == std::round(x)) return static_cast<std::uint64_t>(x);
  (*this)[key].problem(fmt::format("'{}' must be a whole number, got \"{}\"", key, shortened((*this)[key].text())),
                       fmt::format("write {:.0f} or {:.0f}", std::floor(x), std::ceil(x)));
  return 0;
}

Quantity Node::amplitude(std::string_view key, Dimension d) const {
  Quantity const nothing{not_a_number, d, Amplitude::none};
  Node const value = (*this)[key];
  if (data_) data_->note(key, {.form = KeyRequest::Form::amplitude, .dimension = d});
  if (!value.data_) {
    missing(key, described(d), fmt::format("add '{}: {} peak' (or pp, or rms)", key, example(d, -infinity, infinity)));
    return nothing;
  }
  auto q = value.evaluated(d);
  if (!q) return nothing;
  if (q->si == 0 && q->amplitude == Amplitude::none) q->amplitude = Amplitude::peak;  // zero is zero in every kind
  if (q->amplitude != Amplitude::none) return *q;
  std::string const text = shortened(value.text());
  value.problem(fmt::format("\"{}\" does not say which amplitude it is", text),
                fmt::format("write '{0} peak', '{0} pp' or '{0} rms'", text));
  return nothing;
}

Quantity Node::as_quantity() const {
  if (data_) data_->read.form = KeyRequest::Form::quantity;
  if (kind() == Kind::list || kind() == Kind::table)
    problem(
        fmt::format("'{}' is one quantity, got {}", data_->label, kind() == Kind::list ? "a list" : "a table of keys"),
        "write a number with a unit, for example '1 m'");
  if (kind() != Kind::scalar) return {not_a_number, {}, {}};
  auto const value = document_->evaluate(*data_, scope_.get());
  return value ? value->quantity : Quantity{not_a_number, {}, {}};
}

bool refuse_decimal_commas(std::span<Node const> elements, Dimension d, bool zero_is_value) {
  bool any = false;
  for (std::size_t i = 1; d != dim::plain && i < elements.size(); ++i) {
    Node const &whole = elements[i - 1], &rest = elements[i];
    std::string const &digits = whole.text(), &tail = rest.text();
    bool const bare = !digits.empty() && digits.find_first_not_of("0123456789", digits[0] == '-') == digits.npos;
    bool const with_unit_after = tail.find_first_of("0123456789") == 0 && !is_number(tail);
    if (!bare || !with_unit_after || rest.place().line != whole.place().line) continue;
    if (rest.place().column != whole.place().column + whole.data()->width + 1) continue;
    if (zero_is_value && digits.find_first_not_of("-0") == digits.npos) continue;
    whole.document()->add({whole.place(), fmt::format("'{},{}' has a decimal comma", digits, shortened(tail)),
                           fmt::format("write '{}.{}'; two values are '{}, {}'", digits, shortened(tail),
                                       with_unit(digits, d), shortened(tail)),
                           Severity::error, whole.data()->width + 1 + rest.data()->width});
    any = true;
  }
  return any;
}

std::vector<double> Node::as_numbers(Dimension d, std::size_t expected) const {
  std::vector<Node> const elements = as_list();
  if (data_) data_->read = {.form = KeyRequest::Form::numbers, .dimension = d, .count = expected};
  bool const fits = elements.size() == expected;
  std::vector<double> out(expected, not_a_number);
  if (refuse_decimal_commas(elements, d, fits)) return out;
  if (!fits && kind() == Kind::scalar && text().find(',') != std::string::npos)
    problem(fmt::format("'{}' is a list without brackets", data_->label),
            fmt::format("write a list: [{}]", shortened(text())));
  else if (!fits && kind() != Kind::none)
    problem(fmt::format("'{}' needs {} values, got {}", data_->label, expected, elements.size()),
            fmt::format("write a list of {}, each like '{}'", expected, example(d, -infinity, infinity)));
  if (fits)
    for (std::size_t i = 0; i < expected; ++i) out[i] = elements[i].as_number(d);
  return out;
}

double read_uncertainty(Node const& value, double fallback) {
  if (!value) return fallback;
  constexpr std::string_view word = "factor";
  std::string const text = with_plain_spaces(value.text());
  if (text.starts_with(word) && (text.size() == word.size() || text[word.size()] == ' '))
    return read_factor(value, std::string_view(text).substr(word.size()), fallback);
  double const share = value.as_number(dim::plain, 0);
  if (share <= 1) return 1 + share;
  if (share > 1)
    value.problem(fmt::format("an uncertainty is at most 100 %, or a factor; got \"{}\"", shortened(text)),
                  is_number(text) ? fmt::format("did you mean '{0} %' or 'factor {0}'?", text)
                                  : fmt::format("write 'factor {:g}'", 1 + share));
  return fallback;
}

std::string read_status(Node const& table) {
  static constexpr std::string_view all[] = {"measured", "published", "required", "derived", "estimate", "assumed"};
  return table.has("status") ? table.choice("status", all) : std::string();
}

}  // namespace straytrace
