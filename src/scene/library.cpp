// SPDX-License-Identifier: BSD-3-Clause
#include "scene/library.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/input/document.hpp"

namespace straytrace::scene {
namespace {

constexpr std::array<std::string_view, 4> prunable{"materials", "media", "parts", "bodies"};

using Words = std::set<std::string, std::less<>>;

// Entries named by `like` and `preset` are already copied and not needed themselves.
void add_words(NodeData const& data, Words& words) {
  if (data.kind == Node::Kind::scalar) words.insert(data.text);
  for (NodeData::Entry const& e : data.entries)
    if (e.key != "like" && e.key != "preset") add_words(*e.value, words);
  for (auto const& e : data.elements) add_words(*e, words);
}

// Calls f(key, text) for every scalar under a key, in lists too.
template <class F>
void each_scalar(NodeData const& data, std::string_view key, F const& f) {
  if (data.kind == Node::Kind::scalar) f(key, data);
  for (NodeData::Entry const& e : data.entries) each_scalar(*e.value, key == "surfaces" ? key : e.key, f);
  for (auto const& e : data.elements) each_scalar(*e, key, f);
}

bool is_named(NodeData const& model, std::string_view section, std::string const& name) {
  NodeData::Entry const* e = model.find(section);
  return e && e->value->find(name);
}

// A mesh names materials in its own file; an error about a missing name lists all available names.
bool keeps_materials_and_parts(NodeData const& model) {
  bool keep = false;
  for (char const* place : {"scene", "parts"})
    if (NodeData::Entry const* e = model.find(place))
      each_scalar(*e->value, "", [&](std::string_view key, NodeData const& scalar) {
        keep = keep || key == "file" || (key == "use" && !is_named(model, "parts", scalar.text)) ||
               ((key == "material" || key == "surfaces") && !is_named(model, "materials", scalar.text));
      });
  return keep;
}

// Letters, digits and '_': the names of parameters in expressions.
void add_identifiers(std::string const& text, Words& words) {
  std::string word;
  for (char const c : text + ' ')
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '_')
      word += c;
    else if (!word.empty())
      words.insert(std::exchange(word, {}));
}

}  // namespace

void drop_unused(SceneDocument const& document, NodeData& model) {
  bool const keeps_them = keeps_materials_and_parts(model);
  auto const may_go = [&](std::string const& section) {
    if (section == "bodies") return model.find("scene") != nullptr;  // in a file of motion nothing else names them
    return !keeps_them && std::ranges::find(prunable, section) != prunable.end();
  };
  auto const shipped = [&](NodeData::Entry const& e) { return is_library(document.source(e.place.file).name); };
  Words words;
  std::vector<NodeData::Entry const*> waiting;
  for (NodeData::Entry const& section : model.entries) {
    bool const part_of_it = may_go(section.key);
    if (!part_of_it) add_words(*section.value, words);
    for (NodeData::Entry const& e : section.value->entries) {
      if (!part_of_it) break;
      if (shipped(e))
        waiting.push_back(&e);
      else
        add_words(*e.value, words);
    }
  }
  for (bool more = true; more;) {
    auto const named =
        std::partition(waiting.begin(), waiting.end(), [&](auto const* e) { return !words.contains(e->key); });
    more = named != waiting.end();
    for (auto it = named; it != waiting.end(); ++it) add_words(*(*it)->value, words);
    waiting.erase(named, waiting.end());
  }
  std::set<NodeData const*> unused;
  for (auto const* e : waiting) unused.insert(e->value.get());
  for (std::string_view key : prunable) {
    NodeData::Entry const* section = model.find(key);
    if (!section) continue;
    std::vector<NodeData::Entry> const all = std::exchange(section->value->entries, {});
    section->value->index.clear();
    for (NodeData::Entry const& e : all)
      if (!unused.contains(e.value.get())) section->value->add(e);
  }
}

std::vector<std::string> assumed_parameters(Scene const& scene) {
  std::vector<std::string> lines;
  NodeData::Entry const* params = scene.root().data() ? scene.root().data()->find("params") : nullptr;
  if (!params) return lines;
  Words words;
  each_scalar(*scene.root().data(), "", [&](std::string_view, NodeData const& s) { add_identifiers(s.text, words); });
  auto const text = [](NodeData const& table, char const* key) {
    NodeData::Entry const* e = table.find(key);
    return e ? e->value->text : std::string();
  };
  for (NodeData::Entry const& p : params->value->entries) {
    bool const set =
        std::ranges::any_of(scene.overrides(), [&](std::string const& o) { return o.starts_with(p.key + "="); });
    if (set || text(*p.value, "status") != "assumed" || !words.contains(p.key)) continue;
    std::string const source = text(*p.value, "source");
    lines.push_back(fmt::format("parameter {} = {}: assumed{}{}", p.key, text(*p.value, "value"),
                                source.empty() ? "" : "; ", source));
  }
  return lines;
}

}  // namespace straytrace::scene
