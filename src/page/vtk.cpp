// SPDX-License-Identifier: BSD-3-Clause
// VTK XML, appended raw binary (docs.vtk.org, "VTK XML File Formats"): little endian, 64-bit headers.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>

#include "page/exports.hpp"
#include "report/csv.hpp"
#include "report/markup.hpp"

namespace straytrace {
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
  std::map<std::uint64_t, PathRow const*> rows;
  for (PathRow const& row : table.rows) rows[row.hash] = &row;
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

}  // namespace straytrace
