// SPDX-License-Identifier: BSD-3-Clause
#include "scene/scope.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "base/input/table.hpp"
#include "scene/scene_document.hpp"

namespace straytrace::scene {
namespace {

constexpr std::size_t longest_chain =
    50;  // parameters used before they are written, each in the next: bounds recursion

class ScopeBuilder {
 public:
  ScopeBuilder(SceneDocument& document, NodeData const* params, std::shared_ptr<Scope const> outer,
               GivenParameters const* given)
      : document_(document), params_(params), scope_(std::make_shared<Scope>()), given_(given) {
    scope_->outer = std::move(outer);
  }

  // Values that are written as text and may refer to the parameters of this scope.
  void replace(std::string const& name, NodeData const* node) {
    replaced_[name] = node;
    scope_->origins[name] = fmt::format("-p {}={}", name, shortened(node->text));
  }

  std::shared_ptr<Scope const> build() {
    if (params_)
      for (NodeData::Entry const& e : params_->entries)
        if (name_allowed(e)) value_of(e);
    return scope_;
  }

 private:
  bool name_allowed(NodeData::Entry const& e) {
    e.value->known = true;
    bool const reserved = is_reserved_word(e.key);
    if (!reserved && is_parameter_name(e.key)) return true;
    std::string const what = reserved ? fmt::format("'{}' is a unit or a function and cannot name a parameter", e.key)
                                      : fmt::format("'{}' cannot name a parameter", shortened(e.key));
    document_.add({e.place, what,
                   reserved ? fmt::format("choose another name, for example '{}_0'", e.key)
                            : "use letters, digits and '_', beginning with a letter",
                   Severity::error, e.width});
    scope_->own[e.key] = std::nullopt;
    return false;
  }

  std::optional<Value> value_of(NodeData::Entry const& e) {
    if (auto const done = scope_->own.find(e.key); done != scope_->own.end()) return done->second;
    if (std::ranges::find(chain_, e.key) != chain_.end() || chain_.size() >= longest_chain) {
      refuse_chain(e);
      return {};
    }
    chain_.push_back(e.key);
    bool const table = e.value->kind == Node::Kind::table && e.value->find("value");
    std::optional<Value> value = table ? sourced(e.value) : written(*e.value);
    if (auto const hit = replaced_.find(e.key); hit != replaced_.end())
      value = agreeing(value, written(*hit->second), hit->second);
    if (given_)
      if (auto const hit = given_->find(e.key); hit != given_->end()) {
        value = agreeing(value, hit->second.value, hit->second.node);
        scope_->origins[e.key] = hit->second.from;
      }
    chain_.pop_back();
    return scope_->own.emplace(e.key, value).first->second;
  }

  std::optional<Value> written(NodeData const& node) {
    if (node.kind == Node::Kind::none) return {};
    if (node.kind != Node::Kind::scalar) {
      document_.add({node.place, fmt::format("parameter '{}' must be one quantity", node.label),
                     "write a number with a unit, for example '80 cm', or {value: 80 cm, status: assumed}"});
      return {};
    }
    return document_.evaluate(node, {[this](std::string_view name) { return find(name); }, [this] { return names(); }});
  }

  // A quantity with where it is from: {value: 10 m, status: assumed, source: TEXT}.
  std::optional<Value> sourced(std::shared_ptr<NodeData> const& data) {
    Node const table(data, nullptr, &document_);
    for (char const* key : {"value", "source"}) table.has(key);
    read_status(table);
    table.refuse_unknown(fmt::format("parameter '{}'", data->label));
    NodeData const& value = *data->find("value")->value;
    return value.kind == Node::Kind::table ? std::nullopt : written(value);
  }

  // A given value must have the dimension of the written one; a bare 0 adopts it.
  std::optional<Value> agreeing(std::optional<Value> const& written, std::optional<Value> given, NodeData const* node) {
    if (!written || !given || written->bare_zero) return given;
    if (given->bare_zero) given->quantity.dimension = written->quantity.dimension;
    if (given->quantity.dimension == written->quantity.dimension) return given;
    if (node) document_.add(dimension_problem(*node, given->quantity, written->quantity.dimension));
    return {};
  }

