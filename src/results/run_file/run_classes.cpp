// SPDX-License-Identifier: BSD-3-Clause
// /names, /classes, /records: the coupling table; /received and /received_records: the same for receivers.
#include <algorithm>

#include "base/errors.hpp"
#include "results/run_file/run_file.hpp"
#include "results/run_file/run_nodes.hpp"

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

// Where a list of routes stands in the file, and what its routes end on.
struct Section {
  std::string classes, records, folded, end;  // groups, column
  std::vector<CouplingClass> CouplingTable::*list;
  std::vector<std::string> CouplingTable::*ends;
};
Section const to_ports{"/classes", "/records", "/folded", "port", &CouplingTable::classes, &CouplingTable::ports};
Section const to_receivers{"/received", "/received_records",      "/received_folded",
                           "receiver",  &CouplingTable::received, &CouplingTable::receivers};

template <class Row>
void write_steps(hdf5::Writer& out, std::string const& place, std::vector<Row> const& rows) {
  Counts offset = {0};
  Small group;
  Bytes event;
  for (Row const& c : rows) {
    for (PathStep const& s : c.steps) {
      group.push_back(s.group.value);
      event.push_back(std::uint8_t(s.event));
    }
    offset.push_back(group.size());
  }
  out.array(place + "/step_offset", offset, "1");
  out.array(place + "/step_group", group, "row of /names/groups");
  out.array(place + "/step_event", event,
            "0 emit, 1 scatter, 2 reflect, 3 couple, 4 transmit, 5 receive, 6 start of a free beam, 7 diffract");
}

void write_class_columns(hdf5::Writer& out, Section const& at, CouplingTable const& table) {
  std::vector<CouplingClass> const& rows = table.*at.list;
  std::string const place = at.classes + "/";
  auto number = [&](char const* name, auto const& get) { out.array(place + name, column<double>(rows, get), "1"); };
  out.array(place + "hash", column<std::uint64_t>(rows, [](auto& c) { return c.hash; }), "1");
  out.strings(place + "name", column<std::string>(rows, [&](auto& c) {
                return at.list == to_ports.list ? route_name(table, c) : received_name(table, c);
              }));
  out.array(place + at.end, column<std::uint32_t>(rows, [](auto& c) { return c.port.value; }),
            "row of /names/" + at.end + "s");
  write_steps(out, at.classes, rows);
  out.array(place + "kind", column<std::uint8_t>(rows, [](auto& c) { return c.kind; }), "0 scattered, 1 ghost, 2 edge");
  out.strings(place + "statement", column<std::string>(rows, [](auto& c) { return c.statement; }));
  number("reverse", [](auto& c) { return c.reverse; });
  out.array(place + "by_reverse", column<std::uint8_t>(rows, [](auto& c) { return c.by_reverse; }), "0 or 1");
  number("mean", [](auto& c) { return c.coupling.mean; });
  number("std_error", [](auto& c) { return c.coupling.std_error; });
  number("variance_of_variance", [](auto& c) { return c.coupling.variance_of_variance; });
  number("largest_share", [](auto& c) { return c.coupling.largest_share; });
  number("effective_scores", [](auto& c) { return c.coupling.effective_scores; });
  number("tail_slope", [](auto& c) { return c.coupling.tail_slope; });
  number("halves", [](auto& c) { return c.coupling.halves; });
  out.array(place + "scored", column<std::uint64_t>(rows, [](auto& c) { return c.coupling.scored; }), "1");
  out.array(place + "trusted", column<std::uint8_t>(rows, [](auto& c) { return c.coupling.trusted; }), "0 or 1");
  out.strings(place + "why_not", column<std::string>(rows, [](auto& c) { return c.coupling.why_not; }));
  out.array(place + "folded_routes", column<std::uint64_t>(rows, [](auto& c) { return c.folded_routes; }), "1");
  Doubles replicas;
  for (CouplingClass const& c : rows) replicas.insert(replicas.end(), c.replica_sum.begin(), c.replica_sum.end());
  out.array(place + "replica_sum", replicas, "1", {rows.size(), replica_count});
}

