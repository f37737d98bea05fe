// SPDX-License-Identifier: BSD-3-Clause
// The data of a Node and the interface of its document, which the module `scene` implements. Modules that only read
// tables need base/input/table.hpp alone.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/input/table.hpp"

namespace straytrace {

// How a reader requested a value. The schema, the reference of keys, `print` and `diff` are made from these requests,
// so they always agree with the readers.
struct KeyRequest {
  enum class Form : std::uint8_t {
    named,
    number,
    whole,
    amplitude,
    quantity,
    word,
    choice,
    flag,
    table,
    list,
    numbers
  };
  Form form = Form::named;  // named: only looked up, or passed to another reader
  Dimension dimension{};
  double fallback = required, low = -infinity, high = infinity;  // SI; fallback `required`: none
  std::size_t count = 0;                                         // of numbers
  std::vector<std::string> choices{};
  std::string word{};      // the fallback of a word, a choice or a switch
  std::string_view doc{};  // meaning of the key, where its reader states it
};

struct NodeData {
  struct Entry {
    std::string key;
    Place place;
    std::uint32_t width = 1;
    std::shared_ptr<NodeData> value;
  };

  // `none` marks a value whose problem is recorded already: reading it reports nothing more.
  Node::Kind kind = Node::Kind::none;
  Place place;
  std::uint32_t width = 1;     // code points to underline
  std::string text;            // scalar, without quotes
  std::string label;           // the nearest key above, for messages
  int inset = -1;              // code points from place to text; -1: text is not verbatim in the file
  std::vector<Entry> entries;  // table, in file order
  std::map<std::string, std::size_t, std::less<>> index;         // key -> entry
  std::vector<std::shared_ptr<NodeData>> elements;               // list
  mutable bool known = false;                                    // requested by a reader
  mutable std::map<std::string, KeyRequest, std::less<>> asked;  // requested keys, present or not
  mutable KeyRequest read;                                       // how the value itself was read
  mutable bool listed = false;                                   // its keys were read as a list of names
  mutable std::map<std::string, Problem, std::less<>> missing;   // absent keys, as they were reported
  mutable bool misspelt = false;  // has an unknown key, so a missing key may only be misspelt
  mutable std::string role;       // its name in refuse_unknown()

  Entry const* find(std::string_view key) const {
    auto const hit = index.find(key);
    return hit == index.end() ? nullptr : &entries[hit->second];
  }
  void note(std::string_view key, KeyRequest how) const {
    if (kind == Node::Kind::table) asked.insert_or_assign(std::string(key), std::move(how));
  }
  // The meaning of a key, after it was read; `doc` outlives the document.
  void describe(std::string_view key, std::string_view doc) const {
    if (auto const hit = asked.find(key); hit != asked.end()) hit->second.doc = doc;
  }
  // False when the key is there already.
  bool add(Entry entry) {
    if (!index.emplace(entry.key, entries.size()).second) return false;
    entries.push_back(std::move(entry));
    return true;
  }
};

// An evaluated scalar. A bare 0 fits every dimension.
struct Value {
  Quantity quantity;
  bool bare_zero = false;
};

class Document {
 public:
  virtual ~Document() = default;
  virtual void add(Problem) = 0;
  virtual void withdraw(Problem) = 0;      // which another one explains
  virtual std::size_t errors() const = 0;  // so far
  bool healthy() const { return errors() == 0; }
  // Value of a scalar with the parameters of a scope; records a problem when it has none.
  virtual std::optional<Value> evaluate(NodeData const&, scene::Scope const*) = 0;
  // Where the parameters in an expression are set, "line 3 of rows.csv": empty where that is not known, nothing without
  // parameters.
  virtual std::optional<std::string> origin(std::string_view expression, scene::Scope const*) const = 0;
  virtual std::string data_file(Node const& from, std::string const& name) = 0;
  // The same for an optional file: empty and no problem when it is missing.
  virtual std::optional<std::string> optional_file(Node const& from, std::string const& name) = 0;
  // Text that `make` derives from data files, kept under `name` with the other texts. A model from a run file returns
  // the kept text without calling `make`.
  virtual std::optional<std::string> derived_file(Node const& from, std::string const& name,
                                                  std::function<std::optional<std::string>()> const& make) = 0;
  virtual Place place_in_file(Node const& from, std::string const& name, std::uint32_t line, std::uint32_t column) = 0;
};

// "'half_angle' is an angle, got "55" without a unit", with the remedy.
Problem dimension_problem(NodeData const&, Quantity const& got, Dimension wanted);

std::string shortened(std::string_view text);  // for messages: at most 60 characters
std::uint32_t code_points(std::string_view utf8);
bool is_number(std::string_view text);  // a finite literal such as "55" or "-1e-3"
// The finite number that a text begins with, and the text behind it without blanks around: "10 Hz" is 10 and "Hz".
// Nothing without one, or where it is outside the range of double precision.
struct LeadingNumber {
  double value = 0;
  std::string rest;
};
std::optional<LeadingNumber> leading_number(std::string_view text);
// What is wrong with a text that is not: "is not a number", "is outside the range of double precision, 1e-307 to
// 1e308", "has a no-break space (U+202F) between its digits"; of a finite number: in its unit it is outside the range.
std::string number_fault(std::string_view text);

}  // namespace straytrace
