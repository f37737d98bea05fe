// SPDX-License-Identifier: BSD-3-Clause
#include "scene/model_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/merge.hpp"
#include "scene/parts.hpp"
#include "scene/resolved.hpp"
#include "scene/scope.hpp"

namespace straytrace {
namespace {

using Form = Asked::Form;

bool is_number(Form f) {
  return f == Form::number || f == Form::whole || f == Form::amplitude || f == Form::quantity || f == Form::numbers;
}

class TreeReader {
 public:
  explicit TreeReader(Scene const& scene)
      : root_(scene.root()), files_(scene.files()), document_(dynamic_cast<SceneDocument const*>(root_.document())) {}

  ModelValue read(NodeData const& data, Scope const* scope, Asked const& how) const {
    ModelValue out;
    out.kind = data.kind;
    out.how = how.form == Form::named ? data.read : how;
    out.by_key = how.form != Form::named;
    out.role = data.role;
    out.listed = data.listed;
    out.origin = origin(data.place);
    if (data.kind == Node::Kind::scalar) scalar(data, scope, out);
    if (data.kind == Node::Kind::scalar && !out.quantity) out.value = as_of_main_file(out.value, data.place);
    for (NodeData::Entry const& e : data.entries) {
      auto const asked = data.asked.find(e.key);
      out.children.push_back(read(*e.value, scope, asked == data.asked.end() ? Asked{} : asked->second));
      out.children.back().key = e.key;
    }
    for (auto const& [key, asked] : data.asked)
      if (!data.find(key)) out.children.push_back(absent(key, asked));
    for (auto const& element : data.elements) out.children.push_back(read(*element, scope, {}));
    return out;
  }

  ModelValue parameters(NodeData const& data) const {
    Scope const* scope = root_.scope().get();
    ModelValue out = read(data, scope, {});
    for (ModelValue& child : out.children) {
      auto const found = find_parameter(scope, child.key).value;
      if (!found) continue;
      child.quantity = found->quantity;
      if (std::string const si = si_text(found); si != child.value) child.value = si;
    }
    return out;
  }

  ModelValue model() const {
    NodeData const& data = *root_.data();
    ModelValue out = read(data, root_.scope().get(), {});
    out.role = "a model";
    for (ModelValue& child : out.children) {
      if (!child.given()) continue;
      if (child.key == "params") child.children = parameters(*data.find("params")->value).children;
      if (child.key == "parts") child = parts(*data.find("parts")->value);
      if (child.key == "scene") entries(*data.find("scene")->value, child);
    }
    return out;
  }

  // What is written in a part is evaluated where the part is placed: here names stay as they are.
  ModelValue parts(NodeData const& data) const {
    NodeData own = data;
    own.entries.clear();
    own.index.clear();
    std::uint32_t const builtin = builtin_source(root_.place().file);
    for (NodeData::Entry const& e : data.entries)
      if (e.place.file == builtin)
        own.asked.erase(e.key);
      else
        own.add(e);
    ModelValue out = read(own, nullptr, {});
    out.key = "parts";
    if (out.children.empty()) out.kind = Node::Kind::none;
    return out;
  }

  // Keys of an entry that are parameters of its part.
  void entries(NodeData const& data, ModelValue& scene) const {
    for (std::size_t i = 0; i < data.elements.size() && i < scene.children.size(); ++i)
      for (ModelValue& child : scene.children[i].children) {
        if (is_entry_key(child.key) || child.kind != Node::Kind::scalar || child.how.form != Form::named) continue;
        child.how.form = Form::quantity;
        scalar(*data.elements[i]->find(child.key)->value, root_.scope().get(), child);
      }
  }

  std::string origin(Place place) const {
    if (!document_ || place.line == 0) return "";
    return fmt::format("{}:{}", document_->source(place.file).name, place.line);
  }

 private:
  static ModelValue absent(std::string const& key, Asked const& how) {
    ModelValue out;
    out.key = key;
    out.how = how;
    out.by_key = true;
    if (is_number(how.form) && !std::isnan(how.fallback)) {
      out.quantity = Quantity{how.fallback, how.dimension, Amplitude::none};
      out.value = si_text(Value{*out.quantity});
    } else {
      out.value = how.word;
    }
    return out;
  }

  static void scalar(NodeData const& data, Scope const* scope, ModelValue& out) {
    out.value = out.written = data.text;
    if (!is_number(out.how.form)) return;
    try {
      auto const value = evaluate_expression(
          data.text, {[&](auto name) { return find_parameter(scope, name); }, [&] { return parameter_names(scope); }});
      if (!value) return;
      out.quantity = value->quantity;
      if (value->bare_zero) out.quantity->dimension = out.how.dimension;
      out.value = si_text(Value{*out.quantity});
    } catch (ExpressionProblem const&) {  // a word where a number may stand too, or a parameter of a part
    }
  }

  // The name of a data file as the main file would write it; other text as it stands.
  std::string as_of_main_file(std::string const& text, Place place) const {
    if (!document_ || text.empty()) return text;
    auto const folder = std::filesystem::path(document_->source(place.file).name).parent_path();
    std::string const name = (folder / text).lexically_normal().generic_string();
    return !folder.empty() && files_.contains(name) ? name : text;
  }

  Node root_;
  FileTexts const& files_;
  SceneDocument const* document_;
};

}  // namespace

ModelValue const* ModelValue::find(std::string_view wanted) const {
  for (ModelValue const& child : children)
    if (child.key == wanted) return &child;
  return nullptr;
}

ModelValue model_tree(Scene const& scene) { return TreeReader(scene).model(); }

std::vector<PlacedValue> placed_values(Scene const& scene) {
  TreeReader const reader(scene);
  auto const read = [&](Node const& n) {
    return n.data() ? reader.read(*n.data(), n.scope().get(), {}) : ModelValue{};
  };
  std::vector<PlacedValue> out;
  for (Scene::Instance const& i : scene.instances()) {
    PlacedValue v{i.group, i.name, read(i.node), read(i.placement), {}, i.offset, i.repeat_axis};
    for (Node const& frame : i.frames) v.frames.push_back(read(frame));
    out.push_back(std::move(v));
  }
  return out;
}

}  // namespace straytrace
