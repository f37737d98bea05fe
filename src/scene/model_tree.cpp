// SPDX-License-Identifier: BSD-3-Clause
#include "scene/model_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/input/document.hpp"
#include "scene/parts.hpp"
#include "scene/scope.hpp"

namespace straytrace::scene {
namespace {

using Form = KeyRequest::Form;

bool is_number(Form f) {
  return f == Form::number || f == Form::whole || f == Form::amplitude || f == Form::quantity || f == Form::numbers;
}

class TreeReader {
 public:
  explicit TreeReader(Scene const& scene)
      : root_(scene.root()), files_(scene.files()), document_(dynamic_cast<SceneDocument const*>(root_.document())) {}

  ModelValue read(NodeData const& data, Scope const* scope, KeyRequest const& how) const {
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
      out.children.push_back(read(*e.value, scope, asked == data.asked.end() ? KeyRequest{} : asked->second));
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

  // Values of a part are evaluated where the part is placed: here names stay as written.
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
  static ModelValue absent(std::string const& key, KeyRequest const& how) {
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
    } catch (ExpressionProblem const&) {  // a word where a number is allowed too, or a parameter of a part
    }
  }

  // The name of a data file relative to the main file; other text unchanged.
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

namespace {

// One line in flow style.
std::string flow(NodeData const& n) {
  if (n.kind == Node::Kind::scalar) return yaml_text(n.text);
  std::string out;
  for (NodeData::Entry const& e : n.entries)
    out += fmt::format("{}{}: {}", out.empty() ? "" : ", ", yaml_text(e.key), flow(*e.value));
  for (auto const& e : n.elements) out += fmt::format("{}{}", out.empty() ? "" : ", ", flow(*e));
  if (n.kind == Node::Kind::list) return "[" + out + "]";
  return n.kind == Node::Kind::table ? "{" + out + "}" : "\"?\"";
}

std::string section(std::string const& key, NodeData const& n) {
  std::string out = yaml_text(key) + ":";
  if (n.kind == Node::Kind::scalar || (n.entries.empty() && n.elements.empty()))
    return fmt::format("{} {}\n", out, flow(n));
  out += '\n';
  for (NodeData::Entry const& e : n.entries) out += fmt::format("  {}: {}\n", yaml_text(e.key), flow(*e.value));
  for (auto const& e : n.elements) out += fmt::format("  - {}\n", flow(*e));
  return out;
}

std::string instance_line(Scene::Instance const& i, Scope const* model) {
  std::string out = fmt::format("  - {{name: {}, group: {}", yaml_text(i.name), yaml_text(i.group));
  if (i.repeat_axis >= 0) out += fmt::format(", {}: {} m", axes[static_cast<std::size_t>(i.repeat_axis)], i.offset);
  Scope const* own = i.node.scope().get();
  if (own && own != model)
    for (auto const& [name, value] : own->own) out += fmt::format(", {}: {}", name, si_text(value));
  return out + "}\n";
}

}  // namespace

std::string yaml_text(std::string const& text) {
  constexpr std::string_view not_first = "-?:,[]{}#&*!|>'\"%@`~=<. ", nowhere = ":#,[]{}\"'";
  bool const control = std::ranges::any_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x20; });
  bool const special = text.empty() || control || not_first.find(text.front()) != std::string_view::npos ||
                       text.back() == ' ' || text.find_first_of(nowhere) != std::string::npos || text == "null" ||
                       text == "Null" || text == "NULL";
  if (!special) return text;
  std::string out = "\"";
  for (char const c : text) {
    if (static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\x{:02x}", static_cast<unsigned>(c));
    else if (c == '"' || c == '\\')
      out += {'\\', c};
    else
      out += c;
  }
  return out + '"';
}

std::string si_text(std::optional<Value> const& value) {
  if (!value) return "\"?\"";
  Quantity const& q = value->quantity;
  std::string text = with_unit(fmt::format("{}", q.si), dim::plain);
  if (q.dimension == dim::angle)
    text += " rad";  // the example unit of angles is not the SI unit
  else
    text = with_unit(text, q.dimension);
  switch (q.amplitude) {
    case Amplitude::peak:
      return text + " peak";
    case Amplitude::peak_to_peak:
      return text + " pp";
    case Amplitude::rms:
      return text + " rms";
    case Amplitude::none:
      break;
  }
  return text;
}

std::string resolved_text(Node const& root, std::vector<Scene::Instance> const& instances) {
  Scope const* model = root.scope().get();
  std::string out = "straytrace: 1\n";
  if (!root.data()) return out;
  std::vector<NodeData::Entry> entries = root.data()->entries;
  auto const rank = [](NodeData::Entry const& e) {
    return e.key == "title" ? 0 : e.key == "notes" ? 1 : e.key == "params" ? 2 : 3;
  };
  std::ranges::stable_sort(entries, [&](auto const& a, auto const& b) { return rank(a) < rank(b); });
  for (NodeData::Entry const& e : entries) {
    if (e.key != "params") {
      NodeData own = *e.value;
      if (e.key == "parts")
        std::erase_if(own.entries,
                      [&](auto const& part) { return part.place.file == builtin_source(root.place().file); });
      if (e.key != "parts" || !own.entries.empty()) out += section(e.key, own);
      continue;
    }
    out += "params:\n";
    for (NodeData::Entry const& p : e.value->entries)
      out += fmt::format("  {}: {}\n", yaml_text(p.key), si_text(find_parameter(model, p.key).value));
  }
  if (!instances.empty()) out += "instances:\n";
  for (Scene::Instance const& i : instances) out += instance_line(i, model);
  return out;
}

namespace {

constexpr std::size_t comment_column = 44, longest_flow = 72;

bool has_tables(ModelValue const& v) {
  return v.kind == Node::Kind::table || std::ranges::any_of(v.children, has_tables);
}

std::string flow(ModelValue const& v) {
  if (v.kind == Node::Kind::scalar) return v.quantity ? v.value : yaml_text(v.value);
  std::string out;
  for (ModelValue const& c : v.children) {
    if (!c.given()) continue;
    out += (out.empty() ? "" : ", ") + (v.kind == Node::Kind::table ? yaml_text(c.key) + ": " : "") + flow(c);
  }
  return v.kind == Node::Kind::table ? "{" + out + "}" : "[" + out + "]";
}

class Printer {
 public:
  void table(ModelValue const& v, std::size_t depth) {
    for (ModelValue const& c : v.children) entry(c, depth, "");
  }
  std::string const& text() const { return text_; }

