// SPDX-License-Identifier: BSD-3-Clause
// /nodes: every node of the tree of sums, so that merging and resuming give the same bits as one long run; /receivers.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "results/receivers/receivers.hpp"
#include "results/run_file/columns.hpp"

namespace straytrace::results {
namespace {

using MomentSums = std::array<double, 6>;
using MomentCounts = std::array<std::uint64_t, 2>;

MomentSums sums_of(Moments const& m) { return {m.sum, m.sum2, m.sum3, m.sum4, m.block_sum2, m.largest}; }
MomentCounts counts_of(Moments const& m) { return {m.largest_history, m.scored}; }

void set_sums(Moments& m, double const* v, std::string const& path) {
  if (!std::all_of(v, v + std::tuple_size_v<MomentSums>, [](double x) { return std::isfinite(x); }))
    damaged_run(fmt::format("'{}' holds a sum that is not a number", path));
  m.sum = v[0];
  m.sum2 = v[1];
  m.sum3 = v[2];
  m.sum4 = v[3];
  m.block_sum2 = v[4];
  m.largest = v[5];
}
void set_counts(Moments& m, std::uint64_t const* n) {
  m.largest_history = n[0];
  m.scored = n[1];
}

// `of`: the moments in a row; `path`: of the column, for messages.
template <class Column, class Of>
void moment_columns(Column&& column, std::string const& name, Of const& of, std::string const& path) {
  column(name, "1",
         Converted{[of](auto const& row) { return sums_of(std::invoke(of, row)); },
                   [of, path](auto& row, MomentSums const& v) { set_sums(std::invoke(of, row), v.data(), path); }});
  column(name + "_counts", "1",
         Converted{[of](auto const& row) { return counts_of(std::invoke(of, row)); },
                   [of](auto& row, MomentCounts const& n) { set_counts(std::invoke(of, row), n.data()); }});
}

template <class Column>
void number_column(Column&& column) {
  column("", "1", std::identity{});
}

// Further columns of scores: the largest of each row, and its sum over the first blocks. Files of schema 1.1 lack both:
// they read as an infinite score and a NaN.
template <class Row, class Of>
void write_scores(hdf5::Writer& out, std::string const& name, std::vector<Row> const& rows, Of const& of) {
  ColumnWriter(out, name, rows)(
      "_first_sum", "1", [of](auto& row) -> auto& { return of(row).first_sum; });
  write_lists(
      out, name + "_largest_offset", name + "_largest", rows, [of](auto& row) -> auto& { return of(row).tail; },
      [](auto&& list) { number_column(list); });
}

template <class Row, class Of>
void read_scores(hdf5::Reader const& in, std::string const& name, std::vector<Row>& rows, Of const& of) {
  ColumnReader(in, name, rows)(
      "_first_sum", "1", [of](auto& row) -> auto& { return of(row).first_sum; }, not_a_number);
  auto const tail = [of](auto& row) -> auto& { return of(row).tail; };
  if (in.has(name + "_first_sum"))
    read_lists(in, name + "_largest_offset", name + "_largest", rows, tail, [](auto&& list) { number_column(list); });
  else
    for (Row& row : rows) tail(row) = {infinity};
}

// A route of a node: its hash and its sums.
using NamedClass = std::pair<std::uint64_t, ClassSums>;

constexpr auto class_sums = [](auto& c) -> auto& { return c.second; };
constexpr auto class_moments = [](auto& c) -> auto& { return c.second.moments; };
constexpr auto class_sensitivities = [](auto& c) -> auto& { return c.second.phase_sensitivities; };

template <class Column>
void class_columns_of_nodes(Column&& column) {
  column(
      "hash", "1", [](auto& c) -> auto& { return c.first; });
  column("port", "row of /names/ports", through(class_sums, &ClassSums::port));
  moment_columns(column, "moments", class_moments, "/nodes/class_moments");
  column("replica_sum", "1", through(class_sums, &ClassSums::replica_sum));
  column("threshold", "1", through(class_sums, &ClassSums::threshold));
  column("off_list", "1", through(class_sums, &ClassSums::off_list), 0.0);
}

template <class Column>
void kept_columns(Column&& column) {
  column("history", "1", &ScoreAddress::history);
  column("event", "1", &ScoreAddress::event);
  column("connection", "1", &ScoreAddress::connection);
  column("coupling", "1", &ScoreAddress::coupling);
  column("priority", "1", &ScoreAddress::priority);
}

template <class Column>
void sensitivity_columns(Column&& column) {
  column("paths", "1", through(class_sensitivities, &PhaseSensitivitySums::paths));
  column("given_up", yes_or_no, through(class_sensitivities, &PhaseSensitivitySums::given_up));
  column("weight", "1", through(class_sensitivities, &PhaseSensitivitySums::weight));
}

constexpr char const *sensitivity = "/nodes/phase_sensitivity_", *products = "/nodes/phase_sensitivity_product",
                     *product_offset = "/nodes/phase_sensitivity_offset";

void write_classes_of(hdf5::Writer& out, std::vector<BlockSums const*> const& nodes) {
  auto const classes = end_to_end(nodes, &BlockSums::classes);
  out.array("/nodes/class_offset", classes.offset, "1");
  class_columns_of_nodes(ColumnWriter(out, "/nodes/class_", classes.items));
  write_scores(out, "/nodes/class", classes.items, class_moments);
  write_lists(out, "/nodes/kept_offset", "/nodes/kept_", classes.items, through(class_sums, &ClassSums::kept),
              [](auto&& list) { kept_columns(list); });
  sensitivity_columns(ColumnWriter(out, sensitivity, classes.items));
  write_lists(out, product_offset, products, classes.items,
              through(class_sensitivities, &PhaseSensitivitySums::products),
              [](auto&& list) { product_columns(list); });
}

void read_classes_of(hdf5::Reader const& in, std::vector<BlockSums>& nodes) {
  std::vector<NamedClass> classes;
  class_columns_of_nodes(ColumnReader(in, "/nodes/class_", classes, RowCount::of_first_column));
  Counts const offset = read_offsets(in, "/nodes/class_offset", nodes.size(), classes.size());
  read_scores(in, "/nodes/class", classes, class_moments);
  read_lists(in, "/nodes/kept_offset", "/nodes/kept_", classes, through(class_sums, &ClassSums::kept),
             [](auto&& list) { kept_columns(list); });
  if (in.has("/nodes/phase_sensitivity_paths")) {
    sensitivity_columns(ColumnReader(in, sensitivity, classes));
    read_lists(in, product_offset, products, classes, through(class_sensitivities, &PhaseSensitivitySums::products),
               [](auto&& list) { product_columns(list); });
  } else {  // below schema 1.8: their sums are given up
    for (NamedClass& c : classes) class_sensitivities(c).given_up = true;
  }
  for (NamedClass const& c : classes)
    for (PhaseSensitivityProduct const& p : class_sensitivities(c).products)
      if (p.replica >= replica_count) damaged_run("a product of phase sensitivities of an unknown replica");
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t k = offset[i]; k < offset[i + 1]; ++k)
      nodes[i].classes.emplace(classes[k].first, std::move(classes[k].second));
}

template <class Column>
void node_columns(Column&& column) {
  column("histories", "1", &BlockSums::histories);
  column("blocks", "1", &BlockSums::blocks);
  column("bounces", "1", &BlockSums::bounces);
  column("rays", "1", &BlockSums::rays);
  column("lost", "1", &BlockSums::lost);
  moment_columns(column, "emitted", &BlockSums::emitted, "/nodes/emitted");
  column("window_variance", "1", &BlockSums::window_variance, 0.0);  // since schema 1.2
}

constexpr char const* balance = "/nodes/energy_balance";

void write_balance(hdf5::Writer& out, std::vector<BlockSums const*> const& nodes) {
  Doubles sums;
  Counts counts;
  for (BlockSums const* node : nodes)
    for (Moments const& m : node->energy_balance) {
      for (double const x : sums_of(m)) sums.push_back(x);
      for (std::uint64_t const n : counts_of(m)) counts.push_back(n);
    }
  out.array(balance, sums, "1", {nodes.size(), balance_term_count, std::tuple_size_v<MomentSums>});
  out.array(std::string(balance) + "_counts", counts, "1",
            {nodes.size(), balance_term_count, std::tuple_size_v<MomentCounts>});
}

void read_balance(hdf5::Reader const& in, std::vector<BlockSums>& nodes) {
  constexpr std::size_t terms = balance_term_count, doubles = std::tuple_size_v<MomentSums>,
                        integers = std::tuple_size_v<MomentCounts>;
  Doubles const sums = in.rows<double>(balance, nodes.size(), terms * doubles);
  Counts const counts = in.rows<std::uint64_t>(std::string(balance) + "_counts", nodes.size(), terms * integers);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t k = 0; k < terms; ++k) {
      set_sums(nodes[i].energy_balance[k], &sums[(terms * i + k) * doubles], balance);
      set_counts(nodes[i].energy_balance[k], &counts[(terms * i + k) * integers]);
    }
}

