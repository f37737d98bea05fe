// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/merge.hpp"
#include "scene/model_tree.hpp"
#include "scene/resolved.hpp"

namespace straytrace {
namespace {

constexpr std::size_t comment_column = 44, longest_flow = 72;

bool has_tables(ModelValue const& v) {
  return v.kind == Node::Kind::table || std::any_of(v.children.begin(), v.children.end(), has_tables);
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
  // One line: the text, and behind it where it comes from.
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
    bool const single =
        std::none_of(v.children.begin(), v.children.end(), [](ModelValue const& c) { return c.given(); });
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

  // The first key stands behind the dash.
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
  for (ModelValue& section : model.children)  // what a material takes over stands in it already
    if (section.key == "materials")
      for (ModelValue& material : section.children)
        std::erase_if(material.children, [](ModelValue const& v) { return v.key == "like"; });
  auto const rank = [](ModelValue const& v) {
    return v.key == "title" ? 0 : v.key == "notes" ? 1 : v.key == "params" ? 2 : 3;
  };
  std::stable_sort(model.children.begin(), model.children.end(),
                   [&](auto const& a, auto const& b) { return rank(a) < rank(b); });
  printer.table(model, 0);
  return fmt::format("straytrace: {}\n", format_version) + printer.text();
}

}  // namespace straytrace
