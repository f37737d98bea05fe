// SPDX-License-Identifier: BSD-3-Clause
// Measured BSDF files: columns theta_i, theta_s, (phi) or offset, and brdf or brdf_cos.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "world/read_laws.hpp"

namespace straytrace {
namespace {

constexpr double degree = pi / 180;

class MeasuredReader {
 public:
  explicit MeasuredReader(Node const& law) : law_(law) {}

  void read(LawReading& out) {
    std::vector<MeasuredPoint> points;
    std::string beyond;
    if (!read_points(points, beyond) || !enough(points)) return;
    Measured p;
    auto const s = fit_measured(p, points,
                                beyond == "constant" ? Beyond::constant
                                : beyond == "power"  ? Beyond::power
                                                     : Beyond::zero);
    p.prepare();
    report(p, s, beyond, out);
    out.add(p);
  }
  // False, with problems in the document, when the file cannot be used.
  bool read_points(std::vector<MeasuredPoint>& points, std::string& beyond) {
    static constexpr std::string_view rules[] = {"constant", "power", "zero"},
                                      conventions[] = {"from_normal", "from_specular"};
    beyond = law_.choice("beyond", rules);
    double const wavelength = law_.number("wavelength", dim::length, required, 1e-8, 1e-3);
    law_.has("angles");
    name_ = law_.word("file");
    if (name_.empty()) return false;
    file_ = read_columns(law_["file"], name_, "theta_i [deg], theta_s [deg], brdf [1/sr]");
    bool const by_angle = file_.find("theta_s") >= 0;
    std::string const angles = by_angle ? law_.choice("angles", conventions) : "from_normal";
    if (file_.rows.empty() || !columns_fit() || beyond.empty() || angles.empty() || !(wavelength > 0)) return false;
    for (ColumnFile::Row const& row : file_.rows)
      if (!point(row, angles == "from_specular", points)) return false;
    return true;
  }

 private:
  bool problem(std::uint32_t line, std::uint32_t at, std::string what, std::string suggestion) {
    law_["file"].file_problem(name_, line, at, std::move(what), std::move(suggestion));
    return false;
  }

  bool columns_fit() {
    static constexpr std::string_view known[] = {"theta_i", "theta_s", "phi", "offset", "brdf", "brdf_cos"};
    for (ColumnFile::Column const& c : file_.columns) {
      bool const angle = c.name == "theta_i" || c.name == "theta_s" || c.name == "phi",
                 value = c.name.starts_with("brdf");
      if (std::find(std::begin(known), std::end(known), c.name) == std::end(known))
        return problem(c.line, c.at, fmt::format("unknown column '{}'", c.name),
                       fmt::format("known columns: {}", fmt::join(known, ", ")));
      if (c.unit.dimension != (angle ? dim::angle : value ? dim::brdf : dim::plain))
        return problem(c.line, c.at, fmt::format("column '{}' needs its unit", c.name),
                       fmt::format("write '{}{}'", c.name,
                                   angle   ? " [deg]"
                                   : value ? " [1/sr]"
                                           : ""));
    }
    auto const there = [&](char const* column) { return file_.find(column) >= 0; };
    std::uint32_t const line = file_.columns.front().line;
    if (there("brdf") == there("brdf_cos"))
      return problem(line, 1, "the values must be one of 'brdf' and 'brdf_cos'",
                     "'brdf_cos' is BRDF times cos(theta_s)");
    if (there("offset") == there("theta_s") || (there("phi") && !there("theta_s")))
      return problem(line, 1, "the direction of scatter must be 'offset', or 'theta_s' with or without 'phi'",
                     "offset = |alpha - alpha_0| in direction cosines");
    if (!there("theta_i")) return problem(line, 1, "the angle of incidence is missing", "add a column 'theta_i [deg]'");
    if (there("offset") && there("brdf_cos"))
      return problem(line, 1, "'brdf_cos' needs the angle of scatter, not an offset", "divide by the cosine first");
    return true;
  }

  double value(ColumnFile::Row const& row, char const* column) const {
    int const i = file_.find(column);
    return i < 0 ? 0 : row.values[std::size_t(i)];
  }

