// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/message.hpp"
#include "base/number_rows.hpp"
#include "commission/taps.hpp"

namespace straytrace {
namespace {

std::string trimmed(std::string_view text) {
  std::string out(text);
  std::erase(out, '"');
  out.erase(0, std::min(out.find_first_not_of(" \t\r"), out.size()));
  out.erase(out.find_last_not_of(" \t\r") + 1);
  return out;
}

std::vector<std::string> cells_of(std::string_view line) {
  std::vector<std::string> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    std::size_t const end = std::min(line.find(',', begin), line.size());
    cells.push_back(trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return cells;
}

class ListReader {
 public:
  explicit ListReader(std::string const& file) : file_(file) {}

  std::vector<TapPlace> read(std::string_view csv) {
    csv = without_byte_order_mark(csv);
    for (; !csv.empty(); csv.remove_prefix(std::min(csv.find('\n') + 1, csv.size()))) {
      std::size_t const end = csv.find('\n');
      std::string const line = trimmed(csv.substr(0, end));
      ++line_;
      if (!line.empty() && !line.starts_with('#')) header_.empty() ? take_header(line) : take(line);
      if (end == csv.npos) break;
    }
    if (errors_.empty() && places_.empty()) add("no places in it", "the first line is 'place,start,duration'");
    if (!errors_.empty()) throw InputError(fmt::format("{}", fmt::join(errors_, "\n")));
    return std::move(places_);
  }

 private:
  void add(std::string const& what, std::string const& suggestion) {
    errors_.push_back(fmt::format("{}:{}: error: {}\n  {}", file_, line_, what, suggestion));
  }

  void take_header(std::string const& line) {
    header_ = cells_of(line);
    for (char const* name : {"place", "start", "duration"})
      if (std::find(header_.begin(), header_.end(), name) == header_.end())
        add(fmt::format("no column '{}'", name), "the first line names the columns: place, start, duration, strength");
  }

  std::string cell(std::vector<std::string> const& cells, char const* name) const {
    auto const at = std::size_t(std::find(header_.begin(), header_.end(), name) - header_.begin());
    return at < cells.size() ? cells[at] : "";
  }

  double number(std::vector<std::string> const& cells, char const* name) {
    std::string const text = cell(cells, name);
    double value = not_a_number;
    auto const [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status == std::errc{} && end == text.data() + text.size() && std::isfinite(value)) return value;
    add(fmt::format("'{}' is not a number in column '{}'", text, name), "start is GPS time in s, duration in s");
    return not_a_number;
  }

  void take(std::string const& line) {
    if (!errors_.empty() && places_.empty()) return;  // the header is wrong
    std::vector<std::string> const cells = cells_of(line);
    if (cells.size() > header_.size() && !cells[header_.size()].empty())
      return add(fmt::format("{} values for {} columns", cells.size(), header_.size()),
                 "use decimal points, not decimal commas: 1.5, not 1,5");
    TapPlace p{cell(cells, "place"), number(cells, "start"), number(cells, "duration"), cell(cells, "strength")};
    if (p.name.empty()) add("a place without a name", "write it in column 'place'");
    if (p.duration <= 0) add(fmt::format("a duration of {} s", p.duration), "taps of about 20 s are usual");
    places_.push_back(std::move(p));
  }

  std::string const& file_;
  std::size_t line_ = 0;
  std::vector<std::string> header_, errors_;
  std::vector<TapPlace> places_;
};

}  // namespace

std::vector<TapPlace> parse_tap_list(std::string_view csv, std::string const& file) {
  return ListReader(file).read(csv);
}

}  // namespace straytrace