// What rows `other` sum: the largest routes of each.
void write_folded(hdf5::Writer& out, Section const& at, CouplingTable const& table) {
  Small owner;
  std::vector<FoldedRoute> rows;
  for (std::size_t i = 0; i < (table.*at.list).size(); ++i)
    for (FoldedRoute const& f : (table.*at.list)[i].folded) {
      owner.push_back(std::uint32_t(i));
      rows.push_back(f);
    }
  std::string const place = at.folded + "/";
  out.group(at.folded, "the largest routes in rows 'other', and why they have no row of their own");
  out.array(place + "class", owner, "row of " + at.classes);
  out.array(place + "hash", column<std::uint64_t>(rows, [](auto& f) { return f.hash; }), "1");
  out.strings(place + "name", column<std::string>(rows, [&](auto& f) { return folded_name(table, f); }));
  write_steps(out, at.folded, rows);
  out.array(place + "mean", column<double>(rows, [](auto& f) { return f.mean; }), "1");
  out.array(place + "std_error", column<double>(rows, [](auto& f) { return f.std_error; }), "1");
  out.array(place + "trusted", column<std::uint8_t>(rows, [](auto& f) { return f.trusted; }), "0 or 1");
  out.strings(place + "why", column<std::string>(rows, [](auto& f) { return f.why; }));
}

void write_phase_sensitivities(hdf5::Writer& out, std::string const& place, std::vector<PathRecord> const& rows) {
  Counts offset = {0};
  Small body;
  Doubles d;
  for (PathRecord const& r : rows) {
    for (PhaseSensitivity const& l : r.phase_sensitivities) {
      body.push_back(l.body.value);
      d.insert(d.end(), std::begin(l.d), std::end(l.d));
    }
    offset.push_back(body.size());
  }
  out.array(place + "/phase_sensitivity_offset", offset, "1");
  out.array(place + "/phase_sensitivity_body", body, "row of /names/bodies");
  out.array(place + "/phase_sensitivity", d, "3 x rad/m, 3 x rad/rad", {body.size(), 6});
}

void write_records(hdf5::Writer& out, Section const& at, CouplingTable const& table) {
  std::vector<CouplingClass> const& classes = table.*at.list;
  std::string const place = at.records;
  Small owner;
  std::vector<PathRecord> rows;
  for (std::size_t i = 0; i < classes.size(); ++i)
    for (PathRecord const& r : classes[i].records) {
      owner.push_back(std::uint32_t(i));
      rows.push_back(r);
    }
  out.group(place, "kept paths with address, weight and phase sensitivities");
  out.array(place + "/class", owner, "row of " + at.classes);
  out.array(place + "/history", column<std::uint64_t>(rows, [](auto& r) { return r.history; }), "1");
  out.array(place + "/event", column<std::uint32_t>(rows, [](auto& r) { return r.event; }), "1");
  out.array(place + "/connection", column<std::uint32_t>(rows, [](auto& r) { return r.connection; }), "1");
  out.array(place + "/coupling", column<double>(rows, [](auto& r) { return r.coupling; }), "1");
  out.array(place + "/weight", column<double>(rows, [](auto& r) { return r.weight; }), "1");
  out.array(place + "/path_length", column<double>(rows, [](auto& r) { return r.path_length; }), "m");
  write_phase_sensitivities(out, place, rows);
  Doubles fields;
  for (PathRecord const& r : rows)
    for (std::complex<double> const& f : r.field) fields.insert(fields.end(), {f.real(), f.imag()});
  out.array(place + "/field", fields, "1", {rows.size(), 4});
}

