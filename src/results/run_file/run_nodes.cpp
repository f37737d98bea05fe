// SPDX-License-Identifier: BSD-3-Clause
// /nodes: every node of the tree of sums, so that merging and resuming give the same bits as one long run.
#include "results/run_file/run_nodes.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace straytrace::results {
namespace {

struct ClassColumns {
  Counts offset = {0}, hash, kept_offset = {0}, kept_history;
  std::vector<std::uint32_t> port, kept_event, kept_connection;
  ScoreColumns moments;
  Doubles replica_sum, threshold, off_list, kept_coupling, kept_priority;
  PhaseSensitivityColumns phase_sensitivities;

  void add(std::uint64_t name, ClassSums const& c) {
    hash.push_back(name);
    port.push_back(c.port);
    moments.add(c.moments);
    replica_sum.insert(replica_sum.end(), c.replica_sum.begin(), c.replica_sum.end());
    threshold.push_back(c.threshold);
    off_list.push_back(c.off_list);
    for (ScoreAddress const& k : c.kept) {
      kept_history.push_back(k.history);
      kept_event.push_back(k.event);
      kept_connection.push_back(k.connection);
      kept_coupling.push_back(k.coupling);
      kept_priority.push_back(k.priority);
    }
    kept_offset.push_back(kept_history.size());
    phase_sensitivities.add(c.phase_sensitivities);
  }

  ClassSums at(std::size_t i) const {
    ClassSums c;
    c.port = port[i];
    c.moments = moments.at(i);
    std::copy_n(replica_sum.begin() + std::ptrdiff_t(replica_count * i), replica_count, c.replica_sum.begin());
    c.threshold = threshold[i];
    c.off_list = off_list[i];
    for (std::size_t k = kept_offset[i]; k < kept_offset[i + 1]; ++k)
      c.kept.push_back({kept_history[k], kept_event[k], kept_connection[k], kept_coupling[k], kept_priority[k]});
    c.phase_sensitivities = phase_sensitivities.at(i);
    return c;
  }

  void write(hdf5::Writer& out) const {
    out.array("/nodes/class_offset", offset, "1");
    out.array("/nodes/class_hash", hash, "1");
    out.array("/nodes/class_port", port, "row of /names/ports");
    moments.write(out, "/nodes/class_moments", "/nodes/class");
    out.array("/nodes/class_replica_sum", replica_sum, "1", {hash.size(), replica_count});
    out.array("/nodes/class_threshold", threshold, "1");
    out.array("/nodes/class_off_list", off_list, "1");
    out.array("/nodes/kept_offset", kept_offset, "1");
    out.array("/nodes/kept_history", kept_history, "1");
    out.array("/nodes/kept_event", kept_event, "1");
    out.array("/nodes/kept_connection", kept_connection, "1");
    out.array("/nodes/kept_coupling", kept_coupling, "1");
    out.array("/nodes/kept_priority", kept_priority, "1");
    phase_sensitivities.write(out);
  }

  static ClassColumns read(hdf5::Reader const& in, std::size_t nodes) {
    ClassColumns c;
    c.hash = in.array<std::uint64_t>("/nodes/class_hash");
    std::size_t const n = c.hash.size();
    c.offset = read_offsets(in, "/nodes/class_offset", nodes, n);
    c.port = in.rows<std::uint32_t>("/nodes/class_port", n);
    c.moments = ScoreColumns::read(in, "/nodes/class_moments", "/nodes/class", n);
    c.replica_sum = in.rows<double>("/nodes/class_replica_sum", n, replica_count);
    c.threshold = in.rows<double>("/nodes/class_threshold", n);
    c.off_list = in.has("/nodes/class_off_list") ? in.rows<double>("/nodes/class_off_list", n) : Doubles(n);
    c.kept_history = in.array<std::uint64_t>("/nodes/kept_history");
    std::size_t const kept = c.kept_history.size();
    c.kept_offset = read_offsets(in, "/nodes/kept_offset", n, kept);
    c.kept_event = in.rows<std::uint32_t>("/nodes/kept_event", kept);
    c.kept_connection = in.rows<std::uint32_t>("/nodes/kept_connection", kept);
    c.kept_coupling = in.rows<double>("/nodes/kept_coupling", kept);
    c.kept_priority = in.rows<double>("/nodes/kept_priority", kept);
    c.phase_sensitivities = PhaseSensitivityColumns::read(in, n);
    return c;
  }
};

// Lists of moments, one per node, laid end to end.
struct ListColumns {
  Counts offset = {0};
  MomentColumns moments;

