// SPDX-License-Identifier: BSD-3-Clause
#include "session/language.hpp"

#include "base/files/embedded.hpp"

namespace straytrace::session {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view part_entry = "scene entry with part ";

void add_keys(Json const& whole, Json const& table, std::string const& name, std::vector<LanguageKey>& into) {
  std::string const about = table.value("description", name);
  for (auto const& [key, value] : table.at("properties").items()) {
    bool const refers = value.contains("$ref") && !value.contains("x-straytrace");
    Json const& schema = refers ? whole.at(Json::json_pointer(value["$ref"].get<std::string>().substr(1))) : value;
    if (schema.contains("x-straytrace")) into.push_back({name, about, key, schema});
  }
}

std::vector<LanguageKey> read_keys_of_schema() {
  Json const whole = Json::parse(language_schema());
  std::vector<LanguageKey> all;
  add_keys(whole, whole, "model", all);
  for (auto const& [context, table] : whole.at("$defs").items()) {
    if (!table.contains("properties")) continue;
    if (context.starts_with(part_entry))
      add_keys(whole, table, context.substr(part_entry.size()), all);
    else if (table.contains("title"))
      add_keys(whole, table, table["title"], all);
  }
  return all;
}

}  // namespace

std::string LanguageKey::text() const {
  std::string const whole = schema.value("description", "");
  return whole.substr(0, whole.find("\n\n"));
}

std::string LanguageKey::fact(std::string const& name) const { return schema.at("x-straytrace").value(name, ""); }

std::vector<LanguageKey> const& language_keys() {
  static std::vector<LanguageKey> const all = read_keys_of_schema();
  return all;
}

std::string_view language_schema() { return embedded_file("schema/straytrace-1.schema.json"); }

}  // namespace straytrace::session
