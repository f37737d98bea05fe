// SPDX-License-Identifier: BSD-3-Clause
// Regular expressions for short texts. They are those of the standard library, behind a class of our own: std::regex
// recurses for every character and overflows the stack at some tens of thousands of them, and takes seconds to compile.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace {

// What the groups of a pattern have matched; [0] is all of it. Converts to false when the text did not match.
class PatternMatch {
 public:
  explicit operator bool() const { return !groups_.empty(); }
  std::string const& operator[](std::size_t group) const { return groups_[group].text; }
  bool matched(std::size_t group) const { return groups_[group].matched; }
  std::size_t position(std::size_t group) const { return groups_[group].position; }  // in the text, bytes

 private:
  friend class Pattern;
  struct Group {
    std::string text;
    bool matched = false;
    std::size_t position = 0;
  };
  std::vector<Group> groups_;
};

class Pattern {
 public:
  static constexpr std::size_t longest = 2000;  // bytes: longer texts never match

  explicit Pattern(std::string const& form);
  PatternMatch match(std::string const& text) const;        // of the whole text
  std::size_t width_at_start(std::string_view text) const;  // bytes that match where the text begins; 0: none
  // All places that match, replaced by `with` ($1 is the first group). No place may be long.
  std::string replaced(std::string const& text, std::string const& with) const;

 private:
  struct Form;
  std::shared_ptr<Form const> form_;
};

}  // namespace straytrace
