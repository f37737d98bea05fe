// SPDX-License-Identifier: BSD-3-Clause
#include "scene/set_values.hpp"

#include <fmt/format.h>

#include <charconv>

namespace straytrace::scene {
namespace {

std::string name_of(NodeData const& element) {
  NodeData::Entry const* name = element.kind == Node::Kind::table ? element.find("name") : nullptr;
  return name ? name->value->text : "";
}

std::shared_ptr<NodeData>* element_of(NodeData& list, std::string const& key) {
  for (auto& element : list.elements)
    if (name_of(*element) == key) return &element;
  std::size_t number = 0;
  auto const [end, error] = std::from_chars(key.data(), key.data() + key.size(), number);
  bool const whole = error == std::errc{} && end == key.data() + key.size();
  return whole && number < list.elements.size() ? &list.elements[number] : nullptr;
}

std::vector<std::string> names_in(NodeData const& data) {
  std::vector<std::string> names;
  for (NodeData::Entry const& e : data.entries) names.push_back(e.key);
  for (std::size_t i = 0; i < data.elements.size(); ++i) {
    std::string const name = name_of(*data.elements[i]);
    names.push_back(name.empty() ? fmt::format("{}", i) : name);
  }
  return names;
}

std::shared_ptr<NodeData> scalar_of(std::string const& text, Place at) {
  auto out = std::make_shared<NodeData>();
  out->kind = Node::Kind::scalar;
  out->place = at;
  out->text = text;
  out->width = code_points(text);
  out->inset = 0;
  return out;
}

class Setter {
 public:
  // `at`: of the text `place`.
  Setter(SceneDocument& document, std::string place, Place at, std::shared_ptr<NodeData> value)
      : document_(document), place_(std::move(place)), at_(at), value_(std::move(value)) {}

  void set(NodeData& model) const {
    std::vector<std::string> const keys = keys_of_place(place_);
    NodeData* data = &model;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      bool const last = i + 1 == keys.size();
      std::shared_ptr<NodeData>* const value = child(*data, keys[i]);
      if (!value && last && data->kind == Node::Kind::table && data != &model) {
        data->add({keys[i], at_, code_points(place_), labelled(keys[i])});
        return;
      }
      if (!value) return refuse(keys, i, *data);
      if (last) return replace(*value, keys[i]);
      data = value->get();
    }
  }

 private:
  static std::shared_ptr<NodeData>* child(NodeData& data, std::string const& key) {
    if (data.kind == Node::Kind::list) return element_of(data, key);
    auto const hit = data.index.find(key);
    return hit == data.index.end() ? nullptr : &data.entries[hit->second].value;
  }
  void replace(std::shared_ptr<NodeData>& value, std::string const& key) const {
    if (value->kind == Node::Kind::table || value->kind == Node::Kind::list)
      return problem(fmt::format("'{}' is a {}, not a value", shortened(place_),
                                 value->kind == Node::Kind::table ? "table" : "list"),
                     fmt::format("set one of its values, for example {}.{}", shortened(place_),
                                 names_in(*value).empty() ? "KEY" : names_in(*value).front()));
    value = labelled(key);
  }
  std::shared_ptr<NodeData> labelled(std::string const& key) const {
    auto out = std::make_shared<NodeData>(*value_);
    out->label = key;
    return out;
  }
  void refuse(std::vector<std::string> const& keys, std::size_t i, NodeData const& data) const {
    std::vector<std::string> const known = names_in(data);
    std::string list;
    for (std::size_t k = 0; k < known.size() && k < 20; ++k) list += (k > 0 ? ", " : "there are ") + known[k];
    std::string const where = i == 0 ? "the model" : fmt::format("'{}'", keys[i - 1]);
    problem(fmt::format("{} has no '{}'", where, shortened(keys[i])),
            did_you_mean(keys[i], known, list.empty() ? "it is a single value" : list));
  }
  void problem(std::string what, std::string suggestion) const {
    document_.add({at_, std::move(what), std::move(suggestion), Severity::error, code_points(place_)});
  }

  SceneDocument& document_;
  std::string place_;
  Place at_;
  std::shared_ptr<NodeData> value_;
};

void set_by_table(SceneDocument& document, NodeData& model) {
  NodeData::Entry const* const table = model.find("set");
  if (!table) return;
  for (NodeData::Entry const& e : table->value->entries) {
    if (e.value->kind != Node::Kind::scalar)
      document.add({e.place, fmt::format("'{}' is not set to a single value", shortened(e.key)),
                    "write 'set: {materials.steel.scatter.brdf: 5e-3 /sr}'", Severity::error, e.width});
    else if (keys_of_place(e.key).size() < 2)
      document.add({e.place, fmt::format("'{}' is not the place of a value", shortened(e.key)),
                    "write its keys with dots, 'materials.steel.scatter.brdf'; parameters are set under 'params' with "
                    "'override: true'",
                    Severity::error, e.width});
    else
      Setter(document, e.key, e.place, e.value).set(model);
  }
}

}  // namespace

std::vector<std::string> keys_of_place(std::string_view place) {
  std::vector<std::string> keys;
  for (std::size_t from = 0; from <= place.size();) {
    std::size_t const to = std::min(place.find_first_of(".[", from), place.size());
    std::string_view key = place.substr(from, to - from);
    if (key.ends_with(']')) key.remove_suffix(1);
    keys.emplace_back(key);
    from = to + 1;
  }
  return keys;
}

bool names_place(std::string const& text) {
  std::size_t const equals = text.find('='), point = text.find_first_of(".[");
  return equals != text.npos && equals + 1 < text.size() && point != 0 && point < equals;
}

void set_values(SceneDocument& document, NodeData& model, std::vector<std::string> const& overrides) {
  set_by_table(document, model);
  for (std::uint32_t i = 0; i < overrides.size(); ++i) {
    if (!names_place(overrides[i])) continue;
    std::size_t const equals = overrides[i].find('=');
    std::string const place = overrides[i].substr(0, equals);
    Place const at{document.command_line(), i + 1, 4};  // behind "-p "
    Place const behind{at.file, at.line, at.column + code_points(place) + 1};
    Setter(document, place, at, scalar_of(overrides[i].substr(equals + 1), behind)).set(model);
  }
}

}  // namespace straytrace::scene
