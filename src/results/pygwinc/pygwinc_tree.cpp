// SPDX-License-Identifier: BSD-3-Clause
#include "results/pygwinc/pygwinc_tree.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/input/table.hpp"
#include "base/math/constants.hpp"
#include "results/pygwinc/pygwinc_parts.hpp"

namespace straytrace {
namespace {

bool is_nan(std::string const& text) { return text == ".nan" || text == ".NaN" || text == ".NAN"; }

bool below(std::string const& path, std::string const& table) {
  return path.size() > table.size() && path.starts_with(table) && path[table.size()] == '.';
}

Place place_of(YAML::Mark const& mark, std::size_t source) {
  return {std::uint32_t(source), std::uint32_t(mark.line + 1), std::uint32_t(mark.column + 1)};
}

// Nested plain YAML, from a map of dotted paths in order: numbers of a list follow each other.
void write_yaml(YAML::Emitter& out, std::map<std::string, IfoTree::Value> const& values, std::string const& table) {
  std::vector<std::string> keys;
  for (auto const& [path, value] : values) {
    if (!table.empty() && !below(path, table)) continue;
    std::string const rest = table.empty() ? path : path.substr(table.size() + 1);
    std::string const key = rest.substr(0, rest.find('.'));
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
  }
  bool const list = !keys.empty() && std::all_of(keys.begin(), keys.end(), [](std::string const& k) {
    return k.find_first_not_of("0123456789") == k.npos;
  });
  if (list)
    std::sort(keys.begin(), keys.end(), [](auto const& a, auto const& b) { return std::stoi(a) < std::stoi(b); });
  if (list)
    out << YAML::BeginSeq;
  else
    out << YAML::BeginMap;
  for (std::string const& key : keys) {
    std::string const path = table.empty() ? key : table + "." + key;
    if (!list) out << YAML::Key << key << YAML::Value;
    if (auto const found = values.find(path); found != values.end())
      out << found->second.text;
    else
      write_yaml(out, values, path);
  }
  if (list)
    out << YAML::EndSeq;
  else
    out << YAML::EndMap;
}

}  // namespace

void IfoTree::add(std::string const& source, std::string const& yaml) {
  sources_.push_back(source);
  std::size_t const number = sources_.size() - 1;
  auto const collect = [&](auto const& self, YAML::Node const& node, std::string const& path) -> void {
    if (node.IsMap()) {
      std::set<std::string> keys;
      for (auto const& item : node) {
        std::string const key = item.first.Scalar(), inner = path.empty() ? key : path + "." + key;
        if (!keys.insert(key).second)
          problems_.push_back(
              {place_of(item.first.Mark(), number), fmt::format("'{}' stands here twice", inner), "keep one of them"});
        self(self, item.second, inner);
      }
    } else if (node.IsSequence()) {
      std::erase_if(values_, [&](auto const& v) { return below(v.first, path) && v.second.place.file != number; });
      for (std::size_t i = 0; i < node.size(); ++i) self(self, node[i], fmt::format("{}.{}", path, i));
    } else if (node.IsScalar()) {
      values_[path] = {node.Scalar(), place_of(node.Mark(), number)};
    }
  };
  try {
    YAML::Node const root = YAML::Load(yaml);
    if (!root.IsMap()) {
      problems_.push_back({{std::uint32_t(number), 1, 1},
                           "this is not a description of an interferometer",
                           "write keys as in pygwinc's ifo.yaml, or 'extends: aligo' and what differs"});
      return;
    }
    collect(collect, root, "");
  } catch (YAML::Exception const& e) {
    problems_.push_back({place_of(e.mark, number), fmt::format("this is not YAML: {}", e.msg),
                         "write 'key: value', tables by indentation"});
  }
}

void IfoTree::set(std::string const& path, std::string const& text) {
  if (sources_.empty() || sources_.back() != "command line") sources_.push_back("command line");
  values_[path] = {text, {std::uint32_t(sources_.size() - 1), 0, 0}};
}

IfoTree::Value const* IfoTree::find(std::string const& path) {
  asked_.insert(path);
  auto const found = values_.find(path);
  return found == values_.end() ? nullptr : &found->second;
}

std::optional<std::size_t> IfoTree::source_of(std::string const& path) const {
  auto const found = values_.find(path);
  if (found == values_.end() || is_nan(found->second.text)) return std::nullopt;
  return found->second.place.file;
}

void IfoTree::drop(std::string const& path) { values_.erase(path); }

bool IfoTree::has(std::string const& path) const {
  auto const next = values_.lower_bound(path);
  return next != values_.end() &&
         (next->first == path || std::any_of(next, values_.end(), [&](auto const& v) { return below(v.first, path); }));
}

double IfoTree::number(std::string const& path, bool needed) {
  Value const* value = find(path);
  if (value && is_nan(value->text)) value = nullptr;
  if (!value) {
    if (needed) problem(path, fmt::format("'{}' is missing", path), "give a number in SI units");
    return not_a_number;
  }
  char* end = nullptr;
  double const x = std::strtod(value->text.c_str(), &end);
  if (end != value->text.c_str() + value->text.size() || value->text.empty() || !std::isfinite(x)) {
    problem(path, fmt::format("'{}' is a number, got \"{}\"", path, value->text),
            "write it in SI units, without a unit, for example 1.064e-6");
    return not_a_number;
  }
  if (std::string const wanted = out_of_range(path, x); !wanted.empty()) {
    problem(path, fmt::format("'{}' is {:g}, out of range", path, x), fmt::format("write a number {}", wanted));
    return not_a_number;
  }
  return x;
}

double IfoTree::number(std::string const& path, double fallback) {
  double const x = number(path, false);
  return std::isnan(x) ? fallback : x;
}

std::string IfoTree::word(std::string const& path, std::string const& fallback) {
  Value const* const value = find(path);
  return value ? value->text : fallback;
}

std::vector<std::string> IfoTree::elements(std::string const& list) const {
  std::vector<std::string> all;
  while (has(fmt::format("{}.{}", list, all.size()))) all.push_back(fmt::format("{}.{}", list, all.size()));
  return all;
}

void IfoTree::problem(std::string const& path, std::string what, std::string suggestion) {
  auto const found = values_.find(path);
  Place const place = found == values_.end() ? Place{std::uint32_t(sources_.size() - 1), 0, 0} : found->second.place;
  auto const said = [&](Problem const& p) {
    return p.what == what && p.place.file == place.file && p.place.line == place.line && p.place.column == place.column;
  };
  if (std::any_of(problems_.begin(), problems_.end(), said)) return;  // read more than once
  problems_.push_back({place, std::move(what), std::move(suggestion)});
}

void IfoTree::refuse_unread(std::size_t from_source) {
  std::vector<std::string> known(asked_.begin(), asked_.end());
  for (auto const& [path, value] : values_) {
    if (value.place.file < from_source || asked_.contains(path)) continue;
    std::string const near = nearest_word(path, known);
    problem(path, fmt::format("unknown key '{}'", path),
            near.empty() ? "see the keys in docs/reference/budget.md" : fmt::format("did you mean '{}'?", near));
  }
}

void IfoTree::throw_if_problems() {
  if (problems_.empty()) return;
  std::stable_sort(problems_.begin(), problems_.end(), [](Problem const& a, Problem const& b) {
    return std::tie(a.place.file, a.place.line, a.place.column) < std::tie(b.place.file, b.place.line, b.place.column);
  });
  std::string text;
  for (Problem const& p : problems_) text += placed_message(p, sources_.at(p.place.file)) + '\n';
  text += fmt::format("{} error{}. Nothing was run.", problems_.size(), problems_.size() == 1 ? "" : "s");
  throw InputError(problems_, text, sources_);
}

std::string IfoTree::yaml() const {
  YAML::Emitter out;
  write_yaml(out, values_, "");
  return out.c_str();
}

}  // namespace straytrace
