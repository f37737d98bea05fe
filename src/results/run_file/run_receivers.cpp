// SPDX-License-Identifier: BSD-3-Clause
// /receivers, /maps and the maps of /nodes: light in watts.
#include <algorithm>

#include "base/errors.hpp"
#include "results/receivers/receivers.hpp"
#include "results/run_file/run_file.hpp"

namespace straytrace::results {
namespace {

using Doubles = std::vector<double>;
using Counts = std::vector<std::uint64_t>;
using Small = std::vector<std::uint32_t>;
using Bytes = std::vector<std::uint8_t>;

constexpr MapSums ReceiverSums::*maps[] = {&ReceiverSums::image, &ReceiverSums::angles, &ReceiverSums::quadrants};
constexpr char const* map_names[] = {"image", "angles", "quadrants"};
constexpr Doubles FieldSums::*field_parts[] = {&FieldSums::power, &FieldSums::real, &FieldSums::imaginary};
constexpr char const* part_names[] = {"field_power", "field_real", "field_imaginary"};
constexpr Vec3 Pose::*axes[] = {&Pose::origin, &Pose::e1, &Pose::e2, &Pose::e3};

void append(Doubles& into, Doubles const& values) { into.insert(into.end(), values.begin(), values.end()); }

void append_pose(Doubles& into, Pose const& pose) {
  for (auto const axis : axes) append(into, Doubles{(pose.*axis).x, (pose.*axis).y, (pose.*axis).z});
}
Pose pose_at(Doubles const& values, std::size_t row) {
  Pose pose;
  double const* v = values.data() + 12 * row;
  for (auto const axis : axes) {
    pose.*axis = {v[0], v[1], v[2]};
    v += 3;
  }
  return pose;
}

// Fields laid end to end: route and cells of each.
struct FieldColumns {
  Counts route, offset = {0};
  Doubles parts[3];

