// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/errors.hpp"
#include "base/input/document.hpp"
#include "io/delimited_text.hpp"
#include "optics/scatter/model_keys.hpp"
#include "world/build/read_materials.hpp"

namespace straytrace::world {
namespace {

// One of two keys for the same value; returns whether `first` is given.
bool first_of(Node const& law, std::string_view first, std::string_view second) {
  bool const given = law.has(first);
  if (given && law.has(second))
    law.problem(fmt::format("'{}' and '{}' both set the same value", second, first), "keep one of them");
  return given;
}

// Numbers and alternative keys of a model, with their meaning. False, and problems, when the model cannot be built.
template <class Model>
bool read_model_keys(Node const& law, Model& model) {
  ModelKeys<Model> const keys = Model::keys();
  bool whole = true;
  for (ModelKey<Model> const& k : keys.numbers) {
    bool const stays = k.fallback == optional && !k.like && !law.has(k.name);
    double const fallback = k.like ? model.*k.like : k.fallback == optional ? required : k.fallback;
    if (!stays) model.*k.member = law.number(k.name, k.dimension, fallback, k.low, k.high);
    law.data()->describe(k.name, k.doc);
    whole = whole && std::isfinite(model.*k.member);
  }
  if (EitherKey<Model> const& either = keys.either; either.member) {
    auto const& one = first_of(law, either.first.name, either.second.name) ? either.first : either.second;
    double const given = law.number(one.name, one.dimension, required, one.low, one.high);
    for (auto const& k : {either.first, either.second}) law.data()->describe(k.name, k.doc);
    whole = whole && std::isfinite(given);
    if (whole) model.*either.member = one.value ? one.value(model, given) : given;
  }
  if constexpr (requires { model.impossible(); })
    if (ModelComplaint const c = whole ? model.impossible() : ModelComplaint{}; !c.what.empty()) {
      (c.key.empty() ? law : law[c.key]).problem(c.what, c.suggestion);
      return false;
    }
  return whole;
}

// Whether both models have the same value, to the bit, at every key.
template <class Model>
bool same_values(Model const& a, Model const& b) {
  ModelKeys<Model> const keys = Model::keys();
  auto const same = [&](double Model::*member) {
    return std::bit_cast<std::uint64_t>(a.*member) == std::bit_cast<std::uint64_t>(b.*member);
  };
  return std::ranges::all_of(keys.numbers, same, &ModelKey<Model>::member) &&
         (!keys.either.member || same(keys.either.member));
}

// Tables depend on the keys alone: a model takes those of another one with the same values, as on two mirrors of one
// polish.
template <class Model>
void prepare(Model& model, std::vector<Model> const& others) {
  auto const like = std::ranges::find_if(others, [&](Model const& other) { return same_values(model, other); });
  if (like != others.end())
    model = *like;
  else
    model.prepare();
}

template <class Model>
void read_model(Node const& law, LawReading& out) {
  Model model;
  if (!read_model_keys(law, model)) return;
  if constexpr (requires { model.prepare(); }) prepare(model, out.world.laws<Model>());
  out.add(model);
}

}  // namespace

double law_wavelength(Node const& law, World const& world) {
  return law.number("wavelength", dim::length, world.wavelength, 1e-8, 1e-3);
}

void read_polynomial(Node const& law, LawReading& out) {
  Polynomial p;
  auto const rows = law.list("diffuse");
  if (rows.empty()) law.problem("key 'diffuse' (coefficients c_jk) is missing", "add 'diffuse: [[5e-3 /sr]]'");
  bool whole = !rows.empty() && rows.size() <= std::size_t(Polynomial::terms);
  if (!whole && !rows.empty()) law["diffuse"].problem("more than 4 rows of coefficients", "use powers 0 to 3");
  for (std::size_t j = 0; whole && j < rows.size(); ++j) {
    auto const row = rows[j].as_numbers(dim::brdf, rows.size());
    whole = !some_missing(row);
    for (std::size_t k = 0; whole && k < row.size(); ++k) p.c[j][k] = row[k];
  }
  for (int j = 0; whole && j < Polynomial::terms; ++j)
    for (int k = 0; k < j; ++k)
      if (p.c[j][k] != p.c[k][j]) {
        whole = false;
        law["diffuse"].problem(fmt::format("c_{}{} and c_{}{} differ, so the model is not reciprocal", j, k, k, j),
                               "make the table symmetric: [[a, b], [b, c]]");
        j = Polynomial::terms;
        break;
      }
  if (Node const lobe = law.table("lobe")) {
    p.peak = lobe.number("peak", dim::brdf, required, 0, 1e9);
    p.width = lobe.number("width", dim::plain, required, 1e-4, 10);
    p.rise = lobe.number("rise", dim::plain, 1, 0, 8);
    lobe.refuse_unknown("'lobe'");
    whole = whole && p.peak >= 0 && p.width > 0 && p.rise >= 0;
  }
  for (int i = 0; whole && i <= 100; ++i)
    for (int k = 0; whole && k <= i; ++k)
      if (double const value = p.diffuse(i / 100.0, k / 100.0); value < -1e-15) {
        whole = false;
        law["diffuse"].problem(fmt::format("the BRDF is negative, {:.3g} /sr, at {:.0f} deg in and {:.0f} deg out",
                                           value, std::acos(i / 100.0) * 180 / pi, std::acos(k / 100.0) * 180 / pi),
                               "raise the constant term");
      }
  if (!whole) return;
  p.prepare();
  out.add(p);
}

namespace {

// Direction of the grooves; the same for all models of a material.
bool read_lay(Node const& law, Optic& optic) {
  static constexpr std::array<std::string_view, 2> words = {"around", "along"};
  Node const node = law["lay"];
  if (!node) {
    law.problem("key 'lay' (direction of the grooves) is missing",
                "write lay: around (turned), lay: along (drawn) or a direction of the scene, [1, 0, 0]");
    return false;
  }
  Lay lay = Lay::given;
  Vec3 direction;
  if (node.kind() == Node::Kind::list) {
    auto const given = read_direction(node);
    if (!given) return false;
    direction = *given;
  } else {
    lay = law.choice("lay", words) == "along" ? Lay::along : Lay::around;
  }
  bool const other = optic.lay != Lay::free && (optic.lay != lay || length(optic.lay_direction - direction) > 1e-9);
  if (other)
    node.problem("the grooves of one material have one direction", "give all models of the material the same 'lay'");
  optic.lay = lay;
  optic.lay_direction = direction;
  return !other;
}

}  // namespace

void read_grooves(Node const& law, LawReading& out) {
  Grooves p;
  bool const whole = read_model_keys(law, p), laid = read_lay(law, *out.optic);
  bool sound = whole && laid;
  for (char const* key : {"through", "weight"})
    if (Node const other = law[key]) {
      other.problem(fmt::format("'grooves' does not take '{}'", key), "remove it, or use another model");
      sound = false;
    }
  if (!sound) return;
  prepare(p, out.world.laws<Grooves>());
  out.add(p);
}

// docs/theory/surfaces.md: isotropic floor; obstacles take twice their area out of the beam, half of it by diffraction.
void read_defects(Node const& law, LawReading& out) {
  if (first_of(law, "tis", "coverage")) {
    out.add(Lambertian{law.number("tis", dim::plain, required, 0, 1)});
    return;
  }
  double const covered = law.number("coverage", dim::plain, required, 0, 0.4),
               diameter = law.number("diameter", dim::length, required, 1e-7, 1),
               wavelength = law_wavelength(law, out.world);
  double const albedo = law.number("albedo", dim::plain, 1, 0, 1);
  if (!(covered >= 0 && diameter > 0 && wavelength > 0 && albedo >= 0)) return;
  if (diameter < 2 * wavelength) {
    law["diameter"].problem(
        "defects this small do not block light (docs/theory/surfaces.md, eq. 3.24 is for large ones)",
        "give their total as 'tis', or use 'dust' with its size");
    return;
  }
  out.add(Lambertian{albedo * covered});
  Harvey lobe;  // slope -3: the envelope of the Airy pattern; peak and total as diffraction at discs of this diameter
  lobe.width = std::sqrt(2.0) * wavelength / (pi * diameter);
  lobe.slope = -3;
  lobe.b0 = covered / (2 * pi * lobe.width * lobe.width);
  lobe.prepare();
  out.add(lobe);
}

void read_dust(Node const& law, LawReading& out) {
  Dust p;
  double const wavelength = law_wavelength(law, out.world), index = law.number("index", dim::plain, 1.5, 0.01, 20),
               extinction = law.number("extinction", dim::plain, 0, 0, 20);
  p.reflectance = law.number("reflectance", dim::plain, required, 0, 1);
  std::vector<Grain> sizes;
  if (law.has("diameter")) {
    if (law.has("level")) law.problem("'diameter' and 'level' both give the sizes", "keep one of them");
    double const diameter = law.number("diameter", dim::length, required, 1e-9, 1e-3),
                 coverage = law.number("coverage", dim::plain, required, 0, 0.4);
    if (diameter > 0 && coverage >= 0) sizes = {{diameter, coverage / (pi * diameter * diameter / 4)}};
  } else {
    Cleanliness c;
    c.level = law.number("level", dim::plain, required, 2, 2000);
    c.slope = law.number("slope", dim::plain, 0.926, 0.1, 2);
    c.smallest = law.number("smallest", dim::length, 1e-6, 1e-8, 1e-3);
    if (c.smallest < c.level * 1e-6 && c.slope > 0) {
      sizes = grains(c);
      out.note(fmt::format("dust covers {:.3g} % of the area (fit of the standard: {:.3g} %)", 100 * c.covered(),
                           100 * c.covered_by_fit()));
    } else if (c.level > 0 && c.smallest > 0) {
      law.problem("'smallest' is not below the level, so there are no particles",
                  "the level is the largest size in um");
    }
  }
  if (sizes.empty() || !(wavelength > 0 && index > 0 && extinction >= 0 && p.reflectance >= 0)) return;
  set_grains(p, sizes, wavelength, index, extinction, out.world.storage);
  p.prepare();
  out.add(p);
}

// Models from a power spectrum of heights: k-correlation, psd, harvey-shack (docs/theory/surfaces.md).

namespace {

constexpr Dimension metre3{6}, metre4{8};

// The film of `specular`, which is read first; null, and a problem, when there is none.
Film const* film_of(Node const& where, LawReading const& out) {
  Optic const& optic = *out.optic;
  if (optic.has_interface && optic.interface.kind == kind_of<Film, SpecularTypes>())
    return &std::get<View<Film const>>(out.world.view().interfaces.arrays)[optic.interface.index];
  where.problem("'interfaces' needs the layers of the coating",
                "describe it: specular: {film: {layers: [[2.07, quarter], [1.45, quarter]]}, index: fused_silica}");
  return nullptr;
}

// Index behind the film: `substrate`, or what the film says; 0 after a problem.
Complex behind_film(Node const& law, Film const& film, LawReading const& out) {
  if (Node const given = law["substrate"]) {
    bool const named = given.kind() == Node::Kind::scalar && is_medium(given.text(), *out.names);
    if (!named) return {given.as_number(dim::plain, 0.1, 10), 0};
    auto const medium = find_medium(given, out.world, *out.names);
    return {medium ? medium->index : 0, 0};
  }
  if (film.opaque.re > 0 || film.opaque.im > 0) return film.opaque;
  if (film.back_index > 0) return {film.back_index, 0};
  law.problem("the body behind the film is not known here",
              "write substrate: fused_silica, 'index' next to 'film', or 'between' of the film");
  return {};
}

// Scatter from all interfaces of the film of the material.
void read_interfaces(Node const& law, LawReading& out, Roughness& p, double wavelength) {
  Node const how = law["interfaces"];
  for (char const* key : {"index", "reflectance"})
    if (law.has(key))
      law[key].problem(fmt::format("'{}' and 'interfaces' both give the factor Q", key), "keep one of them");
  if (p.harvey_shack)
    how.problem("scatter of interfaces is of first order, Harvey-Shack is not", "write 'theory: rayleigh-rice'");
  bool const words = how.kind() == Node::Kind::scalar && (how.text() == "correlated" || how.text() == "uncorrelated");
  RoughStack stack;
  stack.common = words ? (how.text() == "correlated" ? 1 : 0) : how.as_number(dim::plain, 0, 1);
  Film const* const film = film_of(how, out);
  if (!film) {
    law.has("substrate");
    return;
  }
  stack.behind = behind_film(law, *film, out);
  stack.layers.assign(film->layers.data, film->layers.data + film->layers.size);
  stack.wavelength = wavelength;
  if (!(norm(stack.behind) > 0) || !(wavelength > 0) || !std::isfinite(stack.common)) return;
  p.stack = stack.tabulated(out.world.storage);
  Complex const first = stack.layers.empty() ? stack.behind : stack.layers.front().index;
  double const back = stack.factor(1, 1, 1), front = norm(Fresnel::of_opaque(1, 1, first).rs);
  out.note(
      fmt::format("{} rough interfaces, {:.0f} % correlated: near normal incidence they scatter {:.4g} times as "
                  "much as a perfect mirror with the same heights, their first face alone {:.4g} times",
                  stack.layers.size() + 1, 100 * stack.common, back, front));
}

void read_factor(Node const& law, LawReading& out, Roughness& p, double wavelength) {
  bool const first_order = law["model"].text() != "harvey-shack";
  if (first_order && law.has("interfaces")) return read_interfaces(law, out, p, wavelength);
  if (first_order && law.has("substrate"))
    law["substrate"].problem("'substrate' needs 'interfaces'", "write interfaces: correlated");
  if (law.has("index")) {
    if (law.has("reflectance")) law.problem("'reflectance' and 'index' both give the factor Q", "keep one of them");
    double const n = law.number("index", dim::plain, required, 0, 100),
                 k = law.number("extinction", dim::plain, 0, 0, 100);
    p.factor.permittivity_re = n * n - k * k;
    p.factor.permittivity_im = 2 * n * k;
  } else {
    if (law.has("extinction")) law.problem("'extinction' needs 'index'", "give 'index', the real part, too");
    p.factor.reflectance = law.number("reflectance", dim::plain, 1, 0, 1);
  }
}

void read_theory(Node const& law, Roughness& p) {
  static constexpr std::string_view theories[] = {"rayleigh-rice", "harvey-shack"};
  p.harvey_shack = law.choice("theory", theories, "rayleigh-rice") == "harvey-shack";
}

// Checks the range of the theory, then prepares.
void finish(Node const& law, LawReading& out, Roughness& p, double wavelength) {
  double const rms = std::sqrt(p.variance(0, 1)), g = tis_smooth(rms, 1, 1);
  if (!(g < 1e6)) return law.problem("the spectrum has no finite roughness below 1/wavelength", "give it a lower end");
  out.note(
      fmt::format("rms roughness {:.3g} nm at spatial frequencies below 1/wavelength, (4 pi sigma/lambda)^2 = {:.3g}",
                  rms * wavelength * 1e9, g));
  if (!p.harvey_shack && g > 0.1)
    law.warning(fmt::format("(4 pi sigma/lambda)^2 is {:.2g}: too rough for Rayleigh-Rice", g),
                "write 'theory: harvey-shack'");
  if (g > 6)
    return law.problem(fmt::format("(4 pi sigma/lambda)^2 is {:.3g}: too rough for a model of mirrors (at most 6)", g),
                       "describe the surface by a diffuse model, or measure it ('model: table')");
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
  read_factor(law, out, p, wavelength);
  if (!(wavelength > 0 && knee > 0 && c > 0 && a >= 0) || (law.has("rms") && c <= 1)) return;
  p.a = a / std::pow(wavelength, 4);
  p.b = knee / wavelength;
  p.c = c;
  finish(law, out, p, wavelength);
}

// Two columns: spatial frequency and spectrum; at least two rows, frequencies increasing, values above zero.
HeightSpectrum points_of(Node const& law, std::string const& name, bool profile) {
  std::string const example = profile ? "f [1/mm], s1 [nm^2*mm]" : "f [1/mm], s2 [nm^4]";
  CsvTable const file = read_csv_table(law["file"], name, Comments::anywhere, example);
  HeightSpectrum points;
  if (file.columns.empty()) return points;
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
  for (CsvTable::Row const& row : file.rows) {
    double const f = row.values[0], value = row.values[1];
    if (!(f > 0) || (!points.empty() && f <= points.back().f))
      return problem(row.line(), row.cells[0].column, "the frequency does not increase", "sort the rows; remove f = 0");
    if (!(value > 0))
      return problem(row.line(), row.cells[1].column, fmt::format("spectrum {:g} at {:g} 1/m", value, f),
                     "a density must be positive; remove points below the noise floor");
    points.push_back({f, value});
  }
  if (!file.whole) return {};
  if (points.size() < 2) return problem(file.rows[0].line(), 1, "fewer than two rows", "give at least two frequencies");
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
  read_factor(law, out, p, wavelength);
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
          fmt::format("the profile spectrum rises beyond {:.3g} 1/m, which is impossible for an isotropic surface",
                      q.f),
          "smooth it, or end it there");
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

namespace {

// Models that need more than numbers: files, lists, several models of the list. Those of the list keep its order, the
// others follow.
constexpr LawReader special_readers[] = {{"polynomial", read_polynomial},
                                         {"grooves", read_grooves},
                                         {"k-correlation", read_k_correlation},
                                         {"psd", read_psd},
                                         {"harvey-shack", read_harvey_shack},
                                         {"dust", read_dust},
                                         {"table", read_measured},
                                         {"defects", read_defects}};

constexpr LawReader const* special_reader(std::string_view model) {
  for (LawReader const& reader : special_readers)
    if (reader.model == model) return &reader;
  return nullptr;
}

template <class Model>
LawReader reader_of() {
  if constexpr (constexpr LawReader const* special = special_reader(Model::key); special != nullptr)
    return *special;
  else
    return {Model::key, read_model<Model>};
}

template <class... Model>
std::vector<LawReader> all_readers(std::type_identity<std::tuple<Model...>>) {
  std::vector<LawReader> all{reader_of<Model>()...};
  for (LawReader const& reader : special_readers)
    if (((reader.model != Model::key) && ...)) all.push_back(reader);
  return all;
}

}  // namespace

std::span<LawReader const> law_readers() {
  static std::vector<LawReader> const all = all_readers(std::type_identity<LawTypes>());
  return all;
}

}  // namespace straytrace::world