// Moments by group; `absorbed` since schema 1.3.
constexpr std::pair<char const*, std::vector<Moments> BlockSums::*> group_lists[] = {
    {"/nodes/arrived", &BlockSums::arrived}, {"/nodes/absorbed", &BlockSums::absorbed}};
auto list_of_moments(std::string const& path) {
  return [path](auto&& column) { moment_columns(column, "", std::identity{}, path); };
}
constexpr auto received_power = [](auto& r) -> auto& { return r.power; };

// Of each node, its first block and its level.
struct Places {
  Counts first;
  std::vector<std::uint32_t> level;

  explicit Places(hdf5::Reader const& in)
      : first(in.array<std::uint64_t>("/nodes/first_block")),
        level(in.rows<std::uint32_t>("/nodes/level", first.size())) {
    for (std::size_t i = 0; i < first.size(); ++i)
      if (level[i] > 52 || (first[i] >> level[i]) << level[i] != first[i])
        damaged_run("a node has an impossible place");
  }
};

}  // namespace

std::vector<BlockRange> read_done(hdf5::Reader const& in) {
  auto const [first, level] = Places(in);
  SumTree places;
  for (std::size_t i = 0; i < first.size(); ++i) places.add(level[i], first[i] >> level[i], {});
  return places.done();
}

