// SPDX-License-Identifier: BSD-3-Clause
// Numeric readers of Node.
#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "base/document.hpp"
#include "base/table.hpp"

namespace straytrace {
namespace {

std::string units_hint(Dimension d) { return d == dim::plain ? "" : fmt::format(" (accepted: {})", accepted_units(d)); }

// "1 m", or a plain number inside the range.
std::string example(Dimension d, double low, double high) {
  if (d != dim::plain) return with_unit("1", d);
  return fmt::format("{:g}", 1 < low ? low : 1 > high ? high : 1);
}

// A bound in the unit that the suggestion uses.
std::string bound(double si, Dimension d) {
  auto const unit = parse_unit(example_unit(d));
  return si == 0 ? "0" : with_unit(fmt::format("{:g}", unit ? si / unit->si : si), d);
}

}  // namespace

bool is_number(std::string_view text) {
  double value = 0;
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  auto const [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  return code == std::errc() && end == text.data() + text.size() && std::isfinite(value);
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
  std::string const range = !std::isfinite(high)  ? fmt::format("at least {}", bound(low, d))
                            : !std::isfinite(low) ? fmt::format("at most {}", bound(high, d))
                                                  : fmt::format("between {} and {}", bound(low, d), bound(high, d));
  problem(fmt::format("'{}' must be {}, got \"{}\"", data_->label, range, shortened(text())),
          fmt::format("write a value {}", range));
  return false;
}

double Node::number(std::string_view key, Dimension d, double fallback, double low, double high) const {
  Node const value = (*this)[key];
  if (data_)
    data_->note(key, {.form = Asked::Form::number, .dimension = d, .fallback = fallback, .low = low, .high = high});
  if (value.data_) return value.as_number(d, low, high);
  if (std::isnan(fallback))
    missing(key, described(d), fmt::format("add '{}: {}'{}", key, example(d, low, high), units_hint(d)));
  return fallback;
}

double Node::as_number(Dimension d, double low, double high) const {
  if (data_) data_->read = {.form = Asked::Form::number, .dimension = d, .low = low, .high = high};
  auto const q = evaluated(d);
  if (!q) return not_a_number;
  if (q->amplitude != Amplitude::none) {
    problem(fmt::format("'{}' is {}, not an amplitude, got \"{}\"", data_->label, described(d), shortened(text())),
            "leave out the word peak, pp or rms");
    return not_a_number;
  }
  return within(q->si, d, low, high) ? q->si : not_a_number;
}

std::uint64_t Node::whole(std::string_view key, double fallback, double low, double high) const {
  double const x = number(key, dim::plain, fallback, low, high);
  if (data_) data_->note(key, {.form = Asked::Form::whole, .fallback = fallback, .low = low, .high = high});
  if (std::isnan(x)) return 0;
  if (x == std::round(x)) return static_cast<std::uint64_t>(x);
  (*this)[key].problem(fmt::format("'{}' must be a whole number, got \"{}\"", key, shortened((*this)[key].text())),
                       fmt::format("write {:.0f} or {:.0f}", std::floor(x), std::ceil(x)));
  return 0;
}

Quantity Node::amplitude(std::string_view key, Dimension d) const {
  Quantity const nothing{not_a_number, d, Amplitude::none};
  Node const value = (*this)[key];
  if (data_) data_->note(key, {.form = Asked::Form::amplitude, .dimension = d});
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
  if (data_) data_->read.form = Asked::Form::quantity;
  if (kind() == Kind::list || kind() == Kind::table)
    problem(
        fmt::format("'{}' is one quantity, got {}", data_->label, kind() == Kind::list ? "a list" : "a table of keys"),
        "write a number with a unit, for example '1 m'");
  if (kind() != Kind::scalar) return {not_a_number, {}, {}};
  auto const value = document_->evaluate(*data_, scope_.get());
  return value ? value->quantity : Quantity{not_a_number, {}, {}};
}

std::vector<double> Node::as_numbers(Dimension d, std::size_t expected) const {
  std::vector<Node> const elements = as_list();
  if (data_) data_->read = {.form = Asked::Form::numbers, .dimension = d, .count = expected};
  if (elements.size() != expected && kind() != Kind::none) {
    problem(fmt::format("'{}' needs {} values, got {}", data_->label, expected, elements.size()),
            fmt::format("write a list of {}, each like '{}'", expected, example(d, -infinity, infinity)));
  }
  std::vector<double> out(expected, not_a_number);
  if (elements.size() == expected)
    for (std::size_t i = 0; i < expected; ++i) out[i] = elements[i].as_number(d);
  return out;
}

}  // namespace straytrace
