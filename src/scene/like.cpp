// SPDX-License-Identifier: BSD-3-Clause
#include "scene/like.hpp"

#include <fmt/format.h>

#include "base/document.hpp"

namespace straytrace {
namespace {

// The laws of both, as one list.
std::shared_ptr<NodeData> joined(std::shared_ptr<NodeData> const& first, std::shared_ptr<NodeData> const& second) {
  auto all = std::make_shared<NodeData>(*second);
  all->kind = Node::Kind::list;
  all->entries.clear();
  all->index.clear();
  all->elements.clear();
  for (auto const& laws : {first, second}) {
    if (laws->kind == Node::Kind::list)
      all->elements.insert(all->elements.end(), laws->elements.begin(), laws->elements.end());
    else
      all->elements.push_back(laws);
  }
  return all;
}

void take_over(NodeData const& from, NodeData& into) {
  for (NodeData::Entry const& e : from.entries) {
    if (e.key == "override") continue;
    auto const own = into.index.find(e.key);
    if (own == into.index.end())
      into.add(e);
    else if (e.key == "scatter")
      into.entries[own->second].value = joined(e.value, into.entries[own->second].value);
  }
}

}  // namespace

void take_over_materials(SceneDocument& document, NodeData& model) {
  NodeData::Entry const* section = model.find("materials");
  if (!section || section->value->kind != Node::Kind::table) return;
  NodeData const& materials = *section->value;
  for (NodeData::Entry const& e : materials.entries) {
    NodeData::Entry const* like = e.value->kind == Node::Kind::table ? e.value->find("like") : nullptr;
    if (!like) continue;
    like->value->known = true;
    NodeData::Entry const* from = materials.find(like->value->text);
    if (from && from->value->kind == Node::Kind::table && !from->value->find("like")) {
      take_over(*from->value, *e.value);
      continue;
    }
    std::vector<std::string> names;
    for (NodeData::Entry const& m : materials.entries)
      if (m.value->kind == Node::Kind::table && !m.value->find("like")) names.push_back(m.key);
    std::string const near = nearest_word(like->value->text, names);
    Node(like->value, nullptr, &document)
        .problem(fmt::format("'{}' is no material that can be taken over", shortened(like->value->text)),
                 near.empty() ? "name one of 'materials' that is not itself 'like' another"
                              : fmt::format("did you mean '{}'?", near));
  }
}

}  // namespace straytrace
