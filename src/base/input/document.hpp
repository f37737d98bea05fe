// SPDX-License-Identifier: BSD-3-Clause
// What a Node is made of and what it needs from the document it stands in. The scene room implements Document; rooms
// that only read tables need base/input/table.hpp alone.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/input/table.hpp"

namespace straytrace {

// How a reader asked for a value. From these the schema, the reference of keys, `print` and `diff` are made, so none of
// them can know another language than the readers.
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
  Form form = Form::named;  // named: only that it was looked for, or that the value was handed on
  Dimension dimension{};
  double fallback = required, low = -infinity, high = infinity;  // SI; fallback `required`: none
  std::size_t count = 0;                                         // of numbers
  std::vector<std::string> choices{};
  std::string word{};  // the fallback of a word, a choice or a switch
};

struct NodeData {
  struct Entry {
    std::string key;
    Place place;
    std::uint32_t width = 1;
    std::shared_ptr<NodeData> value;
  };

  // `none` marks a value whose problem is recorded already: reading it stays silent.
  Node::Kind kind = Node::Kind::none;
  Place place;
  std::uint32_t width = 1;     // code points to underline
  std::string text;            // scalar, without quotes
  std::string label;           // the nearest key above, for messages
  int inset = -1;              // code points from place to text; -1: text is not verbatim in the file
  std::vector<Entry> entries;  // table, in file order
  std::map<std::string, std::size_t, std::less<>> index;         // key -> entry
  std::vector<std::shared_ptr<NodeData>> elements;               // list
  mutable bool known = false;                                    // some reader asked for it
  mutable std::map<std::string, KeyRequest, std::less<>> asked;  // keys some reader asked for, present or not
  mutable KeyRequest read;                                       // how the value itself was read
  mutable bool listed = false;                                   // its keys were read as a list of names
  mutable bool misspelt = false;  // a key of it is unknown, so what is missing may only be misspelt
  mutable std::string role;       // what refuse_unknown() called it

  Entry const* find(std::string_view key) const {
    auto const hit = index.find(key);
    return hit == index.end() ? nullptr : &entries[hit->second];
  }
  void note(std::string_view key, KeyRequest how) const {
    if (kind == Node::Kind::table) asked.insert_or_assign(std::string(key), std::move(how));
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
  virtual bool healthy() const = 0;
  // Value of a scalar with the parameters of a scope; when there is none the problem is recorded.
  virtual std::optional<Value> evaluate(NodeData const&, Scope const*) = 0;
  virtual std::string data_file(Node const& from, std::string const& name) = 0;
  // The same for a file that may be missing: nothing then, and no problem.
  virtual std::optional<std::string> optional_file(Node const& from, std::string const& name) = 0;
  // Text that `make` makes of data files, kept under `name` with the other texts; of a model that comes from a run file
  // the kept text, and nothing is made.
  virtual std::optional<std::string> derived_file(Node const& from, std::string const& name,
                                                  std::function<std::optional<std::string>()> const& make) = 0;
  virtual Place place_in_file(Node const& from, std::string const& name, std::uint32_t line, std::uint32_t column) = 0;
};

// "'half_angle' is an angle, got "55" without a unit", with the remedy.
Problem dimension_problem(NodeData const&, Quantity const& got, Dimension wanted);

std::string shortened(std::string_view text);  // for messages: at most 60 characters
std::uint32_t code_points(std::string_view utf8);
bool is_number(std::string_view text);  // a finite literal such as "55" or "-1e-3"

}  // namespace straytrace
