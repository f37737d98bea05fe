// SPDX-License-Identifier: BSD-3-Clause
// /projection: inputs of the noise from the traced model besides the coupling table.
#include "base/errors.hpp"
#include "results/run_file/columns.hpp"

namespace straytrace::results {
namespace {

template <class Column>
void port_columns(Column&& column) {
  column("place", "code", &TracedPort::injection_point);
  column("through_mirror", yes_or_no, &TracedPort::through_mirror);
  column("power", "W", &TracedPort::power);
  column("cavity_length", "m", &TracedPort::cavity_length);
  column("light", "", &TracedPort::light, std::string());  // these four since schema 2.4
  column("lit_by", "", &TracedPort::lit_by, std::string());
  column("along", yes_or_no, &TracedPort::along, false);
  column("both_sides", yes_or_no, &TracedPort::both_sides, false);  // since schema 2.5
  column("reference", "1", &TracedPort::reference, 1.0);
}

template <class Column>
void material_columns(Column&& column) {
  column("", "", &MaterialSpread::name);
  column("_status", "", &MaterialSpread::status);
  column("_spread", "1",
         Converted{[](MaterialSpread const& m) {
                     return std::array{m.low, m.high, m.factor};
                   },
                   [](MaterialSpread& m, std::array<double, 3> const& s) {
                     m.low = s[0];
                     m.high = s[1];
                     m.factor = s[2];
                   }});
  column("_of_reflection", yes_or_no, &MaterialSpread::of_reflection);
}

template <class Column>
void group_columns(Column&& column) {
  column("_group", "row of /names/groups", &GroupId::value);
}

template <Vec3 DrawnOptic::*member>
auto vector_of() {
  return Converted{[](DrawnOptic const& o) {
                     Vec3 const& v = o.*member;
                     return std::array{v.x, v.y, v.z};
                   },
                   [](DrawnOptic& o, std::array<double, 3> const& v) {
                     o.*member = {v[0], v[1], v[2]};
                   }};
}

template <class Column>
void optic_columns(Column&& column) {
  column("", "", &DrawnOptic::name);
  column("_body", "", &DrawnOptic::body);
  column("_vertex", "m", vector_of<&DrawnOptic::vertex>());
  column("_axis", "1", vector_of<&DrawnOptic::axis>());
  column("_curvature", "1/m", &DrawnOptic::curvature);
}

constexpr char const* of_optics = "/projection/optic";  // since schema 2.4, where the interferometer names optics

constexpr char const *of_materials = "/projection/material", *group_offset = "/projection/material_group_offset";

void read_ports(hdf5::Reader const& in, std::vector<std::string> const& names, std::vector<TracedPort>& ports) {
  ports.resize(names.size());
  port_columns(ColumnReader(in, "/projection/port_", ports));
  for (std::size_t i = 0; i < ports.size(); ++i) {
    ports[i].name = names[i];
    if (std::size_t(ports[i].injection_point) >= entrance_names.size())
      damaged_run("'/projection/port_place' names a place that is not there");
  }
}

}  // namespace

void write_projection(hdf5::Writer& out, ProjectionInputs const& p) {
  out.group("/projection", "properties of the traced model that the projection of noise needs besides the routes");
  out.array("/projection/body_meets_light", Bytes(p.meets_light.begin(), p.meets_light.end()), "0 or 1");
  port_columns(ColumnWriter(out, "/projection/port_", p.ports));
  material_columns(ColumnWriter(out, of_materials, p.materials));
  if (!p.optics.empty()) optic_columns(ColumnWriter(out, of_optics, p.optics));
  out.array("/projection/material_scattered", p.scattered, "1");
  write_lists(out, group_offset, of_materials, p.materials, &MaterialSpread::groups,
              [](auto&& list) { group_columns(list); });
  out.strings("/projection/notes", p.notes);
  out.strings("/projection/limits", p.limits);
  out.text("/projection/warnings", p.warnings);
  out.text("/projection/warnings_json", p.warnings_json);
}

ProjectionInputs read_projection(hdf5::Reader const& in, CouplingTable const& table) {
  ProjectionInputs p;
  p.bodies = table.bodies;
  p.wavelength = table.wavelength;
  Bytes const met = in.rows<std::uint8_t>("/projection/body_meets_light", p.bodies.size());
  p.meets_light.assign(met.begin(), met.end());
  read_ports(in, table.ports, p.ports);
  material_columns(ColumnReader(in, of_materials, p.materials, RowCount::of_first_column));
  if (in.has(of_optics)) optic_columns(ColumnReader(in, of_optics, p.optics, RowCount::of_first_column));
  p.scattered = in.rows<double>("/projection/material_scattered", p.materials.size());
  read_lists(in, group_offset, of_materials, p.materials, &MaterialSpread::groups,
             [](auto&& list) { group_columns(list); });
  for (MaterialSpread const& m : p.materials)
    for (GroupId const group : m.groups)
      if (group.value >= table.groups.size())
        damaged_run("'/projection/material_group' names a group that is not there");
  p.notes = in.strings("/projection/notes");
  p.limits = in.strings("/projection/limits");
  p.warnings = in.text("/projection/warnings");
  p.warnings_json = in.text("/projection/warnings_json");
  return p;
}

}  // namespace straytrace::results
