// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/coupling/coupling_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "base/errors.hpp"
#include "base/units/quantity.hpp"
#include "io/number_rows.hpp"

namespace straytrace {
namespace {

constexpr CouplingFlag flags[] = {CouplingFlag::measured, CouplingFlag::upper_limit, CouplingFlag::below_thresholds,
                                  CouplingFlag::no_data, CouplingFlag::not_linear};

std::string plain(std::string_view text) {  // lower case, without blanks around and quotes
  std::string out;
  for (char const c : text)
    if (c != '"' && c != '\r') out += char(std::tolower(static_cast<unsigned char>(c)));
  out.erase(0, std::min(out.find_first_not_of(" \t"), out.size()));
  out.erase(out.find_last_not_of(" \t") + 1);
  return out;
}

std::vector<std::string_view> cells_of(std::string_view line, std::string_view separators) {
  std::vector<std::string_view> cells;
  while (true) {
    std::size_t const end = line.find_first_of(separators);
    cells.push_back(line.substr(0, end));
    if (end == line.npos) return cells;
    line.remove_prefix(end + 1);
  }
}

std::optional<CouplingFlag> flag_of(std::string_view text) {
  std::string const word = plain(text);
  if (word == "measured") return CouplingFlag::measured;
  for (CouplingFlag const f : flags)
    if (word == plain(name_of(f))) return f;
  return {};
}

// Reads one file; knows its name and the line, for messages.
class Reader {
 public:
  explicit Reader(std::string const& file) : file_(file) {}

  CouplingFunction read(std::string_view csv) {
    csv = without_byte_order_mark(csv);
    while (!csv.empty()) {
      std::size_t const end = std::min(csv.find('\n'), csv.size());
      ++line_;
      take(csv.substr(0, end));
      csv.remove_prefix(std::min(end + 1, csv.size()));
    }
    line_ = 0;
    if (columns_.empty() || out_.points.empty()) refuse("no couplings in it", "the columns are " + std::string(wanted));
    return std::move(out_);
  }

  [[noreturn]] void refuse(std::string const& what, std::string const& suggestion) const {
    Problem const problem{{0, line_, 0}, what, suggestion};
    throw InputError({problem}, placed_message(problem, file_), {file_});
  }

 private:
  static constexpr std::string_view glued = "darmbgcoherence";  // pemcoupling forgets a comma between two names
  static constexpr std::string_view wanted = "frequency, factor, factor_counts, flag";

  void take(std::string_view line) {
    if (plain(line).empty() || plain(line).starts_with('#')) return;
    if (columns_.empty())
      take_header(line);
    else
      take_row(line);
  }

  // Names hold no blanks, so one that separates two of them is a comma that was forgotten. A cell without a name is a
  // column all the same: that of the row numbers of pandas.
  void take_header(std::string_view line) {
    std::size_t at = 0;
    for (std::string_view const cell : cells_of(line, ",")) {
      std::size_t const before = at;
      for (std::string_view const word : cells_of(cell, " \t"))
        if (std::string const name = plain(word); !name.empty()) {
          columns_.emplace(name == "freq" ? "frequency" : name, at++);
          if (name == glued) columns_.emplace("coherence", at++);
        }
      if (at == before) ++at;
    }
    named_ = at;
    for (char const* name : {"frequency", "factor", "flag"})
      if (!columns_.contains(name))
        refuse(fmt::format("no column '{}'", name), fmt::format("the first line names the columns: {}", wanted));
  }

