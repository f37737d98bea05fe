// SPDX-License-Identifier: BSD-3-Clause
// /names, /classes, /records: the coupling table; /received and /received_records: the same for receivers.
#include <algorithm>

#include "base/errors.hpp"
#include "results/run_file/columns.hpp"
#include "results/run_file/run_nodes.hpp"

namespace straytrace::results {
namespace {

using Doubles = std::vector<double>;
using Counts = std::vector<std::uint64_t>;
using Small = std::vector<std::uint32_t>;
using Bytes = std::vector<std::uint8_t>;

void check_ids(Small const& ids, std::size_t names, char const* what) {
  for (std::uint32_t const id : ids)
    if (id >= names) damaged_run(std::string(what) + " without a name");
}

// Where the file holds a list of routes, and what its routes end on.
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

constexpr char const* yes_or_no = "0 or 1";

template <class Column>
void class_columns(Column const& column) {
  column(
      "hash", "1", [](auto& c) -> auto& { return c.hash; });
  column(
      "kind", "0 scattered, 1 ghost, 2 edge", [](auto& c) -> auto& { return c.kind; }, ClassKind::scattered);
  column(
      "statement", "", [](auto& c) -> auto& { return c.statement; }, "");
  column(
      "reverse", "1", [](auto& c) -> auto& { return c.reverse; });
  column(
      "by_reverse", yes_or_no, [](auto& c) -> auto& { return c.by_reverse; }, false);
  column(
      "mean", "1", [](auto& c) -> auto& { return c.coupling.mean; });
  column(
      "std_error", "1", [](auto& c) -> auto& { return c.coupling.std_error; });
  column(
      "variance_of_variance", "1", [](auto& c) -> auto& { return c.coupling.variance_of_variance; });
  column(
      "largest_share", "1", [](auto& c) -> auto& { return c.coupling.largest_share; });
  column(
      "effective_scores", "1", [](auto& c) -> auto& { return c.coupling.effective_scores; });
  column(
      "tail_slope", "1", [](auto& c) -> auto& { return c.coupling.tail_slope; }, not_a_number);
  column(
      "halves", "1", [](auto& c) -> auto& { return c.coupling.halves; }, not_a_number);
  column(
      "scored", "1", [](auto& c) -> auto& { return c.coupling.scored; });
  column(
      "trusted", yes_or_no, [](auto& c) -> auto& { return c.coupling.trusted; });
  column(
      "why_not", "", [](auto& c) -> auto& { return c.coupling.why_not; });
  column(
      "folded_routes", "1", [](auto& c) -> auto& { return c.folded_routes; }, std::size_t{0});
}

// Rows of the lists inside classes, laid end to end, and the class of each.
template <class Row>
struct Owned {
  Small owner;
  std::vector<Row> rows;

