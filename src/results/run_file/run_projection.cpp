// SPDX-License-Identifier: BSD-3-Clause
// /projection: inputs of the noise from the traced model besides the coupling table; /noise.
#include <span>

#include "base/errors.hpp"
#include "results/curves/band.hpp"
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

// /noise: strain noise curves on their frequency bins.

namespace {

constexpr char const* strain = "1/sqrt(Hz)";

struct TraceColumn {
  char const* name;
  Doubles NoiseTrace::*member;
  bool may_lack = false;  // in older files, and where it was not made: NaN
  char const* unit = strain;
};
constexpr TraceColumn mean{"mean", &NoiseTrace::asd}, sigma{"sigma", &NoiseTrace::sigma},
    phase{"phase", &NoiseTrace::phase_asd}, amplitude{"amplitude", &NoiseTrace::amplitude_asd},
    linear_share{"linear_share", &NoiseTrace::linear_share, true, "1"};  // since schema 1.5
constexpr TraceColumn curves_of_total[] = {mean,
                                           sigma,
                                           phase,
                                           amplitude,
                                           {"power_sigma", &NoiseTrace::power_sigma, true},  // since schema 1.8
                                           {"phase_sensitivities_sigma", &NoiseTrace::phase_sensitivities_sigma, true},
                                           {"paths_sigma", &NoiseTrace::paths_sigma, true},
                                           linear_share};
constexpr TraceColumn curves_of_routes[] = {mean,
                                            sigma,
                                            phase,
                                            amplitude,
                                            linear_share,
                                            {"input_low", &NoiseTrace::input_low, true},  // since schema 1.6
                                            {"input_high", &NoiseTrace::input_high, true}};

void append_bins(Doubles& to, Doubles const& from, std::size_t bins, std::string const& name) {
  if (from.size() != bins) throw NumericalError("noise curve '" + name + "' has the wrong number of frequencies");
  to.insert(to.end(), from.begin(), from.end());
}

Doubles slice(Doubles const& all, std::size_t row, std::size_t bins) {
  auto const begin = all.begin() + std::ptrdiff_t(row * bins);
  return {begin, begin + std::ptrdiff_t(bins)};
}

// A curve of each trace, laid end to end.
Doubles bins_of(TraceColumn const& curve, std::span<NoiseTrace const> traces, std::size_t bins) {
  Doubles all;
  for (NoiseTrace const& t : traces) {
    Doubles const& values = t.*curve.member;
    append_bins(all, curve.may_lack && values.empty() ? Doubles(bins, not_a_number) : values, bins, t.name);
  }
  return all;
}

template <class Column>
void route_columns_of_noise(Column&& column) {
  column("name", "", &NoiseTrace::name);
  column("hash", "1", &NoiseTrace::hash);
  column("mean_square_phase", "rad^2", &NoiseTrace::mean_square_phase);
  column("resolved", yes_or_no, &NoiseTrace::resolved);
  column("faint", yes_or_no, &NoiseTrace::faint);
  column("why_not", "", &NoiseTrace::why_not);
}

template <class Column>
void source_columns(Column&& column) {
  column("source", "", &InputSource::name);
  column("statement", "", &InputSource::statement);
  column("source_low", "1", &InputSource::low);
  column("source_high", "1", &InputSource::high);
  column("source_share", "1", &InputSource::share);
}

void write_routes(hdf5::Writer& out, std::vector<NoiseTrace> const& routes, std::size_t bins) {
  for (TraceColumn const& curve : curves_of_routes)
    out.array(std::string("/noise/routes/") + curve.name, bins_of(curve, routes, bins), curve.unit,
              {routes.size(), bins});
  route_columns_of_noise(ColumnWriter(out, "/noise/routes/", routes));
}

void write_design(hdf5::Writer& out, std::vector<DesignCurve> const& design, std::size_t bins) {
  std::vector<std::string> names;
  Doubles all;
  for (DesignCurve const& d : design) {
    names.push_back(d.name);
    append_bins(all, d.asd, bins, d.name);
  }
  out.strings("/noise/design/name", names);
  out.array("/noise/design/asd", all, strain, {design.size(), bins});
}

void write_bands(hdf5::Writer& out, NoiseBands const& bands, std::size_t bins) {
  out.group("/noise/bands",
            "uncertainty of the total besides its Monte-Carlo error: stated inputs and unknown static phases");
  for (BandCurve const& column : band_curves) {
    Doubles checked;
    append_bins(checked, bands.*(column.member), bins, column.name);
    out.array(std::string("/noise/bands/") + column.name, checked, strain);
  }
  source_columns(ColumnWriter(out, "/noise/bands/", bands.sources));
  out.strings("/noise/bands/taken_as_exact", bands.taken_as_exact);
}

NoiseBands read_bands(hdf5::Reader const& in, std::size_t bins) {
  NoiseBands bands;
  for (BandCurve const& column : band_curves)
    bands.*(column.member) = in.rows<double>(std::string("/noise/bands/") + column.name, bins);
  source_columns(ColumnReader(in, "/noise/bands/", bands.sources, RowCount::of_first_column));
  bands.taken_as_exact = in.strings("/noise/bands/taken_as_exact");
  return bands;
}

void write_positions(hdf5::Writer& out, NoiseBudget const& b, std::size_t bins) {
  out.group("/noise/positions", "total with one body at several positions along the beam, of known static phase");
  out.attribute("/noise/positions", "body", b.scanned_body);
  Doubles phases, all;
  for (PositionCurve const& p : b.positions) {
    phases.push_back(p.phase);
    append_bins(all, p.asd, bins, "position of " + b.scanned_body);
  }
  out.array("/noise/positions/phase", phases, "rad");
  out.array("/noise/positions/asd", all, strain, {b.positions.size(), bins});
}

void read_positions(hdf5::Reader const& in, NoiseBudget& b) {
  b.scanned_body = in.attribute_text("/noise/positions", "body");
  Doubles const phases = in.array<double>("/noise/positions/phase");
  Doubles const all = in.rows<double>("/noise/positions/asd", phases.size(), b.grid.size());
  for (std::size_t i = 0; i < phases.size(); ++i) b.positions.push_back({phases[i], slice(all, i, b.grid.size())});
}

void read_routes(hdf5::Reader const& in, NoiseBudget& b) {
  route_columns_of_noise(ColumnReader(in, "/noise/routes/", b.routes, RowCount::of_first_column));
  for (TraceColumn const& curve : curves_of_routes) {
    std::string const place = std::string("/noise/routes/") + curve.name;
    if (curve.may_lack && !in.has(place)) continue;
    Doubles const all = in.rows<double>(place, b.routes.size(), b.grid.size());
    for (std::size_t i = 0; i < b.routes.size(); ++i) b.routes[i].*curve.member = slice(all, i, b.grid.size());
  }
}

void write_total(hdf5::Writer& out, NoiseTrace const& total, std::size_t bins) {
  out.group(
      "/noise/total",
      "all resolved routes, and the observed part of the others; a lower bound when /noise/unresolved is not empty");
  out.attribute("/noise/total", "name", total.name);
  out.attribute("/noise/total", "mean_square_phase", total.mean_square_phase);
  out.attribute("/noise/total", "resolved", std::vector<std::uint64_t>{total.resolved});
  out.attribute("/noise/total", "why_not", total.why_not);
  for (TraceColumn const& curve : curves_of_total)
    out.array(std::string("/noise/total/") + curve.name, bins_of(curve, {&total, 1}, bins), curve.unit);
  out.array("/noise/total/bound_share", total.bound_share.empty() ? Doubles(bins) : total.bound_share, "1");
}

void read_total(hdf5::Reader const& in, NoiseTrace& total, std::size_t bins) {
  total.name = in.attribute_text("/noise/total", "name");
  total.mean_square_phase = in.attribute_number("/noise/total", "mean_square_phase");
  total.resolved = in.attribute_count("/noise/total", "resolved") != 0;
  total.why_not = in.attribute_text("/noise/total", "why_not");
  for (TraceColumn const& curve : curves_of_total)
    if (std::string const place = std::string("/noise/total/") + curve.name; !curve.may_lack || in.has(place))
      total.*curve.member = in.rows<double>(place, bins);
}

}  // namespace

