// SPDX-License-Identifier: BSD-3-Clause
// /nodes: every node of the tree of sums, so that merging and resuming give the same bits as one long run.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/math/constants.hpp"
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

}  // namespace straytrace::results
