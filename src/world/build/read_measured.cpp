// SPDX-License-Identifier: BSD-3-Clause
// The law `table`: measured scatter from a file of any format that world/scatter_data reads.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/input/document.hpp"
#include "world/build/read_laws.hpp"
#include "world/scatter_data/scatter_file.hpp"

namespace straytrace::world {
namespace {

constexpr double far_wavelength = 0.05;  // relative

class MeasuredReader {
 public:
  explicit MeasuredReader(Node const& law) : law_(law) {}

  void read(LawReading& out) {
    if (!read_file()) return;
    out.wavelength = fmt::format("{:g} nm", file.declared.wavelength * 1e9);
    at_wavelength(out);
    MeasuredSummary summary;
    Measured p = law_of_points(file.points, beyond_, summary);
    p.prepare();
    report(p, summary, out);
    out.add(p);
  }

  // False, with problems in the document, when the file cannot be used.
  bool read_file() {
    static constexpr std::string_view rules[] = {"constant", "power", "zero"}, scalings[] = {"none", "smooth"};
    beyond_ = law_.choice("beyond", rules);
    std::string const scaling = law_.choice("scaling", scalings, "none");
    scaled = scaling == "smooth";
    double const scale = law_.number("scale", dim::plain, 1, 1e-6, 1e6);
    ScatterDeclared const given = declared();
    name_ = law_.word("file");
    if (name_.empty() || beyond_.empty() || scaling.empty() || !law_.healthy()) return false;
    std::string const text = law_["file"].data_file(name_);
    if (text.empty() && !law_["file"].document()->optional_file(law_["file"], name_))
      return false;  // data_file() reports it
    std::vector<Problem> problems;
    file = read_scatter_file(text, given, problems);
    if (problems.empty()) check_scatter_points(file.points, problems);
    for (ScatterPoint& p : file.points) {
      p.value *= scale;
      p.error *= scale;
    }
    file.declared.noise_floor *= scale;
    for (Problem const& p : problems)
      law_["file"].file_problem(name_, p.place.line, p.place.column, p.what, p.suggestion);
    return problems.empty() && side_fits();
  }

  ScatterFile file;
  bool scaled = false;

 private:
  ScatterDeclared declared() const {
    static constexpr std::string_view conventions[] = {"from_normal", "from_specular"};
    ScatterDeclared d;
    if (law_.has("wavelength")) d.wavelength = law_.number("wavelength", dim::length, required, 1e-8, 1e-3);
    if (law_.has("angles")) d.angles = law_.choice("angles", conventions);
    if (law_.has("entry")) d.entry = law_.word("entry");
    return d;
  }

  bool side_fits() const {
    bool const through = law_.has("through") && law_.flag("through", false);
    if (!file.transmitted || through) return true;
    law_["file"].problem(fmt::format("'{}' contains scatter through the surface (BTDF)", name_),
                         "write 'through: yes' next to it");
    return false;
  }

  // docs/theory/surfaces.md, eq. 3.8: of a smooth surface the same spatial frequencies scatter at offsets in proportion
  // to the wavelength, with a BSDF that goes as its inverse fourth power.
  void at_wavelength(LawReading& out) {
    double const measured = file.declared.wavelength, wanted = out.world.wavelength, ratio = measured / wanted;
    double const factor = std::pow(ratio, 4);
    if (scaled) {
      for (ScatterPoint& p : file.points) {
        p.offset /= ratio;
        p.value *= factor;
      }
      std::erase_if(file.points, [](ScatterPoint const& p) { return p.offset >= 1 + std::sin(p.theta_i); });
      out.note(
          fmt::format("'{}' scaled from {:g} nm to {:g} nm as a smooth surface: BSDF times {:.4g}, offsets times "
                      "{:.4g} (eq. 3.8)",
                      name_, measured * 1e9, wanted * 1e9, factor, 1 / ratio));
    } else if (std::fabs(ratio - 1) > far_wavelength) {
      law_.warning(fmt::format("'{}' was measured at {:g} nm, the scene is at {:g} nm; nothing is scaled", name_,
                               measured * 1e9, wanted * 1e9),
                   fmt::format("a smooth surface would scatter {:.3g} times as much at {:.3g} times the offset (eq. "
                               "3.8): 'scaling: smooth' does that; a rough or black one changes little",
                               factor, 1 / ratio));
    }
  }

  void report(Measured const& p, MeasuredSummary const& s, LawReading& out) {
    out.note(fmt::format(
        "'{}' ({}): {:g} angles of incidence up to {:.3g} deg, |alpha - alpha_0| from {:.3g} to {:.3g}; {} beyond; "
        "reciprocity violated by a factor of up to {:.3g}, removed by averaging over exchanged directions",
        name_, file.format, p.incidences, std::asin(p.sine[int(p.incidences) - 1]) / (pi / 180), s.smallest_offset,
        s.largest_offset, beyond_, s.asymmetry));
    if (file.incidences_left_out > 0)
      law_.warning(fmt::format("the file has {} angles of incidence, of which {} are used",
                               p.incidences + double(file.incidences_left_out), p.incidences),
                   "the law holds no more; leave out those that matter least yourself to choose");
    auto const limits = std::ranges::count_if(file.points, [](auto const& q) { return q.limit; });
    if (limits > 0)
      law_.warning(fmt::format("{} of {} points are upper limits at the noise floor of {:.3g} /sr", limits,
                               file.points.size(), file.declared.noise_floor),
                   "the law takes the floor there, which is the most that it may be");
    for (StatedTis const& t : file.stated)
      if (std::fabs(t.integral / t.stated - 1) > stated_tis_tolerance) {
        law_.warning(fmt::format("the file states a total of {:.4g} at {:g} deg, its own values integrate to {:.4g}",
                                 t.stated, t.theta_i / (pi / 180), t.integral),
                     "the values are used; a lobe narrower than the steps of the table is lost in them");
        break;
      }
    if (s.reach < 0.95 || s.smallest_offset > 0.01)
      law_.warning(
          fmt::format("measured for |alpha - alpha_0| from {:.3g} to {:.3g}; beyond, the law is {}", s.smallest_offset,
                      s.largest_offset, beyond_ == "power" ? "continued as a power law" : beyond_),
          "results at other offsets depend on 'beyond'");
    if (s.spread > 1.5)
      law_.warning(
          fmt::format(
              "points of one incidence at the same |alpha - alpha_0| differ by a factor {:.3g}: the surface is not "
              "what this law describes",
              s.spread),
          "their geometric mean is used; remove glints, or use two materials");
    if (s.asymmetry > 1.5)
      law_.warning(fmt::format("the BRDF violates reciprocity by a factor of {:.3g}", s.asymmetry),
                   "the mean is used; check the angles and the cosine ('brdf' or 'brdf_cos')");
  }

  Node law_;
  std::string name_, beyond_;
};

}  // namespace

void read_measured(Node const& law, LawReading& out) { MeasuredReader(law).read(out); }

std::vector<MeasuredPoint> measured_points(Node const& law) {
  MeasuredReader reader(law);
  std::vector<MeasuredPoint> points;
  if (reader.read_file() && !reader.scaled)
    for (ScatterPoint const& p : reader.file.points) points.push_back({std::sin(p.theta_i), p.offset, p.value});
  return points;
}

}  // namespace straytrace::world
