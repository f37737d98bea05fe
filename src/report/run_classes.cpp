// SPDX-License-Identifier: BSD-3-Clause
// /names, /classes, /records: the coupling table.
#include <algorithm>

#include "base/message.hpp"
#include "report/run_parts.hpp"

namespace straytrace {
namespace {

using Doubles = std::vector<double>;
using Counts = std::vector<std::uint64_t>;
using Small = std::vector<std::uint32_t>;
using Bytes = std::vector<std::uint8_t>;

// One column: the same member of every row.
template <class T, class Row, class Get>
std::vector<T> column(std::vector<Row> const& rows, Get const& get) {
  std::vector<T> values;
  values.reserve(rows.size());
  for (Row const& row : rows) values.push_back(T(get(row)));
  return values;
}

void check_ids(Small const& ids, std::size_t names, char const* what) {
  for (std::uint32_t const id : ids)
    if (id >= names) damaged_run(std::string(what) + " without a name");
}

void write_steps(hdf5::Writer& out, CouplingTable const& table) {
  Counts offset = {0};
  Small group;
  Bytes event;
  for (CouplingClass const& c : table.classes) {
    for (PathStep const& s : c.steps) {
      group.push_back(s.group.value);
      event.push_back(std::uint8_t(s.event));
    }
    offset.push_back(group.size());
  }
  out.array("/classes/step_offset", offset, "1");
  out.array("/classes/step_group", group, "row of /names/groups");
  out.array("/classes/step_event", event, "0 emit, 1 scatter, 2 reflect, 3 couple");
}

void write_class_columns(hdf5::Writer& out, CouplingTable const& table) {
  std::vector<CouplingClass> const& rows = table.classes;
  auto number = [&](char const* name, auto const& get) {
    out.array(std::string("/classes/") + name, column<double>(rows, get), "1");
  };
  out.array("/classes/hash", column<std::uint64_t>(rows, [](auto& c) { return c.hash; }), "1");
  out.strings("/classes/name", column<std::string>(rows, [&](auto& c) { return route_name(table, c); }));
  out.array("/classes/port", column<std::uint32_t>(rows, [](auto& c) { return c.port.value; }), "row of /names/ports");
  write_steps(out, table);
  number("reverse", [](auto& c) { return c.reverse; });
  number("mean", [](auto& c) { return c.coupling.mean; });
  number("std_error", [](auto& c) { return c.coupling.std_error; });
  number("variance_of_variance", [](auto& c) { return c.coupling.variance_of_variance; });
  number("largest_share", [](auto& c) { return c.coupling.largest_share; });
  number("effective_scores", [](auto& c) { return c.coupling.effective_scores; });
  out.array("/classes/scored", column<std::uint64_t>(rows, [](auto& c) { return c.coupling.scored; }), "1");
  out.array("/classes/trusted", column<std::uint8_t>(rows, [](auto& c) { return c.coupling.trusted; }), "0 or 1");
  out.strings("/classes/why_not", column<std::string>(rows, [](auto& c) { return c.coupling.why_not; }));
  Doubles replicas;
  for (CouplingClass const& c : rows) replicas.insert(replicas.end(), c.replica_sum.begin(), c.replica_sum.end());
  out.array("/classes/replica_sum", replicas, "1", {rows.size(), replica_count});
  out.array("/classes/replica_histories", Counts(table.replica_histories.begin(), table.replica_histories.end()), "1");
}

void write_levers(hdf5::Writer& out, std::vector<PathRecord> const& rows) {
  Counts offset = {0};
  Small body;
  Doubles d;
  for (PathRecord const& r : rows) {
    for (Lever const& l : r.levers) {
      body.push_back(l.body.value);
      d.insert(d.end(), std::begin(l.d), std::end(l.d));
    }
    offset.push_back(body.size());
  }
  out.array("/records/lever_offset", offset, "1");
  out.array("/records/lever_body", body, "row of /names/bodies");
  out.array("/records/lever", d, "3 x rad/m, 3 x rad/rad", {body.size(), 6});
}

void write_records(hdf5::Writer& out, CouplingTable const& table) {
  Small owner;
  std::vector<PathRecord> rows;
  for (std::size_t i = 0; i < table.classes.size(); ++i)
    for (PathRecord const& r : table.classes[i].records) {
      owner.push_back(std::uint32_t(i));
      rows.push_back(r);
    }
  out.group("/records", "kept paths with address, weight and levers");
  out.array("/records/class", owner, "row of /classes");
  out.array("/records/history", column<std::uint64_t>(rows, [](auto& r) { return r.history; }), "1");
  out.array("/records/event", column<std::uint32_t>(rows, [](auto& r) { return r.event; }), "1");
  out.array("/records/connection", column<std::uint32_t>(rows, [](auto& r) { return r.connection; }), "1");
  out.array("/records/coupling", column<double>(rows, [](auto& r) { return r.coupling; }), "1");
  out.array("/records/weight", column<double>(rows, [](auto& r) { return r.weight; }), "1");
  out.array("/records/path_length", column<double>(rows, [](auto& r) { return r.path_length; }), "m");
  write_levers(out, rows);
}

void read_steps(hdf5::Reader const& in, CouplingTable& table) {
  Small const group = in.array<std::uint32_t>("/classes/step_group");
  Bytes const event = in.rows<std::uint8_t>("/classes/step_event", group.size());
  Counts const offset = read_offsets(in, "/classes/step_offset", table.classes.size(), group.size());
  check_ids(group, table.groups.size(), "a group");
  for (std::size_t i = 0; i < table.classes.size(); ++i)
    for (std::size_t k = offset[i]; k < offset[i + 1]; ++k) {
      if (event[k] > std::uint8_t(Event::couple)) damaged_run("a step of unknown kind");
      table.classes[i].steps.push_back({{group[k]}, Event(event[k])});
    }
}

void read_class_columns(hdf5::Reader const& in, CouplingTable& table) {
  Counts const hash = in.array<std::uint64_t>("/classes/hash");
  std::size_t const n = hash.size();
  table.classes.resize(n);
  auto number = [&](char const* name) { return in.rows<double>(std::string("/classes/") + name, n); };
  Small const port = in.rows<std::uint32_t>("/classes/port", n);
  check_ids(port, table.ports.size(), "a port");
  Doubles const reverse = number("reverse"), mean = number("mean"), error = number("std_error"),
                vov = number("variance_of_variance"), largest = number("largest_share"),
                effective = number("effective_scores"),
                replicas = in.rows<double>("/classes/replica_sum", n, replica_count);
  Counts const scored = in.rows<std::uint64_t>("/classes/scored", n);
  Bytes const trusted = in.rows<std::uint8_t>("/classes/trusted", n);
  std::vector<std::string> const why = in.strings("/classes/why_not", n);
  for (std::size_t i = 0; i < n; ++i) {
    CouplingClass& c = table.classes[i];
    c.hash = hash[i];
    c.port = {port[i]};
    c.reverse = reverse[i];
    c.coupling = {mean[i], error[i], vov[i], largest[i], effective[i], scored[i], trusted[i] != 0, why[i]};
    std::copy_n(replicas.begin() + std::ptrdiff_t(i * replica_count), replica_count, c.replica_sum.begin());
  }
  Counts const histories = in.rows<std::uint64_t>("/classes/replica_histories", replica_count);
  std::copy(histories.begin(), histories.end(), table.replica_histories.begin());
}

void read_records(hdf5::Reader const& in, CouplingTable& table) {
  Small const owner = in.array<std::uint32_t>("/records/class");
  std::size_t const n = owner.size();
  check_ids(owner, table.classes.size(), "a path of a route");
  Counts const history = in.rows<std::uint64_t>("/records/history", n);
  Small const event = in.rows<std::uint32_t>("/records/event", n);
  Small const connection = in.rows<std::uint32_t>("/records/connection", n);
  Doubles const coupling = in.rows<double>("/records/coupling", n), weight = in.rows<double>("/records/weight", n),
                length = in.rows<double>("/records/path_length", n);
  Small const body = in.array<std::uint32_t>("/records/lever_body");
  check_ids(body, table.bodies.size(), "a body");
  Counts const offset = read_offsets(in, "/records/lever_offset", n, body.size());
  Doubles const lever = in.rows<double>("/records/lever", body.size(), 6);
  for (std::size_t i = 0; i < n; ++i) {
    PathRecord r{history[i], event[i], connection[i], coupling[i], weight[i], length[i], {}};
    for (std::size_t k = offset[i]; k < offset[i + 1]; ++k) {
      Lever l{{body[k]}, {}};
      std::copy_n(lever.begin() + std::ptrdiff_t(6 * k), 6, std::begin(l.d));
      r.levers.push_back(l);
    }
    table.classes[owner[i]].records.push_back(std::move(r));
  }
}

}  // namespace

void write_classes(hdf5::Writer& out, CouplingTable const& table) {
  out.group("/names", "names of ids; an id is a row number");
  out.strings("/names/groups", table.groups);
  out.strings("/names/bodies", table.bodies);
  out.strings("/names/ports", table.ports);
  out.group("/classes",
            "one row per route of stray light; couplings of ordered paths, power fraction rejoining the port");
  out.attribute("/classes", "wavelength", table.wavelength);
  out.attribute("/classes", "reverse_routes", std::vector<std::uint64_t>{table.reverse_routes});
  write_class_columns(out, table);
  write_records(out, table);
}

CouplingTable read_classes(hdf5::Reader const& in) {
  CouplingTable table;
  table.groups = in.strings("/names/groups");
  table.bodies = in.strings("/names/bodies");
  table.ports = in.strings("/names/ports");
  table.wavelength = in.attribute_number("/classes", "wavelength");
  table.reverse_routes = in.attribute_count("/classes", "reverse_routes") != 0;
  table.seed = in.attribute_count("/", "seed");
  table.histories = in.attribute_count("/", "histories");
  read_class_columns(in, table);
  read_steps(in, table);
  read_records(in, table);
  return table;
}

}  // namespace straytrace
