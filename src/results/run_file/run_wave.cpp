// SPDX-License-Identifier: BSD-3-Clause
// /wave and /wave_ring: the solved cavity of the table `wave`; /seam: what the noise does at another crossover angle.
#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "results/run_file/columns.hpp"
#include "wave/arm/wave_record.hpp"
#include "wave/ring/ring_record.hpp"

namespace straytrace::results {
namespace {

using wave::DiodeRecord;
using wave::GridCheck;
using wave::HeightBand;
using wave::HeightBands;
using wave::HeightsRecord;
using wave::MirrorLevers;
using wave::MirrorRecord;
using wave::MirrorSpot;
using wave::ModeLine;
using wave::PlaneIrradiance;
using wave::PolarIrradiance;
using wave::RimDrawRecord;
using wave::RimLevers;
using wave::RimRecord;
using wave::RimResponse;
using wave::RingRecord;
using wave::RingSurfaceRecord;
using wave::SpeckleMeans;
using wave::WaveRecord;

// Complex members as two columns, of the real and of the imaginary parts.
template <class Column, class Member>
void complex_column(Column& column, std::string const& name, std::string const& unit, Member const& member) {
  column(name + "_real", unit,
         Converted{[member](auto const& row) { return std::invoke(member, row).real(); },
                   [member](auto& row, double x) { std::invoke(member, row).real(x); }});
  column(name + "_imaginary", unit,
         Converted{[member](auto const& row) { return std::invoke(member, row).imag(); },
                   [member](auto& row, double x) { std::invoke(member, row).imag(x); }});
}
template <std::size_t n, class Column, class Member>
void complex_columns(Column& column, std::string const& name, ColumnText const& unit, Member const& member) {
  using Numbers = std::array<double, n>;
  column(name + "_real", unit,
         Converted{[member](auto const& row) {
                     Numbers x;
                     for (std::size_t i = 0; i < n; ++i) x[i] = std::invoke(member, row)[i].real();
                     return x;
                   },
                   [member](auto& row, Numbers const& x) {
                     for (std::size_t i = 0; i < n; ++i) std::invoke(member, row)[i].real(x[i]);
                   }});
  column(name + "_imaginary", unit,
         Converted{[member](auto const& row) {
                     Numbers x;
                     for (std::size_t i = 0; i < n; ++i) x[i] = std::invoke(member, row)[i].imag();
                     return x;
                   },
                   [member](auto& row, Numbers const& x) {
                     for (std::size_t i = 0; i < n; ++i) std::invoke(member, row)[i].imag(x[i]);
                   }});
}

template <class Column>
void wave_mirror_columns(Column&& column) {
  column("name", "", &MirrorRecord::name);
  column("radius", {"m", "of the clear aperture"}, &MirrorRecord::radius);
  column("curvature", "1/m", &MirrorRecord::curvature);
  column("mode_radius", {"m", "1/e^2 radius of the mode"}, &MirrorRecord::spot);
  column("height_rms", {"m", "below the crossover angle"}, &MirrorRecord::roughness);
  column("scattered", {"1", "share scattered beyond the crossover angle"}, &MirrorRecord::scattered);
  column("lost", {"1", "share of the power lost past the rim, and scattered, per round trip"}, &MirrorRecord::lost);
  column("centroid", {"m", "of the light that arrives, x and y, in the first draw"},
         through(&MirrorRecord::light, &MirrorSpot::found));
  column("axis", {"m", "of the mode (eq. W.23)"}, through(&MirrorRecord::light, &MirrorSpot::expected));
}

template <class Column>
void wave_height_columns(Column&& column) {
  column("rms", {"m", "of mirror 1 and 2, below the crossover angle"}, &HeightsRecord::roughness);
  column("loss", {"1", "of power per round trip"}, &HeightsRecord::loss);
  column("residual", {"1", "of the mode (eq. W.9)"}, &HeightsRecord::residual);
  column("round_trips", {"1", "that the search took"}, &HeightsRecord::round_trips);
  column("at_mirrors", {"1", "share of the power lost at mirror 1 and 2"}, &HeightsRecord::at_mirrors);
  column("on_baffles", {"1", "share of the power on all baffles, of light towards mirror 1 and 2"},
         &HeightsRecord::on_baffles);
  column("beyond_band", {"1", "share of the power at angles that reach no opening"}, &HeightsRecord::beyond_band);
  for (std::size_t i : {0, 1}) {
    std::string const name = i == 0 ? "mirror1_" : "mirror2_";
    auto const levers = through(
        &HeightsRecord::mirrors, [i](auto& both) -> auto& { return both[i]; });
    auto const whole = through(levers, &MirrorLevers::whole);
    complex_columns<3>(column, name + "displacement", "1/m", through(whole, &RimLevers::displacement));
    complex_columns<3>(column, name + "rotation", "1/rad", through(whole, &RimLevers::rotation));
    complex_columns<3>(column, name + "figure",
                       {"", "by the motion of outline and heights alone: along x and y, 1/m, and about z, 1/rad"},
                       through(levers, &MirrorLevers::figure));
  }
}

template <class Column>
void wave_mode_columns(Column&& column) {
  auto const number = [](auto member) {
    return Converted{[member](ModeLine const& m) { return std::uint32_t(std::invoke(member, m)); },
                     [member](ModeLine& m, std::uint32_t n) { std::invoke(member, m) = int(n); }};
  };
  using Named = ModeLine::Named;
  column("order", {"1", "of the mode"}, number(&ModeLine::order));
  column("n", {"1", "quanta along x of the Hermite-Gauss mode next to it"},
         number(through(&ModeLine::hermite, &Named::one)));
  column("m", {"1", "quanta along y"}, number(through(&ModeLine::hermite, &Named::two)));
  column("shared", {"1", "power shared with the Hermite-Gauss mode"}, through(&ModeLine::hermite, &Named::shared));
  column("p", {"1", "radial order of the Laguerre-Gauss mode next to it"},
         number(through(&ModeLine::laguerre, &Named::one)));
  column("l", {"1", "azimuthal order"},
         Converted{[](ModeLine const& m) { return double(m.laguerre.two); },
                   [](ModeLine& m, double l) { m.laguerre.two = std::fabs(l) < 1e6 ? int(std::lround(l)) : 0; }});
  column("shared_laguerre", {"1", "power shared with the Laguerre-Gauss mode"},
         through(&ModeLine::laguerre, &Named::shared));
  column("shared_order", {"1", "power shared with all modes of the order"}, &ModeLine::in_order);
  column("loss", {"1", "of power per round trip"}, &ModeLine::loss);
  column("phase", {"turns", "of the round trip over that of the fundamental mode"}, &ModeLine::phase);
  column("residual", "1", &ModeLine::residual);
  column("alike", {"1", "modes of this order with its eigenvalue"}, number(&ModeLine::alike));
}

template <class Column>
void wave_rim_columns(Column&& column) {
  column("name", {"", "object whose inner edge it is"}, &RimRecord::name);
  column("centre", {"m", "x, y, z from mirror 1 along the axis"},
         Converted{[](RimRecord const& r) {
                     return std::array{r.centre.x, r.centre.y, r.centre.z};
                   },
                   [](RimRecord& r, std::array<double, 3> const& at) {
                     r.centre = {at[0], at[1], at[2]};
                   }});
  column("radius", "m", &RimRecord::radius);
  column("angle1", {"rad", "seen from mirror 1"}, &RimRecord::angle1);
  column("angle2", {"rad", "seen from mirror 2"}, &RimRecord::angle2);
  column("towards_mirror2", {"1", "share of the power on the baffle, of light towards mirror 2"},
         &RimRecord::towards_mirror2);
  column("towards_mirror1", {"1", "share of the power on the baffle, of light towards mirror 1"},
         &RimRecord::towards_mirror1);
  column("speckle_field", {"1", "mean of |s|^2 (eq. W.22)"}, through(&RimRecord::speckle, &SpeckleMeans::field));
  column("speckle_across", {"1/m^2", "mean of |A_x|^2 (eq. W.22)"},
         through(&RimRecord::speckle, &SpeckleMeans::transverse));
  column("speckle_along", {"1/m^2", "mean of |A_z|^2 (eq. W.22)"},
         through(&RimRecord::speckle, &SpeckleMeans::longitudinal));
}

template <class Column>
void wave_diode_columns(Column&& column) {
  column("name", "", &DiodeRecord::name);
  column("edge", "row of /wave/edges; 2^32 - 1: at a mirror", &DiodeRecord::rim);
  column("towards_mirror1", yes_or_no, &DiodeRecord::towards_mirror1);
  column("centre", {"m", "x and y across the axis"}, &DiodeRecord::centre);
  column("area", "m^2", &DiodeRecord::area);
  column("power", {"1", "share of the power of the mode, with the heights of the first draw"}, &DiodeRecord::power);
  column("mean", {"1", "over all heights that no map states (eq. W.41)"}, &DiodeRecord::mean);
  column("spread", {"1", "standard deviation over them (eq. W.43)"}, &DiodeRecord::spread);
}

template <class Column>
void wave_draw_columns(Column&& column) {
  column("heights", "row of /wave/heights", &RimDrawRecord::heights);
  column("tolerance", {"1", "0: edges as in the scene; from 1: draw of the tolerances and of the roll of a mirror"},
         &RimDrawRecord::tolerance);
  auto const levers = through(&RimDrawRecord::response, &RimResponse::levers);
  complex_columns<3>(column, "displacement", "1/m", through(levers, &RimLevers::displacement));
  complex_columns<3>(column, "rotation", "1/rad", through(levers, &RimLevers::rotation));
  complex_column(column, "widening", "1/m", through(&RimDrawRecord::response, &RimResponse::widening));
  complex_column(column, "clipped", "1", &RimDrawRecord::clipped);
}

// Irradiances of all planes, laid end to end: towards mirror 2, then towards mirror 1.
struct PlaneRow {
  std::uint32_t plane = 0, rings = 0, sectors = 0;
  bool towards_mirror1 = false;
  double step = 0;
};

template <class Column>
void wave_plane_columns(Column&& column) {
  column("plane", {"1", "0: mirror 1; edges in the order of /wave/edges; last: mirror 2"}, &PlaneRow::plane);
  column("towards_mirror1", yes_or_no, &PlaneRow::towards_mirror1);
  column("step", {"m", "width of a ring"}, &PlaneRow::step);
  column("rings", "1", &PlaneRow::rings);
  column("sectors", "1", &PlaneRow::sectors);
}

constexpr char const *wave_draws = "/wave/draws/", *wave_draw_offset = "/wave/edges/draw_offset";

void write_wave_irradiance(hdf5::Writer& out, PlaneIrradiance const& all) {
  out.group("/wave/irradiance",
            "light that arrives at the planes, by rings and sectors about the axis, relative to the power of the mode");
  std::vector<PlaneRow> rows;
  std::vector<float> mean, square;
  for (bool const towards_mirror1 : {false, true}) {
    auto const& side = towards_mirror1 ? all.towards_mirror1 : all.towards_mirror2;
    for (std::size_t plane = 0; plane < side.size(); ++plane) {
      PolarIrradiance const& p = side[plane];
      if (p.mean.empty()) continue;
      rows.push_back({std::uint32_t(plane), std::uint32_t(p.rings), std::uint32_t(p.sectors), towards_mirror1, p.step});
      mean.insert(mean.end(), p.mean.begin(), p.mean.end());
      square.insert(square.end(), p.square.begin(), p.square.end());
    }
  }
  wave_plane_columns(ColumnWriter(out, "/wave/irradiance/", rows));
  out.array("/wave/irradiance/mean", mean, "1/m^2");
  out.array("/wave/irradiance/mean_square", square, "1/m^4");
}

PlaneIrradiance read_wave_irradiance(hdf5::Reader const& in, std::size_t planes) {
  std::vector<PlaneRow> rows;
  wave_plane_columns(ColumnReader(in, "/wave/irradiance/", rows, RowCount::of_first_column));
  auto const mean = in.array<float>("/wave/irradiance/mean");
  auto const square = in.rows<float>("/wave/irradiance/mean_square", mean.size());
  PlaneIrradiance all;
  all.towards_mirror2.resize(planes);
  all.towards_mirror1.resize(planes);
  std::size_t first = 0;
  for (PlaneRow const& row : rows) {
    std::size_t const cells = std::size_t(row.rings) * row.sectors;
    if (row.plane >= planes || cells > mean.size() - first)
      damaged_run("'/wave/irradiance/plane' names a plane that is not there");
    auto const part = [&](std::vector<float> const& of) {
      auto const from = of.begin() + std::ptrdiff_t(first);
      return std::vector<float>(from, from + std::ptrdiff_t(cells));
    };
    (row.towards_mirror1 ? all.towards_mirror1 : all.towards_mirror2)[row.plane] = {
        row.step, int(row.rings), int(row.sectors), part(mean), part(square)};
    first += cells;
  }
  if (first != mean.size()) damaged_run("'/wave/irradiance/mean' does not fit its planes");
  return all;
}

constexpr char const* wave_fields[] = {"/wave/fields/mirror1", "/wave/fields/mirror2"};

void write_wave_fields(hdf5::Writer& out, WaveRecord const& w) {
  if (w.fields.empty()) return;
  out.group("/wave/fields", "complex fields that arrive at the mirrors, over the root of the power of the mode");
  std::vector<double> at;
  for (int i = 0; i < w.grid.points; ++i) at.push_back(w.grid.at(i));
  out.array("/wave/fields/at", at, "m");
  for (std::size_t i : {0, 1}) {
    std::uint64_t const n = w.fields[i].points;
    out.array(wave_fields[i], w.fields[i].values, "1/m", {n, n, 2});
  }
}

void read_wave_fields(hdf5::Reader const& in, WaveRecord& w) {
  if (!in.has("/wave/fields")) return;
  std::size_t const n = std::size_t(w.grid.points);
  for (char const* const path : wave_fields) w.fields.push_back({std::uint32_t(n), in.rows<float>(path, n, 2 * n)});
}

constexpr char const *finer_grid = "/wave/grid_check", *by_frequency = "/wave/by_frequency",
                     *photodiodes = "/wave/photodiodes";

template <class Check, class Number>
void grid_check_numbers(Check& g, Number const& number) {
  number("loss", g.loss);
  number("at_mirror1", g.ledger.mirror1);
  number("at_mirror2", g.ledger.mirror2);
  number("beyond_band", g.ledger.beyond_band);
  number("across", g.across);
  number("along", g.along);
  number("expected", g.expected);
}

void write_grid_check(hdf5::Writer& out, GridCheck const& g) {
  out.group(finer_grid, "changes by a finer grid, in the first draw of the heights");
  out.attribute(finer_grid, "points", Counts{std::uint64_t(g.points)});
  grid_check_numbers(g, [&](char const* name, double value) { out.attribute(finer_grid, name, value); });
  out.array("/wave/grid_check/towards_mirror2", g.ledger.towards_mirror2, "1");
  out.array("/wave/grid_check/towards_mirror1", g.ledger.towards_mirror1, "1");
}

GridCheck read_grid_check(hdf5::Reader const& in, std::size_t rims) {
  GridCheck g;
  g.points = int(std::min<std::uint64_t>(in.attribute_count(finer_grid, "points"), 1u << 16));
  grid_check_numbers(g, [&](char const* name, double& value) {
    value = in.has_attribute(finer_grid, name) ? in.attribute_number(finer_grid, name) : std::nan("");
  });
  g.ledger.towards_mirror2 = in.rows<double>("/wave/grid_check/towards_mirror2", rims);
  g.ledger.towards_mirror1 = in.rows<double>("/wave/grid_check/towards_mirror1", rims);
  return g;
}

template <class Column>
void wave_band_columns(Column&& column) {
  column("from", {"1/m", "lowest spatial frequency of the heights"}, &HeightBand::from);
  column("to", {"1/m", "highest spatial frequency of the heights"}, &HeightBand::to);
  column("scattered", {"1", "share of the power that mirror 1 and 2 scatter, to first order"}, &HeightBand::scattered);
  column("loss", {"1", "per round trip, with these heights alone, less that of smooth mirrors"}, &HeightBand::loss);
}

void write_bands(hdf5::Writer& out, HeightBands const& f) {
  out.group(by_frequency, "loss by the spatial frequency of the heights, of the first draw (eq. W.34)");
  out.attribute(by_frequency, "smooth", f.smooth);
  out.attribute(by_frequency, "beyond", f.beyond);
  wave_band_columns(ColumnWriter(out, "/wave/by_frequency/", f.bands));
}

HeightBands read_bands(hdf5::Reader const& in) {
  HeightBands f;
  f.smooth = in.attribute_number(by_frequency, "smooth");
  f.beyond = in.attribute_number(by_frequency, "beyond");
  wave_band_columns(ColumnReader(in, "/wave/by_frequency/", f.bands, RowCount::of_first_column));
  return f;
}

// Attributes that arms and rings have: number(name, member) writes or reads each number.
template <class Record, class Number>
void cavity_numbers(Record& r, Number const& number) {
  number("power", r.power);
  number("wavelength", r.wavelength);
  number("length", r.length);
  number("window", r.grid.window);
  number("crossover", r.crossover);
  number("beyond_band", r.beyond_band);
}

void write_complex(hdf5::Writer& out, char const* group, std::string const& name, wave::Complex value) {
  out.attribute(group, name + "_real", value.real());
  out.attribute(group, name + "_imaginary", value.imag());
}
wave::Complex read_complex(hdf5::Reader const& in, char const* group, std::string const& name) {
  return {in.attribute_number(group, name + "_real"), in.attribute_number(group, name + "_imaginary")};
}

template <class Record>
void write_cavity(hdf5::Writer& out, char const* group, Record const& r) {
  out.attribute(group, "beam", r.beam);
  cavity_numbers(r, [&](char const* name, double value) { out.attribute(group, name, value); });
  out.attribute(group, "points", Counts{std::uint64_t(r.grid.points)});
  write_complex(out, group, "eigenvalue", r.eigenvalue);
  out.attribute(group, "loss", r.loss());
  out.strings(group + std::string("/warnings"), r.warnings);
}

template <class Record>
void read_cavity(hdf5::Reader const& in, char const* group, Record& r) {
  r.beam = in.attribute_text(group, "beam");
  cavity_numbers(r, [&](char const* name, double& value) { value = in.attribute_number(group, name); });
  r.grid.points = int(std::min<std::uint64_t>(in.attribute_count(group, "points"), 1u << 16));
  r.eigenvalue = read_complex(in, group, "eigenvalue");
  r.warnings = in.strings(group + std::string("/warnings"));
}

}  // namespace

void write_wave(hdf5::Writer& out, wave::WaveRecord const& w) {
  out.group("/wave", "field of a cavity at small angles (docs/theory/wave.md)");
  write_cavity(out, "/wave", w);
  out.attribute("/wave", "key", w.key);
  out.attribute("/wave", "device", w.device);
  out.attribute("/wave", "loss_of_smooth_mirrors", w.perfect_loss);
  out.group("/wave/mirrors", "mirror 1 and mirror 2");
  wave_mirror_columns(ColumnWriter(out, "/wave/mirrors/", std::vector(w.mirrors.begin(), w.mirrors.end())));
  out.group("/wave/heights", "draws of the heights of the mirrors");
  wave_height_columns(ColumnWriter(out, "/wave/heights/", w.heights));
  out.group("/wave/modes", "modes of the mirrors without baffles, next to Hermite-Gauss modes");
  wave_mode_columns(ColumnWriter(out, "/wave/modes/", w.modes));
  out.group("/wave/edges", "inner edges of baffles in order of place");
  wave_rim_columns(ColumnWriter(out, "/wave/edges/", w.rims));
  out.group("/wave/draws", "derivatives of the stray field by the motion of each edge, in each draw (eq. W.14)");
  write_lists(out, wave_draw_offset, wave_draws, w.rims, &wave::RimRecord::draws,
              [](auto&& list) { wave_draw_columns(list); });
  if (!w.diodes.empty()) {
    out.group(photodiodes, "light on photodiodes");
    wave_diode_columns(ColumnWriter(out, photodiodes + std::string("/"), w.diodes));
  }
  write_wave_irradiance(out, w.irradiance);
  if (w.grid_check) write_grid_check(out, *w.grid_check);
  if (w.bands) write_bands(out, *w.bands);
  write_wave_fields(out, w);
}

wave::WaveRecord read_wave(hdf5::Reader const& in) {
  wave::WaveRecord w;
  read_cavity(in, "/wave", w);
  w.key = in.attribute_text("/wave", "key");
  if (in.has_attribute("/wave", "device")) w.device = in.attribute_text("/wave", "device");
  w.perfect_loss = in.attribute_number("/wave", "loss_of_smooth_mirrors");
  std::vector<wave::MirrorRecord> mirrors(w.mirrors.size());
  wave_mirror_columns(ColumnReader(in, "/wave/mirrors/", mirrors));
  std::ranges::move(mirrors, w.mirrors.begin());
  wave_height_columns(ColumnReader(in, "/wave/heights/", w.heights, RowCount::of_first_column));
  if (w.heights.empty()) damaged_run("'/wave/heights' is empty");
  wave_mode_columns(ColumnReader(in, "/wave/modes/", w.modes, RowCount::of_first_column));
  wave_rim_columns(ColumnReader(in, "/wave/edges/", w.rims, RowCount::of_first_column));
  read_lists(in, wave_draw_offset, wave_draws, w.rims, &wave::RimRecord::draws,
             [](auto&& list) { wave_draw_columns(list); });
  for (wave::RimRecord const& rim : w.rims)
    for (wave::RimDrawRecord const& draw : rim.draws)
      if (draw.heights >= w.heights.size()) damaged_run("'/wave/draws/heights' names a draw that is not there");
  if (in.has(photodiodes))
    wave_diode_columns(ColumnReader(in, photodiodes + std::string("/"), w.diodes, RowCount::of_first_column));
  for (DiodeRecord const& d : w.diodes)
    if (d.rim != DiodeRecord::none && d.rim >= w.rims.size())
      damaged_run("'/wave/photodiodes/edge' names an edge that is not there");
  w.irradiance = read_wave_irradiance(in, w.rims.size() + 2);
  if (in.has(finer_grid)) w.grid_check = read_grid_check(in, w.rims.size());
  if (in.has(by_frequency)) w.bands = read_bands(in);
  read_wave_fields(in, w);
  return w;
}

// Rings and folded cavities.

namespace {

template <class Column>
void ring_surface_columns(Column&& column) {
  using Surface = RingSurfaceRecord;
  column("name", {"", "object whose inner edge it is, or mirror"}, &Surface::name);
  column("body", {"", "that moves it; empty: none"}, &Surface::body);
  column("mirror", yes_or_no, &Surface::mirror);
  column("reference", {"m", "centre of the edge or vertex of the mirror, in the scene"},
         Converted{[](Surface const& s) {
                     return std::array{s.reference.x, s.reference.y, s.reference.z};
                   },
                   [](Surface& s, std::array<double, 3> const& at) {
                     s.reference = {at[0], at[1], at[2]};
                   }});
  column("lost", {"1", "share of the power lost per round trip"}, &Surface::lost);
  complex_columns<3>(column, "displacement", "1/m", through(&Surface::levers, &RimLevers::displacement));
  complex_columns<3>(column, "rotation", "1/rad", through(&Surface::levers, &RimLevers::rotation));
  complex_column(column, "widening", "1/m", &Surface::widening);
}

constexpr char const *finer_ring = "/wave_ring/grid_check", *finer_losses = "/wave_ring/grid_check/lost";

template <class Check, class Number>
void ring_check_numbers(Check& g, Number const& number) {
  number("loss", g.loss);
  number("beyond_band", g.losses.beyond_band);
  number("phase", g.phase);
  number("edges", g.edges);
  number("mirrors", g.mirrors);
}

void write_ring_check(hdf5::Writer& out, wave::RingGridCheck const& g) {
  out.group(finer_ring, "changes by a finer grid");
  out.attribute(finer_ring, "points", Counts{std::uint64_t(g.points)});
  ring_check_numbers(g, [&](char const* name, double value) { out.attribute(finer_ring, name, value); });
  out.array(finer_losses, g.losses.taken, "1");
}

wave::RingGridCheck read_ring_check(hdf5::Reader const& in, std::size_t surfaces) {
  wave::RingGridCheck g;
  g.points = int(std::min<std::uint64_t>(in.attribute_count(finer_ring, "points"), 1u << 16));
  ring_check_numbers(g, [&](char const* name, double& value) { value = in.attribute_number(finer_ring, name); });
  g.losses.taken = in.rows<double>(finer_losses, surfaces);
  return g;
}

}  // namespace

void write_ring(hdf5::Writer& out, RingRecord const& r) {
  char const* const group = "/wave_ring";
  out.group(group, "field of a ring or folded cavity at small angles (docs/theory/wave.md)");
  write_cavity(out, group, r);
  out.attribute(group, "residual", r.residual);
  write_complex(out, group, "reverse_eigenvalue", r.reverse_eigenvalue);
  out.group("/wave_ring/modes", "modes with all baffles, next to Hermite-Gauss modes");
  wave_mode_columns(ColumnWriter(out, "/wave_ring/modes/", r.modes));
  out.group("/wave_ring/surfaces", "derivatives of the stray field by the motion of each edge and mirror (eq. W.57)");
  ring_surface_columns(ColumnWriter(out, "/wave_ring/surfaces/", r.surfaces));
  if (r.grid_check) write_ring_check(out, *r.grid_check);
}

RingRecord read_ring(hdf5::Reader const& in) {
  char const* const group = "/wave_ring";
  RingRecord r;
  read_cavity(in, group, r);
  r.residual = in.attribute_number(group, "residual");
  r.reverse_eigenvalue = read_complex(in, group, "reverse_eigenvalue");
  wave_mode_columns(ColumnReader(in, "/wave_ring/modes/", r.modes, RowCount::of_first_column));
  ring_surface_columns(ColumnReader(in, "/wave_ring/surfaces/", r.surfaces, RowCount::of_first_column));
  if (in.has(finer_ring)) r.grid_check = read_ring_check(in, r.surfaces.size());
  return r;
}

// The noise at two crossover angles.

namespace {

// number(name, member) writes or reads each.
template <class Check, class Number>
void seam_numbers(Check& c, Number const& number) {
  number("frequency", c.frequency);
  number("crossover", c.crossover);
  number("other_crossover", c.other_crossover);
  auto const light = [&](std::string const& name, auto& of) {
    number(name + "_strain", of.strain);
    number(name + "_strain_sigma", of.strain_sigma);
    number(name + "_other", of.other);
    number(name + "_other_sigma", of.other_sigma);
    number(name + "_change", of.change);
    number(name + "_change_sigma", of.change_sigma);
  };
  light("baffles", c.baffles);
  light("total", c.total);
}

}  // namespace

void write_seam(hdf5::Writer& out, SeamCheck const& c) {
  out.group("/seam", "noise at two crossover angles, on which it must not depend (docs/theory/wave.md, eq. W.21)");
  out.attribute("/seam", "histories", Counts{c.histories});
  seam_numbers(c, [&](std::string const& name, double value) { out.attribute("/seam", name, value); });
}

SeamCheck read_seam(hdf5::Reader const& in) {
  SeamCheck c;
  c.histories = in.attribute_count("/seam", "histories");
  seam_numbers(c, [&](std::string const& name, double& value) { value = in.attribute_number("/seam", name); });
  return c;
}

}  // namespace straytrace::results