void write_noise(hdf5::Writer& out, NoiseBudget const& b) {
  std::size_t const bins = b.grid.size();
  out.group("/noise", "one-sided strain amplitude spectral densities, mean over static phases");
  out.attribute("/noise", "margin", b.margin);
  out.attribute("/noise", "unresolved_hint", b.unresolved_hint);
  out.attribute("/noise", "faint_share", b.faint_share);
  Doubles centres;
  for (std::size_t i = 0; i < bins; ++i) centres.push_back(b.grid.centre(i));
  out.array("/noise/frequency_edges", b.grid.edges, "Hz");
  out.array("/noise/frequency", centres, "Hz");
  out.strings("/noise/unresolved", b.unresolved);
  out.strings("/noise/faint", b.faint);
  out.strings("/noise/warnings", b.warnings);
  write_total(out, b.total, bins);
  out.group("/noise/routes", "noise of each route; rows as in /classes");
  write_routes(out, b.routes, bins);
  out.group("/noise/design", "design curves at the centres of the bins");
  write_design(out, b.design, bins);
  if (b.bands.made()) write_bands(out, b.bands, bins);
  if (!b.positions.empty()) write_positions(out, b, bins);
}

NoiseBudget read_noise(hdf5::Reader const& in) {
  NoiseBudget b;
  b.grid.edges = in.array<double>("/noise/frequency_edges");
  std::size_t const bins = b.grid.size();
  b.margin = in.attribute_number("/noise", "margin");
  b.unresolved_hint = in.attribute_number("/noise", "unresolved_hint");
  b.unresolved = in.strings("/noise/unresolved");
  b.faint_share = in.attribute_number("/noise", "faint_share");
  b.faint = in.strings("/noise/faint");
  if (in.has("/noise/warnings")) b.warnings = in.strings("/noise/warnings");
  read_total(in, b.total, bins);
  read_routes(in, b);
  std::vector<std::string> const names = in.strings("/noise/design/name");
  Doubles const all = in.rows<double>("/noise/design/asd", names.size(), bins);
  for (std::size_t i = 0; i < names.size(); ++i) b.design.push_back({names[i], slice(all, i, bins)});
  if (in.has("/noise/bands")) b.bands = read_bands(in, bins);
  if (in.has("/noise/positions")) read_positions(in, b);  // since schema 2.4
  return b;
}

}  // namespace straytrace::results