 private:
  // One line: the text, followed by its origin.
  void line(std::size_t depth, std::string_view lead, std::string text, std::string const& comment) {
    text = std::string(2 * depth, ' ') + std::string(lead) + text;
    if (!comment.empty()) text = fmt::format("{:<{}}  # {}", text, comment_column, comment);
    text_ += text + "\n";
  }

  static std::string comment(ModelValue const& v) {
    return v.written.empty() || v.written == v.value ? v.origin : v.origin + ", " + v.written;
  }

  void entry(ModelValue const& v, std::size_t depth, std::string_view lead) {
    std::string const key = yaml_text(v.key) + ":";
    if (!v.given()) {
      if (!v.value.empty()) line(depth, lead, fmt::format("# {} {}", key, v.value), "default");
      return;
    }
    bool const single = std::ranges::none_of(v.children, [](ModelValue const& c) { return c.given(); });
    if (single || (!has_tables(v) && flow(v).size() < longest_flow))
      return line(depth, lead, key + " " + flow(v), comment(v));
    line(depth, lead, key, v.origin);
    if (v.kind == Node::Kind::list)
      elements(v, depth + 1);
    else
      table(v, depth + 1);
  }

  void elements(ModelValue const& v, std::size_t depth) {
    for (ModelValue const& c : v.children) {
      bool const block = c.kind == Node::Kind::table && !c.children.empty() && c.children.front().given();
      if (!block) {
        line(depth, "- ", flow(c), comment(c));
        continue;
      }
      entry_of_list(c, depth);
    }
  }

  // The first key follows the dash.
  void entry_of_list(ModelValue const& c, std::size_t depth) {
    std::size_t const begin = text_.size();
    for (ModelValue const& child : c.children) entry(child, depth + 1, "");
    text_[begin + 2 * depth] = '-';
  }

  std::string text_;
};

}  // namespace

std::string printed_model(Scene const& scene) {
  Printer printer;
  ModelValue model = model_tree(scene);
  for (ModelValue& section : model.children)  // they already contain their copied entries
    if (section.key == "materials")
      for (ModelValue& material : section.children)
        std::erase_if(material.children, [](ModelValue const& v) { return v.key == "like"; });
  auto const rank = [](ModelValue const& v) {
    return v.key == "title" ? 0 : v.key == "notes" ? 1 : v.key == "params" ? 2 : 3;
  };
  std::ranges::stable_sort(model.children, [&](auto const& a, auto const& b) { return rank(a) < rank(b); });
  printer.table(model, 0);
  return fmt::format("straytrace: {}\n", format_version) + printer.text();
}

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
