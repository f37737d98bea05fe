// SPDX-License-Identifier: BSD-3-Clause
#include <assimp/Exporter.hpp>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>

#include "base/message.hpp"
#include "page/exports.hpp"
#include "report/csv.hpp"

namespace straytrace {
namespace {

// Arrays that the scene of the library owns and deletes.
template <class T>
T** owned(std::vector<std::unique_ptr<T>>& list, unsigned& count) {
  count = unsigned(list.size());
  T** const all = new T*[list.size()];
  for (std::size_t i = 0; i < list.size(); ++i) all[i] = list[i].release();
  list.clear();
  return all;
}

aiVector3D vector(Vec3 v) { return {ai_real(v.x), ai_real(v.y), ai_real(v.z)}; }

class Builder {
 public:
  void add_part(DrawnPart const& part, DrawnMesh const& mesh) {
    unsigned const number = mesh_of(mesh, material_of(part.front.empty() ? part.back : part.front), part.name);
    for (std::size_t i = 0; i < part.places.size(); ++i) {
      auto node = std::make_unique<aiNode>(part.places.size() > 1 ? fmt::format("{} {}", part.name, i + 1) : part.name);
      aiMatrix4x4::Translation(vector(part.places[i]), node->mTransformation);
      add_node(std::move(node), number);
    }
  }
  // One set of lines about the first point.
  void add_lines(std::string const& name, std::vector<DrawnPath const*> const& paths) {
    Vec3 const origin = paths.front()->points.front().point;
    auto mesh = std::make_unique<aiMesh>();
    std::vector<aiVector3D> points;
    std::vector<std::pair<unsigned, unsigned>> pieces;
    for (DrawnPath const* path : paths)
      for (std::size_t i = 0; i < path->points.size(); ++i) {
        if (i > 0) pieces.emplace_back(unsigned(points.size()) - 1, unsigned(points.size()));
        points.push_back(vector(path->points[i].point - origin));
      }
    fill(*mesh, points, aiPrimitiveType_LINE, name, material_of("path"));
    mesh->mNumFaces = unsigned(pieces.size());
    mesh->mFaces = new aiFace[pieces.size()];
    for (std::size_t i = 0; i < pieces.size(); ++i) set(mesh->mFaces[i], {pieces[i].first, pieces[i].second});
    meshes_.push_back(std::move(mesh));
    auto node = std::make_unique<aiNode>(name);
    aiMatrix4x4::Translation(vector(origin), node->mTransformation);
    add_node(std::move(node), unsigned(meshes_.size()) - 1);
  }
  std::unique_ptr<aiScene> finish() {
    auto scene = std::make_unique<aiScene>();
    scene->mMeshes = owned(meshes_, scene->mNumMeshes);
    scene->mMaterials = owned(materials_, scene->mNumMaterials);
    scene->mRootNode = new aiNode("straytrace");
    for (auto& node : nodes_) node->mParent = scene->mRootNode;
    scene->mRootNode->mChildren = owned(nodes_, scene->mRootNode->mNumChildren);
    return scene;
  }

 private:
  static void set(aiFace& face, std::vector<unsigned> const& corners) {
    face.mNumIndices = unsigned(corners.size());
    face.mIndices = new unsigned[corners.size()];
    std::copy(corners.begin(), corners.end(), face.mIndices);
  }
  static void fill(aiMesh& mesh, std::vector<aiVector3D> const& points, unsigned kind, std::string const& name,
                   unsigned material) {
    mesh.mName = name;
    mesh.mPrimitiveTypes = kind;
    mesh.mMaterialIndex = material;
    mesh.mNumVertices = unsigned(points.size());
    mesh.mVertices = new aiVector3D[points.size()];
    std::copy(points.begin(), points.end(), mesh.mVertices);
  }
  unsigned mesh_of(DrawnMesh const& drawn, unsigned material, std::string const& name) {
    auto const [at, added] = known_.emplace(std::pair(&drawn, material), unsigned(meshes_.size()));
    if (!added) return at->second;
    auto mesh = std::make_unique<aiMesh>();
    std::vector<aiVector3D> points;
    for (std::size_t i = 0; i < drawn.points.size(); i += 3)
      points.emplace_back(drawn.points[i], drawn.points[i + 1], drawn.points[i + 2]);
    fill(*mesh, points, aiPrimitiveType_TRIANGLE, name, material);
    mesh->mNumFaces = unsigned(drawn.triangles());
    mesh->mFaces = new aiFace[drawn.triangles()];
    for (std::size_t i = 0; i < drawn.triangles(); ++i)
      set(mesh->mFaces[i], {drawn.corners[3 * i], drawn.corners[3 * i + 1], drawn.corners[3 * i + 2]});
    meshes_.push_back(std::move(mesh));
    return at->second;
  }
  unsigned material_of(std::string const& name) {
    auto const [at, added] = material_.emplace(name, unsigned(materials_.size()));
    if (!added) return at->second;
    static constexpr float tints[][3] = {{0.49f, 0.61f, 0.72f}, {0.79f, 0.63f, 0.42f}, {0.56f, 0.70f, 0.54f},
                                         {0.71f, 0.54f, 0.65f}, {0.66f, 0.66f, 0.66f}, {0.82f, 0.72f, 0.28f}};
    auto const& t = tints[at->second % std::size(tints)];
    auto material = std::make_unique<aiMaterial>();
    aiString const title(name.empty() ? "no material" : name);
    aiColor4D const tint(t[0], t[1], t[2], 1);
    int const both_sides = 1;
    material->AddProperty(&title, AI_MATKEY_NAME);
    material->AddProperty(&tint, 1, AI_MATKEY_BASE_COLOR);
    material->AddProperty(&both_sides, 1, AI_MATKEY_TWOSIDED);
    materials_.push_back(std::move(material));
    return at->second;
  }
  void add_node(std::unique_ptr<aiNode> node, unsigned mesh) {
    node->mNumMeshes = 1;
    node->mMeshes = new unsigned[1]{mesh};
    nodes_.push_back(std::move(node));
  }
  std::vector<std::unique_ptr<aiMesh>> meshes_;
  std::vector<std::unique_ptr<aiMaterial>> materials_;
  std::vector<std::unique_ptr<aiNode>> nodes_;
  std::map<std::pair<DrawnMesh const*, unsigned>, unsigned> known_;
  std::map<std::string, unsigned> material_;
};

}  // namespace

std::string glb_bytes(SceneDrawing const& scene, std::vector<DrawnPath> const& paths, PathTable const* table) {
  Builder builder;
  for (DrawnPart const& part : scene.parts)
    if (scene.meshes[part.mesh].triangles() > 0) builder.add_part(part, scene.meshes[part.mesh]);
  std::map<std::uint64_t, std::vector<DrawnPath const*>> routes;
  for (DrawnPath const& p : paths)
    if (p.points.size() > 1) routes[p.route].push_back(&p);
  for (auto const& [route, some] : routes) {
    std::string name = "path " + hash_text(route);
    if (table)
      for (PathRow const& row : table->rows)
        if (row.hash == route) name = row.sequence;
    builder.add_lines(name, some);
  }
  std::unique_ptr<aiScene> const whole = builder.finish();
  Assimp::Exporter exporter;
  aiExportDataBlob const* const blob = exporter.ExportToBlob(whole.get(), "glb2");
  if (!blob) throw NumericalError(fmt::format("the scene could not be written as GLB: {}", exporter.GetErrorString()));
  return std::string(static_cast<char const*>(blob->data), blob->size);
}

}  // namespace straytrace
