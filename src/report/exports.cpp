// SPDX-License-Identifier: BSD-3-Clause
#include "report/exports.hpp"

#include <assimp/Exporter.hpp>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <memory>
#include <tuple>

#include "base/errors.hpp"
#include "io/markup.hpp"
#include "noise/project/route_noise.hpp"
#include "results/curves/band.hpp"
#include "results/text/columns.hpp"

namespace straytrace::report {
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

// The writer of glTF takes a translation of less than 1e-2 m for none and leaves it out: such places belong into the
// points.
Vec3 origin_for(Vec3 place) {
  return std::max({std::fabs(place.x), std::fabs(place.y), std::fabs(place.z)}) < 2e-2 ? Vec3{} : place;
}

class Builder {
 public:
  void add_part(DrawnPart const& part, DrawnMesh const& mesh) {
    unsigned const material = material_of(part.front.empty() ? part.back : part.front);
    for (std::size_t i = 0; i < part.places.size(); ++i) {
      Vec3 const origin = origin_for(part.places[i]);
      unsigned const number = mesh_of(mesh, part.places[i] - origin, material, part.name);
      auto node = std::make_unique<aiNode>(part.places.size() > 1 ? fmt::format("{} {}", part.name, i + 1) : part.name);
      aiMatrix4x4::Translation(vector(origin), node->mTransformation);
      add_node(std::move(node), number);
    }
  }
  // One set of lines about the first point.
  void add_lines(std::string const& name, std::vector<DrawnPath const*> const& paths) {
    Vec3 const origin = origin_for(paths.front()->points.front().point);
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
  unsigned mesh_of(DrawnMesh const& drawn, Vec3 shift, unsigned material, std::string const& name) {
    std::tuple const key(&drawn, material, shift.x, shift.y, shift.z);
    auto const [at, added] = known_.emplace(key, unsigned(meshes_.size()));
    if (!added) return at->second;
    auto mesh = std::make_unique<aiMesh>();
    std::vector<aiVector3D> points;
    for (std::size_t i = 0; i < drawn.points.size(); i += 3)
      points.push_back(vector(Vec3{drawn.points[i], drawn.points[i + 1], drawn.points[i + 2]} + shift));
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
  std::map<std::tuple<DrawnMesh const*, unsigned, double, double, double>, unsigned> known_;
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

// VTK XML, appended raw binary (docs.vtk.org, "VTK XML File Formats"): little endian, 64-bit headers.

namespace {

static_assert(std::endian::native == std::endian::little);

// Declarations in the head of the file, numbers behind it.
class PolyData {
 public:
  void begin(std::string const& section) { head_ += "      <" + section + ">\n"; }
  void end(std::string const& section) { head_ += "      </" + section + ">\n"; }
  template <class T>
  void array(std::string const& name, std::vector<T> const& values, int components = 1) {
    char const* const type = std::is_same_v<T, double> ? "Float64" : "Int64";
    head_ += fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n",
        type, escaped(name), components, data_.size());
    std::uint64_t const bytes = values.size() * sizeof(T);
    data_.append(reinterpret_cast<char const*>(&bytes), sizeof bytes);
    data_.append(reinterpret_cast<char const*>(values.data()), bytes);
  }
  std::string text(std::size_t points, std::size_t lines, std::size_t polygons) const {
    return fmt::format(
               "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
               "header_type=\"UInt64\">\n  <PolyData>\n    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" "
               "NumberOfLines=\"{}\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
               points, lines, polygons) +
           head_ + "    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n   _" + data_ +
           "\n  </AppendedData>\n</VTKFile>\n";
  }

 private:
  std::string head_, data_;
};

using Longs = std::vector<std::int64_t>;

void add_points(PolyData& file, std::vector<double> const& points) {
  file.begin("Points");
  file.array("points", points, 3);
  file.end("Points");
}

void add_cells(PolyData& file, std::string const& kind, Longs const& corners, Longs const& ends) {
  file.begin(kind);
  file.array("connectivity", corners);
  file.array("offsets", ends);
  file.end(kind);
}

std::int64_t number_of(std::vector<std::string> const& names, std::string const& name) {
  auto const at = std::find(names.begin(), names.end(), name);
  return at == names.end() ? -1 : at - names.begin();
}

std::string part_text(DrawnPart const& part, DrawnMesh const& mesh, std::int64_t body) {
  std::vector<double> points;
  Longs corners, ends, instance, bodies;
  std::size_t const each = mesh.points.size() / 3;
  for (std::size_t i = 0; i < part.places.size(); ++i) {
    Vec3 const& at = part.places[i];
    for (std::size_t k = 0; k < mesh.points.size(); ++k)
      points.push_back(mesh.points[k] + (k % 3 == 0 ? at.x : k % 3 == 1 ? at.y : at.z));
    for (std::size_t k = 0; k < mesh.corners.size(); ++k) {
      corners.push_back(std::int64_t(i * each + mesh.corners[k]));
      if (k % 3 != 2) continue;
      ends.push_back(std::int64_t(corners.size()));
      instance.push_back(std::int64_t(i));
      bodies.push_back(body);
    }
  }
  PolyData file;
  file.begin("CellData");
  file.array("instance", instance);
  file.array("body", bodies);
  file.end("CellData");
  add_points(file, points);
  add_cells(file, "Polys", corners, ends);
  return file.text(points.size() / 3, 0, ends.size());
}

std::string paths_text(World const& world, std::vector<DrawnPath> const& paths, PathTable const& table) {
  auto const rows = by_hash(table.rows);
  std::vector<double> points, power;
  std::vector<std::vector<double>> strain(table.frequencies.size());
  Longs corners, ends, path, route, history, body, event, on, on_body;
  for (DrawnPath const& p : paths) {
    for (PathPoint const& v : p.points) {
      corners.push_back(std::int64_t(points.size() / 3));
      points.insert(points.end(), {v.point.x, v.point.y, v.point.z});
      event.push_back(std::int64_t(v.event));
      on.push_back(v.group.valid() ? v.group.value : -1);
      on_body.push_back(v.body.valid() ? v.body.value : -1);
    }
    ends.push_back(std::int64_t(corners.size()));
    path.push_back(std::int64_t(path.size()));
    history.push_back(std::int64_t(p.history));
    power.push_back(p.weight);
    auto const found = rows.find(p.route);
    PathRow const* const row = found == rows.end() ? nullptr : found->second;
    route.push_back(row ? std::int64_t(row->rank) : -1);
    body.push_back(row ? number_of(world.body_names(), row->body) : -1);
    for (std::size_t i = 0; i < strain.size(); ++i)
      strain[i].push_back(row && i < row->strain.size() ? row->strain[i].value : not_a_number);
  }
  PolyData file;
  file.begin("PointData");
  file.array("event", event);
  file.array("surface", on);
  file.array("body", on_body);
  file.end("PointData");
  file.begin("CellData");
  file.array("path", path);
  file.array("route", route);
  file.array("history", history);
  file.array("power", power);
  file.array("moving body", body);
  for (std::size_t i = 0; i < strain.size(); ++i) file.array(fmt::format("h {:g} Hz", table.frequencies[i]), strain[i]);
  file.end("CellData");
  add_points(file, points);
  add_cells(file, "Lines", corners, ends);
  return file.text(points.size() / 3, ends.size(), 0);
}

std::string names_text(World const& world, PathTable const* table) {
  std::string text = "array,number,name\n";
  auto const add = [&](char const* array, std::vector<std::string> const& names) {
    for (std::size_t i = 0; i < names.size(); ++i) text += fmt::format("{},{},{}\n", array, i, csv_text(names[i]));
  };
  add("surface", world.groups());
  add("body", world.body_names());
  for (int e = 0; e <= int(Event::diffract); ++e) text += fmt::format("event,{},{}\n", e, letter(Event(e)));
  if (table)
    for (PathRow const& row : table->rows) text += fmt::format("route,{},{}\n", row.rank, csv_text(row.sequence));
  return text;
}

}  // namespace

NamedTexts vtk_files(World const& world, SceneDrawing const& scene, std::vector<DrawnPath> const& paths,
                     PathTable const* table) {
  NamedTexts files;
  std::string blocks;
  for (std::size_t i = 0; i < scene.parts.size(); ++i) {
    DrawnPart const& part = scene.parts[i];
    std::string const name = fmt::format("parts/{:04}.vtp", i);
    blocks += fmt::format("      <DataSet index=\"{}\" name=\"{}\" file=\"{}\"/>\n", i, escaped(part.name), name);
    files.emplace_back(name, part_text(part, scene.meshes[part.mesh], number_of(world.body_names(), part.body)));
  }
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n  <vtkMultiBlockDataSet>\n    <Block index=\"0\" name=\"scene\">\n" +
      blocks + "    </Block>\n";
  if (table) {
    text += "    <DataSet index=\"1\" name=\"paths\" file=\"paths.vtp\"/>\n";
    files.emplace_back("paths.vtp", paths_text(world, paths, *table));
  }
  files.emplace_back("names.csv", names_text(world, table));
  files.emplace_back("straytrace.vtm", text + "  </vtkMultiBlockDataSet>\n</VTKFile>\n");
  return files;
}

// Every curve of a run as CSV.

namespace {

std::string value_at(std::vector<double> const& curve, std::size_t i) {
  return i < curve.size() ? csv_number(true, curve[i]) : "nan";
}

std::string budget_csv(RunContent const& run) {
  NoiseBudget const& b = *run.noise;
  std::vector<std::pair<std::string, std::vector<double> const*>> curves = {{"h_mean", &b.total.asd},
                                                                            {"h_sigma", &b.total.sigma},
                                                                            {"phase_only", &b.total.phase_asd},
                                                                            {"amplitude_only", &b.total.amplitude_asd}};
  for (BandCurve const& c : band_curves) curves.emplace_back(c.name, &(b.bands.*c.member));
  for (DesignCurve const& c : b.design) curves.emplace_back(c.name, &c.asd);
  std::string text = file_header(run) + "# one-sided strain ASD, 1/sqrt(Hz)\nfrequency_Hz";
  for (auto const& [name, curve] : curves) text += "," + csv_text(name);
  for (std::size_t i = 0; i < b.grid.size(); ++i) {
    text += "\n" + csv_number(true, b.grid.centre(i));
    for (auto const& [name, curve] : curves) text += "," + value_at(*curve, i);
  }
  return text + "\n";
}

std::string routes_csv(RunContent const& run, PathTable const& table) {
  NoiseBudget const& b = *run.noise;
  auto const traces = by_hash(b.routes);
  std::vector<std::pair<NoiseTrace const*, double>> routes;  // with the relative error of h over random mirrors
  std::string text = file_header(run) +
                     "# one-sided strain ASD of each resolved route and its standard error, 1/sqrt(Hz), by rank\n"
                     "frequency_Hz";
  for (PathRow const& row : table.rows) {
    auto const found = traces.find(row.hash);
    if (!row.resolved || found == traces.end()) continue;
    routes.emplace_back(found->second, mirror_error(row.kind, row.coupling) / 2);
    text += "," + csv_text(row.sequence) + "," + csv_text(row.sequence + " sigma");
  }
  for (std::size_t i = 0; i < b.grid.size(); ++i) {
    text += "\n" + csv_number(true, b.grid.centre(i));
    for (auto const& [t, mirrors] : routes)
      text += "," + value_at(t->asd, i) + "," + csv_number(true, std::hypot(t->sigma.at(i), mirrors * t->asd.at(i)));
  }
  return text + "\n";
}

}  // namespace

NamedTexts curve_files(RunContent const& run, PathTable const& table) {
  NamedTexts files;
  if (run.noise) {
    files.emplace_back("budget.csv", budget_csv(run));
    files.emplace_back("routes.csv", routes_csv(run, table));
  }
  files.emplace_back("paths.csv", path_csv(table, run));
  return files;
}

}  // namespace straytrace::report