  std::string_view text(char const* column) const {
    auto const found = columns_.find(column);
    return found == columns_.end() || found->second >= cells_.size() ? std::string_view() : cells_[found->second];
  }
  double number(char const* column) const {
    std::string const word = plain(text(column));
    if (word.empty() || word == "nan") return not_a_number;
    double value = 0;
    auto const [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (status != std::errc{} || end != word.data() + word.size())
      refuse(fmt::format("'{}' is not a number in column '{}'", word, column), "write it as 1.5e-3");
    return value;
  }
  void agree(std::string& kept, char const* column) const {
    std::string_view word = text(column);
    word.remove_suffix(word.ends_with('\r') ? 1 : 0);
    if (kept.empty()) kept = word;
    if (!word.empty() && word != kept)
      refuse(fmt::format("two different entries in column '{}'", column), "split the file");
  }

  void take_row(std::string_view line) {
    cells_ = cells_of(line, ",");
    if (cells_.size() > named_ && !plain(cells_[named_]).empty())
      refuse(fmt::format("more values than the {} columns that have a name", named_),
             "use decimal points, not decimal commas: 1.5, not 1,5");
    auto const flag = flag_of(text("flag"));
    if (!flag)
      refuse(fmt::format("'{}' is not a flag", plain(text("flag"))),
             "flags are Real, Upper Limit, Thresholds not met, No data, Fringe wrapped");
    CouplingPoint p;
    p.hz = number("frequency");
    p.flag = *flag;
    if (!(p.hz >= 0) || (!out_.points.empty() && p.hz <= out_.points.back().hz))
      refuse("the frequency does not increase", "sort the rows by frequency");
    bool const known = p.flag == CouplingFlag::measured || p.flag == CouplingFlag::upper_limit;
    double const factor = number("factor");
    if (known && !(factor > 0 && std::isfinite(factor))) refuse("the factor is not positive", "or flag it 'No data'");
    if (known || (p.flag == CouplingFlag::not_linear && factor > 0)) p.factor = factor;
    if (known) p.factor_counts = number("factor_counts");
    p.sigma = number("factor_error");
    p.witness_ratio = number("witness_ratio");
    p.target_ratio = number("target_ratio");
    p.significance = number("significance");
    p.coherence = number("coherence");
    agree(out_.unit, "unit");
    agree(out_.witness_unit, "witness_unit");
    agree(out_.witness, "witness");
    agree(out_.target, "target");
    out_.points.push_back(p);
  }

  std::string const& file_;
  std::uint32_t line_ = 0;
  std::map<std::string, std::size_t> columns_;
  std::size_t named_ = 0;  // columns of the header
  std::vector<std::string_view> cells_;
  CouplingFunction out_;
};

std::string number_text(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

// One unit from the file, the caller or both; they must agree.
void settle(Reader const& reader, std::string& found, std::string const& said, char const* what, char const* option) {
  if (found.empty()) found = said;
  if (found.empty())
    reader.refuse(fmt::format("the file does not say the unit of its {}", what), fmt::format("add {}", option));
  if (!parse_unit(found)) reader.refuse(fmt::format("'{}' is not a unit", found), "write for example m, m/s^2, 1/m");
  if (!said.empty() && said != found)
    reader.refuse(fmt::format("its {} are in {}, not in {}", what, found, said), "leave the unit to the file");
}

}  // namespace

CouplingFunction parse_coupling(std::string_view csv, std::string const& file, std::string const& unit,
                                std::string const& witness_unit) {
  Reader reader(file);
  CouplingFunction c = reader.read(csv);
  settle(reader, c.unit, unit, "factors", "--coupling-unit, for example 1/m");
  settle(reader, c.witness_unit, witness_unit, "witness", "--witness-unit, for example m");
  return c;
}

std::string coupling_csv(CouplingFunction const& c) {
  std::string out =
      "frequency,factor,factor_counts,flag,factor_error,unit,witness,witness_unit,target,witness_ratio,target_ratio,"
      "significance,coherence\n";
  for (CouplingPoint const& p : c.points)
    out += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", p.hz, number_text(p.factor),
                       number_text(p.factor_counts), name_of(p.flag), number_text(p.sigma), c.unit, c.witness,
                       c.witness_unit, c.target, number_text(p.witness_ratio), number_text(p.target_ratio),
                       number_text(p.significance), number_text(p.coherence));
  return out;
}

}  // namespace straytrace
