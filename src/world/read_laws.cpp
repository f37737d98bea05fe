// SPDX-License-Identifier: BSD-3-Clause
#include "world/read_laws.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "base/message.hpp"

namespace straytrace {
namespace {

// One of two keys for the same thing; returns whether `first` is given.
bool first_of(Node const& law, char const* first, char const* second) {
  bool const given = law.has(first);
  if (given && law.has(second))
    law.problem(fmt::format("'{}' and '{}' say the same thing twice", second, first), "keep one of them");
  return given;
}

}  // namespace

double law_wavelength(Node const& law, World const& world) {
  return law.number("wavelength", dim::length, world.wavelength, 1e-8, 1e-3);
}

void read_lambertian(Node const& law, LawReading& out) {
  double const reflectance = first_of(law, "brdf", "tis") ? pi * law.number("brdf", dim::brdf, required, 0, 1 / pi)
                                                          : law.number("tis", dim::plain, required, 0, 1);
  out.add(Lambertian{reflectance});
}

void read_power_law(Node const& law, LawReading& out) {
  PowerLaw p;
  p.exponent = law.number("exponent", dim::plain, 2, 0, 8);
  p.above = law.number("above", dim::angle, required, 1e-9, 1.5);
  if (law.has("tis")) {
    if (law.has("kappa")) law.problem("'tis' and 'kappa' say the same thing twice", "keep one of them");
    if (p.exponent != 2)
      law.problem("a total is defined for exponent 2 only (docs/theory/surfaces.md, eq. 3.19)", "give 'kappa'");
    double const tis = law.number("tis", dim::plain, required, 0, 1);
    p.kappa = p.above > 0 ? tis * statistical_kappa(p.above) / (2 * pi) : 0;
  } else {
    p.kappa = law.number("kappa", dim::brdf, required, 0, 1e3);
  }
  if (!(p.above > 0 && p.kappa >= 0 && std::isfinite(p.exponent))) return;
  p.prepare();
  out.add(p);
}

void read_abg(Node const& law, LawReading& out) {
  Abg p;
  p.a = law.number("a", dim::brdf, required, 0, 1e6);
  p.b = law.number("b", dim::plain, required, 1e-12, 1e6);
  p.g = law.number("g", dim::plain, required, 0, 8);
  if (!(p.a >= 0 && p.b > 0 && p.g >= 0)) return;
  p.prepare();
  out.add(p);
}

void read_harvey(Node const& law, LawReading& out) {
  Harvey p;
  p.width = law.number("l", dim::plain, required, 1e-7, 10);
  p.slope = law.number("s", dim::plain, required, -8, 0);
  if (law.has("l_across")) p.across = law.number("l_across", dim::plain, required, 1e-7, 10);
  if (p.across > 0 && (p.across > 4 * p.width || p.across < p.width / 4))
    law.problem("'l_across' is more than a factor 4 from 'l'", "use two laws, or a factor of 4 at most");
  bool const absolute = first_of(law, "b0", "tis");
  double const given =
      absolute ? law.number("b0", dim::brdf, required, 0, 1e9) : law.number("tis", dim::plain, required, 0, 1);
  if (!(p.width > 0 && std::isfinite(p.slope) && given >= 0 && p.across >= 0)) return;
  p.b0 = 1;
  p.b0 = absolute ? given : given / p.tis();
  p.prepare();
  out.add(p);
}

void read_gaussian(Node const& law, LawReading& out) {
  Gaussian p;
  p.width = law.number("width", dim::plain, required, 1e-7, 10);
  bool const absolute = first_of(law, "peak", "tis");
  double const given =
      absolute ? law.number("peak", dim::brdf, required, 0, 1e12) : law.number("tis", dim::plain, required, 0, 1);
  if (!(p.width > 0 && given >= 0)) return;
  double const square = 2 * p.width * p.width;
  p.peak = absolute ? given : given / (-pi * square * std::expm1(-1 / square));
  p.prepare();
  out.add(p);
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
        law["diffuse"].problem(fmt::format("c_{}{} and c_{}{} differ, so the law is not reciprocal", j, k, k, j),
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

void read_microfacet(Node const& law, LawReading& out) {
  Microfacet p;
  p.alpha = law.number("roughness", dim::plain, required, 1e-4, 1);
  p.reflectance = law.number("reflectance", dim::plain, required, 0, 1);
  p.grazing = law.number("grazing", dim::plain, p.reflectance, 0, 1);
  if (!(p.alpha > 0 && p.reflectance >= 0 && p.grazing >= 0)) return;
  p.prepare();
  out.add(p);
}

namespace {

// How the grooves run; all of one material run one way.
bool read_lay(Node const& law, Optic& optic) {
  static constexpr std::array<std::string_view, 2> words = {"around", "along"};
  Node const node = law["lay"];
  if (!node) {
    law.problem("key 'lay' (how the grooves run) is missing",
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
  if (other) node.problem("the grooves of one material run one way", "give all laws of the material the same 'lay'");
  optic.lay = lay;
  optic.lay_direction = direction;
  return !other;
}

}  // namespace

void read_grooves(Node const& law, LawReading& out) {
  Grooves p;
  p.across = law.number("across", dim::plain, required, 1e-3, 1);
  p.along = law.number("along", dim::plain, required, 1e-4, 1);
  p.reflectance = law.number("reflectance", dim::plain, required, 0, 1);
  p.grazing = law.number("grazing", dim::plain, p.reflectance, 0, 1);
  bool sound = read_lay(law, *out.optic) && p.along <= p.across;
  for (char const* key : {"through", "weight"})
    if (Node const other = law[key]) {
      other.problem(fmt::format("'grooves' has no '{}'", key), "leave it out, or use another law");
      sound = false;
    }
  if (p.along > p.across)
    law["along"].problem("'along' is larger than 'across': grooves are steep across and smooth along", "swap the two");
  if (!(sound && p.across > 0 && p.along > 0 && p.reflectance >= 0 && p.grazing >= 0)) return;
  p.prepare();
  out.add(p);
}

// physics.md 3.5, 3.4: isotropic floor; obstacles take twice their area out of the beam, half of it by diffraction.
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
        "defects this small are not obstacles (docs/theory/surfaces.md, eq. 3.24 is for large ones)",
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

}  // namespace straytrace