  Owned(std::vector<CouplingClass> const& classes, std::vector<Row> CouplingClass::*list) {
    for (std::size_t i = 0; i < classes.size(); ++i)
      for (Row const& row : classes[i].*list) {
        owner.push_back(std::uint32_t(i));
        rows.push_back(row);
      }
  }
};

template <class Column>
void folded_columns(Column const& column) {
  column(
      "hash", "1", [](auto& f) -> auto& { return f.hash; });
  column(
      "mean", "1", [](auto& f) -> auto& { return f.mean; });
  column(
      "std_error", "1", [](auto& f) -> auto& { return f.std_error; });
  column(
      "trusted", yes_or_no, [](auto& f) -> auto& { return f.trusted; });
  column(
      "why", "", [](auto& f) -> auto& { return f.why; });
}

template <class Column>
void record_columns(Column const& column) {
  column(
      "history", "1", [](auto& r) -> auto& { return r.history; });
  column(
      "event", "1", [](auto& r) -> auto& { return r.event; });
  column(
      "connection", "1", [](auto& r) -> auto& { return r.connection; });
  column(
      "coupling", "1", [](auto& r) -> auto& { return r.coupling; });
  column(
      "weight", "1", [](auto& r) -> auto& { return r.weight; });
  column(
      "path_length", "m", [](auto& r) -> auto& { return r.path_length; });
}

void write_class_columns(hdf5::Writer& out, Section const& at, CouplingTable const& table) {
  std::vector<CouplingClass> const& rows = table.*at.list;
  ColumnWriter const column(out, at.classes, rows);
  class_columns(column);
  auto const name = at.list == to_ports.list ? route_name : received_name;
  column("name", "", [&](auto& c) { return name(table, c); });
  column(
      at.end.c_str(), ("row of /names/" + at.end + "s").c_str(), [](auto& c) -> auto& { return c.port.value; });
  write_steps(out, at.classes, rows);
  Doubles replicas;
  for (CouplingClass const& c : rows) replicas.insert(replicas.end(), c.replica_sum.begin(), c.replica_sum.end());
  out.array(at.classes + "/replica_sum", replicas, "1", {rows.size(), replica_count});
}

void write_folded(hdf5::Writer& out, Section const& at, CouplingTable const& table) {
  Owned<FoldedRoute> const folded(table.*at.list, &CouplingClass::folded);
  out.group(at.folded, "the largest routes in rows 'other', and why they have no row of their own");
  out.array(at.folded + "/class", folded.owner, "row of " + at.classes);
  ColumnWriter const column(out, at.folded, folded.rows);
  folded_columns(column);
  column("name", "", [&](auto& f) { return folded_name(table, f); });
  write_steps(out, at.folded, folded.rows);
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
  Owned<PathRecord> const records(table.*at.list, &CouplingClass::records);
  out.group(at.records, "kept paths with address, weight and phase sensitivities");
  out.array(at.records + "/class", records.owner, "row of " + at.classes);
  record_columns(ColumnWriter(out, at.records, records.rows));
  write_phase_sensitivities(out, at.records, records.rows);
  Doubles fields;
  for (PathRecord const& r : records.rows)
    for (std::complex<double> const& f : r.field) fields.insert(fields.end(), {f.real(), f.imag()});
  out.array(at.records + "/field", fields, "1", {records.rows.size(), 4});
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
  Small const owner = in.array<std::uint32_t>(at.folded + "/class");
  check_ids(owner, (table.*at.list).size(), "a part of a row");
  std::vector<FoldedRoute> rows(owner.size());
  folded_columns(ColumnReader(in, at.folded, rows));
  read_steps(in, at.folded, table.groups.size(), rows);
  for (std::size_t i = 0; i < rows.size(); ++i) (table.*at.list)[owner[i]].folded.push_back(std::move(rows[i]));
}

void read_class_columns(hdf5::Reader const& in, Section const& at, CouplingTable& table) {
  std::vector<CouplingClass>& rows = table.*at.list;
  Small const port = in.array<std::uint32_t>(at.classes + "/" + at.end);
  check_ids(port, (table.*at.ends).size(), "the end of a route");
  rows.resize(port.size());
  class_columns(ColumnReader(in, at.classes, rows));
  Doubles const replicas = in.rows<double>(at.classes + "/replica_sum", rows.size(), replica_count);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].kind > ClassKind::edge) damaged_run("a route of unknown kind");
    rows[i].port = {port[i]};
    std::copy_n(replicas.begin() + std::ptrdiff_t(i * replica_count), replica_count, rows[i].replica_sum.begin());
  }
}

void read_records(hdf5::Reader const& in, Section const& at, CouplingTable& table) {
  Small const owner = in.array<std::uint32_t>(at.records + "/class");
  std::size_t const n = owner.size();
  check_ids(owner, (table.*at.list).size(), "a path of a route");
  std::vector<PathRecord> records(n);
  record_columns(ColumnReader(in, at.records, records));
  Small const body = in.array<std::uint32_t>(at.records + "/phase_sensitivity_body");
  check_ids(body, table.bodies.size(), "a body");
  Counts const offset = read_offsets(in, at.records + "/phase_sensitivity_offset", n, body.size());
  Doubles const phase_sensitivity = in.rows<double>(at.records + "/phase_sensitivity", body.size(), 6);
  bool const fields = in.has(at.records + "/field");  // since schema 1.6
  Doubles const field = fields ? in.rows<double>(at.records + "/field", n, 4) : Doubles(4 * n);
  for (std::size_t i = 0; i < n; ++i) {
    PathRecord& r = records[i];
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

}  // namespace straytrace::results