template <class Row>
void read_steps(hdf5::Reader const& in, std::string const& place, std::size_t groups, std::vector<Row>& rows) {
  Small const group = in.array<std::uint32_t>(place + "/step_group");
  Bytes const event = in.rows<std::uint8_t>(place + "/step_event", group.size());
  Counts const offset = read_offsets(in, place + "/step_offset", rows.size(), group.size());
  check_ids(group, groups, "a group");
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t k = offset[i]; k < offset[i + 1]; ++k) {
      if (event[k] > std::uint8_t(Event::diffract)) damaged_run("a step of unknown kind");
      rows[i].steps.push_back({{group[k]}, Event(event[k])});
    }
}

void read_folded(hdf5::Reader const& in, Section const& at, CouplingTable& table) {
  if (!in.has(at.folded)) return;  // since schema 1.3
  std::string const place = at.folded + "/";
  Small const owner = in.array<std::uint32_t>(place + "class");
  std::size_t const n = owner.size();
  check_ids(owner, (table.*at.list).size(), "a part of a row");
  Counts const hash = in.rows<std::uint64_t>(place + "hash", n);
  Doubles const mean = in.rows<double>(place + "mean", n), error = in.rows<double>(place + "std_error", n);
  Bytes const trusted = in.rows<std::uint8_t>(place + "trusted", n);
  std::vector<std::string> const why = in.strings(place + "why", n);
  std::vector<FoldedRoute> rows;
  for (std::size_t i = 0; i < n; ++i) rows.push_back({hash[i], {}, mean[i], error[i], trusted[i] != 0, why[i]});
  read_steps(in, at.folded, table.groups.size(), rows);
  for (std::size_t i = 0; i < n; ++i) (table.*at.list)[owner[i]].folded.push_back(std::move(rows[i]));
}

void read_class_columns(hdf5::Reader const& in, Section const& at, CouplingTable& table) {
  Counts const hash = in.array<std::uint64_t>(at.classes + "/hash");
  std::size_t const n = hash.size();
  (table.*at.list).resize(n);
  auto number = [&](char const* name) { return in.rows<double>(at.classes + "/" + name, n); };
  Small const port = in.rows<std::uint32_t>(at.classes + "/" + at.end, n);
  check_ids(port, (table.*at.ends).size(), "the end of a route");
  Doubles const reverse = number("reverse"), mean = number("mean"), error = number("std_error"),
                vov = number("variance_of_variance"), largest = number("largest_share"),
                effective = number("effective_scores"),
                replicas = in.rows<double>(at.classes + "/replica_sum", n, replica_count);
  Counts const scored = in.rows<std::uint64_t>(at.classes + "/scored", n);
  auto const optional = [&](char const* name) {  // not in files of schema 1.1
    return in.has(at.classes + "/" + name) ? number(name) : Doubles(n, not_a_number);
  };
  Doubles const slope = optional("tail_slope"), halves = optional("halves");
  Bytes const trusted = in.rows<std::uint8_t>(at.classes + "/trusted", n);
  std::vector<std::string> const why = in.strings(at.classes + "/why_not", n);
  std::string const mirrored = at.classes + "/by_reverse";    // since schema 1.2
  std::string const counted = at.classes + "/folded_routes";  // since schema 1.3
  Counts const folded = in.has(counted) ? in.rows<std::uint64_t>(counted, n) : Counts(n);
  Bytes const by_reverse = in.has(mirrored) ? in.rows<std::uint8_t>(mirrored, n) : Bytes(n);
  bool const kinds = in.has(at.classes + "/kind");  // since schema 1.4
  Bytes const kind = kinds ? in.rows<std::uint8_t>(at.classes + "/kind", n) : Bytes(n);
  std::vector<std::string> const statement =
      kinds ? in.strings(at.classes + "/statement", n) : std::vector<std::string>(n);
  for (std::size_t i = 0; i < n; ++i) {
    CouplingClass& c = (table.*at.list)[i];
    c.hash = hash[i];
    c.port = {port[i]};
    c.reverse = reverse[i];
    c.by_reverse = by_reverse[i] != 0;
    if (kind[i] > std::uint8_t(ClassKind::edge)) damaged_run("a route of unknown kind");
    c.kind = ClassKind(kind[i]);
    c.statement = statement[i];
    c.folded_routes = folded[i];
    c.coupling = {mean[i],   error[i],        vov[i], largest[i], effective[i],
                  scored[i], trusted[i] != 0, why[i], slope[i],   halves[i]};
    std::copy_n(replicas.begin() + std::ptrdiff_t(i * replica_count), replica_count, c.replica_sum.begin());
  }
}