  void refuse_chain(NodeData::Entry const& e) {
    if (chain_.size() >= longest_chain) {
      document_.add({e.place, fmt::format("more than {} parameters depend on each other in a row", longest_chain),
                     "write some of them as numbers", Severity::error, e.width});
      return;
    }
    std::string circle;
    for (auto it = std::ranges::find(chain_, e.key); it != chain_.end(); ++it) circle += *it + " -> ";
    document_.add({e.place, fmt::format("parameter '{}' depends on itself ({})", e.key, shortened(circle + e.key)),
                   "write one of them as a number", Severity::error, e.width});
  }

  ParameterLookup::Found find(std::string_view name) {
    NodeData::Entry const* own = params_ ? params_->find(name) : nullptr;
    if (own && is_parameter_name(name) && !is_reserved_word(name)) return {true, value_of(*own)};
    return find_parameter(scope_->outer.get(), name);
  }

  std::vector<std::string> names() const {
    std::vector<std::string> out = parameter_names(scope_->outer.get());
    if (params_)
      for (NodeData::Entry const& e : params_->entries) out.push_back(e.key);
    return out;
  }

  SceneDocument& document_;
  NodeData const* params_;
  std::shared_ptr<Scope> scope_;
  GivenParameters const* given_;
  std::map<std::string, NodeData const*> replaced_;
  std::vector<std::string> chain_;  // being evaluated
};

}  // namespace

ParameterLookup::Found find_parameter(Scope const* scope, std::string_view name) {
  for (; scope; scope = scope->outer.get())
    if (auto const hit = scope->own.find(name); hit != scope->own.end()) return {true, hit->second};
  return {};
}

std::vector<std::string> parameter_names(Scope const* scope) {
  std::vector<std::string> out;
  for (; scope; scope = scope->outer.get())
    for (auto const& [name, value] : scope->own) out.push_back(name);
  return out;
}

std::shared_ptr<Scope const> make_scope(SceneDocument& document, NodeData const* params,
                                        std::shared_ptr<Scope const> outer, GivenParameters const& given) {
  return ScopeBuilder(document, params, std::move(outer), &given).build();
}

namespace {

std::string settable(std::vector<std::string> const& names) {
  constexpr std::size_t most = 20;
  if (names.empty()) return "only names under the top-level 'params' can be set, and there are none";
  std::string list;
  for (std::size_t i = 0; i < std::min(most, names.size()); ++i) list += (i > 0 ? ", " : "") + names[i];
  return fmt::format("there are {}{}", list,
                     names.size() > most ? fmt::format(" and {} more", names.size() - most) : "");
}

}  // namespace

std::shared_ptr<Scope const> make_model_scope(SceneDocument& document, NodeData const* params,
                                              std::vector<std::string> const& overrides) {
  ScopeBuilder builder(document, params, nullptr, nullptr);
  std::vector<std::string> names;
  if (params)
    for (NodeData::Entry const& e : params->entries) names.push_back(e.key);
  std::vector<std::shared_ptr<NodeData>> texts;
  for (std::uint32_t i = 0; i < overrides.size(); ++i) {
    std::string const& o = overrides[i];
    if (names_place(o)) continue;
    std::size_t const equals = o.find('=');
    std::string const name = o.substr(0, equals);
    Place place{document.command_line(), i + 1, 4};  // behind "-p "
    if (equals == std::string::npos || equals == 0 || equals + 1 == o.size()) {
      document.add({place, fmt::format("'{}' does not set a parameter", shortened(o)),
                    "write 'name=value', for example 'aperture=60cm', or a place in the model, "
                    "'materials.steel.scatter.brdf=5e-3/sr'",
                    Severity::error, code_points(o)});
      continue;
    }
    if (!params || !params->find(name)) {
      document.add({place, fmt::format("parameter '{}' is not defined in the model", shortened(name)),
                    did_you_mean(name, names, settable(names)), Severity::error, code_points(name)});
      continue;
    }
    auto text = std::make_shared<NodeData>();
    place.column += code_points(name) + 1;
    text->kind = Node::Kind::scalar;
    text->place = place;
    text->text = o.substr(equals + 1);
    text->width = code_points(text->text);
    text->label = name;
    text->inset = 0;
    builder.replace(name, text.get());
    texts.push_back(std::move(text));
  }
  return builder.build();
}

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
