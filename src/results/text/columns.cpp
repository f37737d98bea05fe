// SPDX-License-Identifier: BSD-3-Clause
#include "results/text/columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text/words.hpp"
#include "results/results.hpp"
#include "results/text/table.hpp"

namespace straytrace::results {
namespace {

std::string line_of(std::vector<std::string> const& cells, std::vector<std::size_t> const& widths,
                    std::vector<bool> const& left, std::string const& indent) {
  std::string line = indent;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    std::string const gap(widths[i] - width_of(cells[i]), ' ');
    bool const to_left = i < left.size() && left[i];
    line += (i > 0 ? "  " : "") + (to_left ? cells[i] + gap : gap + cells[i]);
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

}  // namespace

std::size_t width_of(std::string const& utf8) {
  return std::size_t(
      std::count_if(utf8.begin(), utf8.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::string aligned(Columns const& columns, std::string const& indent) {
  std::vector<std::size_t> widths;
  for (std::string const& title : columns.titles) widths.push_back(width_of(title));
  for (std::vector<std::string> const& row : columns.rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width_of(row[i]));
  std::size_t total = 2 * (widths.size() - 1);
  for (std::size_t const w : widths) total += w;
  std::string const rule = indent + std::string(total, '-') + "\n";
  std::string text = line_of(columns.titles, widths, columns.left, indent) + rule;
  for (std::vector<std::string> const& row : columns.rows)
    text += row.empty() ? rule : line_of(row, widths, columns.left, indent);
  return printable(text);  // names come from foreign files
}

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

std::string csv_text(std::string const& text) {
  std::string quoted = "\"";
  for (char const c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text.find_first_of(",\"\n") == std::string::npos ? text : quoted + "\"";
}

std::string csv_number(bool known, double value) {
  return known && !std::isnan(value) ? fmt::format("{}", value) : "nan";
}

std::string finite_text(double x, std::string const& format) {
  return std::isfinite(x) ? fmt::format(fmt::runtime(format), x) : "-";
}

// Cells of tables.

std::string_view name_of(ColumnKind kind) {
  constexpr std::string_view names[] = {"text", "flag", "count", "number", "estimate", "list"};
  return names[std::size_t(kind)];
}

std::string cell_text(TableCell const& cell, std::string const& format) {
  if (auto const* const text = std::get_if<std::string>(&cell)) return text->empty() ? "-" : *text;
  if (auto const* const yes = std::get_if<bool>(&cell)) return *yes ? "yes" : "no";
  if (auto const* const count = std::get_if<std::uint64_t>(&cell)) return fmt::format("{}", *count);
  if (auto const* const x = std::get_if<WithError>(&cell)) return with_brackets(*x);
  return finite_text(std::get<double>(cell), format);
}

std::string cell_csv(TableCell const& cell, double scale) {
  if (auto const* const text = std::get_if<std::string>(&cell)) return csv_text(*text);
  if (auto const* const yes = std::get_if<bool>(&cell)) return *yes ? "yes" : "no";
  if (auto const* const count = std::get_if<std::uint64_t>(&cell)) return fmt::format("{}", *count);
  if (auto const* const x = std::get_if<WithError>(&cell))
    return csv_number(true, scale * x->value) + "," + csv_number(true, scale * x->sigma);
  return csv_number(true, scale * std::get<double>(cell));
}

nlohmann::ordered_json error_json(WithError const& x) {
  nlohmann::ordered_json j{{"value", x.value}, {"sigma", x.sigma}};
  if (x.at_most && x.incomplete)
    j["bound"] = bound_name(true, true);
  else if (x.at_most)
    j["at_most"] = true;
  return j;
}

nlohmann::ordered_json cell_json(TableCell const& cell, double scale) {
  if (auto const* const text = std::get_if<std::string>(&cell)) return *text;
  if (auto const* const yes = std::get_if<bool>(&cell)) return *yes;
  if (auto const* const count = std::get_if<std::uint64_t>(&cell)) return *count;
  if (auto const* const x = std::get_if<WithError>(&cell))
    return error_json({scale * x->value, scale * x->sigma, x->at_most, x->incomplete});
  return scale * std::get<double>(cell);
}

// Numbers with errors, printed with the digits that the error allows.

namespace {

int decade(double x) { return int(std::floor(std::log10(x))); }

// value and sigma over 10^exponent, with `decimals` digits behind the point.
struct Rounded {
  std::string value, sigma;
  int exponent = 0, decimals = 0;
};

// Position of the last digit of the error: one digit, two when it begins with 1 (so that rounding costs below 20 %).
int last_place(double sigma) {
  int const top = decade(sigma);
  return sigma / std::pow(10.0, top) < 1.95 ? top - 1 : top;
}

Rounded rounded(double value, double sigma) {
  int const place = last_place(sigma);
  int top = decade(std::max(std::fabs(value), sigma));
  double const unit = std::pow(10.0, place);
  if (std::fabs(std::round(value / unit)) * unit >= std::pow(10.0, top + 1) * (1 - 1e-12)) ++top;
  Rounded r;
  r.exponent = top < -3 || top > 4 ? top : 0;
  r.decimals = std::max(0, r.exponent - place);
  double const scale = std::pow(10.0, r.exponent);
  // Plain numbers with an error above 10 are rounded in front of the point.
  double const step = place > 0 && r.exponent == 0 ? unit : 0;
  auto digits = [&](double x) {
    return fmt::format("{:.{}f}", step > 0 ? std::round(x / step) * step : x / scale, r.decimals);
  };
  r.value = digits(value);
  r.sigma = digits(sigma);
  return r;
}

std::string power(int exponent) { return exponent == 0 ? "" : fmt::format("e{:+03d}", exponent); }

std::string bounded(WithError const& x) {
  if (!(x.value > 0 && std::isfinite(x.value))) return with_error(x.value, 0);
  return x.incomplete ? fmt::format("about {:.2g}", x.value) : "at most " + two_digits(x.value, true);
}

// Computed light with a negligible part of sampled light: the error is below the last printed digit.
bool tiny(double value, double sigma) { return sigma < 1e-7 * std::fabs(value); }

}  // namespace

std::string with_error(double value, double sigma) {
  if (!std::isfinite(value) || !std::isfinite(sigma) || sigma < 0) return "unresolved";
  if (sigma == 0) return fmt::format("{:.3g} (computed)", value);
  if (tiny(value, sigma)) return fmt::format("{:.4g} ± {:.1g}", value, sigma);
  Rounded const r = rounded(value, sigma);
  return fmt::format("{0}{2} ± {1}{2}", r.value, r.sigma, power(r.exponent));
}

std::string with_brackets(double value, double sigma) {
  if (!std::isfinite(value) || !std::isfinite(sigma) || sigma < 0) return "unresolved";
  if (sigma == 0) return fmt::format("{:.3g} computed", value);
  if (tiny(value, sigma)) return fmt::format("{:.4g}(<1)", value);
  Rounded const r = rounded(value, sigma);
  bool const below_one = r.decimals > 0 && r.sigma.starts_with("0.");
  std::string error = below_one ? r.sigma.substr(2) : r.sigma;
  if (below_one) error.erase(0, std::min(error.find_first_not_of('0'), error.size() - 1));
  return fmt::format("{}({}){}", r.value, error, power(r.exponent));
}

std::string two_digits(double value, bool up) {
  double const unit = std::pow(10.0, decade(value) - 1), digits = value / unit;  // 10 to 100
  constexpr double rounding = 1e-12;
  double const rounded = unit * (up ? std::ceil(digits * (1 - rounding)) : std::floor(digits * (1 + rounding)));
  return rounded < 1e-3 || rounded >= 1e5 ? fmt::format("{:.1e}", rounded) : fmt::format("{:g}", rounded);
}

std::string with_error(WithError const& x) { return x.at_most ? bounded(x) : with_error(x.value, x.sigma); }

std::string with_brackets(WithError const& x) { return x.at_most ? bounded(x) : with_brackets(x.value, x.sigma); }

std::string percent_text(WithError const& share) {
  bool const exact = share.sigma == 0 && std::isfinite(share.value) && !share.at_most;
  return exact ? fmt::format("{:.3g}", 100 * share.value)
               : with_brackets({100 * share.value, 100 * share.sigma, share.at_most});
}

std::string bound_name(bool has_upper_bounds, bool incomplete) {
  return has_upper_bounds && incomplete ? "neither" : has_upper_bounds ? "upper" : incomplete ? "lower" : "";
}

std::string bound_text(bool has_upper_bounds, std::size_t missing) {
  std::string const routes = counted(missing, "route") + " unresolved";
  if (missing == 0) return has_upper_bounds ? "upper bound" : "";
  return (has_upper_bounds ? "contains upper bounds; " : "lower bound: ") + routes;
}

}  // namespace straytrace::results