void read_records(hdf5::Reader const& in, Section const& at, CouplingTable& table) {
  Small const owner = in.array<std::uint32_t>(at.records + "/class");
  std::size_t const n = owner.size();
  check_ids(owner, (table.*at.list).size(), "a path of a route");
  Counts const history = in.rows<std::uint64_t>(at.records + "/history", n);
  Small const event = in.rows<std::uint32_t>(at.records + "/event", n);
  Small const connection = in.rows<std::uint32_t>(at.records + "/connection", n);
  Doubles const coupling = in.rows<double>(at.records + "/coupling", n),
                weight = in.rows<double>(at.records + "/weight", n),
                length = in.rows<double>(at.records + "/path_length", n);
  Small const body = in.array<std::uint32_t>(at.records + "/phase_sensitivity_body");
  check_ids(body, table.bodies.size(), "a body");
  Counts const offset = read_offsets(in, at.records + "/phase_sensitivity_offset", n, body.size());
  Doubles const phase_sensitivity = in.rows<double>(at.records + "/phase_sensitivity", body.size(), 6);
  bool const fields = in.has(at.records + "/field");  // since schema 1.6
  Doubles const field = fields ? in.rows<double>(at.records + "/field", n, 4) : Doubles(4 * n);
  for (std::size_t i = 0; i < n; ++i) {
    PathRecord r{history[i], event[i], connection[i], coupling[i], weight[i], length[i], {}};
    for (std::size_t state = 0; state < r.field.size(); ++state)
      r.field[state] = {field[4 * i + 2 * state], field[4 * i + 2 * state + 1]};
    for (std::size_t k = offset[i]; k < offset[i + 1]; ++k) {
      PhaseSensitivity l{{body[k]}, {}};
      std::copy_n(phase_sensitivity.begin() + std::ptrdiff_t(6 * k), 6, std::begin(l.d));
      r.phase_sensitivities.push_back(l);
    }
    (table.*at.list)[owner[i]].records.push_back(std::move(r));
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
  out.array("/classes/replica_histories", Counts(table.replica_histories.begin(), table.replica_histories.end()), "1");
  write_class_columns(out, to_ports, table);
  write_records(out, to_ports, table);
  write_folded(out, to_ports, table);
  write_phase_sensitivity_moments(out, table);
  out.strings("/names/receivers", table.receivers);
  out.group("/received", "one row per route of light that ends on a receiver; power over that of the main mode");
  write_class_columns(out, to_receivers, table);
  write_records(out, to_receivers, table);
  write_folded(out, to_receivers, table);
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
  table.block_size = in.attribute_count("/", "block_size");
  Counts const histories = in.rows<std::uint64_t>("/classes/replica_histories", replica_count);
  std::copy(histories.begin(), histories.end(), table.replica_histories.begin());
  if (in.has("/names/receivers")) table.receivers = in.strings("/names/receivers");
  for (Section const& at : {to_ports, to_receivers}) {
    if (!in.has(at.classes)) continue;
    read_class_columns(in, at, table);
    read_steps(in, at.classes, table.groups.size(), table.*at.list);
    read_folded(in, at, table);
    read_records(in, at, table);
  }
  read_phase_sensitivity_moments(in, table);
  return table;
}

}  // namespace straytrace