  void add(std::vector<Moments> const& list) {
    for (Moments const& m : list) moments.add(m);
    offset.push_back(moments.numbers.size() / moment_counts);
  }
  void write(hdf5::Writer& out, std::string const& path) const {
    out.array(path + "_offset", offset, "1");
    moments.write(out, path, {offset.back()});
  }
  static ListColumns read(hdf5::Reader const& in, std::string const& path, std::size_t nodes) {
    if (!in.has(path)) return {Counts(nodes + 1), {}};
    ListColumns c;
    c.moments = MomentColumns::read(in, path, in.shape(path).at(0));
    c.offset = read_offsets(in, path + "_offset", nodes, c.moments.numbers.size() / moment_counts);
    return c;
  }
  std::vector<Moments> at(std::size_t node) const {
    std::vector<Moments> list;
    for (std::size_t k = offset[node]; k < offset[node + 1]; ++k) list.push_back(moments.at(k));
    return list;
  }
};

using Counter = std::uint64_t BlockSums::*;
struct NamedCounter {
  char const* name;
  Counter member;
};
constexpr NamedCounter counters[] = {{"histories", &BlockSums::histories},
                                     {"blocks", &BlockSums::blocks},
                                     {"bounces", &BlockSums::bounces},
                                     {"rays", &BlockSums::rays},
                                     {"lost", &BlockSums::lost}};

void write_counters(hdf5::Writer& out, SumTree const& tree) {
  for (NamedCounter const& counter : counters) {
    Counts column;
    for (auto const& [place, node] : tree.nodes()) column.push_back(node.*(counter.member));
    out.array(fmt::format("/nodes/{}", counter.name), column, "1");
  }
}

}  // namespace

void write_nodes(hdf5::Writer& out, SumTree const& tree) {
  Counts first;
  std::vector<std::uint32_t> level;
  MomentColumns emitted, energy_balance;
  ListColumns arrived, absorbed;
  ScoreColumns received;
  Doubles window_variance;
  ClassColumns classes;
  for (auto const& [place, node] : tree.nodes()) {
    first.push_back(place.first);
    level.push_back(place.second);
    emitted.add(node.emitted);
    for (Moments const& m : node.energy_balance) energy_balance.add(m);
    window_variance.push_back(node.window_variance);
    arrived.add(node.arrived);
    absorbed.add(node.absorbed);
    for (ReceiverSums const& r : node.receivers) received.add(r.power);
    for (auto const& [hash, c] : node.classes) classes.add(hash, c);
    classes.offset.push_back(classes.hash.size());
  }
  out.group("/nodes", "partial sums over blocks of histories, for merging and resuming");
  out.array("/nodes/first_block", first, "1");
  out.array("/nodes/level", level, "1");
  write_counters(out, tree);
  emitted.write(out, "/nodes/emitted", {first.size()});
  energy_balance.write(out, "/nodes/energy_balance", {first.size(), balance_term_count});
  out.array("/nodes/window_variance", window_variance, "1");
  arrived.write(out, "/nodes/arrived");
  absorbed.write(out, "/nodes/absorbed");
  classes.write(out);
  received.write(out, "/nodes/received", "/nodes/received");
  write_node_maps(out, tree);
}

