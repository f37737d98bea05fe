// SPDX-License-Identifier: BSD-3-Clause
// /names, /classes, /records: the coupling table; /received and /received_records: the same for receivers.
#include <algorithm>

#include "base/errors.hpp"
#include "results/route_table/route_columns.hpp"
#include "results/run_file/columns.hpp"

namespace straytrace::results {
namespace {

void check_ids(Small const& ids, std::size_t names, char const* what) {
  for (std::uint32_t const id : ids)
    if (id >= names) damaged_run(std::string(what) + " without a name");
}

// Place of a list of routes in the file, and the end of its routes.
struct Section {
  std::string classes, records, folded, end;  // groups, column
  std::vector<CouplingClass> CouplingTable::*list;
  std::vector<std::string> CouplingTable::*ends;
};
Section const to_ports{"/classes", "/records", "/folded", "port", &CouplingTable::classes, &CouplingTable::ports};
Section const to_receivers{"/received", "/received_records",      "/received_folded",
                           "receiver",  &CouplingTable::received, &CouplingTable::receivers};

template <class Column>
void step_columns(Column&& column) {
  column("group", "row of /names/groups", through(&PathStep::group, &GroupId::value));
  column("event", "0 emit, 1 scatter, 2 reflect, 3 couple, 4 transmit, 5 receive, 6 start of a free beam, 7 diffract",
         &PathStep::event);
}

template <class Column>
void class_columns(Column&& column) {
  auto const of = [](auto member) { return through(&CouplingClass::coupling, member); };
  column("hash", {"1", "identifier of the route, the same in all runs of one model"}, &CouplingClass::hash);
  column("kind",
         {"0 scattered, 1 ghost, 2 edge, 3 wave, 4 speckle, 5 halo, 6 rim",
          "all but the first are computed, without Monte-Carlo error"},
         &CouplingClass::kind, ClassKind::scattered);
  column("statement", {"", "of computed routes: meaning of the number and its validity"}, &CouplingClass::statement,
         "");
  column("reverse", {"1", "factor C_rev for the reversed route, not included in the mean"}, &CouplingClass::reverse);
  column("by_reverse", {yes_or_no, "taken from the reversed route (reciprocity)"}, &CouplingClass::by_reverse, false);
  column("mean", {"1", "power fraction; not reliable unless trusted"}, of(&Estimate::mean));
  column("std_error", {"1", "standard error of the mean"}, of(&Estimate::std_error));
  column("variance_of_variance", {"1", "relative variance of the squared error"}, of(&Estimate::variance_of_variance));
  column("largest_share", {"1", "share of the largest single history in the sum"}, of(&Estimate::largest_share));
  column("effective_scores", {"1", "effective sample size"}, of(&Estimate::effective_scores));
  column("tail_slope", {"1", "p of x^-p that the largest histories follow"}, of(&Estimate::tail_slope), not_a_number);
  column("halves", {"1", "difference between the first and the other blocks, in standard errors"},
         of(&Estimate::halves), not_a_number);
  column("scored", {"1", "number of histories with a score"}, of(&Estimate::scored));
  column("trusted", {yes_or_no, "whether the mean is reliable"}, of(&Estimate::trusted));
  column("why_not", {"", "why the mean is not reliable"}, of(&Estimate::why_not));
  column("folded_routes", {"1", "number of routes in a row that sums several"}, &CouplingClass::folded_routes, 0u);
}

// Rows of the lists inside classes, laid end to end, and the class of each.
template <class Row>
struct Owned {
  Small owner;
  std::vector<Row const*> rows;