  bool point(ColumnFile::Row const& row, bool from_specular, std::vector<MeasuredPoint>& points) {
    auto const at = [&](char const* column) { return row.at[std::size_t(file_.find(column))]; };
    double const incidence = value(row, "theta_i");
    if (!(incidence >= 0 && incidence < pi / 2))
      return problem(row.line, at("theta_i"), fmt::format("incidence of {:g} deg", incidence / degree),
                     "give 0 to below 90 deg");
    bool const by_angle = file_.find("theta_s") >= 0;
    double const scatter = value(row, "theta_s") + (from_specular ? incidence : 0), phi = value(row, "phi");
    if (!(std::fabs(scatter) < pi / 2))
      return problem(row.line, at("theta_s"), fmt::format("scatter at {:g} deg from the normal", scatter / degree),
                     "leave out what is below the surface; check 'angles'");
    MeasuredPoint p;
    p.sin_i = std::sin(incidence);
    double const x = std::sin(scatter) * std::cos(phi) - p.sin_i, y = std::sin(scatter) * std::sin(phi);
    p.offset = by_angle ? std::hypot(x, y) : value(row, "offset");
    if (!(p.offset >= 0 && p.offset < 2))
      return problem(row.line, at("offset"), fmt::format("offset {:g}", p.offset), "give 0 to below 2");
    char const* const column = file_.find("brdf") >= 0 ? "brdf" : "brdf_cos";
    p.value = value(row, column) / (file_.find("brdf") >= 0 ? 1 : std::cos(scatter));
    if (!(p.value > 0))
      return problem(row.line, at(column),
                     by_angle ? fmt::format("BRDF {:g} /sr at {:g} deg", p.value, scatter / degree)
                              : fmt::format("BRDF {:g} /sr at offset {:g}", p.value, p.offset),
                     "leave out points at or below the noise floor");
    points.push_back(p);
    return true;
  }

  bool enough(std::vector<MeasuredPoint> const& points) {
    std::vector<double> sines;
    for (MeasuredPoint const& p : points) {
      bool known = false;
      for (double s : sines) known = known || std::fabs(s - p.sin_i) < 1e-6;
      if (!known) sines.push_back(p.sin_i);
    }
    if (sines.size() > Measured::most_incidences)
      return problem(0, 0, fmt::format("{} angles of incidence", sines.size()),
                     fmt::format("keep {} at most", int(Measured::most_incidences)));
    for (double s : sines) {
      double low = 2, high = 0;
      for (MeasuredPoint const& p : points)
        if (std::fabs(s - p.sin_i) < 1e-6) {
          low = std::fmin(low, p.offset);
          high = std::fmax(high, p.offset);
        }
      if (high < 1.5 * low || high < 1e-6)
        return problem(
            0, 0, fmt::format("the points at {:.4g} deg of incidence cover no range of angles", std::asin(s) / degree),
            "measure several angles of scatter for each incidence, or leave this one out");
    }
    return true;
  }

  void report(Measured const& p, MeasuredSummary const& s, std::string const& beyond, LawReading& out) {
    out.note(fmt::format(
        "'{}': {:g} angles of incidence up to {:.3g} deg, |alpha - alpha_0| from {:.3g} to {:.3g}; {} beyond; "
        "directions exchanged, it differs by a factor up to {:.3g} before the mean is taken",
        name_, p.incidences, std::asin(p.sine[int(p.incidences) - 1]) / degree, s.smallest_offset, s.largest_offset,
        beyond, s.asymmetry));
    if (s.reach < 0.95 || s.smallest_offset > 0.01)
      law_.warning(
          fmt::format("measured for |alpha - alpha_0| from {:.3g} to {:.3g}; beyond, the law is {}", s.smallest_offset,
                      s.largest_offset, beyond == "power" ? "continued as a power law" : beyond),
          "trust what falls outside as far as you trust 'beyond'");
    if (s.spread > 1.5)
      law_.warning(
          fmt::format(
              "points of one incidence at the same |alpha - alpha_0| differ by a factor {:.3g}: the surface is not "
              "what this law describes",
              s.spread),
          "their geometric mean is used; remove glints, or use two materials");
    if (s.asymmetry > 1.5)
      law_.warning(fmt::format("with the directions exchanged the BRDF differs by a factor {:.3g}", s.asymmetry),
                   "the mean is used; check the angles and the cosine ('brdf' or 'brdf_cos')");
  }

  Node law_;
  std::string name_;
  ColumnFile file_;
};

}  // namespace

void read_measured(Node const& law, LawReading& out) { MeasuredReader(law).read(out); }

std::vector<MeasuredPoint> measured_points(Node const& law) {
  std::vector<MeasuredPoint> points;
  std::string beyond;
  MeasuredReader(law).read_points(points, beyond);
  return points;
}

}  // namespace straytrace
