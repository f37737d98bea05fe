// SPDX-License-Identifier: BSD-3-Clause
// /noise: strain noise curves on their frequency bins.
#include <span>

#include "base/errors.hpp"
#include "results/curves/band.hpp"
#include "results/run_file/columns.hpp"

namespace straytrace::results {
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
