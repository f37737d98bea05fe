// SPDX-License-Identifier: BSD-3-Clause
#include "scene/scene.hpp"

#include <fmt/format.h>

#include "scene/model_tree.hpp"
#include "scene/parts.hpp"
#include "scene/scene_document.hpp"
#include "scene/scope.hpp"

namespace straytrace::scene {

struct Scene::Impl {
  std::string main_file;
  std::vector<std::string> overrides;
  SceneDocument document;
  Node root{};
  std::vector<Instance> instances{};
};

Scene::Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

Node Scene::root() const { return impl_->root; }
std::vector<Scene::Instance> const& Scene::instances() const { return impl_->instances; }
std::string const& Scene::main_file() const { return impl_->main_file; }
std::vector<std::string> const& Scene::overrides() const { return impl_->overrides; }
FileTexts const& Scene::files() const { return impl_->document.files(); }
std::string Scene::title() const { return root()["title"].as_word(); }
std::string Scene::place_text(Place p) const {
  return fmt::format("{}:{}", impl_->document.source(p.file).name, p.line);
}
std::string Scene::warnings() const { return rendered_warnings(impl_->document); }
void Scene::throw_if_problems() const { throw_errors(impl_->document); }
std::string Scene::resolved() const { return resolved_text(impl_->root, impl_->instances); }

Scene read_scene(std::string const& file, std::vector<std::string> const& overrides, FileTexts const* texts) {
  std::filesystem::path const path(file);
  Scene scene;
  scene.impl_.reset(
      new Scene::Impl{path.filename().string(), overrides, SceneDocument(path.parent_path(), texts, overrides)});
  Scene::Impl& impl = *scene.impl_;
  std::shared_ptr<NodeData> const model = read_model(impl.document, impl.main_file, overrides);
  NodeData::Entry const* params = model->find("params");
  bool const table = params && params->value->kind == Node::Kind::table;
  auto const scope = make_model_scope(impl.document, table ? params->value.get() : nullptr, overrides);
  impl.root = Node(model, scope, &impl.document);
  impl.instances = expand_scene(impl.document, impl.root);
  return scene;
}

}  // namespace straytrace::scene
