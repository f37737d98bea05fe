// SPDX-License-Identifier: BSD-3-Clause
// Zemax tabular BSDF: scatter about the specular direction, by azimuth and by angle from it, a total for each
// incidence.
#include <fmt/format.h>

#include <cmath>

#include "base/constants.hpp"
#include "base/vec3.hpp"
#include "world/degree.hpp"
#include "world/measured/scatter_file.hpp"
#include "world/measured/text_tokens.hpp"

namespace straytrace {
namespace {

// Azimuth 0 points from the specular direction towards the normal.
Vec3 outgoing(double incidence, double azimuth, double radial) {
  Vec3 const specular{std::sin(incidence), 0, std::cos(incidence)}, up{-std::cos(incidence), 0, std::sin(incidence)};
  return std::cos(radial) * specular + std::sin(radial) * (std::cos(azimuth) * up + std::sin(azimuth) * Vec3{0, 1, 0});
}

class ZemaxReader {
 public:
  ZemaxReader(std::string_view text, ScatterFile& file, std::vector<Problem>& problems)
      : in_(text, problems), file_(file) {}

  void read() {
    header();
    if (in_.sound) check_header();
    if (in_.sound) data();
    if (!in_.sound) return;
    file_.notes.push_back(
        fmt::format("{}, {}; {} incidences, {} azimuths, {} radial angles about the specular direction", symmetry_,
                    type_, incidence_.size(), azimuth_.size(), radial_.size()));
  }

 private:
  void header() {
    while (in_.sound && !in_.is_next("DataBegin")) {
      Token const key = in_.next();
      if (key.line == 0)
        return in_.refuse(key, "the line 'DataBegin' is missing", "the file is cut off: export it again");
      if (key.text == "Source" || key.text == "Symmetry" || key.text == "SpectralContent" || key.text == "ScatterType")
        word(key);
      else if (key.text == "SampleRotation")
        list(key, rotation_);
      else if (key.text == "AngleOfIncidence")
        list(key, incidence_);
      else if (key.text == "ScatterAzimuth")
        list(key, azimuth_);
      else if (key.text == "ScatterRadial")
        list(key, radial_);
      else if (key.text.starts_with("Tristimulus"))
        spectral_ = "XYZ";
      else if (key.text != "Monochrome")
        in_.refuse(key, fmt::format("unknown keyword '{}'", key.text),
                   "known: Source, Symmetry, SpectralContent, ScatterType, SampleRotation, AngleOfIncidence, "
                   "ScatterAzimuth, ScatterRadial, DataBegin");
    }
  }
  void word(Token const& key) {
    auto const words = in_.rest_of_line(key);
    if (words.empty()) return in_.refuse(key, fmt::format("'{}' says nothing", key.text), "write its value behind it");
    if (key.text == "Symmetry") symmetry_ = words[0].text;
    if (key.text == "SpectralContent") spectral_ = words[0].text;
    if (key.text == "ScatterType") type_ = words[0].text;
  }
  void list(Token const& key, std::vector<double>& into) {
    double const count = in_.number(fmt::format("the number of values of {}", key.text));
    if (in_.sound && !(count >= 1 && count <= 1e5 && count == std::floor(count)))
      return in_.refuse(key, fmt::format("{:g} values of {}", count, key.text), "write a whole number, 1 or more");
    into = in_.numbers(std::size_t(count), std::string(key.text));
    for (std::size_t i = 1; i < into.size() && in_.sound; ++i)
      if (!(into[i] > into[i - 1]))
        in_.refuse(key,
                   fmt::format("the values of {} do not increase: {:g} after {:g}", key.text, into[i], into[i - 1]),
                   "sort them, together with the data");
  }

  void check_header() {
    auto const missing = [&](char const* key, bool is) {
      if (is) in_.refuse({}, fmt::format("keyword '{}' is missing", key), "export the file again, with its header");
    };
    missing("Symmetry", symmetry_.empty());
    missing("ScatterType", type_.empty());
    missing("AngleOfIncidence", incidence_.empty());
    missing("ScatterAzimuth", azimuth_.empty());
    missing("ScatterRadial", radial_.empty());
    bool const half = symmetry_ == "PlaneSymmetrical",
               known = half || symmetry_ == "Asymmetrical" || symmetry_ == "ASymmetrical" ||
                       symmetry_ == "Asymmetrical4D" || symmetry_ == "ASymmetrical4D";
    if (!known)
      in_.refuse({}, fmt::format("unknown Symmetry '{}'", symmetry_),
                 "PlaneSymmetrical, Asymmetrical or Asymmetrical4D");
    if (type_ != "BRDF" && type_ != "BTDF")
      in_.refuse({}, fmt::format("unknown ScatterType '{}'", type_), "BRDF or BTDF");
    if (spectral_ != "Monochrome")
      in_.refuse({}, "the data are colours (XYZ), not scatter at one wavelength", "measure at one wavelength");
    if (rotation_.size() > 1)
      in_.refuse({},
                 fmt::format("{} rotations of the sample: the surface has a direction, the law 'table' has none",
                             rotation_.size()),
                 "keep one rotation, or describe grooves by the law 'grooves'");
    if (half && in_.sound && (azimuth_.front() < 0 || azimuth_.back() > 180))
      in_.refuse({}, "PlaneSymmetrical with azimuths beyond 0 to 180 deg", "write Asymmetrical");
    for (double t : incidence_)
      if (!(t >= 0 && t < 90)) in_.refuse({}, fmt::format("incidence of {:g} deg", t), "give 0 to below 90 deg");
    file_.transmitted = type_ == "BTDF";
  }

