// SPDX-License-Identifier: BSD-3-Clause
// Laws from a power spectrum of heights: k-correlation, psd, harvey-shack (physics.md 3.2).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "optics/height_spectrum.hpp"
#include "world/read_laws.hpp"

namespace straytrace {
namespace {

constexpr Dimension metre3{6}, metre4{8};

void read_factor(Node const& law, Roughness& p) {
  if (law.has("index")) {
    if (law.has("reflectance")) law.problem("'reflectance' and 'index' both give the factor Q", "keep one of them");
    double const n = law.number("index", dim::plain, required, 0, 100),
                 k = law.number("extinction", dim::plain, 0, 0, 100);
    p.factor.permittivity_re = n * n - k * k;
    p.factor.permittivity_im = 2 * n * k;
  } else {
    if (law.has("extinction")) law.problem("'extinction' without 'index'", "give 'index', the real part, too");
    p.factor.reflectance = law.number("reflectance", dim::plain, 1, 0, 1);
  }
}

void read_theory(Node const& law, Roughness& p) {
  static constexpr std::string_view theories[] = {"rayleigh-rice", "harvey-shack"};
  p.harvey_shack = law.choice("theory", theories, "rayleigh-rice") == "harvey-shack";
}

// Checks the range of the theory, then prepares.
void finish(Node const& law, LawReading& out, Roughness& p, double wavelength) {
  double const rms = std::sqrt(p.variance(0, 1)), g = std::pow(4 * pi * rms, 2);
  if (!(g < 1e6)) return law.problem("the spectrum has no finite roughness below 1/wavelength", "give it a lower end");
  out.note(
      fmt::format("rms roughness {:.3g} nm at spatial frequencies below 1/wavelength, (4 pi sigma/lambda)^2 = {:.3g}",
                  rms * wavelength * 1e9, g));
  if (!p.harvey_shack && g > 0.1)
    law.warning(fmt::format("(4 pi sigma/lambda)^2 is {:.2g}: too rough for Rayleigh-Rice", g),
                "write 'theory: harvey-shack'");
  if (g > 6)
    return law.problem(fmt::format("(4 pi sigma/lambda)^2 is {:.3g}: too rough for a law of mirrors (at most 6)", g),
                       "describe the surface by a diffuse law, or measure it ('model: table')");
  p.prepare();
  out.add(p);
}

void read_knee(Node const& law, LawReading& out, Roughness& p) {
  double const wavelength = law_wavelength(law, out.world);
  double const knee = law.number("b", dim::length, required, 1e-9, 100),
               c = law.number("c", dim::plain, required, 1e-3, 20);
  double a = 0;
  if (law.has("rms")) {
    if (law.has("a")) law.problem("'rms' and 'a' both give the height", "keep one of them");
    double const rms = law.number("rms", dim::length, required, 0, 1e-3);
    if (c <= 1)
      law["rms"].problem("the total roughness is infinite for c <= 1 (docs/theory/surfaces.md, eq. 3.13)",
                         "give 'a' instead");
    a = rms * rms * (c - 1) * knee * knee / (2 * pi);
  } else {
    a = law.number("a", metre4, required, 0, 1);
  }
  read_factor(law, p);
  if (!(wavelength > 0 && knee > 0 && c > 0 && a >= 0) || (law.has("rms") && c <= 1)) return;
  p.a = a / std::pow(wavelength, 4);
  p.b = knee / wavelength;
  p.c = c;
  finish(law, out, p, wavelength);
}

// Two columns: spatial frequency and spectrum; at least two rows, frequencies increasing, values above zero.
HeightSpectrum points_of(Node const& law, std::string const& name, bool profile) {
  std::string const example = profile ? "f [1/mm], s1 [nm^2*mm]" : "f [1/mm], s2 [nm^4]";
  ColumnFile const file = read_columns(law["file"], name, example);
  HeightSpectrum points;
  if (file.rows.empty()) return points;
  auto const problem = [&](std::uint32_t line, std::uint32_t at, std::string what, std::string suggestion) {
    law["file"].file_problem(name, line, at, std::move(what), std::move(suggestion));
    return HeightSpectrum();
  };
  Dimension const wanted = profile ? metre3 : metre4;
  if (file.columns.size() != 2 || file.columns[0].unit.dimension != dim::per_metre ||
      file.columns[1].unit.dimension != wanted)
    return problem(file.columns[0].line, 1,
                   fmt::format("a {} spectrum needs a frequency in 1/m and a density in {}", profile ? "1d" : "2d",
                               profile ? "m^3" : "m^4"),
                   fmt::format("begin with the header '{}'", example));
  for (ColumnFile::Row const& row : file.rows) {
    double const f = row.values[0], value = row.values[1];
    if (!(f > 0) || (!points.empty() && f <= points.back().f))
      return problem(row.line, row.at[0], "the frequency is not above the one before",
                     "sort the rows; leave out f = 0");
    if (!(value > 0))
      return problem(row.line, row.at[1], fmt::format("spectrum {:g} at {:g} 1/m", value, f),
                     "a density is above zero; leave out points below the noise floor");
    points.push_back({f, value});
  }
  if (points.size() < 2) return problem(file.rows[0].line, 1, "fewer than two rows", "give at least two frequencies");
  return points;
}

void tabulate(Roughness& p, HeightSpectrum const& points, double wavelength, std::string const& beyond) {
  std::size_t const n = points.size();
  double const low = points.front().f, high = points.back().f, end = points[n - 2].f;
  p.first = low * wavelength;
  p.last = high * wavelength;
  p.cut_below = p.cut_above = beyond == "zero";
  p.slope = beyond == "power" ? std::log(points[n - 1].value / points[n - 2].value) / std::log(high / end) : 0;
  for (int i = 0; i < Roughness::points; ++i) {
    double const f = low * std::pow(high / low, double(i) / (Roughness::points - 1));
    p.log_value[i] = std::log(spectrum_at(points, std::fmin(f, high))) - 4 * std::log(wavelength);
  }
}

void read_file(Node const& law, LawReading& out, Roughness& p) {
  static constexpr std::string_view kinds[] = {"1d", "2d"}, sides[] = {"one", "two"},
                                    rules[] = {"constant", "power", "zero"};
  std::string const kind = law.choice("dimension", kinds), side = law.choice("sides", sides),
                    beyond = law.choice("beyond", rules);
  double const wavelength = law_wavelength(law, out.world);
  read_factor(law, p);
  std::string const name = law.word("file");
  if (name.empty() || kind.empty() || side.empty() || beyond.empty() || !(wavelength > 0)) return;
  if (kind == "2d" && side == "one")
    return law["sides"].problem("a 2d spectrum is over the whole plane of frequencies, so two-sided",
                                "write 'sides: two'");
  auto points = points_of(law, name, kind == "1d");
  if (points.empty()) return;
  if (side == "one")
    for (SpectrumPoint& q : points) q.value /= 2;
  double const low = points.front().f, high = points.back().f;
  double const rms = std::sqrt(kind == "1d" ? variance_1d(points, low, high) : variance_2d(points, low, high));
  if (kind == "1d") points = surface_of_profile(points);
  for (SpectrumPoint const& q : points)
    if (!(q.value > 0))
      return law["file"].problem(
          fmt::format("the profile spectrum rises beyond {:.3g} 1/m, so no isotropic surface has it", q.f),
          "smooth it or cut it there");
  tabulate(p, points, wavelength, beyond);
  out.note(fmt::format("rms roughness {:.4g} nm between {:.3g} and {:.3g} 1/m, where '{}' is given; {} beyond",
                       1e9 * rms, low, high, name, beyond));
  finish(law, out, p, wavelength);
}

}  // namespace

void read_k_correlation(Node const& law, LawReading& out) {
  Roughness p;
  read_theory(law, p);
  read_knee(law, out, p);
}

void read_psd(Node const& law, LawReading& out) {
  Roughness p;
  read_theory(law, p);
  read_file(law, out, p);
}

void read_harvey_shack(Node const& law, LawReading& out) {
  Roughness p;
  p.harvey_shack = 1;
  if (law.has("file"))
    read_file(law, out, p);
  else
    read_knee(law, out, p);
}

}  // namespace straytrace
