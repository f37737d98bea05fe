// SPDX-License-Identifier: BSD-3-Clause
#include "session/library_entries.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "base/files/read_write.hpp"
#include "base/input/document.hpp"
#include "base/text/json_text.hpp"
#include "scene/model_tree.hpp"
#include "scene/scene.hpp"
#include "world/build/read_parts.hpp"

namespace straytrace::session {

namespace {

constexpr std::string_view builtin_parts = "library/parts/builtin.yaml";

std::vector<std::string_view> text_lines(std::string_view text) {
  std::vector<std::string_view> lines;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t const end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

// The entry that begins on this line (from 1 on), up to the next thing indented as little.
std::string block(std::string_view text, std::uint32_t first) {
  std::vector<std::string_view> const lines = text_lines(text);
  auto const indent = [](std::string_view line) { return std::min(line.find_first_not_of(' '), line.size()); };
  std::string out(lines[first - 1]);
  std::string blank;
  for (std::size_t i = first; i < lines.size(); ++i) {
    if (lines[i].empty()) {
      blank += '\n';
      continue;
    }
    if (indent(lines[i]) <= indent(lines[first - 1])) break;
    out += '\n' + std::exchange(blank, {}) + std::string(lines[i]);
  }
  return out + '\n';
}

std::string flow(NodeData const& n) {
  if (n.kind == Node::Kind::scalar) return n.text;
  std::string out;
  for (NodeData::Entry const& e : n.entries)
    out += fmt::format("{}{} {}", out.empty() ? "" : ", ", e.key, flow(*e.value));
  for (auto const& e : n.elements) out += fmt::format("{}{}", out.empty() ? "" : " / ", flow(*e));
  return out;
}

std::string text_at(NodeData const& table, std::string_view key) {
  NodeData::Entry const* e = table.kind == Node::Kind::table ? table.find(key) : nullptr;
  return e ? flow(*e->value) : "";
}

void append(std::string& all, std::string const& more, std::string_view between = "; ") {
  if (more.empty()) return;
  all += (all.empty() ? "" : std::string(between)) + more;
}

std::string law_in_brief(NodeData const& law) {
  std::string keys;
  for (NodeData::Entry const& e : law.entries)
    if (e.key != "model") append(keys, e.key + " " + flow(*e.value), ", ");
  return fmt::format("{} ({})", text_at(law, "model"), keys);
}

std::string material_in_brief(NodeData const& m) {
  std::string value;
  if (NodeData::Entry const* preset = m.find("preset"); preset && preset->value->kind == Node::Kind::table) {
    for (auto const& [key, noun] : {std::pair("brdf", "BRDF"),
                                    {"tis", "TIS"},
                                    {"tis_at_75_deg", "TIS at 75 deg"},
                                    {"reflect", "R"},
                                    {"through", "through"}})
      if (preset->value->find(key)) append(value, fmt::format("{} {}", noun, text_at(*preset->value, key)), ", ");
    return value;
  }
  if (m.find("specular")) append(value, text_at(m, "specular"), ", ");
  if (NodeData::Entry const* scatter = m.find("scatter")) {
    if (scatter->value->kind == Node::Kind::table) append(value, law_in_brief(*scatter->value), ", ");
    for (auto const& law : scatter->value->elements) append(value, law_in_brief(*law), " + ");
  }
  if (m.find("bracket")) append(value, "bracket " + text_at(m, "bracket"), ", ");
  return value.empty() ? "absorbs all" : value;
}

// Parameters with their defaults; of a table {value, status, source} the value.
std::vector<std::pair<std::string, std::string>> numbers_of(NodeData const& about) {
  std::vector<std::pair<std::string, std::string>> all;
  if (NodeData::Entry const* params = about.find("params"))
    for (NodeData::Entry const& p : params->value->entries)
      all.emplace_back(p.key, p.value->kind == Node::Kind::scalar ? p.value->text : text_at(*p.value, "value"));
  return all;
}

std::string part_in_brief(LibraryEntry const& part) {
  std::string value;
  for (auto const& [name, number] : part.numbers) append(value, name + " " + number, ", ");
  return value;
}

LibraryEntry library_entry(std::string kind, NodeData::Entry const& e, EmbeddedFile const& file, std::uint32_t line) {
  NodeData const& about = *e.value;
  NodeData::Entry const* preset = about.find("preset");
  NodeData const& facts = preset && preset->value->kind == Node::Kind::table ? *preset->value : about;
  std::string const include = file.name == builtin_parts ? "" : std::string(file.name);
  LibraryEntry out{std::move(kind), e.key, include, "", "", "", "", "", block(file.text, line)};
  if (out.kind == "part") out.numbers = numbers_of(about);
  out.value = out.kind == "material" ? material_in_brief(about) : part_in_brief(out);
  out.wavelength = text_at(facts, "wavelength");
  out.status = text_at(facts, "status");
  out.source = text_at(facts, "source");
  out.note = text_at(facts, "note");
  return out;
}

// The first comment of a file without its signs.
std::string first_sentence(std::string_view text) {
  std::string out;
  for (std::string_view line : text_lines(text)) {
    if (!line.starts_with("# ")) break;
    append(out, std::string(line.substr(2)), " ");
  }
  return out.substr(0, out.find(". ") + (out.find(". ") == out.npos ? 0 : 1));
}

LibraryEntry detector_of(EmbeddedFile const& file, NodeData const& root) {
  LibraryEntry out{"detector",
                   std::filesystem::path(file.name).stem().string(),
                   std::string(file.name),
                   "",
                   "",
                   "",
                   "",
                   "",
                   std::string(file.text)};
  NodeData const& params = *root.find("params")->value;
  std::size_t assumed = 0;
  for (NodeData::Entry const& p : params.entries) assumed += text_at(*p.value, "status") == "assumed";
  auto const number = [&](char const* name) { return text_at(*params.find(name)->value, "value"); };
  out.value = fmt::format("L {}, {}, mirrors {}, tube {}, baffles {} (radii)", number("L"), number("arm_power"),
                          number("mirror_radius"), number("tube_radius"), number("rim"));
  out.wavelength = number("lambda");
  out.status = fmt::format("{} numbers, {} assumed", params.entries.size(), assumed);
  out.note = first_sentence(file.text);
  out.numbers = numbers_of(root);
  return out;
}

std::vector<LibraryEntry> media() {
  std::vector<LibraryEntry> all;
  for (KnownMedium const& m : known_media())
    all.push_back({"medium", m.name, "", fmt::format("n {:.5f}", m.index), fmt::format("{:.0f} nm", m.wavelength * 1e9),
                   "", m.source, "", fmt::format("media: {{NAME: {{preset: {}}}}}\n", m.name)});
  return all;
}

// The text of one file alone, and the line of it that is its first.
std::pair<std::string, std::uint32_t> alone(std::string_view text) {
  bool const whole = text.starts_with("straytrace:");
  std::string out = whole ? "" : "straytrace: 1\n";
  for (std::string_view line : text_lines(text))
    out += (line.starts_with("include:") ? "# " : "") + std::string(line) + '\n';
  return {out, whole ? 1 : 2};
}

void add_file(EmbeddedFile const& file, std::vector<LibraryEntry>& all) {
  bool const builtin = file.name == builtin_parts;
  auto const [text, first] = alone(builtin ? "" : file.text);
  FileTexts const texts{{"list", text}};
  Scene const scene = read_scene("list", {}, &texts);  // its problems are those of a file alone
  NodeData const& root = *scene.root().data();
  if (file.name.starts_with("library/detectors/")) return all.push_back(detector_of(file, root));
  for (auto const& [section, kind] : {std::pair("materials", "material"), {"parts", "part"}}) {
    NodeData::Entry const* table = root.find(section);
    if (!table) continue;
    for (NodeData::Entry const& e : table->value->entries)
      if ((e.place.file == root.place.file) != builtin)
        all.push_back(library_entry(kind, e, file, builtin ? e.place.line : e.place.line + 1 - first));
  }
}

}  // namespace

std::vector<LibraryEntry> library_entries() {
  std::vector<LibraryEntry> all = media();
  for (EmbeddedFile const& file : embedded_files())
    if (is_library(file.name)) {
      if (file.name.starts_with("library/arm"))
        all.push_back({"arm", std::filesystem::path(file.name).stem().string(), std::string(file.name), "", "", "", "",
                       first_sentence(file.text), std::string(file.text)});
      add_file(file, all);
    }
  static constexpr std::string_view order[] = {"detector", "arm", "material", "medium", "part"};
  auto const rank = [](LibraryEntry const& e) { return std::find(std::begin(order), std::end(order), e.kind); };
  std::stable_sort(all.begin(), all.end(), [&](auto const& a, auto const& b) { return rank(a) < rank(b); });
  return all;
}

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
  Json const whole = read_ordered_json(language_schema());
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
