// SPDX-License-Identifier: BSD-3-Clause
// Geometry and light of a page.
#include "report/html/page_json.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "io/markup.hpp"
#include "results/curves/band.hpp"
#include "results/receivers/receivers.hpp"
#include "results/route_table/route_columns.hpp"
#include "results/route_table/route_filter.hpp"
#include "results/route_table/route_sums.hpp"
#include "results/text/columns.hpp"
#include "world/model/world.hpp"

namespace straytrace::report {

static_assert(std::endian::native == std::endian::little);  // typed arrays of browsers

namespace {

// Digits needed for a picture of 40 km: 1e-5 m.
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

PageJson told_json(std::vector<HistoryEvent> const& events) {
  PageJson all = PageJson::array();
  for (HistoryEvent const& e : events) {
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

// Densities of the cells of a map; null without light.
PageJson cells_json(CellValues const& map, double scale, bool per_area) {
  std::vector<double> places, value, error;
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    MapCell const& c = map.cells[i];
    places.insert(places.end(), {c.u_low, c.u_high, c.v_low, c.v_high});
    double const factor = map.count[i] == 0 ? not_a_number : per_area ? scale / map.area[i] : scale;
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
                   {"noise", cells_json(m.noise, percent_per_cm2, true)},
                   {"light", cells_json(m.light, watts, false)},
                   {"histories", m.histories},
                   {"light_unit", beam_power > 0 ? "W/m²" : "1/m² per W of the main mode"},
                   {"places", places},
                   {"noise_by_place", numbers(percent(m.noise_by_place))},
                   {"noise_by_place_error", numbers(percent(m.noise_by_place_error))}});
  }
  return all;
}

// Path table and noise budget of a page.

PageJson number(double x) {
  if (!std::isfinite(x)) return nullptr;
  return x == 0 ? 0 : six_digits(x);
}

PageJson numbers(std::vector<double> const& all) {
  PageJson list = PageJson::array();
  for (double const x : all) list.push_back(number(x));
  return list;
}

namespace {

PageJson values_of(RouteColumn const& c) {
  if (c.is_text) return c.texts;
  PageJson list = PageJson::array();
  for (double const x : c.numbers) list.push_back(c.whole && !std::isnan(x) ? PageJson(std::int64_t(x)) : number(x));
  return list;
}

// `units`: units that a filter accepts after a number, of columns of numbers.
PageJson column_json(RouteColumn const& c) {
  PageJson j{{"key", c.key}, {"title", c.title}, {"unit", c.unit}, {"help", c.help}, {"values", values_of(c)}};
  j["shown"] = c.shown_first;
  if (c.is_text) return j;
  j["units"] = c.units;
  j["whole"] = c.whole;
  j["needs_unit"] = c.needs_unit;
  return j;
}

PageJson curve_json(NoiseTrace const& t) {
  return {{"name", t.name}, {"asd", numbers(t.asd)}, {"sigma", numbers(t.sigma)}};
}

}  // namespace

PageJson table_json(PathTable const& table) {
  RouteColumns const columns(table, nullptr);
  PageJson all = PageJson::array();
  for (RouteColumn const& c : columns.all()) all.push_back(column_json(c));
  return {{"columns", all}, {"rows", columns.rows()}, {"band", {table.low, table.high}}, {"hertz", frequency_units()}};
}

namespace {

using Floats = std::vector<float>;

std::string floats_text(Floats const& all) { return base64(all.data(), all.size() * sizeof(float)); }

// Data to remove rows from the total on the page: per bin, the share of a route in the PSD of the total,
// and asd * sigma over that PSD, of the loudest routes; the rest of the resolved ones in one sum.
PageJson shares_json(NoiseTrace const& total, std::vector<NoiseTrace const*> const& routes) {
  constexpr std::size_t most = 400;
  std::size_t const bins = total.asd.size();
  Floats share, error;
  std::vector<double> rest(bins), rest_error(bins);
  PageJson ids = PageJson::array(), rest_ids = PageJson::array();
  for (std::size_t r = 0; r < routes.size(); ++r) {
    NoiseTrace const& t = *routes[r];
    bool const own = r < most;
    (own ? ids : rest_ids).push_back(hash_text(t.hash));
    for (std::size_t k = 0; k < bins; ++k) {
      double const psd = total.asd[k] * total.asd[k];
      double const part = psd > 0 ? t.asd[k] * t.asd[k] / psd : 0, off = psd > 0 ? t.asd[k] * t.sigma[k] / psd : 0;
      if (own) {
        share.push_back(float(part));
        error.push_back(float(off));
      } else {
        rest[k] += part;
        rest_error[k] += off;
      }
    }
  }
  return {{"ids", ids},
          {"rest_ids", rest_ids},
          {"share", floats_text(share)},
          {"error", floats_text(error)},
          {"rest", floats_text({rest.begin(), rest.end()})},
          {"restError", floats_text({rest_error.begin(), rest_error.end()})}};
}

}  // namespace

PageJson budget_json(NoiseBudget const& b, PathTable const& table, std::size_t routes) {
  PageJson j;
  std::vector<double> f;
  for (std::size_t i = 0; i < b.grid.size(); ++i) f.push_back(b.grid.centre(i));
  j["frequency"] = numbers(f);
  j["total"] = curve_json(b.total);
  j["bound"] = false;
  for (std::size_t i = 0; i < b.grid.size(); ++i)
    if (at_most(b.total, i)) j["bound"] = true;
  j["phase"] = numbers(b.total.phase_asd);
  j["amplitude"] = numbers(b.total.amplitude_asd);
  for (BandCurve const& curve : band_curves) j[curve.name] = numbers(b.bands.*curve.member);
  j["design"] = PageJson::array();
  for (DesignCurve const& c : b.design) j["design"].push_back({{"name", c.name}, {"asd", numbers(c.asd)}});
  j["margin"] = b.margin;
  j["unresolved"] = b.unresolved;
  j["routes"] = PageJson::array();
  auto const traces = by_hash(b.routes);
  std::vector<NoiseTrace const*> resolved;
  for (PathRow const& row : table.rows) {
    auto const found = traces.find(row.hash);
    if (found == traces.end() || !found->second->resolved) continue;
    resolved.push_back(found->second);
    if (j["routes"].size() >= routes || !(row.share.value > 0)) continue;
    j["routes"].push_back({{"id", hash_text(row.hash)}, {"name", row.sequence}, {"asd", numbers(found->second->asd)}});
  }
  j["shares"] = shares_json(b.total, resolved);
  return j;
}

// Provenance, energy balance and convergence of a run.

namespace {

PageJson with_error(Estimate const& e) { return {{"value", number(e.mean)}, {"sigma", number(e.std_error)}}; }

constexpr int least_replicas = 4;  // for a spread

// Relative standard error of the mean of the first replicas, for growing numbers of them: {histories, error}.
struct Convergence {
  std::vector<double> histories, error;
};

Convergence converging(std::array<double, replica_count> const& sums, CouplingTable const& table) {
  Convergence c;
  double sum = 0, n = 0;
  for (int r = 1; r <= replica_count; ++r) {
    sum += sums[std::size_t(r - 1)];
    n += double(table.replica_histories[std::size_t(r - 1)]);
    if (r < least_replicas || !(sum > 0) || !(n > 0)) continue;
    double square = 0;  // of the deviations of the sums of replicas from their expectation
    for (int i = 0; i < r; ++i) {
      double const off = sums[std::size_t(i)] - sum / n * double(table.replica_histories[std::size_t(i)]);
      square += off * off;
    }
    c.histories.push_back(n);
    c.error.push_back(std::sqrt(square * r / (r - 1)) / sum);
  }
  return c;
}

PageJson curve(std::string const& name, Convergence const& c) {
  return {{"name", name}, {"histories", numbers(c.histories)}, {"error", numbers(c.error)}};
}

PageJson map_json(std::string const& name, std::string const& what, Receiver const& r, CellEstimates const& cells,
                  std::vector<double> const& areas, double watts, std::string const& unit) {
  std::vector<double> mean = cells.mean, error = cells.error;
  for (auto* list : {&mean, &error})
    for (std::size_t i = 0; i < list->size(); ++i) (*list)[i] *= watts / areas[i];
  PageJson map = {
      {"name", name}, {"what", what}, {"unit", unit}, {"values", numbers(mean)}, {"errors", numbers(error)}};
  if (r.by_light) {
    std::vector<double> sides;
    MapCell whole{infinity, -infinity, infinity, -infinity};
    for (std::size_t i = 0; i < r.cells.size; ++i) {
      MapCell const& c = r.cells[i];
      sides.insert(sides.end(), {c.u_low, c.u_high, c.v_low, c.v_high});
      whole = {std::fmin(whole.u_low, c.u_low), std::fmax(whole.u_high, c.u_high), std::fmin(whole.v_low, c.v_low),
               std::fmax(whole.v_high, c.v_high)};
    }
    map["chart"] = chart_names[std::size_t(r.chart)];
    map["whole"] = {whole.u_low, whole.u_high, whole.v_low, whole.v_high};
    map["cells"] = sides;
  } else {
    map["columns"] = r.columns;
    map["rows"] = r.rows;
    map["x"] = {-r.half_width, r.half_width};
    map["y"] = {-r.half_height, r.half_height};
  }
  return map;
}

}  // namespace

PageJson provenance_json(RunContent const& run) {
  Provenance const& p = run.provenance;
  PageJson files = PageJson::array();
  for (auto const& [name, text] : run.files)
    files.push_back({{"name", name}, {"bytes", text.size()}, {"sha256", sha256(text)}});
  return {{"program", p.program},
          {"version", p.version},
          {"commit", p.commit},
          {"created", p.created},
          {"build", p.build_flags},
          {"model", run.model_hash},
          {"seed", run.trace->coupling.seed},
          {"histories", run.trace->coupling.histories},
          {"stop_rule", run.trace->stop_rule},
          {"complete", !run.trace->checkpointed()},
          {"seconds", number(run.trace->seconds)},
          {"interferometer", run.interferometer},
          {"replaced_by", run.motion_file},
          {"parameters", run.overrides},
          {"beam_power", number(run.beam_power > 0 ? run.beam_power : not_a_number)},
          {"reverse_routes", run.trace->coupling.reverse_routes},
          {"files", files}};
}

PageJson energy_balance_json(RunContent const& run) {
  std::vector<BalanceRow> const rows = balance_rows(run.trace->total);
  PageJson terms = PageJson::array(), objects = PageJson::array();
  for (std::size_t i = 1; i < rows.size(); ++i)
    terms.push_back({{"name", rows[i].name}, {"power", with_error(rows[i].power)}});
  for (ObjectRow const& row : object_rows(*run.trace)) {
    objects.push_back({{"name", row.name}});
    if (row.arriving) objects.back()["arriving"] = with_error(*row.arriving);
    if (row.absorbed) objects.back()["absorbed"] = with_error(*row.absorbed);
  }
  return {{"emitted", with_error(rows.front().power)},
          {"terms", terms},
          {"closure", energy_balance_text(run)},
          {"objects", objects}};
}

PageJson convergence_json(RunContent const& run, PathTable const& table) {
  CouplingTable const& coupling = run.trace->coupling;
  auto const classes = by_hash(coupling.classes);
  std::array<double, replica_count> noise = {};
  PageJson curves = PageJson::array(), merit = PageJson::array();
  constexpr std::size_t shown = 6;
  for (PathRow const& row : table.rows) {
    CouplingClass const& c = *classes.at(row.hash);
    if (!row.resolved || c.deterministic()) continue;
    if (curves.size() < shown) curves.push_back(curve(row.sequence, converging(c.replica_sum, coupling)));
    if (!(row.share.value > 0) || !(c.coupling.mean > 0)) continue;
    for (std::size_t r = 0; r < noise.size(); ++r) noise[r] += row.share.value * c.replica_sum[r] / c.coupling.mean;
  }
  Convergence total = converging(noise, coupling);
  for (double& e : total.error) e /= 2;  // of the ASD: half of that of its square
  for (Merit const& m : merits(run)) {
    if (merit.size() >= 2 * shown) break;
    if (std::isfinite(m.value)) merit.push_back({{"name", m.what}, {"value", number(m.value)}});
  }
  return {{"total", curve("h in the band, total", total)}, {"routes", curves}, {"merit", merit}};
}

PageJson inputs_json(RunContent const& run) {
  NoiseBands const bands = run.noise ? run.noise->bands : NoiseBands{};
  auto const rows = source_rows(bands, run.projection ? &*run.projection : nullptr);
  return {{"sources", source_table().page_table(rows)}, {"exact", bands.taken_as_exact}};
}

PageJson receivers_json(RunContent const& run, World const& world) {
  PageJson maps = PageJson::array();
  if (run.receivers.empty()) return {{"list", PageJson::array()}, {"maps", maps}};
  BlockSums const& total = run.trace->total;
  bool const in_watts = run.beam_power > 0;
  for (std::size_t i = 0; i < run.receivers.size(); ++i) {
    Receiver const& r = run.receivers[i];
    if (r.map_size() == 0) continue;
    maps.push_back(
        map_json(run.trace->coupling.receivers[i], "irradiance", r,
                 cell_estimates(total.receivers[i].image, total.histories, total.blocks),
                 run.map_areas.empty() ? map_areas(world.view(), world.receivers().at(i).surface, r) : run.map_areas[i],
                 in_watts ? run.beam_power : 1, in_watts ? "W/m²" : "1/m² (per W of the main mode)"));
  }
  return {{"list", receiver_page_list(receiver_table(run))}, {"maps", maps}};
}

}  // namespace straytrace::report
