// SPDX-License-Identifier: BSD-3-Clause
// /receivers, /maps and the maps of /nodes: light in watts.
#include <algorithm>
#include <span>

#include "base/errors.hpp"
#include "results/receivers/receivers.hpp"
#include "results/run_file/columns.hpp"

namespace straytrace::results {
namespace {

constexpr MapSums ReceiverSums::*maps[] = {&ReceiverSums::image, &ReceiverSums::angles, &ReceiverSums::quadrants};
constexpr char const* map_names[] = {"image", "angles", "quadrants"};
constexpr Doubles FieldSums::*field_parts[] = {&FieldSums::power, &FieldSums::real, &FieldSums::imaginary};
constexpr char const* part_names[] = {"field_power", "field_real", "field_imaginary"};
constexpr Vec3 Pose::*axes[] = {&Pose::origin, &Pose::e1, &Pose::e2, &Pose::e3};

void append(Doubles& into, Doubles const& values) { into.insert(into.end(), values.begin(), values.end()); }

auto pose_column(Pose Receiver::*pose) {
  using Numbers = std::array<double, 12>;
  auto const get = [pose](Receiver const& r) {
    Numbers all;
    double* to = all.data();
    for (auto const axis : axes)
      for (double const x : {(r.*pose.*axis).x, (r.*pose.*axis).y, (r.*pose.*axis).z}) *to++ = x;
    return all;
  };
  auto const set = [pose](Receiver& r, Numbers const& all) {
    double const* from = all.data();
    for (auto const axis : axes) {
      r.*pose.*axis = {from[0], from[1], from[2]};
      from += 3;
    }
  };
  return Converted{get, set};
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

namespace {

Converted const sides_column{[](Receiver const& r) { return std::uint8_t((r.front ? 1 : 0) + (r.back ? 2 : 0)); },
                             [](Receiver& r, std::uint8_t all) {
                               r.front = all & 1;
                               r.back = all & 2;
                             }};
Converted const pixels_column{[](Receiver const& r) {
                                return std::array{r.columns, r.rows};
                              },
                              [](Receiver& r, std::array<std::uint32_t, 2> const& n) {
                                r.columns = n[0];
                                r.rows = n[1];
                              }};
Converted const size_column{[](Receiver const& r) {
                              return std::array{2 * r.half_width, 2 * r.half_height};
                            },
                            [](Receiver& r, std::array<double, 2> const& whole) {
                              r.half_width = 0.5 * whole[0];
                              r.half_height = 0.5 * whole[1];
                            }};
Converted const chart_column{
    [](Receiver const& r) { return std::string(r.by_light ? chart_names[std::size_t(r.chart)] : ""); },
    [](Receiver& r, std::string const& word) {
      auto const name = std::find(std::begin(chart_names), std::end(chart_names), word);
      r.by_light = name != std::end(chart_names);
      if (r.by_light) r.chart = Chart(name - std::begin(chart_names));
    }};

template <class Column>
void receiver_columns(Column&& column) {
  column("surface", "number of the surface", through(&Receiver::surface, &SurfaceId::value));
  column("sides", "1 front, 2 back, 3 both", sides_column);
  column("passes", yes_or_no, &Receiver::clear);
  column("behind_glass", yes_or_no, &Receiver::behind_glass);
  column("pixels", "columns, rows; 0: no map of pixels", pixels_column);
  column("chart", "", chart_column, "");  // since schema 1.9
  column("size", "m", size_column);
  column("frame", "m, then unit vectors", pose_column(&Receiver::frame));
  column("angle_bins", "1", &Receiver::angle_bins);
  column("angle_sine", "1", &Receiver::half_angle_sine);
  column("quadrants", yes_or_no, &Receiver::quadrants);
  column("gap", "m", &Receiver::gap);
  column("quadrant_frame", "m, then unit vectors", pose_column(&Receiver::quadrant_frame));
}

template <class Column>
void power_columns(Column&& column) {
  column("mean", {"1", "power over that of the main mode; not reliable unless trusted"}, &Estimate::mean);
  column("std_error", {"1", "standard error of the mean"}, &Estimate::std_error);
  column("trusted", {yes_or_no, "whether the mean is reliable"}, &Estimate::trusted);
  column("why_not", {"", "why the mean is not reliable"}, &Estimate::why_not);
}

// Cells of maps without stated pixels.
template <class Column>
void cell_columns(Column&& column) {
  column("cells", "m, m, m or rad, m or rad",
         Converted{[](MapCell const& c) {
                     return std::array{c.u_low, c.u_high, c.v_low, c.v_high};
                   },
                   [](MapCell& c, std::array<double, 4> const& s) {
                     c = {s[0], s[1], s[2], s[3]};
                   }});
}

void read_cells(hdf5::Reader const& in, RunContent& run) {
  if (!in.has("/receivers/cells")) return;  // since schema 1.9
  std::vector<MapCell> all;
  cell_columns(ColumnReader(in, "/receivers/", all, RowCount::of_first_column));
  Counts const offset = read_offsets(in, "/receivers/cell_offset", run.receivers.size(), all.size());
  for (std::size_t i = 0; i < run.receivers.size(); ++i) {
    auto const from = all.begin() + std::ptrdiff_t(offset[i]), to = all.begin() + std::ptrdiff_t(offset[i + 1]);
    if (Receiver& r = run.receivers[i]; r.by_light) r.cells = run.cells.keep(std::vector<MapCell>(from, to));
  }
}

// Areas of pixels and cells, laid end to end.
void write_areas(hdf5::Writer& out, std::vector<Doubles> const& of_maps) {
  Counts offset = {0};
  Doubles areas;
  for (Doubles const& map : of_maps) {
    append(areas, map);
    offset.push_back(areas.size());
  }
  out.array("/receivers/area_offset", offset, "1");
  out.array("/receivers/area", areas, "m^2");
}

void read_areas(hdf5::Reader const& in, RunContent& run) {
  if (!in.has("/receivers/area")) return;  // since schema 2.1
  Doubles const areas = in.array<double>("/receivers/area");
  Counts const offset = read_offsets(in, "/receivers/area_offset", run.receivers.size(), areas.size());
  for (std::size_t i = 0; i < run.receivers.size(); ++i) {
    if (offset[i + 1] - offset[i] != run.receivers[i].map_size()) damaged_run("a map of other cells than its areas");
    run.map_areas.emplace_back(areas.begin() + std::ptrdiff_t(offset[i]),
                               areas.begin() + std::ptrdiff_t(offset[i + 1]));
  }
}

}  // namespace

void write_receivers(hdf5::Writer& out, RunContent const& run) {
  out.group("/receivers", "receivers and their maps; rows as in /names/receivers");
  out.attribute("/receivers", "beam_power", run.beam_power);
  power_columns(ColumnWriter(out, "/receivers/", run.trace->coupling.received_power));
  receiver_columns(ColumnWriter(out, "/receivers/", run.receivers));
  write_lists(
      out, "/receivers/cell_offset", "/receivers/", run.receivers,
      [](Receiver const& r) { return std::span(r.cells.data, r.cells.size); }, [](auto&& list) { cell_columns(list); });
  if (run.map_areas.size() == run.receivers.size()) write_areas(out, run.map_areas);
}

void read_receivers(hdf5::Reader const& in, std::size_t n, RunContent& run) {
  if (!in.has("/receivers")) return;
  run.beam_power = in.attribute_number("/receivers", "beam_power");
  run.receivers.resize(n);
  receiver_columns(ColumnReader(in, "/receivers/", run.receivers));
  read_cells(in, run);
  read_areas(in, run);
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

namespace {

template <class Column>
void strip_columns(Column&& column) {
  using Strip = ImportanceMap::Strip;
  column("group", "row of /names/groups", &Strip::group);
  column("patch", "row of /importance/adjoint", &Strip::patch);
  column("z", "m",
         Converted{[](Strip const& s) {
                     return std::array{s.low, s.high};
                   },
                   [](Strip& s, std::array<double, 2> const& z) {
                     s.low = z[0];
                     s.high = z[1];
                   }});
  column("area", "m^2", &Strip::area);
}

}  // namespace

void write_importance(hdf5::Writer& out, ImportanceMap const& map) {
  out.group("/importance",
            "importance tables that steered the trace: strips of surfaces, and the adjoint flux on both sides of their "
            "patches");
  strip_columns(ColumnWriter(out, "/importance/", map.strips));
  out.array("/importance/adjoint", map.adjoint, "1", {map.adjoint.size() / 2, 2});
  out.array("/importance/law_share", map.law_share, "1", {map.law_share.size() / 2, 2});
}

ImportanceMap read_importance(hdf5::Reader const& in, std::size_t groups) {
  ImportanceMap map;
  if (!in.has("/importance")) return map;
  strip_columns(ColumnReader(in, "/importance/", map.strips, RowCount::of_first_column));
  map.adjoint = in.array<double>("/importance/adjoint", 2);
  map.law_share = in.rows<double>("/importance/law_share", map.adjoint.size() / 2, 2);
  for (ImportanceMap::Strip const& s : map.strips) {
    if (s.patch >= map.adjoint.size() / 2) damaged_run("'/importance/patch' names a patch that is not there");
    if (s.group >= groups) damaged_run("'/importance/group' names a group that is not there");
  }
  return map;
}

}  // namespace straytrace::results