namespace {

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

SumTree read_nodes(hdf5::Reader const& in) {
  auto const [first, level] = Places(in);
  std::size_t const n = first.size();
  MomentColumns const emitted = MomentColumns::read(in, "/nodes/emitted", n);
  MomentColumns const energy_balance = MomentColumns::read(in, "/nodes/energy_balance", n, balance_term_count);
  bool const odds = in.has("/nodes/window_variance");  // since schema 1.2
  Doubles const window_variance = odds ? in.rows<double>("/nodes/window_variance", n) : Doubles(n);
  ListColumns const arrived = ListColumns::read(in, "/nodes/arrived", n);
  ListColumns const absorbed = ListColumns::read(in, "/nodes/absorbed", n);  // since schema 1.3
  ClassColumns const classes = ClassColumns::read(in, n);

  std::vector<BlockSums> nodes(n);
  for (NamedCounter const& counter : counters) {
    Counts const column = in.rows<std::uint64_t>(fmt::format("/nodes/{}", counter.name), n);
    for (std::size_t i = 0; i < n; ++i) nodes[i].*(counter.member) = column[i];
  }
  read_node_maps(in, nodes);
  std::size_t receivers = 0, next = 0;
  for (BlockSums const& node : nodes) receivers += node.receivers.size();
  ScoreColumns const received =
      receivers > 0 ? ScoreColumns::read(in, "/nodes/received", "/nodes/received", receivers) : ScoreColumns{};
  for (BlockSums& node : nodes)
    for (ReceiverSums& r : node.receivers) r.power = received.at(next++);
  SumTree tree;
  for (std::size_t i = 0; i < n; ++i) {
    BlockSums& node = nodes[i];
    node.emitted = emitted.at(i);
    node.window_variance = window_variance[i];
    for (std::size_t k = 0; k < balance_term_count; ++k)
      node.energy_balance[k] = energy_balance.at(i * balance_term_count + k);
    node.arrived = arrived.at(i);
    node.absorbed = absorbed.at(i);
    for (std::size_t k = classes.offset[i]; k < classes.offset[i + 1]; ++k)
      node.classes.emplace(classes.hash[k], classes.at(k));
    tree.add(level[i], first[i] >> level[i], std::move(node));
  }
  return tree;
}

namespace {

constexpr std::size_t products_each = std::tuple_size_v<decltype(PhaseSensitivityProduct::sum)>;

}  // namespace

void ProductColumns::add(PhaseSensitivityProduct const& p) {
  replica.push_back(p.replica);
  body.insert(body.end(), {p.first.value, p.second.value});
  sum.insert(sum.end(), p.sum.begin(), p.sum.end());
}

PhaseSensitivityProduct ProductColumns::at(std::size_t i) const {
  PhaseSensitivityProduct p{replica[i], {body[2 * i]}, {body[2 * i + 1]}};
  std::copy_n(sum.begin() + std::ptrdiff_t(products_each * i), products_each, p.sum.begin());
  return p;
}

void ProductColumns::write(hdf5::Writer& out, std::string const& path) const {
  out.array(path + "_replica", replica, "1");
  out.array(path + "_body", body, "row of /names/bodies", {rows(), 2});
  out.array(path, sum, "products of 3 x rad/m, 3 x rad/rad", {rows(), products_each});
}

ProductColumns ProductColumns::read(hdf5::Reader const& in, std::string const& path) {
  ProductColumns c;
  c.replica = in.array<std::uint32_t>(path + "_replica");
  c.body = in.rows<std::uint32_t>(path + "_body", c.rows(), 2);
  c.sum = in.rows<double>(path, c.rows(), products_each);
  for (std::uint32_t const r : c.replica)
    if (r >= replica_count) damaged_run("a product of phase sensitivities of an unknown replica");
  return c;
}

void PhaseSensitivityColumns::add(PhaseSensitivitySums const& s) {
  paths.push_back(s.paths);
  given_up.push_back(s.given_up);
  weight.insert(weight.end(), s.weight.begin(), s.weight.end());
  for (PhaseSensitivityProduct const& p : s.products) products.add(p);
  offset.push_back(products.rows());
}

PhaseSensitivitySums PhaseSensitivityColumns::at(std::size_t i) const {
  PhaseSensitivitySums s;
  s.paths = paths[i];
  s.given_up = given_up[i] != 0;
  std::copy_n(weight.begin() + std::ptrdiff_t(replica_count * i), replica_count, s.weight.begin());
  for (std::size_t k = offset[i]; k < offset[i + 1]; ++k) s.products.push_back(products.at(k));
  return s;
}

void PhaseSensitivityColumns::write(hdf5::Writer& out) const {
  out.array("/nodes/phase_sensitivity_paths", paths, "1");
  out.array("/nodes/phase_sensitivity_given_up", given_up, "0 or 1");
  out.array("/nodes/phase_sensitivity_weight", weight, "1", {paths.size(), replica_count});
  out.array("/nodes/phase_sensitivity_offset", offset, "1");
  products.write(out, "/nodes/phase_sensitivity_product");
}

PhaseSensitivityColumns PhaseSensitivityColumns::read(hdf5::Reader const& in, std::size_t rows) {
  PhaseSensitivityColumns c;
  if (!in.has("/nodes/phase_sensitivity_paths")) {
    c.paths = c.offset = Counts(rows + 1);
    c.given_up.assign(rows, 1);
    c.weight.resize(rows * replica_count);
    return c;
  }
  c.paths = in.rows<std::uint64_t>("/nodes/phase_sensitivity_paths", rows);
  c.given_up = in.rows<std::uint8_t>("/nodes/phase_sensitivity_given_up", rows);
  c.weight = in.rows<double>("/nodes/phase_sensitivity_weight", rows, replica_count);
  c.products = ProductColumns::read(in, "/nodes/phase_sensitivity_product");
  c.offset = read_offsets(in, "/nodes/phase_sensitivity_offset", rows, c.products.rows());
  return c;
}

void write_phase_sensitivity_moments(hdf5::Writer& out, CouplingTable const& table) {
  std::vector<std::uint32_t> owner;
  ProductColumns products;
  for (std::size_t i = 0; i < table.classes.size(); ++i)
    for (PhaseSensitivityProduct const& p : table.classes[i].phase_sensitivities) {
      owner.push_back(std::uint32_t(i));
      products.add(p);
    }
  out.group("/phase_sensitivities",
            "mean coupling times mean product of two phase sensitivities, contributions of the replicas");
  out.array("/phase_sensitivities/class", owner, "row of /classes");
  products.write(out, "/phase_sensitivities/product");
}

void read_phase_sensitivity_moments(hdf5::Reader const& in, CouplingTable& table) {
  if (!in.has("/phase_sensitivities")) return;  // since schema 1.8
  ProductColumns const products = ProductColumns::read(in, "/phase_sensitivities/product");
  auto const owner = in.rows<std::uint32_t>("/phase_sensitivities/class", products.rows());
  for (std::size_t i = 0; i < owner.size(); ++i) {
    PhaseSensitivityProduct const p = products.at(i);
    if (owner[i] >= table.classes.size() || std::max(p.first.value, p.second.value) >= table.bodies.size())
      damaged_run("a product of phase sensitivities without a route or a body");
    table.classes[owner[i]].phase_sensitivities.push_back(p);
  }
}

}  // namespace straytrace::results
