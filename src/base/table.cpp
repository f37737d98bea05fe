// SPDX-License-Identifier: BSD-3-Clause
#include "base/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "base/document.hpp"

namespace straytrace {
namespace {

// Stands for a value whose problem is recorded already.
Node silent(Node const& like) {
  auto data = std::make_shared<NodeData>();
  data->place = like.place();
  return {std::move(data), like.scope(), like.document()};
}

std::string kind_name(Node::Kind kind) {
  switch (kind) {
    case Node::Kind::scalar:
      return "a single value";
    case Node::Kind::list:
      return "a list";
    case Node::Kind::table:
      return "a table of keys";
    case Node::Kind::none:
      break;
  }
  return "nothing";
}

std::string listed(std::span<std::string const> words) {
  std::string out;
  for (std::size_t i = 0; i < words.size() && i < 40; ++i) out += (i ? ", " : "") + words[i];
  return words.size() > 40 ? out + ", ..." : out;
}

}  // namespace

Node::Kind Node::kind() const { return data_ ? data_->kind : Kind::none; }

Place Node::place() const { return data_ ? data_->place : Place{}; }

std::string const& Node::text() const {
  static std::string const empty;
  return data_ ? data_->text : empty;
}

bool Node::has(std::string_view key) const {
  if (kind() != Kind::table) return false;
  data_->asked.try_emplace(std::string(key));
  NodeData::Entry const* entry = data_->find(key);
  if (entry) entry->value->known = true;
  return entry != nullptr;
}

Node Node::operator[](std::string_view key) const {
  if (!data_) return {nullptr, scope_, document_};
  if (data_->kind == Kind::none) return *this;
  if (data_->kind != Kind::table) {
    problem(fmt::format("'{}' needs a table with the key '{}', got {}", data_->label, key, kind_name(data_->kind)),
            fmt::format("write '{{{}: ...}}'", key));
    return silent(*this);
  }
  if (!has(key)) return {nullptr, scope_, document_};
  return {data_->find(key)->value, scope_, document_};
}

std::vector<std::pair<std::string, Node>> Node::items() const {
  std::vector<std::pair<std::string, Node>> out;
  if (kind() == Kind::scalar || kind() == Kind::list)
    problem(fmt::format("'{}' needs a table of keys, got {}", data_->label, kind_name(data_->kind)),
            "write '{name: value}'");
  if (kind() != Kind::table) return out;
  data_->listed = true;
  for (NodeData::Entry const& e : data_->entries) {
    e.value->known = true;
    out.emplace_back(e.key, Node(e.value, scope_, document_));
  }
  return out;
}

Place Node::key_place(std::string_view key) const {
  NodeData::Entry const* entry = kind() == Kind::table ? data_->find(key) : nullptr;
  return entry ? entry->place : place();
}

void Node::missing(std::string_view key, std::string_view nature, std::string const& suggestion) const {
  if (!document_) return;
  std::string const in = data_ && !data_->label.empty() ? fmt::format(" in '{}'", data_->label) : "";
  document_->add({place(), fmt::format("key '{}' ({}) is missing{}", key, nature, in), suggestion});
}

std::string Node::word(std::string_view key, std::string_view fallback) const {
  Node const value = (*this)[key];
  if (data_) data_->note(key, {.form = Asked::Form::word, .word = std::string(fallback)});
  if (value.data_) return value.as_word();
  if (fallback.empty()) missing(key, "text", fmt::format("add '{}: ...'", key));
  return std::string(fallback);
}

std::string Node::as_word() const {
  if (data_) data_->read.form = Asked::Form::word;
  if (kind() == Kind::list || kind() == Kind::table)
    problem(fmt::format("'{}' is a single text, got {}", data_->label, kind_name(kind())),
            fmt::format("write '{}: text'", data_->label));
  return text();
}

std::string Node::choice(std::string_view key, std::span<std::string_view const> choices,
                         std::string_view fallback) const {
  std::vector<std::string> const words(choices.begin(), choices.end());
  Node const value = (*this)[key];
  if (data_) data_->note(key, {.form = Asked::Form::choice, .choices = words, .word = std::string(fallback)});
  if (!value.data_) {
    if (fallback.empty())
      missing(key, "a choice", fmt::format("add '{}: {}' (accepted: {})", key, words.front(), listed(words)));
    return std::string(fallback);
  }
  if (!value) return {};
  std::string const word = value.as_word();
  if (value.kind() != Kind::scalar || std::find(words.begin(), words.end(), word) != words.end()) return word;
  std::string const near = nearest_word(word, words);
  value.problem(fmt::format("'{}' cannot be \"{}\"", key, shortened(word)),
                near.empty() ? "write one of: " + listed(words)
                             : fmt::format("did you mean '{}'? (accepted: {})", near, listed(words)));
  return {};
}

bool Node::flag(std::string_view key, bool fallback) const {
  Node const value = (*this)[key];
  if (data_) data_->note(key, {.form = Asked::Form::flag, .word = fallback ? "on" : "off"});
  if (!value) return fallback;
  std::string const word = value.as_word();
  if (word == "on" || word == "yes" || word == "true") return true;
  if (word == "off" || word == "no" || word == "false") return false;
  if (value.kind() == Kind::scalar)
    value.problem(fmt::format("'{}' is a switch, got \"{}\"", key, shortened(word)),
                  "write on or off (also yes, no, true, false)");
  return fallback;
}

Node Node::table(std::string_view key) const {
  Node const value = (*this)[key];
  if (data_) data_->note(key, {.form = Asked::Form::table});
  if (!value || value.kind() == Kind::table) return value;
  value.problem(fmt::format("'{}' needs a table of keys, got {}", key, kind_name(value.kind())),
                fmt::format("write '{}: {{name: value}}'", key));
  return silent(value);
}

std::vector<Node> Node::list(std::string_view key) const {
  Node const value = (*this)[key];
  if (data_) data_->note(key, {.form = Asked::Form::list});
  return value.as_list();
}

std::vector<Node> Node::as_list() const {
  std::vector<Node> out;
  if (kind() == Kind::none) return out;
  if (data_->read.form == Asked::Form::named) data_->read.form = Asked::Form::list;
  if (kind() != Kind::list) return {*this};
  for (auto const& element : data_->elements) out.emplace_back(element, scope_, document_);
  return out;
}

void Node::refuse_unknown(std::string_view what) const {
  if (kind() != Kind::table) return;
  data_->role = what;
  std::vector<std::string> known;
  for (auto const& [key, how] : data_->asked) known.push_back(key);
  int reported = 0;
  for (NodeData::Entry const& e : data_->entries) {
    if (e.value->known || ++reported > 100) continue;  // hostile input: enough is said
    std::string const near = nearest_word(e.key, known);
    std::string const suggestion = !near.empty()   ? fmt::format("did you mean '{}'?", near)
                                   : known.empty() ? "remove it"
                                                   : "known keys: " + listed(known);
    document_->add(
        {e.place, fmt::format("unknown key '{}' in {}", shortened(e.key), what), suggestion, Severity::error, e.width});
  }
}

void Node::problem(std::string what, std::string suggestion) const {
  if (document_)
    document_->add({place(), std::move(what), std::move(suggestion), Severity::error, data_ ? data_->width : 1});
}

void Node::warning(std::string what, std::string suggestion) const {
  if (document_)
    document_->add({place(), std::move(what), std::move(suggestion), Severity::warning, data_ ? data_->width : 1});
}

bool Node::healthy() const { return !document_ || document_->healthy(); }

std::string Node::data_file(std::string const& name) const {
  return document_ ? document_->data_file(*this, name) : "";
}

void Node::file_problem(std::string const& name, std::uint32_t line, std::uint32_t column, std::string what,
                        std::string suggestion) const {
  if (!document_) return;
  document_->add({document_->place_in_file(*this, name, line, column), std::move(what), std::move(suggestion)});
}

std::string nearest_word(std::string_view word, std::span<std::string const> words) {
  constexpr std::size_t longest = 64;
  std::size_t const n = word.size();
  if (n == 0 || n > longest) return {};
  auto const lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(1, (n + 1) / 3) + 1;
  for (std::string const& other : words) {
    std::size_t const m = other.size();
    if (m == 0 || m > longest || std::max(m, n) - std::min(m, n) >= best_distance) continue;
    // Edit distance with transpositions of neighbours; rows i-2, i-1 and i of the table.
    std::array<std::array<std::size_t, longest + 1>, 3> row{};
    for (std::size_t j = 0; j <= m; ++j) row[0][j] = j;
    for (std::size_t i = 1; i <= n; ++i) {
      auto &now = row[i % 3], &up = row[(i + 2) % 3], &upper = row[(i + 1) % 3];
      now[0] = i;
      for (std::size_t j = 1; j <= m; ++j) {
        bool const same = lower(word[i - 1]) == lower(other[j - 1]);
        now[j] = std::min({up[j] + 1, now[j - 1] + 1, up[j - 1] + (same ? 0 : 1)});
        bool const swapped =
            i > 1 && j > 1 && lower(word[i - 1]) == lower(other[j - 2]) && lower(word[i - 2]) == lower(other[j - 1]);
        if (swapped) now[j] = std::min(now[j], upper[j - 2] + 1);
      }
    }
    if (row[n % 3][m] < best_distance) {
      best_distance = row[n % 3][m];
      best = other;
    }
  }
  return best;
}

}  // namespace straytrace
