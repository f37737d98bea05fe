// SPDX-License-Identifier: BSD-3-Clause
// /projection: inputs of the noise from the traced model besides the coupling table.
#include "base/errors.hpp"
#include "results/run_file/run_file.hpp"

namespace straytrace::results {
namespace {

using Counts = std::vector<std::uint64_t>;
using Small = std::vector<std::uint32_t>;
using Bytes = std::vector<std::uint8_t>;
using Names = std::vector<std::string>;

void write_ports(hdf5::Writer& out, std::vector<TracedPort> const& ports) {
  Bytes place, through;
  std::vector<double> power, length;
  for (TracedPort const& p : ports) {
    place.push_back(std::uint8_t(p.injection_point));
    through.push_back(p.through_mirror);
    power.push_back(p.power);
    length.push_back(p.cavity_length);
  }
  out.array("/projection/port_place", place, "code");
  out.array("/projection/port_through_mirror", through, "0 or 1");
  out.array("/projection/port_power", power, "W");
  out.array("/projection/port_cavity_length", length, "m");
}

std::vector<TracedPort> read_ports(hdf5::Reader const& in, Names const& names) {
  std::size_t const n = names.size();
  auto const place = in.rows<std::uint8_t>("/projection/port_place", n),
             through = in.rows<std::uint8_t>("/projection/port_through_mirror", n);
  auto const power = in.rows<double>("/projection/port_power", n),
             length = in.rows<double>("/projection/port_cavity_length", n);
  std::vector<TracedPort> ports;
  for (std::size_t i = 0; i < n; ++i) {
    if (place[i] >= entrance_names.size()) damaged_run("'/projection/port_place' names a place that is not there");
    ports.push_back({names[i], InjectionPoint(place[i]), power[i], length[i], through[i] != 0});
  }
  return ports;
}

void write_materials(hdf5::Writer& out, ProjectionInputs const& p) {
  Names names, status;
  std::vector<double> spread;
  Bytes of_reflection;
  Counts offset = {0};
  Small groups;
  for (MaterialSpread const& m : p.materials) {
    names.push_back(m.name);
    status.push_back(m.status);
    spread.insert(spread.end(), {m.low, m.high, m.factor});
    of_reflection.push_back(m.of_reflection);
    for (GroupId const group : m.groups) groups.push_back(group.value);
    offset.push_back(groups.size());
  }
  out.strings("/projection/material", names);
  out.strings("/projection/material_status", status);
  out.array("/projection/material_spread", spread, "1", {names.size(), 3});
  out.array("/projection/material_of_reflection", of_reflection, "0 or 1");
  out.array("/projection/material_scattered", p.scattered, "1");
  out.array("/projection/material_group_offset", offset, "1");
  out.array("/projection/material_group", groups, "row of /names/groups");
}

void read_materials(hdf5::Reader const& in, std::size_t group_count, ProjectionInputs& p) {
  Names const names = in.strings("/projection/material");
  std::size_t const n = names.size();
  Names const status = in.strings("/projection/material_status", n);
  auto const spread = in.rows<double>("/projection/material_spread", n, 3);
  auto const of_reflection = in.rows<std::uint8_t>("/projection/material_of_reflection", n);
  auto const groups = in.array<std::uint32_t>("/projection/material_group");
  Counts const offset = read_offsets(in, "/projection/material_group_offset", n, groups.size());
  p.scattered = in.rows<double>("/projection/material_scattered", n);
  for (std::size_t i = 0; i < n; ++i) {
    MaterialSpread m{names[i], status[i], spread[3 * i], spread[3 * i + 1], spread[3 * i + 2], of_reflection[i] != 0,
                     {}};
    for (std::size_t k = offset[i]; k < offset[i + 1]; ++k) {
      if (groups[k] >= group_count) damaged_run("'/projection/material_group' names a group that is not there");
      m.groups.push_back({groups[k]});
    }
    p.materials.push_back(std::move(m));
  }
}

}  // namespace

void write_projection(hdf5::Writer& out, ProjectionInputs const& p) {
  out.group("/projection", "what noise needs from the traced model besides the routes");
  out.array("/projection/body_meets_light", Bytes(p.meets_light.begin(), p.meets_light.end()), "0 or 1");
  write_ports(out, p.ports);
  write_materials(out, p);
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
  p.ports = read_ports(in, table.ports);
  read_materials(in, table.groups.size(), p);
  p.notes = in.strings("/projection/notes");
  p.limits = in.strings("/projection/limits");
  p.warnings = in.text("/projection/warnings");
  p.warnings_json = in.text("/projection/warnings_json");
  return p;
}

}  // namespace straytrace::results