  Owned(std::vector<CouplingClass> const& classes, std::vector<Row> CouplingClass::*list) {
    for (std::size_t i = 0; i < classes.size(); ++i)
      for (Row const& row : classes[i].*list) {
        owner.push_back(std::uint32_t(i));
        rows.push_back(&row);
      }
  }
};

template <class Column>
void folded_columns(Column&& column) {
  column("hash", "1", &FoldedRoute::hash);
  column("mean", "1", &FoldedRoute::mean);
  column("std_error", "1", &FoldedRoute::std_error);
  column("trusted", yes_or_no, &FoldedRoute::trusted);
  column("why", "", &FoldedRoute::why);
}

template <class Column>
void record_columns(Column&& column) {
  column("history", "1", &PathRecord::history);
  column("event", "1", &PathRecord::event);
  column("connection", "1", &PathRecord::connection);
  column("coupling", "1", &PathRecord::coupling);
  column("weight", "1", &PathRecord::weight);
  column("path_length", "m", &PathRecord::path_length);
}

template <class Column>
void phase_sensitivity_columns(Column&& column) {
  column("_body", "row of /names/bodies", through(&PhaseSensitivity::body, &BodyId::value));
  column("", "3 x rad/m, 3 x rad/rad", &PhaseSensitivity::d);
  column("_delay", {"3 x s rad/m, 3 x s rad/rad", "sum over the hits of phase sensitivity times delay"},
         Converted{[](PhaseSensitivity const& s) { return std::to_array(s.moment); },
                   [](PhaseSensitivity& s, std::array<double, 6> const& m) { std::ranges::copy(m, s.moment); }},
         std::array{not_a_number, not_a_number, not_a_number, not_a_number, not_a_number,
                    not_a_number});  // since schema 2.4
}

template <class Column>
void amplitude_lever_columns(Column&& column) {
  column("_body", "row of /names/bodies", through(&PhaseSensitivity::body, &BodyId::value));
  column("", "3 x 1/m, 3 x 1/rad", &PhaseSensitivity::d);
}

// Of light to ports only.
template <class Column>
void member_column(Column&& column) {
  column("member", {"1", "of a row 'other': its route, counted from the first of the row in /members; else 2^32 - 1"},
         &PathRecord::member, no_member);  // since schema 2.1
}

template <class Column>
void beam_column(Column&& column) {
  column("beam", {"1", "that the light leaves, by position in the table 'beams'; 2^32 - 1: the beam of the port"},
         &PathRecord::beam, beam_of_port);  // since schema 2.4
}

// Real and imaginary part of both states.
Converted const field_column{[](auto const& r) {
                               auto const& [a, b] = r.field;
                               return std::array{a.real(), a.imag(), b.real(), b.imag()};
                             },
                             [](auto& r, std::array<double, 4> const& f) {
                               r.field = {{{f[0], f[1]}, {f[2], f[3]}}};
                             }};

template <class Row>
void write_steps(hdf5::Writer& out, std::string const& place, std::vector<Row> const& rows) {
  write_lists(
      out, place + "/step_offset", place + "/step_", rows, [](auto& c) -> auto& { return c.steps; },
      [](auto&& column) { step_columns(column); });
}

// The columns of the route table that the columns above do not give.
void write_route_table(hdf5::Writer& out, std::string const& group, CouplingTable const& table) {
  PathTable const routes = unranked_routes(table);
  std::vector<RouteRow> rows;
  for (PathRow const& row : routes.rows) rows.push_back({routes, row});
  TableWriter<RouteRow> const list(route_columns(routes));
  ColumnWriter const column(out, group + "/", rows);
  for (TableColumn<RouteRow> const* c : list.of(&TableColumn<RouteRow>::file)) {
    std::string const& name = c->name_in(&TableColumn<RouteRow>::file);
    auto const write = [&](std::string const& end, auto of_cell) {
      column(name + end, {c->unit, c->help}, [&](RouteRow const& r) { return of_cell(c->value(r)); });
    };
    using Cell = TableCell const&;
    if (c->kind == ColumnKind::text) write("", [](Cell cell) { return std::get<std::string>(cell); });
    if (c->kind == ColumnKind::flag) write("", [](Cell cell) { return std::get<bool>(cell); });
    if (c->kind == ColumnKind::number) write("", [](Cell cell) { return std::get<double>(cell); });
    if (c->kind == ColumnKind::count)  // 0 where it is not known
      write("", [](Cell cell) { return cell.index() == 2 ? std::get<std::uint64_t>(cell) : 0; });
    if (c->kind != ColumnKind::estimate) continue;
    write("", [](Cell cell) { return std::get<WithError>(cell).value; });
    write("_sigma", [](Cell cell) { return std::get<WithError>(cell).sigma; });
  }
}

void write_class_columns(hdf5::Writer& out, Section const& at, CouplingTable const& table) {
  std::vector<CouplingClass> const& rows = table.*at.list;
  ColumnWriter column(out, at.classes + "/", rows);
  class_columns(column);
  if (at.list == to_ports.list)
    write_route_table(out, at.classes, table);
  else
    column("name", {"", "name of the route"}, [&](auto& c) { return received_name(table, c); });
  column(at.end, {"row of /names/" + at.end + "s", "where the light ends"},
         through(&CouplingClass::port, &PortId::value));
  write_steps(out, at.classes, rows);
  column("replica_sum", "1", &CouplingClass::replica_sum);
}

void write_folded(hdf5::Writer& out, Section const& at, CouplingTable const& table) {
  Owned<FoldedRoute> const folded(table.*at.list, &CouplingClass::folded);
  out.group(at.folded,
            "the largest routes in rows 'other' and all routes in rows of ghosts whose fields add, with the reason for "
            "having "
            "no row of their own");
  out.array(at.folded + "/class", folded.owner, "row of " + at.classes);
  ColumnWriter column(out, at.folded + "/", folded.rows);
  folded_columns(column);
  column("name", "", [&](auto& f) { return folded_name(table, f); });
  write_steps(out, at.folded, folded.rows);
}

void write_records(hdf5::Writer& out, Section const& at, CouplingTable const& table) {
  Owned<PathRecord> const records(table.*at.list, &CouplingClass::records);
  out.group(at.records, "sampled paths with address, weight and phase sensitivities");
  out.array(at.records + "/class", records.owner, "row of " + at.classes);
  ColumnWriter column(out, at.records + "/", records.rows);
  record_columns(column);
  std::string const sensitivity = at.records + "/phase_sensitivity";
  write_lists(out, sensitivity + "_offset", sensitivity, records.rows, &PathRecord::phase_sensitivities,
              [](auto&& list) { phase_sensitivity_columns(list); });
  column("field", "1", field_column);
  std::string const lever = at.records + "/amplitude_lever";
  if (at.list == to_ports.list)
    write_lists(out, lever + "_offset", lever, records.rows, &PathRecord::amplitude_levers,
                [](auto&& list) { amplitude_lever_columns(list); });
  if (at.list == to_ports.list) member_column(column);
  beam_column(column);
}

template <class Row>
void read_steps(hdf5::Reader const& in, std::string const& place, std::size_t groups, std::vector<Row>& rows) {
  read_lists(in, place + "/step_offset", place + "/step_", rows, &Row::steps,
             [](auto&& column) { step_columns(column); });
  for (Row const& row : rows)
    for (PathStep const& s : row.steps) {
      if (s.group.value >= groups) damaged_run("a group without a name");
      if (s.event > Event::diffract) damaged_run("a step of unknown kind");
    }
}

// The routes of the paths in rows `other`; light on receivers makes no noise, so that its paths need none.
void write_members(hdf5::Writer& out, CouplingTable const& table) {
  Owned<MemberRoute> const members(table.classes, &CouplingClass::members);
  out.group("/members", "routes of the sampled paths in rows 'other'; no steps: more vertices than 'route_vertices'");
  out.array("/members/class", members.owner, "row of /classes");
  write_steps(out, "/members", members.rows);
}

void read_members(hdf5::Reader const& in, CouplingTable& table) {
  if (!in.has("/members")) return;  // since schema 2.1
  Small const owner = in.array<std::uint32_t>("/members/class");
  check_ids(owner, table.classes.size(), "a route of a row");
  std::vector<MemberRoute> rows(owner.size());
  read_steps(in, "/members", table.groups.size(), rows);
  for (std::size_t i = 0; i < rows.size(); ++i) table.classes[owner[i]].members.push_back(std::move(rows[i]));
}

void read_folded(hdf5::Reader const& in, Section const& at, CouplingTable& table) {
  if (!in.has(at.folded)) return;  // since schema 1.3
  Small const owner = in.array<std::uint32_t>(at.folded + "/class");
  check_ids(owner, (table.*at.list).size(), "a part of a row");
  std::vector<FoldedRoute> rows(owner.size());
  folded_columns(ColumnReader(in, at.folded + "/", rows));
  read_steps(in, at.folded, table.groups.size(), rows);
  for (std::size_t i = 0; i < rows.size(); ++i) (table.*at.list)[owner[i]].folded.push_back(std::move(rows[i]));
}

void read_class_columns(hdf5::Reader const& in, Section const& at, CouplingTable& table) {
  std::vector<CouplingClass>& rows = table.*at.list;
  ColumnReader column(in, at.classes + "/", rows, RowCount::of_first_column);
  class_columns(column);
  column(at.end, "", through(&CouplingClass::port, &PortId::value));
  column("replica_sum", "1", &CouplingClass::replica_sum);
  for (CouplingClass const& c : rows) {
    if (std::size_t(c.kind) >= class_kind_names.size()) damaged_run("a route of unknown kind");
    if (c.port.value >= (table.*at.ends).size()) damaged_run("the end of a route without a name");
  }
}

void read_records(hdf5::Reader const& in, Section const& at, CouplingTable& table) {
  Small const owner = in.array<std::uint32_t>(at.records + "/class");
  check_ids(owner, (table.*at.list).size(), "a path of a route");
  std::vector<PathRecord> records(owner.size());
  ColumnReader column(in, at.records + "/", records);
  record_columns(column);
  std::string const sensitivity = at.records + "/phase_sensitivity";
  read_lists(in, sensitivity + "_offset", sensitivity, records, &PathRecord::phase_sensitivities,
             [](auto&& list) { phase_sensitivity_columns(list); });
  column("field", "1", field_column, std::array<double, 4>{});                               // since schema 1.6
  if (std::string const lever = at.records + "/amplitude_lever"; in.has(lever + "_offset"))  // since schema 2.4
    read_lists(in, lever + "_offset", lever, records, &PathRecord::amplitude_levers,
               [](auto&& list) { amplitude_lever_columns(list); });
  if (at.list == to_ports.list) member_column(column);
  beam_column(column);
  for (std::size_t i = 0; i < records.size(); ++i) {
    for (PhaseSensitivity const& s : records[i].phase_sensitivities)
      if (s.body.value >= table.bodies.size()) damaged_run("a body without a name");
    for (PhaseSensitivity const& s : records[i].amplitude_levers)
      if (s.body.value >= table.bodies.size()) damaged_run("a body without a name");
    CouplingClass& route = (table.*at.list)[owner[i]];
    if (records[i].member != no_member && records[i].member >= route.members.size())
      damaged_run("a path of a route that is not listed");
    route.records.push_back(std::move(records[i]));
  }
}

// Second moments of the phase sensitivities of the routes to ports.
void write_products(hdf5::Writer& out, CouplingTable const& table) {
  Owned<PhaseSensitivityProduct> const products(table.classes, &CouplingClass::phase_sensitivities);
  out.group("/phase_sensitivities", "mean coupling times the mean product of two phase sensitivities, by replica");
  out.array("/phase_sensitivities/class", products.owner, "row of /classes");
  product_columns(ColumnWriter(out, "/phase_sensitivities/product", products.rows));
}

void read_products(hdf5::Reader const& in, CouplingTable& table) {
  if (!in.has("/phase_sensitivities")) return;  // since schema 1.8
  auto const owner = in.array<std::uint32_t>("/phase_sensitivities/class");
  check_ids(owner, table.classes.size(), "a product of phase sensitivities");
  std::vector<PhaseSensitivityProduct> products(owner.size());
  product_columns(ColumnReader(in, "/phase_sensitivities/product", products));
  for (std::size_t i = 0; i < owner.size(); ++i) {
    PhaseSensitivityProduct const& p = products[i];
    if (p.replica >= replica_count) damaged_run("a product of phase sensitivities of an unknown replica");
    if (std::max(p.first.value, p.second.value) >= table.bodies.size())
      damaged_run("a product of phase sensitivities without a body");
    table.classes[owner[i]].phase_sensitivities.push_back(p);
  }
}

}  // namespace

void write_classes(hdf5::Writer& out, CouplingTable const& table) {
  out.group("/names", "names by id; an id is a row number");
  out.strings("/names/groups", table.groups);
  out.strings("/names/bodies", table.bodies);
  out.strings("/names/ports", table.ports);
  out.group("/classes", "one row per route of stray light; couplings are recoupled power fractions of ordered paths");
  out.attribute("/classes", "wavelength", table.wavelength);
  out.attribute("/classes", "reverse_routes", std::vector<std::uint64_t>{table.reverse_routes});
  out.array("/classes/replica_histories", Counts(table.replica_histories.begin(), table.replica_histories.end()), "1");
  write_class_columns(out, to_ports, table);
  write_records(out, to_ports, table);
  write_folded(out, to_ports, table);
  write_members(out, table);
  write_products(out, table);
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
    if (at.list == to_ports.list) read_members(in, table);
    read_records(in, at, table);
  }
  read_products(in, table);
  return table;
}

}  // namespace straytrace::results