  void data() {
    in_.next();  // DataBegin
    for (double const t : incidence_) {
      double stated = -1;
      if (in_.is_next("TIS")) {
        in_.next();
        stated = in_.number("the total (TIS)");
      }
      std::vector<Token> places;
      std::vector<double> values;
      std::size_t const count = azimuth_.size() * radial_.size();
      for (std::size_t i = 0; i < count && in_.sound; ++i) {
        places.push_back(in_.peek());
        values.push_back(in_.number(fmt::format("value {} of {} at {:g} deg of incidence", i + 1, count, t)));
      }
      if (!in_.sound) return;
      keep(t * degree, values, places);
      if (stated >= 0) file_.stated.push_back({t * degree, stated, integral(t * degree, values)});
    }
    if (!in_.is_next("DataEnd"))
      in_.refuse(in_.peek(), "'DataEnd' should stand here: the numbers of values and of angles differ",
                 fmt::format("give {} values for each incidence", azimuth_.size() * radial_.size()));
  }

  void keep(double incidence, std::vector<double> const& values, std::vector<Token> const& places) {
    for (std::size_t a = 0; a < azimuth_.size(); ++a)
      for (std::size_t r = 0; r < radial_.size(); ++r) {
        Vec3 const out = outgoing(incidence, azimuth_[a] * degree, radial_[r] * degree);
        if (!(out.z > 1e-9)) continue;
        std::size_t const i = a * radial_.size() + r;
        ScatterPoint p =
            scatter_point(incidence, std::acos(std::fmin(1.0, out.z)), std::atan2(out.y, out.x), values[i]);
        p.line = places[i].line;
        p.column = places[i].column;
        file_.points.push_back(p);
      }
  }

  // BSDF cos_s over the hemisphere: linear between the points in both angles, 4 x 8 midpoints in each cell; the last
  // azimuth is joined to the first where the data go round.
  double integral(double incidence, std::vector<double> const& values) const {
    bool const half = symmetry_ == "PlaneSymmetrical";
    std::size_t const n = azimuth_.size(), m = radial_.size();
    double sum = 0;
    for (std::size_t a = 0; a < n; ++a) {
      bool const last = a + 1 == n;
      if (last && (half ? n > 1 : azimuth_.back() - azimuth_.front() > 359.999)) break;
      double const from = azimuth_[a], to = !last ? azimuth_[a + 1] : half ? from + 180 : azimuth_[0] + 360;
      double const* const low = &values[a * m];
      double const* const high = &values[(last ? 0 : a + 1) * m];
      for (std::size_t r = 0; r + 1 < m; ++r)
        for (int i = 0; i < 4; ++i)
          for (int k = 0; k < 8; ++k) {
            double const u = (i + 0.5) / 4, v = (k + 0.5) / 8, radial = radial_[r] + v * (radial_[r + 1] - radial_[r]);
            double const at_low = low[r] + v * (low[r + 1] - low[r]), at_high = high[r] + v * (high[r + 1] - high[r]);
            Vec3 const out = outgoing(incidence, (from + u * (to - from)) * degree, radial * degree);
            double const area =
                std::sin(radial * degree) * (radial_[r + 1] - radial_[r]) * (to - from) * degree * degree;
            sum += (at_low + u * (at_high - at_low)) * std::fmax(0.0, out.z) * area / 32;
          }
    }
    return half ? sum * 360 / (n > 1 ? azimuth_.back() - azimuth_.front() : 180) : sum;
  }

  TokenReader in_;
  ScatterFile& file_;
  std::string symmetry_, type_, spectral_ = "Monochrome";
  std::vector<double> rotation_, incidence_, azimuth_, radial_;  // deg
};

}  // namespace

void read_zemax_table(std::string_view text, ScatterFile& file, std::vector<Problem>& problems) {
  ZemaxReader(text, file, problems).read();
}

}  // namespace straytrace
