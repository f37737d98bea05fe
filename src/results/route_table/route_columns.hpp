// SPDX-License-Identifier: BSD-3-Clause
// The columns of the path table: the one list behind text, CSV, JSON, pages, filters, run file and Python, and its
// values by column, which pages draw and filters compare.
#pragma once

#include <algorithm>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "results/results.hpp"
#include "results/text/columns.hpp"
#include "results/text/table.hpp"

namespace straytrace::results {

// Names of routes in tables of text, whose columns must stay narrow.

// Each name with whole steps left out around "…" until it has at most `width` characters; its first and last step
// always stay. Different names look different where that is possible.
std::vector<std::string> shortened_routes(std::vector<std::string> const& names, std::size_t width);

// In the column `route`, to a width for terminals; whether one had to be shortened.
bool shorten_routes(Columns&);
inline constexpr char const* explanation_of_shortened =
    "…: steps of a long route that are left out here; CSV and JSON list all of them.\n";

struct RouteRow {
  PathTable const& table;
  PathRow const& row;
};

// Routes in the order of the coupling table, without ranks and noise: the part of the table in the run file.
PathTable unranked_routes(CouplingTable const&);
// The columns of a table with these frequencies and kinds of routes.
std::vector<TableColumn<RouteRow>> route_columns(PathTable const&);
bool has_kinds(PathTable const&);   // more than scattered light
std::string strain_key(double hz);  // of the column of h at a frequency

struct RouteColumn {
  std::string key, title, unit, help;
  bool is_text = false, whole = false;  // whole: counts, kept to the last digit
  bool shown_first = false;             // on pages, before the reader chooses columns
  std::vector<std::string> texts;       // one per row, if `is_text`
  std::vector<double> numbers;          // else: in `unit`; NaN: not resolved, or not known
  // Units that a filter accepts after a number, with their factors to `unit`; whether it needs one.
  std::vector<std::pair<std::string, double>> units;
  bool needs_unit = false;

  bool is_error() const { return key.ends_with("_sigma"); }
};

class RouteColumns {
 public:
  explicit RouteColumns(std::vector<RouteColumn> columns);  // all of one length
  // `budget` may be null; with it h is available at any frequency of its grid. It must outlive this.
  RouteColumns(PathTable const&, NoiseBudget const* budget);

  std::deque<RouteColumn> const& all() const { return all_; }
  std::size_t rows() const { return all_.empty() ? 0 : std::max(all_[0].texts.size(), all_[0].numbers.size()); }
  RouteColumn const* find(std::string_view key) const;  // null: no such column
  // h at a frequency [Hz], 1/sqrt(Hz) by row; where it is not known, throws std::out_of_range with what is.
  RouteColumn const& strain(double hz);

 private:
  RouteColumn& add(RouteColumn);

  std::deque<RouteColumn> all_;  // references hold while columns are added
  std::map<std::string, std::size_t, std::less<>> place_;
  std::vector<std::uint64_t> hashes_;  // by row
  std::vector<bool> resolved_;         // by row
  NoiseBudget const* budget_ = nullptr;
};

// To six digits, as columns are compared and drawn: more precise than their errors.
double six_digits(double);

// Names of the objects on a route: ITM, baffles of "ITM·S > baffles·S". None for a row `other`, which sums many routes.
std::vector<std::string> objects_of(std::string const& sequence);

// Different objects that the light of a row meets, in the order of the route; of ghosts whose fields add, those of all
// that are listed.
std::vector<std::string> objects_met(PathRow const&);
inline constexpr char const* between_objects = "; ";  // in the column `via`

}  // namespace straytrace::results