  void add(ReceiverSums const& r, double scale = 1) {
    for (auto const& [hash, field] : r.fields) {
      route.push_back(hash);
      for (int k = 0; k < 3; ++k)
        for (double const x : field.*field_parts[k]) parts[k].push_back(scale * x);
      offset.push_back(parts[0].size());
    }
  }
  void write(hdf5::Writer& out, std::string const& place) const {
    out.array(place + "field_route", route, "1");
    out.array(place + "field_offset", offset, "1");
    for (int k = 0; k < 3; ++k) out.array(place + part_names[k], parts[k], "1");
  }
  static FieldColumns read(hdf5::Reader const& in, std::string const& place) {
    FieldColumns c;
    c.route = in.array<std::uint64_t>(place + "field_route");
    c.parts[0] = in.array<double>(place + part_names[0]);
    for (int k = 1; k < 3; ++k) c.parts[k] = in.rows<double>(place + part_names[k], c.parts[0].size());
    c.offset = read_offsets(in, place + "field_offset", c.route.size(), c.parts[0].size());
    return c;
  }
  FieldSums at(std::size_t i) const {
    FieldSums field;
    for (int k = 0; k < 3; ++k)
      (field.*field_parts[k])
          .assign(parts[k].begin() + std::ptrdiff_t(offset[i]), parts[k].begin() + std::ptrdiff_t(offset[i + 1]));
    return field;
  }
};

}  // namespace

void write_receivers(hdf5::Writer& out, RunContent const& run) {
  Small pixels, bins, surface;
  Counts cell_offset = {0};
  Doubles cells;
  Doubles size, frame, sine, gap, quadrant_frame;
  Bytes sides, passes, quadrants, behind_glass;
  std::vector<std::string> charts;
  for (Receiver const& r : run.receivers) {
    surface.push_back(r.surface.value);
    charts.emplace_back(r.by_light ? chart_names[std::size_t(r.chart)] : "");
    for (std::size_t i = 0; i < r.cells.size; ++i)
      append(cells, Doubles{r.cells[i].u_low, r.cells[i].u_high, r.cells[i].v_low, r.cells[i].v_high});
    cell_offset.push_back(cells.size() / 4);
    pixels.insert(pixels.end(), {r.columns, r.rows});
    append(size, Doubles{2 * r.half_width, 2 * r.half_height});
    append_pose(frame, r.frame);
    bins.push_back(r.angle_bins);
    sine.push_back(r.half_angle_sine);
    quadrants.push_back(r.quadrants);
    gap.push_back(r.gap);
    append_pose(quadrant_frame, r.quadrant_frame);
    sides.push_back(std::uint8_t((r.front ? 1 : 0) + (r.back ? 2 : 0)));
    passes.push_back(r.clear);
    behind_glass.push_back(r.behind_glass);
  }
  Doubles mean, error;
  Bytes trusted;
  std::vector<std::string> why;
  for (Estimate const& e : run.trace->coupling.received_power) {
    mean.push_back(e.mean);
    error.push_back(e.std_error);
    trusted.push_back(e.trusted);
    why.push_back(e.why_not);
  }
  std::size_t const n = run.receivers.size();
  out.group("/receivers", "where light is counted; rows as in /names/receivers");
  out.attribute("/receivers", "beam_power", run.beam_power);
  out.array("/receivers/mean", mean, "1");
  out.array("/receivers/std_error", error, "1");
  out.array("/receivers/trusted", trusted, "0 or 1");
  out.strings("/receivers/why_not", why);
  out.array("/receivers/surface", surface, "number of the surface");
  out.array("/receivers/sides", sides, "1 front, 2 back, 3 both");
  out.array("/receivers/passes", passes, "0 or 1");
  out.array("/receivers/behind_glass", behind_glass, "0 or 1");
  out.array("/receivers/pixels", pixels, "columns, rows; 0: no map of pixels", {n, 2});
  out.strings("/receivers/chart", charts);
  out.array("/receivers/cell_offset", cell_offset, "1");
  out.array("/receivers/cells", cells, "m, m, m or rad, m or rad", {cells.size() / 4, 4});
  out.array("/receivers/size", size, "m", {n, 2});
  out.array("/receivers/frame", frame, "m, then unit vectors", {n, 12});
  out.array("/receivers/angle_bins", bins, "1");
  out.array("/receivers/angle_sine", sine, "1");
  out.array("/receivers/quadrants", quadrants, "0 or 1");
  out.array("/receivers/gap", gap, "m");
  out.array("/receivers/quadrant_frame", quadrant_frame, "m, then unit vectors", {n, 12});
}

namespace {

// Of maps without stated pixels, since schema 1.9.
void read_cells(hdf5::Reader const& in, RunContent& run) {
  if (!in.has("/receivers/cells")) return;
  auto const charts = in.strings("/receivers/chart");
  auto const all = in.rows<double>("/receivers/cells", in.shape("/receivers/cells").at(0), 4);
  if (charts.size() != run.receivers.size()) damaged_run("'/receivers/chart' has another number of rows");
  Counts const offset = read_offsets(in, "/receivers/cell_offset", run.receivers.size(), all.size() / 4);
  for (std::size_t i = 0; i < run.receivers.size(); ++i) {
    Receiver& r = run.receivers[i];
    auto const name = std::find(std::begin(chart_names), std::end(chart_names), charts[i]);
    r.by_light = name != std::end(chart_names);
    if (!r.by_light) continue;
    r.chart = Chart(name - std::begin(chart_names));
    std::vector<MapCell> cells;
    for (std::uint64_t c = offset[i]; c < offset[i + 1]; ++c)
      cells.push_back({all[4 * c], all[4 * c + 1], all[4 * c + 2], all[4 * c + 3]});
    r.cells = run.cells.keep(std::move(cells));
  }
}

}  // namespace

void read_receivers(hdf5::Reader const& in, std::size_t n, RunContent& run) {
  if (!in.has("/receivers")) return;
  run.beam_power = in.attribute_number("/receivers", "beam_power");
  auto const surface = in.rows<std::uint32_t>("/receivers/surface", n);
  auto const sides = in.rows<std::uint8_t>("/receivers/sides", n),
             passes = in.rows<std::uint8_t>("/receivers/passes", n),
             glass = in.rows<std::uint8_t>("/receivers/behind_glass", n),
             quadrants = in.rows<std::uint8_t>("/receivers/quadrants", n);
  auto const pixels = in.rows<std::uint32_t>("/receivers/pixels", n, 2);
  auto const size = in.rows<double>("/receivers/size", n, 2), frame = in.rows<double>("/receivers/frame", n, 12),
             sine = in.rows<double>("/receivers/angle_sine", n), gap = in.rows<double>("/receivers/gap", n),
             quadrant_frame = in.rows<double>("/receivers/quadrant_frame", n, 12);
  auto const bins = in.rows<std::uint32_t>("/receivers/angle_bins", n);
  for (std::size_t i = 0; i < n; ++i) {
    Receiver r;
    r.surface = {surface[i]};
    r.front = sides[i] & 1;
    r.back = sides[i] & 2;
    r.clear = passes[i];
    r.behind_glass = glass[i];
    r.columns = pixels[2 * i];
    r.rows = pixels[2 * i + 1];
    r.half_width = 0.5 * size[2 * i];
    r.half_height = 0.5 * size[2 * i + 1];
    r.frame = pose_at(frame, i);
    r.angle_bins = bins[i];
    r.half_angle_sine = sine[i];
    r.quadrants = quadrants[i];
    r.gap = gap[i];
    r.quadrant_frame = pose_at(quadrant_frame, i);
    run.receivers.push_back(r);
  }
  read_cells(in, run);
}

void write_maps_of(hdf5::Writer& out, BlockSums const& total) {
  out.group("/maps", "mean power per cell and history over that of the main mode, by receiver; nan: no light seen");
  for (int k = 0; k < 3; ++k) {
    Counts offset = {0};
    Doubles mean, error;
    for (ReceiverSums const& r : total.receivers) {
      CellEstimates const cells = cell_estimates(r.*maps[k], total.histories, total.blocks);
      append(mean, cells.mean);
      append(error, cells.error);
      offset.push_back(mean.size());
    }
    std::string const name = std::string("/maps/") + map_names[k];
    out.array(name + "_offset", offset, "1");
    out.array(name, mean, "1");
    out.array(name + "_error", error, "1");
  }
  FieldColumns fields;
  Small receiver;
  for (std::size_t i = 0; i < total.receivers.size(); ++i) {
    fields.add(total.receivers[i], total.histories > 0 ? 1 / double(total.histories) : 1);
    receiver.resize(fields.route.size(), std::uint32_t(i));
  }
  out.array("/maps/field_receiver", receiver, "row of /names/receivers");
  fields.write(out, "/maps/");
}

void write_node_maps(hdf5::Writer& out, SumTree const& tree) {
  Counts first = {0}, field_first = {0}, offset = {0};
  Doubles sum, sum2;
  FieldColumns fields;
  for (auto const& [place, node] : tree.nodes()) {
    for (ReceiverSums const& r : node.receivers) {
      for (auto const map : maps) {
        append(sum, (r.*map).sum);
        append(sum2, (r.*map).sum2);
        offset.push_back(sum.size());
      }
      fields.add(r);
      field_first.push_back(fields.route.size());
    }
    first.push_back(first.back() + node.receivers.size());
  }
  out.array("/nodes/receiver_offset", first, "1");
  out.array("/nodes/map_offset", offset, "1");
  out.array("/nodes/map_sum", sum, "1");
  out.array("/nodes/map_sum2", sum2, "1");
  out.array("/nodes/receiver_fields", field_first, "1");
  fields.write(out, "/nodes/");
}

void read_node_maps(hdf5::Reader const& in, std::vector<BlockSums>& nodes) {
  if (!in.has("/nodes/receiver_offset")) return;
  std::size_t const lists = in.shape("/nodes/map_offset").at(0), receivers = (lists - 1) / 3;
  Counts const first = read_offsets(in, "/nodes/receiver_offset", nodes.size(), receivers);
  Doubles const sum = in.array<double>("/nodes/map_sum"), sum2 = in.rows<double>("/nodes/map_sum2", sum.size());
  Counts const offset = read_offsets(in, "/nodes/map_offset", 3 * receivers, sum.size());
  FieldColumns const fields = FieldColumns::read(in, "/nodes/");
  Counts const field_first = read_offsets(in, "/nodes/receiver_fields", receivers, fields.route.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    nodes[i].receivers.resize(first[i + 1] - first[i]);
    for (std::size_t r = first[i]; r < first[i + 1]; ++r) {
      ReceiverSums& into = nodes[i].receivers[r - first[i]];
      for (std::size_t k = 0; k < 3; ++k) {
        auto const from = std::ptrdiff_t(offset[3 * r + k]), to = std::ptrdiff_t(offset[3 * r + k + 1]);
        (into.*maps[k]).sum.assign(sum.begin() + from, sum.begin() + to);
        (into.*maps[k]).sum2.assign(sum2.begin() + from, sum2.begin() + to);
      }
      for (std::size_t f = field_first[r]; f < field_first[r + 1]; ++f) into.fields[fields.route[f]] = fields.at(f);
    }
  }
}

// /importance: the tables that steered the trace.

void write_importance(hdf5::Writer& out, ImportanceMap const& map) {
  std::vector<std::uint32_t> group, patch;
  std::vector<double> z, area;
  for (ImportanceMap::Strip const& s : map.strips) {
    group.push_back(s.group);
    patch.push_back(s.patch);
    z.insert(z.end(), {s.low, s.high});
    area.push_back(s.area);
  }
  out.group("/importance", "what steered the trace: strips of surfaces, and the adjoint of each side of their patches");
  out.array("/importance/group", group, "row of /names/groups");
  out.array("/importance/patch", patch, "row of /importance/adjoint");
  out.array("/importance/z", z, "m", {map.strips.size(), 2});
  out.array("/importance/area", area, "m^2");
  out.array("/importance/adjoint", map.adjoint, "1", {map.adjoint.size() / 2, 2});
  out.array("/importance/law_share", map.law_share, "1", {map.law_share.size() / 2, 2});
}

ImportanceMap read_importance(hdf5::Reader const& in, std::size_t groups) {
  ImportanceMap map;
  if (!in.has("/importance")) return map;
  auto const group = in.array<std::uint32_t>("/importance/group");
  std::size_t const strips = group.size();
  auto const patch = in.rows<std::uint32_t>("/importance/patch", strips);
  auto const z = in.rows<double>("/importance/z", strips, 2), area = in.rows<double>("/importance/area", strips);
  map.adjoint = in.array<double>("/importance/adjoint", 2);
  map.law_share = in.rows<double>("/importance/law_share", map.adjoint.size() / 2, 2);
  for (std::size_t i = 0; i < strips; ++i) {
    if (patch[i] >= map.adjoint.size() / 2) damaged_run("'/importance/patch' names a patch that is not there");
    if (group[i] >= groups) damaged_run("'/importance/group' names a group that is not there");
    map.strips.push_back({group[i], patch[i], z[2 * i], z[2 * i + 1], area[i]});
  }
  return map;
}

}  // namespace straytrace::results
