// SPDX-License-Identifier: BSD-3-Clause
// Geometry and light of a page.
#include <bit>
#include <cmath>

#include "page/page_json.hpp"
#include "report/csv.hpp"
#include "report/markup.hpp"

namespace straytrace {

static_assert(std::endian::native == std::endian::little);  // typed arrays of browsers

namespace {

// All digits that a picture of 40 km needs: 1e-5 m.
double metres(double x) { return std::round(x * 1e6) * 1e-6; }
PageJson vector_json(Vec3 p) { return {metres(p.x), metres(p.y), metres(p.z)}; }

std::string group_name(World const& world, GroupId id) { return id.valid() ? world.groups()[id.value] : ""; }

}  // namespace

PageJson scene_json(SceneDrawing const& scene) {
  PageJson meshes = PageJson::array(), parts = PageJson::array();
  double moved = 0;
  for (DrawnMesh const& m : scene.meshes) {
    meshes.push_back({{"points", base64(m.points.data(), m.points.size() * sizeof(float))},
                      {"corners", base64(m.corners.data(), m.corners.size() * sizeof(std::uint32_t))},
                      {"triangles", m.triangles()},
                      {"of", m.of_triangles}});
    moved = std::max(moved, m.moved);
  }
  for (DrawnPart const& p : scene.parts) {
    PageJson places = PageJson::array();
    for (Vec3 const& at : p.places) places.push_back(vector_json(at));
    parts.push_back({{"name", p.name},
                     {"body", p.body},
                     {"front", p.front},
                     {"back", p.back},
                     {"shape", p.shape},
                     {"mesh", p.mesh},
                     {"clear", p.clear},
                     {"places", places}});
  }
  return {{"box", {vector_json(scene.box.lower), vector_json(scene.box.upper)}},
          {"meshes", meshes},
          {"parts", parts},
          {"triangles", scene.triangles()},
          {"of_triangles", scene.of_triangles()},
          {"moved", number(moved)}};
}

PageJson paths_json(World const& world, std::vector<DrawnPath> const& paths) {
  PageJson all = PageJson::array();
  for (DrawnPath const& p : paths) {
    PageJson points = PageJson::array(), steps = PageJson::array();
    for (PathPoint const& v : p.points) {
      points.push_back(vector_json(v.point));
      steps.push_back(fmt::format("{}·{}", group_name(world, v.group), letter(v.event)));
    }
    all.push_back({{"id", hash_text(p.route)},
                   {"address", p.computed ? "computed" : fmt::format("{}:{}:{}", p.history, p.event, p.connection)},
                   {"weight", number(p.weight)},
                   {"length", metres(p.path_length)},
                   {"reversed", p.reversed},
                   {"points", points},
                   {"steps", steps}});
  }
  return all;
}

PageJson rays_json(World const& world, std::vector<RaySegment> const& rays) {
  PageJson all = PageJson::array();
  for (RaySegment const& r : rays)
    all.push_back({{"from", vector_json(r.from)},
                   {"to", vector_json(r.to)},
                   {"power", number(r.power)},
                   {"order", r.order},
                   {"end", r.end == RaySegment::End::escaped ? "escaped" : group_name(world, r.on)},
                   {"history", r.history}});
  return all;
}

PageJson told_json(std::vector<ToldEvent> const& events) {
  PageJson all = PageJson::array();
  for (ToldEvent const& e : events) {
    bool const placed = std::isfinite(e.point.x);
    all.push_back({{"what", e.what},
                   {"event", placed ? PageJson(e.event) : PageJson()},
                   {"order", placed ? PageJson(e.order) : PageJson()},
                   {"where", e.where},
                   {"body", e.body},
                   {"point_m", placed ? PageJson{e.point.x, e.point.y, e.point.z} : PageJson()},
                   {"power", e.power}});
  }
  return all;
}

PageJson lit_json(World const& world) {
  PageJson all = PageJson::array();
  for (Footprint const& f : world.footprints()) {
    bool const on = f.surface.valid();
    all.push_back({{"at", vector_json(f.centre)},
                   {"travel", {f.travel.x, f.travel.y, f.travel.z}},
                   {"radius", number(f.profile == Profile::astigmatic ? std::sqrt(f.astigmatism.w1 * f.astigmatism.w2)
                                                                      : f.radius)},
                   {"on", on ? group_name(world, world.surfaces()[f.surface.value].group) : "free beam"},
                   {"port", f.port.valid() ? world.ports()[f.port.value] : ""},
                   {"standing", f.standing},
                   {"beam", f.beam},
                   {"share", number(f.share)}});
  }
  return all;
}

namespace {

// Densities of the cells of a map; null where nothing was seen.
PageJson cells_json(Chart chart, CellValues const& map, double scale, bool per_area) {
  std::vector<double> places, value, error;
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    MapCell const& c = map.cells[i];
    places.insert(places.end(), {c.u_low, c.u_high, c.v_low, c.v_high});
    double const factor = map.count[i] == 0 ? not_a_number : per_area ? scale / area_of(chart, c) : scale;
    value.push_back(factor * map.value[i]);
    error.push_back(factor * map.error[i]);
  }
  return {{"cells", numbers(places)}, {"values", numbers(value)}, {"errors", numbers(error)}, {"count", map.count}};
}

std::vector<double> percent(std::vector<double> shares) {
  for (double& x : shares) x *= 100;
  return shares;
}

}  // namespace

PageJson maps_json(std::vector<SurfaceMap> const& maps, double beam_power) {
  PageJson all = PageJson::array();
  double const watts = beam_power > 0 ? beam_power : 1, percent_per_cm2 = 100 * 1e-4;
  constexpr char const* charts[] = {"plane", "polar", "unrolled"};
  for (SurfaceMap const& m : maps) {
    PageJson places = PageJson::array();
    for (Vec3 const& p : m.places) places.push_back(vector_json(p));
    all.push_back({{"name", m.name},
                   {"chart", charts[int(m.chart)]},
                   {"whole", numbers({m.whole.u_low, m.whole.u_high, m.whole.v_low, m.whole.v_high})},
                   {"x_axis", numbers({m.x_axis.x, m.x_axis.y, m.x_axis.z})},
                   {"y_axis", numbers({m.y_axis.x, m.y_axis.y, m.y_axis.z})},
                   {"surfaces", m.surfaces},
                   {"noise_sum", number(100 * m.noise_sum)},
                   {"noise", cells_json(m.chart, m.noise, percent_per_cm2, true)},
                   {"light", cells_json(m.chart, m.light, watts, false)},
                   {"histories", m.histories},
                   {"light_unit", beam_power > 0 ? "W/m²" : "1/m² per W of the main mode"},
                   {"places", places},
                   {"noise_by_place", numbers(percent(m.noise_by_place))},
                   {"noise_by_place_error", numbers(percent(m.noise_by_place_error))}});
  }
  return all;
}

}  // namespace straytrace
