// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "app/explain.hpp"
#include "app/library_list.hpp"

namespace straytrace {
namespace {

std::string fact(char const* name, std::string const& value) {
  return value.empty() ? "" : fmt::format("  {:<10} {}\n", name, value);
}

nlohmann::ordered_json about(LibraryEntry const& e) {
  return {{"of", fmt::format("the {} {} of the library", e.kind, e.name)},
          {"status", e.status},
          {"source", e.source},
          {"note", e.note},
          {"include", e.file}};
}

std::string where(LibraryEntry const& e) {
  return fact("status", e.status) + fact("source", e.source) + fact("note", e.note) +
         fact("include", e.file.empty() ? "none is needed" : e.file) +
         fmt::format("straytrace library {} prints it whole; see docs/reference/library.md\n", e.name);
}

Explanation of_number(LibraryEntry const& e, std::string const& name, std::string const& value) {
  Explanation a;
  a.json = about(e);
  a.json["key"] = e.name + "." + name;
  a.json["default"] = value;
  a.text = fmt::format("{}.{}: number of the {} {} of the library\n", e.name, name, e.kind, e.name) +
           fact("default", value) + where(e);
  return a;
}

Explanation of_entry(LibraryEntry const& e) {
  Explanation a;
  a.json = about(e);
  a.json["key"] = e.name;
  a.json["value"] = e.value;
  a.text = fmt::format("{}: {} of the library\n", e.name, e.kind);
  for (auto const& [name, value] : e.numbers) a.text += fmt::format("  {:<18} {}\n", name, value);
  a.text += (e.numbers.empty() ? fact("value", e.value) : "") + fact("wavelength", e.wavelength) + where(e);
  return a;
}

}  // namespace

std::optional<Explanation> explain_library(std::string const& what) {
  for (LibraryEntry const& e : library_entries()) {
    if (e.name == what) return of_entry(e);
    for (auto const& [name, value] : e.numbers)
      if (e.name + "." + name == what) return of_number(e, name, value);
  }
  return {};
}

std::string parts_like(std::string const& what) {
  std::string const word = what.substr(0, what.find('.'));
  if (word.size() < 3) return "";
  std::vector<std::string> parts;
  std::set<std::string> numbers;
  for (LibraryEntry const& e : library_entries()) {
    if (e.kind != "part" || e.name.find(word) == e.name.npos) continue;
    parts.push_back(e.name);
    for (auto const& [name, value] : e.numbers) numbers.insert(name);
  }
  if (parts.empty()) return "";
  return fmt::format("parts of this name: {}, with numbers {}; ", fmt::join(parts, ", "), fmt::join(numbers, ", "));
}

}  // namespace straytrace