void write_nodes(hdf5::Writer& out, SumTree const& tree) {
  Counts first;
  Small level;
  std::vector<BlockSums const*> nodes;
  for (auto const& [place, node] : tree.nodes()) {
    first.push_back(place.first);
    level.push_back(place.second);
    nodes.push_back(&node);
  }
  out.group("/nodes", "partial sums over blocks of histories, for merging and resuming");
  out.array("/nodes/first_block", first, "1");
  out.array("/nodes/level", level, "1");
  node_columns(ColumnWriter(out, "/nodes/", nodes));
  write_balance(out, nodes);
  for (auto const& [path, list] : group_lists)
    write_lists(out, std::string(path) + "_offset", path, nodes, list, list_of_moments(path));
  write_classes_of(out, nodes);
  auto const receivers = end_to_end(nodes, &BlockSums::receivers).items;
  moment_columns(ColumnWriter(out, "/nodes/received", receivers), "", received_power, "/nodes/received");
  write_scores(out, "/nodes/received", receivers, received_power);
  write_node_maps(out, tree);
}

namespace {

// Of the receivers of all nodes, which have their maps.
void read_received(hdf5::Reader const& in, std::vector<BlockSums>& nodes) {
  std::vector<ReceiverSums> all;
  for (BlockSums& node : nodes)
    for (ReceiverSums& r : node.receivers) all.push_back(std::move(r));
  if (all.empty()) return;
  moment_columns(ColumnReader(in, "/nodes/received", all), "", received_power, "/nodes/received");
  read_scores(in, "/nodes/received", all, received_power);
  auto next = all.begin();
  for (BlockSums& node : nodes)
    for (ReceiverSums& r : node.receivers) r = std::move(*next++);
}

}  // namespace

SumTree read_nodes(hdf5::Reader const& in) {
  auto const [first, level] = Places(in);
  std::vector<BlockSums> nodes(first.size());
  node_columns(ColumnReader(in, "/nodes/", nodes));
  read_balance(in, nodes);
  for (auto const& [path, list] : group_lists)
    if (in.has(path)) read_lists(in, std::string(path) + "_offset", path, nodes, list, list_of_moments(path));
  read_classes_of(in, nodes);
  read_node_maps(in, nodes);
  read_received(in, nodes);
  SumTree tree;
  for (std::size_t i = 0; i < nodes.size(); ++i) tree.add(level[i], first[i] >> level[i], std::move(nodes[i]));
  return tree;
}

// /receivers, /maps and the maps of /nodes: light in watts.

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
