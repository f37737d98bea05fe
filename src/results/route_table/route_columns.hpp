// SPDX-License-Identifier: BSD-3-Clause
// What is known of each route of a path table, by columns: the table of the report, and what filters compare.
#pragma once

#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "results/results.hpp"

namespace straytrace {

struct RouteColumn {
  std::string key, title, unit, help;
  bool is_text = false, whole = false;  // whole: counts, kept to the last digit
  std::vector<std::string> texts;       // one per row, if `is_text`
  std::vector<double> numbers;          // else: in `unit`; NaN: not resolved, or not known
  // What a filter may write behind a number, with its factor to `unit`; where one must be written.
  std::vector<std::pair<std::string, double>> units;
  bool needs_unit = false;

  bool is_error() const { return key.ends_with("_sigma"); }
};

class RouteColumns {
 public:
  // `budget` may be null; with it h is known at any frequency of its grid. It must outlive this.
  RouteColumns(PathTable const&, CouplingTable const&, NoiseBudget const* budget);

  std::deque<RouteColumn> const& all() const { return all_; }
  std::size_t rows() const { return rows_; }
  RouteColumn const* find(std::string_view key) const;  // null: there is none
  // h at a frequency [Hz], 1/sqrt(Hz) by row; throws std::out_of_range with what is known where it is not.
  RouteColumn const& strain(double hz);

 private:
  RouteColumn& at(std::string const& key, std::string const& title, std::string const& unit, std::string const& help);
  void text(std::string const& key, std::string const& title, std::string const& help, std::string value);
  void number(std::string const& key, std::string const& title, std::string const& unit, std::string const& help,
              double value);
  void count(std::string const& key, std::string const& title, std::string const& help, double value);
  void add_names(PathRow const&, CouplingClass const*, CouplingTable const&);
  void add_noise(PathTable const&, PathRow const&);
  void add_light(PathRow const&, double wavelength);
  void add_units();

  std::deque<RouteColumn> all_;  // references hold while columns are added
  std::map<std::string, std::size_t, std::less<>> place_;
  std::vector<std::uint64_t> hashes_;  // by row
  std::vector<bool> resolved_;         // by row
  std::vector<double> listed_;         // Hz
  NoiseBudget const* budget_;
  std::size_t rows_ = 0;
};

// To six digits, as columns are compared and drawn: more than any error of them holds.
double six_digits(double);

// Names of the objects on a route, "ITM·S > baffles·S": ITM, baffles. None of a row `other`, which sums many routes.
std::vector<std::string> objects_of(std::string const& sequence);

}  // namespace straytrace
