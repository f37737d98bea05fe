// SPDX-License-Identifier: BSD-3-Clause
// Zemax tabular BSDF: scatter about the specular direction, by azimuth and by angle from it, a total for each
// incidence.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "base/input/document.hpp"
#include "base/input/table.hpp"
#include "base/math/constants.hpp"
#include "base/math/vec3.hpp"
#include "io/delimited_text.hpp"
#include "world/scatter_data/scatter_file.hpp"

namespace straytrace::world {
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
      TextCell const key = in_.next();
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
  void word(TextCell const& key) {
    auto const words = in_.rest_of_line(key);
    if (words.empty()) return in_.refuse(key, fmt::format("'{}' has no value", key.text), "write its value after it");
    if (key.text == "Symmetry") symmetry_ = words[0].text;
    if (key.text == "SpectralContent") spectral_ = words[0].text;
    if (key.text == "ScatterType") type_ = words[0].text;
  }
  void list(TextCell const& key, std::vector<double>& into) {
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
                 fmt::format("{} rotations of the sample: the surface is anisotropic, the model 'table' is isotropic",
                             rotation_.size()),
                 "keep one rotation, or describe grooves by the model 'grooves'");
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
      std::vector<TextCell> places;
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
      in_.refuse(in_.peek(), "'DataEnd' is expected here: the numbers of values and of angles differ",
                 fmt::format("give {} values for each incidence", azimuth_.size() * radial_.size()));
  }

  void keep(double incidence, std::vector<double> const& values, std::vector<TextCell> const& places) {
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

  WordReader in_;
  ScatterFile& file_;
  std::string symmetry_, type_, spectral_ = "Monochrome";
  std::vector<double> rotation_, incidence_, azimuth_, radial_;  // deg
};

}  // namespace

void read_zemax_table(std::string_view text, ScatterFile& file, std::vector<Problem>& problems) {
  ZemaxReader(text, file, problems).read();
}

// Zemax ABg catalogues: entries of a name, a wavelength and rows of incidence, A, B, g (docs/theory/surfaces.md,
// eq. 3.16).

namespace {

struct Row {
  double theta_i, a, b, g;  // rad, 1/sr, 1, 1
  TextCell where;
};
struct Entry {
  std::string name;
  double wavelength = 0;  // m
  std::vector<Row> rows;
  TextCell where;
};

class CatalogueReader {
 public:
  explicit CatalogueReader(std::vector<Problem>& problems) : problems_(problems) {}
  std::vector<Entry> entries;

  void line(TextLine const& line) {
    auto const words = words_of(line);
    std::string_view const key = words[0].text;
    if (key == "NAME") return name(line, words);
    if (entries.empty()) return complain(problems_, words[0], "numbers before any 'NAME'", "begin with 'NAME paint'");
    if (key == "WAVE" || key == "WAVELENGTH") return wave(words);
    bool const data = key == "DATA";
    if (!data && !is_number(key) && !has_digit(key))
      return complain(problems_, words[0], fmt::format("unknown keyword '{}'", key), "known: NAME, WAVE, DATA");
    row({words.begin() + (data ? 1 : 0), words.end()}, words[0]);
  }

 private:
  static bool has_digit(std::string_view s) { return s.find_first_of("0123456789") != s.npos; }
  void name(TextLine const& line, std::vector<TextCell> const& words) {
    if (words.size() < 2)
      return complain(problems_, words[0], "'NAME' without a name", "write for example 'NAME paint'");
    Entry e;
    e.name = without_blanks(line.text.substr(line.text.find("NAME") + 4));
    e.where = words[1];
    for (Entry const& other : entries)
      if (other.name == e.name)
        complain(problems_, words[1], fmt::format("entry '{}' appears twice", e.name), "choose another name");
    entries.push_back(e);
  }
  void wave(std::vector<TextCell> const& words) {
    auto const um = words.size() == 2 ? number_in(words[1].text) : std::nullopt;
    if (!um || *um < 0 || *um > 1000)
      return complain(problems_, words.back(), "'WAVE' needs the wavelength in micrometres",
                      "write for example 'WAVE 1.064'");
    entries.back().wavelength = *um * 1e-6;
  }
  void row(std::vector<TextCell> const& words, TextCell const& first) {
    static constexpr char const* what[] = {"the angle of incidence in deg", "A", "B", "g"};
    if (words.size() != 4)
      return complain(problems_, first, fmt::format("{} numbers in a row", words.size()),
                      "write four: angle of incidence in deg, A, B, g");
    double x[4] = {};
    for (std::size_t i = 0; i < 4; ++i) {
      auto const value = number_in(words[i].text);
      if (!value) return complain_of_number(problems_, words[i], what[i]);
      x[i] = *value;
      bool const fits = i == 0 ? x[0] >= 0 && x[0] < 90 : x[i] >= 0;
      if (!fits)
        return complain(problems_, words[i], fmt::format("{} is {:g}", what[i], x[i]),
                        i == 0 ? "give 0 to below 90 deg" : "give 0 or more");
    }
    if (x[2] == 0 && x[3] >= 2)
      return complain(problems_, words[2], fmt::format("B = 0 with g = {:g}: an infinite total", x[3]),
                      "give B above 0");
    entries.back().rows.push_back({x[0] * degree, x[1], x[2], x[3], words[1]});
  }
  std::vector<Problem>& problems_;
};

Entry const* chosen(std::vector<Entry> const& all, std::string const& wanted, std::vector<Problem>& problems) {
  std::vector<std::string> names;
  for (Entry const& e : all) {
    if (e.name == wanted || (wanted.empty() && all.size() == 1)) return &e;
    names.push_back(e.name);
  }
  complain(problems, {},
           wanted.empty() ? fmt::format("the catalogue has {} entries", all.size())
                          : fmt::format("the catalogue has no entry '{}'", wanted),
           did_you_mean(wanted, names,
                        fmt::format("name one with 'entry' (--entry in a command): {}", fmt::join(names, ", "))));
  return nullptr;
}

}  // namespace

void read_abg_catalogue(std::string_view text, ScatterFile& file, std::vector<Problem>& problems) {
  std::size_t const before = problems.size();
  CatalogueReader reader(problems);
  for (TextLine const& line : text_lines(text, Comments::anywhere)) reader.line(line);
  if (problems.size() > before) return;
  Entry const* const e = chosen(reader.entries, file.declared.entry, problems);
  if (!e) return;
  if (e->rows.empty()) return complain(problems, e->where, fmt::format("entry '{}' has no row", e->name), "add one");
  if (e->wavelength > 0) file.declared.wavelength = e->wavelength;
  for (Row const& r : e->rows) {
    for (int i = 0; i <= 320; ++i) {  // a formula has no points: as dense as the table that is made of it
      ScatterPoint p;
      p.theta_i = r.theta_i;
      p.theta_s = p.phi = std::numeric_limits<double>::quiet_NaN();
      p.offset = 1e-6 * std::pow(1.999e6, i / 320.0);
      p.value = r.a / (r.b + std::pow(p.offset, r.g));
      p.line = r.where.line;
      p.column = r.where.column;
      file.points.push_back(p);
    }
    file.notes.push_back(fmt::format("{:g} deg: A = {:g} /sr, B = {:g}, g = {:g}", r.theta_i / degree, r.a, r.b, r.g));
  }
  file.notes.push_back(
      fmt::format("entry '{}' of {}; formulas, not measured points; beyond its rows the nearest row applies", e->name,
                  reader.entries.size()));
}

}  // namespace straytrace::world
