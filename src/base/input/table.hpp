// SPDX-License-Identifier: BSD-3-Clause
// The checked input tree from which every module reads its structs. A Node knows its place in the file, the parameters
// in scope and its document. Readers never throw at the first problem: they record it in the document, return NaN or an
// empty value and continue; the document throws once, at the end (docs/reference/scene.md).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/units/quantity.hpp"

namespace straytrace::scene {
struct Scope;  // parameters in force: scene/scope.hpp
}  // namespace straytrace::scene

namespace straytrace {

constexpr double required = std::numeric_limits<double>::quiet_NaN();

// One numeric key of the input language. Reading, range check, suggestion and reference page use this line.
template <class T>
struct Key {
  std::string_view name;
  double T::*member;
  Dimension dimension;
  double fallback, low, high;  // SI; fallback `required` = no default
  std::string_view doc;
};

class Document;   // files, sources, problems: base/input/document.hpp
struct NodeData;  // base/input/document.hpp

// One value of the input: nothing, a scalar, a list or a mapping ("table"). Cheap to copy.
class Node {
 public:
  enum class Kind : std::uint8_t { none, scalar, list, table };

  Node() = default;
  Node(std::shared_ptr<NodeData> data, std::shared_ptr<scene::Scope const> scope, Document* document)
      : data_(std::move(data)), scope_(std::move(scope)), document_(document) {}

  Kind kind() const;
  explicit operator bool() const { return kind() != Kind::none; }
  Place place() const;
  std::string const& text() const;  // scalar exactly as written (empty when not a scalar)

  // --- tables ---------------------------------------------------------------------------------------------------
  bool has(std::string_view key) const;                     // marks the key as known
  Node operator[](std::string_view key) const;              // marks the key as known; none when absent
  std::vector<std::pair<std::string, Node>> items() const;  // in file order; marks every key as known
  Place key_place(std::string_view key) const;

  // A number with the dimension; `fallback` NaN means required. Out of range or wrong: a problem and NaN.
  double number(std::string_view key, Dimension, double fallback = required, double low = -infinity,
                double high = infinity) const;
  // A whole number in [low, high]; 0 and a problem when wrong, or missing without a fallback.
  std::uint64_t whole(std::string_view key, double fallback, double low, double high) const;
  // A length-like amplitude that must say peak, pp or rms.
  Quantity amplitude(std::string_view key, Dimension) const;
  std::string word(std::string_view key,
                   std::string_view fallback = {}) const;  // any text; required when fallback empty
  // One of `choices`, otherwise a problem with the nearest as suggestion.
  std::string choice(std::string_view key, std::span<std::string_view const> choices,
                     std::string_view fallback = {}) const;
  bool flag(std::string_view key, bool fallback) const;  // on/off, yes/no, true/false
  Node table(std::string_view key) const;                // problem when present and not a table; none when absent
  std::vector<Node> list(std::string_view key) const;    // a scalar or table counts as a list of one

  // Records a problem for every key that no reader requested, with the nearest known key as suggestion; `what` names
  // the table ("shape 'cone'").
  void refuse_unknown(std::string_view what) const;
  // The same only for keys that a missing key explains, where not all keys of the table are known.
  void refuse_misspelt(std::string_view what) const;

  // Records that a required key is absent; refuse_unknown() withdraws this where the key is only misspelt.
  void lack(std::string_view key, std::string what, std::string suggestion) const;

  // --- scalars and lists -----------------------------------------------------------------------------------------
  double as_number(Dimension, double low = -infinity, double high = infinity) const;
  Quantity as_quantity() const;  // any dimension; NaN and a problem when not a quantity
  std::string as_word() const;
  std::vector<Node> as_list() const;  // elements; a scalar or table counts as a list of one
  std::vector<double> as_numbers(Dimension, std::size_t expected) const;  // exactly `expected` elements

  // --- messages, files -------------------------------------------------------------------------------------------
  void problem(std::string what, std::string suggestion) const;  // at this node
  void warning(std::string what, std::string suggestion) const;
  bool healthy() const;  // the document has no error so far
  // Text of a data file, named relative to the file of this node; empty and a problem when unreadable. The document
  // keeps name and text for the run file.
  std::string data_file(std::string const& name) const;
  // A problem inside a data file that data_file(name) has read: "steel.csv:214:3: error: ..."; line 0: the whole file.
  void file_problem(std::string const& name, std::uint32_t line, std::uint32_t column, std::string what,
                    std::string suggestion) const;

  std::shared_ptr<NodeData> const& data() const { return data_; }
  std::shared_ptr<scene::Scope const> const& scope() const { return scope_; }
  Document* document() const { return document_; }

 private:
  void missing(std::string_view key, std::string_view nature, std::string const& suggestion) const;
  void refuse_keys(std::string_view what, bool only_misspelt) const;
  std::optional<Quantity> evaluated(Dimension) const;  // of this dimension, otherwise a problem
  bool within(double si, Dimension, double low, double high) const;

  std::shared_ptr<NodeData> data_;
  std::shared_ptr<scene::Scope const> scope_;
  Document* document_ = nullptr;
};

// Fills a struct from a table through its key list.
template <class T>
void read_keys(Node const& table, std::span<Key<T> const> keys, T& into) {
  for (Key<T> const& k : keys) into.*(k.member) = table.number(k.name, k.dimension, k.fallback, k.low, k.high);
}

// Reports elements of a list such as "1" and "5 m" without a space between them: the decimal comma of "1,5 m". Zero
// needs no unit, so "[0,5 m]" is in doubt unless `zero_is_value`.
bool refuse_decimal_commas(std::span<Node const> elements, Dimension, bool zero_is_value);

// How well an input is known, `uncertainty: 30 %` or `uncertainty: factor 1.5`: one standard deviation of the logarithm
// as a factor of at least 1. 1.3 for 30 % means a value between 1/1.3 and 1.3 times the stated one. Returns `fallback`
// for a missing or wrong value. A share is at most 100 %, so that 30 without the sign is not read as a factor of 31.
double read_uncertainty(Node const& value, double fallback = 1);

// How far a number can be trusted: the key `status` of a table, empty without it. One of measured, published (a paper
// or public code), required (a specification), derived (computed from others), estimate, assumed (no public number).
std::string read_status(Node const& table);

// The nearest of `words` by edit distance, empty when nothing is close: "did you mean ...?".
std::string nearest_word(std::string_view word, std::span<std::string const> words);
// "did you mean 'NEAREST'?", or `otherwise` when nothing is close.
std::string did_you_mean(std::string_view word, std::span<std::string const> words, std::string otherwise);

}  // namespace straytrace
