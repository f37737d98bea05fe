// SPDX-License-Identifier: BSD-3-Clause
// A plain YAML file as a list of values by dotted path, "Suspension.Stage.0.Mass": tolerant, unlike the scene language.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "base/errors.hpp"
#include "noise/fundamental/fundamental.hpp"

namespace YAML {
class Node;
}

namespace straytrace::results {

class IfoTree {
 public:
  struct Value {
    std::string text;
    Place place;  // file: number of the source
  };
  // Adds the values of a text to the existing ones; a list replaces an earlier one.
  void add(std::string const& source, std::string const& yaml);
  void set(std::string const& path, std::string const& text);           // from the command line
  bool has(std::string const& path) const;                              // value, table or list
  std::optional<std::size_t> source_of(std::string const& path) const;  // which source gave it; none: none, or ".nan"
  void drop(std::string const& path);                                   // as if not given
  // Number at a path; NaN when it is not there or ".nan", `needed`: with a problem; NaN and a problem when it is no
  // number or out of its range.
  double number(std::string const& path, bool needed = true);
  double number(std::string const& path, double fallback);
  std::string word(std::string const& path, std::string const& fallback = "");
  std::vector<std::string> elements(std::string const& list) const;  // "list.0", "list.1", ...
  void problem(std::string const& path, std::string what, std::string suggestion);
  void report_unread(
      std::size_t from_source);  // problems for values that were not read, in the sources from this number on
  void throw_if_problems();      // InputError with all of them
  std::string yaml() const;      // everything, as one plain file

 private:
  Value const* find(std::string const& path);
  void collect(YAML::Node const&, std::string const& path, std::size_t depth);
  void collect_table(YAML::Node const&, std::string const& path, std::size_t depth);
  std::vector<std::string> sources_;
  std::map<std::string, Value> values_;
  std::map<std::string, Place> empty_;  // keys without a value
  std::size_t nodes_ = 0;               // of the last source, aliases expanded
  std::set<std::string> asked_;
  std::vector<Problem> problems_;
};

// Sections of a file in the layout of pygwinc's ifo.yaml.

SuspensionChain read_suspension(IfoTree&, double arm_length);
SubstrateMaterial read_substrate(IfoTree&);
CoatingMaterial read_coating(IfoTree&, std::string const& which);  // "lown", "highn"
std::vector<GasSpecies> read_gas(IfoTree&);
Ground read_ground(IfoTree&);
std::optional<Squeezer> read_squeezer(IfoTree&);  // none: no squeezed light

// Ranges of the numbers of an ifo.yaml, by the end of their path.

// Empty when the number is valid at this path ("Suspension.Stage.0.Mass"), otherwise the requirement.
std::string out_of_range(std::string_view path, double value);

}  // namespace straytrace::results
