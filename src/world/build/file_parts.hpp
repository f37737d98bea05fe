// SPDX-License-Identifier: BSD-3-Clause
// What scene entries with `file` have in common: the unit, and rules that give materials to parts by name or colour.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "world/build/read_parts.hpp"

namespace straytrace {

// Whether `text` is `pattern`, in which each * stands for any characters.
bool matches(std::string_view pattern, std::string_view text);

// A part as its file names it. Rules see the whole name, "tower/dump", and its last piece, "dump".
struct PartLabel {
  std::string name, material, colour;  // colour "#rrggbb"; empty: the file says none
};

// Rows of a table of an entry, `surfaces` or `medium`, in the order of the scene, then its default, then for `surfaces`
// the `material` of the entry: the first that fits counts.
class PartRules {
 public:
  PartRules(Scene::Instance const&, std::string_view table, bool first_time);
  // What the rules say of a part; empty when none fits.
  Node of(PartLabel const&);
  // The optic of a part; everything black, and a note for report(), when no rule fits.
  std::uint32_t optic(PartLabel const&, Registry const&);
  // What fits nothing, and parts without material, in one problem each. `parts`: all of the file `name`.
  void report(Scene::Instance const&, std::string const& name, std::vector<PartLabel> const& parts) const;

 private:
  struct Rule {
    std::string pattern, colour;  // of a rule by colour only the colour
    Node says;
    bool used = false;
    bool fits(PartLabel const&) const;
  };
  void add(std::string const& pattern, Node const& says, bool complain);

  std::vector<Rule> rules_;
  std::vector<std::string> bare_;
};

// The volume of a part that is filled with the medium that a node names.
using FillPart = std::function<std::uint32_t(Node const& medium, std::string const& part)>;

// m per unit of the file; 0, and a problem, when it is not known. `box`: in units of the file. `stated`: m, 0 when the
// file says none. `source` for messages: "its format says m".
double read_file_unit(Scene::Instance const&, Box const& box, double stated, std::string const& source,
                      bool first_time);

// A warning about the file that `file` names.
void warn_of_file(Node const& file, std::string const& what, std::string const& suggestion);

}  // namespace straytrace
