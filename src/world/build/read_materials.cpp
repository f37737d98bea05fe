// SPDX-License-Identifier: BSD-3-Clause
#include "world/build/read_materials.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/files/read_write.hpp"
#include "base/input/document.hpp"
#include "optics/coating/coating.hpp"
#include "optics/coating/specular.hpp"
#include "optics/scatter/angle_weight.hpp"
#include "scene/model_tree.hpp"
#include "world/scatter_data/scatter_file.hpp"

namespace straytrace::world {
namespace {

// Pairs [angle, weight], linear in the angle between them and constant outside.
View<AngleWeight const> read_weight(Node const& law, World& world, PoolRef ref) {
  std::vector<std::pair<double, double>> points;
  bool whole = true;
  for (Node const& pair : law.list("weight")) {
    auto const parts = pair.as_list();
    if (pair.kind() != Node::Kind::list || parts.size() != 2) {
      pair.problem("'weight' is a list of pairs of angle and weight", "write [[0 deg, 1], [80 deg, 3]]");
      return {};
    }
    double const angle = parts[0].as_number(dim::angle, 0, pi / 2), value = parts[1].as_number(dim::plain, 0, 1e6);
    whole = whole && std::isfinite(angle) && std::isfinite(value);
    if (whole && !points.empty() && angle <= points.back().first) {
      pair.problem("the angles of 'weight' do not increase", "sort the pairs");
      return {};
    }
    points.emplace_back(angle, value);
  }
  if (!whole || points.empty()) return {};
  auto const at = [&](double cosine) {
    double const angle = 2 * atan_positive(std::sqrt((1 - cosine) / (1 + cosine)));
    std::size_t i = 0;
    while (i < points.size() && points[i].first <= angle) ++i;
    if (i == 0) return points.front().second;
    if (i == points.size()) return points.back().second;
    double const share = (angle - points[i - 1].first) / (points[i].first - points[i - 1].first);
    return points[i - 1].second + share * (points[i].second - points[i - 1].second);
  };
  std::vector<AngleWeight> one{weight_of(world.view().laws, ref, at)};
  return world.storage.keep(std::move(one));
}

// "5 ppm", "[1, 2]", "{low: 1}", as written.
std::string written_value(NodeData const& data) {
  if (data.kind == Node::Kind::scalar) return data.text;
  std::vector<std::string> parts;
  for (auto const& element : data.elements) parts.push_back(written_value(*element));
  for (NodeData::Entry const& entry : data.entries) parts.push_back(entry.key + ": " + written_value(*entry.value));
  char const* const form = data.kind == Node::Kind::list ? "[{}]" : "{{{}}}";
  return fmt::format(fmt::runtime(form), fmt::join(parts, ", "));
}

// "exponent 2, tis 5 ppm": what a BSDF model states besides its name and where its numbers are from.
std::string written_parameters(Node const& law) {
  constexpr std::array<std::string_view, 5> others{"model", "source", "wavelength", "through", "note"};
  std::vector<std::string> parts;
  for (NodeData::Entry const& entry : law.data()->entries)
    if (std::ranges::find(others, entry.key) == others.end())
      parts.push_back(fmt::format("{} {}", entry.key, shortened(written_value(*entry.value))));
  return fmt::format("{}", fmt::join(parts, ", "));
}

void read_law(Node const& law, LawReading& out, Optic& optic, MaterialInfo& info) {
  if (law.kind() != Node::Kind::table)
    return law.problem("a BSDF model is a table", "write {model: lambertian, tis: 1 %}");
  static std::vector<std::string_view> const names = [] {
    std::vector<std::string_view> all;
    for (LawReader const& reader : law_readers()) all.push_back(reader.model);
    return all;
  }();
  std::string const model = law.choice("model", names);
  std::size_t const before = out.laws.size();
  out.wavelength.clear();
  for (LawReader const& reader : law_readers())
    if (model == reader.model) reader.read(law, out);
  bool const through = law.flag("through", false);
  LawInfo about{model, law.word("source", "not given"),
                law.has("wavelength")    ? law["wavelength"].as_word()
                : out.wavelength.empty() ? "not given"
                                         : out.wavelength,
                written_parameters(law), law.place()};
  for (std::size_t i = before; i < out.laws.size() && i < std::size_t(Optic::most_laws); ++i) {
    optic.law[i] = out.laws[i];
    optic.through[i] = through;
    optic.weight[i] = {};
    if (law.has("weight")) optic.weight[i] = read_weight(law, out.world, out.laws[i]);
    info.laws.push_back(about);
  }
  info.spread.widen(read_spread(law));
  if (!model.empty()) return law.refuse_unknown(fmt::format("BSDF model '{}'", model));
  law.refuse_misspelt("a BSDF model");
}

// Dust scatters all light at grazing incidence: stated shares become a coating, which conserves power.
void yield_to_dust(MaterialInfo const& info, World& world, Optic& optic) {
  bool dusty = false;
  for (LawInfo const& law : info.laws) dusty = dusty || law.model == "dust";
  if (!dusty || optic.has_interface || !(optic.reflect + optic.transmit > 0)) return;
  double const r = optic.reflect, t = optic.transmit;
  CoatingRow const rows[] = {{0, r, r, t, t, 0}, {pi / 2, r, r, t, t, 0}};
  optic.interface = world.add_interface(make_coating(rows, false, world.storage));
  optic.has_interface = true;
}

// "assumed; SOURCE; NOTE" of a material; empty when it states none.
std::string said_of(Node const& material) {
  std::string said = read_status(material);
  for (char const* key : {"source", "wavelength", "note"})
    if (Node const text = material[key]) said += (said.empty() ? "" : "; ") + text.as_word();
  return said;
}

Vec3 incoming(double cosine, double turn) {
  double const sine = std::sqrt((1 - cosine) * (1 + cosine));
  SinCos const azimuth = sincos_turn(turn);
  return {sine * azimuth.cos, sine * azimuth.sin, cosine};
}

// docs/theory/surfaces.md, eq. 3.1, at every incidence of the albedo table, from vacuum into vacuum. The excess
// of a quadrature over an albedo of 1 is no light.
void check_energy(std::string const& name, Node const& node, Optic const& optic, WorldView const& world) {
  constexpr double quadrature = 1e-4;
  for (int i = AlbedoTable::size - 1; i >= 0; --i) {
    double const cosine = AlbedoTable::cosine(i);
    double scattered = scatter_albedo(world.laws, optic, cosine);
    for (double const turn : {0.0, 0.125, 0.25})  // grooves: the direction counts
      if (optic.lay != Lay::free)
        scattered = std::max(scattered, scatter_albedo(world.laws, optic, incoming(cosine, turn)));
    SpecularShares const s = specular_shares(world.interfaces, optic, cosine, 1, 1, true, scattered);
    if (!(s.reflect + s.transmit + (1 - quadrature) * scattered > 1 + 1e-9))
      continue;  // NaN: a value is missing, and reported
    node.problem(fmt::format("material '{}' violates energy conservation: at {:.0f} deg of incidence it reflects "
                             "{:.6g}, transmits {:.6g} and scatters {:.6g}, together more than 1",
                             name, std::acos(cosine) * 180 / pi, s.reflect, s.transmit, scattered),
                 "lower one of them; the remainder is absorbed");
    return;
  }
}

}  // namespace

void read_materials(Scene const& scene, World& world, Registry& names) {
  names.black = world.add_optic({});
  for (auto const& [name, node] : scene.table("materials").items()) {
    Optic optic;
    MaterialInfo info{name, node.word("source", "not given"), {}, 0, {}};
    read_specular(node, world, names, optic);
    optic.depolarise = node.number("depolarise", dim::plain, 1, 0, 1);
    LawReading reading{.world = world, .material = name, .laws = {}, .optic = &optic, .names = &names};
    std::string const said = said_of(node);
    node.has("like");  // already adopted
    if (node.has("preset")) {
      LawInfo const about = read_preset(node, reading, optic);
      for (std::size_t i = 0; i < reading.laws.size(); ++i) {
        optic.law[i] = reading.laws[i];
        info.laws.push_back(about);
      }
      info.spread = reading.spread;
      info.spread.factor = read_uncertainty(node["uncertainty"], info.spread.factor);
    } else {
      info.spread = read_spread(node);
      info.spread.status = read_status(node);
      if (node.has("status")) reading.note(said);
    }
    for (Node const& law : node.list("scatter")) read_law(law, reading, optic, info);
    if (reading.laws.size() > std::size_t(Optic::most_laws))
      node.problem(fmt::format("a material has more than {} BSDF models", int(Optic::most_laws)),
                   "combine some of them");
    optic.laws = std::min(int(reading.laws.size()), Optic::most_laws);
    yield_to_dust(info, world, optic);
    prescribe_scatter(node, world, optic);
    node.refuse_unknown(fmt::format("material '{}'", name));
    check_energy(name, node, optic, world.view());
    info.optic = names.materials[name] = world.add_optic(optic);
    world.materials.push_back(std::move(info));
  }
}

namespace {

constexpr std::string_view cases[] = {"low", "mid", "high"};

// `take`: low, mid or high, or a number 0, 1, 2, which may be a parameter.
int case_of(Node const& material) {
  Node const take = material["take"];
  if (!take) return 1;
  for (int i = 0; i < 3; ++i)
    if (take.kind() == Node::Kind::scalar && take.text() == cases[i]) return i;
  double const number = take.as_number(dim::plain, 0, 2);
  if (std::isfinite(number) && number != std::floor(number))
    take.problem("'take' is one of three cases", "write low, mid or high, or 0, 1, 2 for a parameter");
  return std::isfinite(number) ? int(number) : 1;
}

// The preset of a material: a name of the list, or its own numbers.
std::optional<MaterialPreset> preset_of(std::string const& name, Node const& material) {
  if (Node const own = material["preset"]; own.kind() == Node::Kind::table) return read_preset_numbers(name, own);
  std::vector<std::string_view> names;
  for (MaterialPreset const& p : material_presets()) names.push_back(p.name);
  std::string const wanted = material.choice("preset", names);
  for (MaterialPreset const& p : material_presets())
    if (p.name == wanted) return p;
  return {};
}

// Largest share of the light that the models read so far scatter at any incidence.
double most_scattered(LawReading const& out) {
  double most = 0;
  for (int i = 0; i < AlbedoTable::size; ++i) {
    double sum = 0;
    for (PoolRef const law : out.laws)
      sum += out.world.view().laws.visit(law, [&](auto const& l) { return l.albedo(AlbedoTable::cosine(i)); });
    most = std::fmax(most, sum);
  }
  return most;
}

}  // namespace

LawInfo read_preset(Node const& material, LawReading& out, Optic& optic) {
  int const which = case_of(material);
  auto const preset = preset_of(out.material, material);
  if (!preset) {
    material.has("bracket");
    return {};
  }
  using Gives = MaterialPreset::Gives;
  Dimension const dimension = preset->gives == Gives::brdf ? dim::brdf : dim::plain;
  double values[3] = {preset->values[0], preset->values[1], preset->values[2]};
  bool const own = material.has("bracket");
  if (own) {
    auto const given = material["bracket"].as_numbers(dimension, 3);
    if (some_missing(given)) return {};
    if (!(given[0] >= 0 && given[0] <= given[1] && given[1] <= given[2])) {
      material["bracket"].problem("a bracket is low, mid, high, in this order", "write [1e-3 /sr, 3e-3 /sr, 1e-2 /sr]");
      return {};
    }
    for (int i = 0; i < 3; ++i) values[i] = given[std::size_t(i)];
  }
  double const value = values[which];
  if (value > 0) {
    out.spread.low = values[0] / value;
    out.spread.high = values[2] / value;
  }
  out.spread.of_reflection = preset->gives == Gives::reflect;
  out.spread.status = preset->status;
  if (preset->gives == Gives::reflect) {
    optic.reflect = value;
  } else if (preset->gives == Gives::tis_75 && !own) {
    constexpr double per_peak = 0.0868071;  // albedo at 75 deg of a forward lobe of peak 1/sr, width 0.3, rise 1
    Polynomial p;
    p.c[0][0] = value / pi;
    p.width = 0.3;
    p.peak = (preset->at_75[which] - value) / per_peak;
    p.prepare();
    out.add(p);
  } else {
    double const tis = preset->gives == Gives::brdf ? pi * value : value;
    if (tis > 1) material.problem("the preset would scatter more than the incident power", "lower its bracket");
    out.add(Lambertian{std::fmin(tis, 1)});
  }
  if (preset->through > 0) {
    optic.through[out.laws.size()] = true;
    out.add(Lambertian{preset->through});
  }
  if (preset->reflect > 0 && !material.has("specular")) {
    optic.reflect = preset->reflect;
    if (preset->through > 0) optic.transmit = std::fmax(0, 1 - preset->reflect - most_scattered(out));  // a window
  }
  out.note(fmt::format("preset {}, {} of [{:g}, {:g}, {:g}]{}; {}, {}, {}{}{}", preset->name, cases[which], values[0],
                       values[1], values[2], dimension == dim::brdf ? " /sr" : "", preset->status, preset->source,
                       preset->wavelength, preset->note.empty() ? "" : "; ", preset->note));
  if (!own && !preset->has_bracket())
    material["preset"].warning(
        fmt::format("preset '{}' comes without a bracket", preset->name),
        fmt::format("name a material of your own: {{preset: {}, bracket: [low, mid, high]}}", preset->name));
  return {"preset " + preset->name, fmt::format("{}, {}", preset->status, preset->source), preset->wavelength};
}

namespace {

// One value, or low, mid, high.
bool read_case_values(Node const& node, Dimension dimension, double (&into)[3]) {
  if (node.kind() == Node::Kind::list) {
    auto const given = node.as_numbers(dimension, 3);
    if (given.size() != 3) return false;
    std::copy(given.begin(), given.end(), into);
  } else {
    std::fill(into, into + 3, node.as_number(dimension));
  }
  if (into[0] >= 0 && into[0] <= into[1] && into[1] <= into[2]) return true;
  if (node.healthy())
    node.problem("a bracket is low, mid, high, in this order", "write [1e-3 /sr, 3e-3 /sr, 1e-2 /sr]");
  return false;
}

std::vector<MaterialPreset> presets_of_library() {
  FileTexts texts;
  std::string include;
  for (EmbeddedFile const& file : embedded_files())
    if (file.name.starts_with("library/materials/")) {
      texts[std::string(file.name)] = file.text;
      include += (include.empty() ? "" : ", ") + std::string(file.name);
    }
  texts["presets"] = fmt::format("straytrace: 1\ninclude: [{}]\nscene: [{{name: all, file: all}}]\n", include);
  Scene const scene = read_scene("presets", {}, &texts);
  std::vector<MaterialPreset> all;
  for (auto const& [name, node] : scene.table("materials").items())
    if (Node const table = node["preset"]; table.kind() == Node::Kind::table)
      if (auto const preset = read_preset_numbers(name, table)) all.push_back(*preset);
  return all;
}

}  // namespace

std::optional<MaterialPreset> read_preset_numbers(std::string const& name, Node const& table) {
  using Gives = MaterialPreset::Gives;
  MaterialPreset p;
  p.name = name;
  p.status = read_status(table);
  p.wavelength = table.word("wavelength", "wavelength not given");
  p.source = table.word("source", "source not given");
  if (table.has("note")) p.note = table.word("note");
  bool const brdf = table.has("brdf"), tis = table.has("tis"), at_75 = table.has("tis_at_75_deg");
  bool const mirror = !brdf && !tis && table.has("reflect");
  if (!brdf && !tis && !mirror) {
    table.problem("a table 'preset' has numbers", "write {brdf: [1e-3 /sr, 3e-3 /sr, 1e-2 /sr]}, 'tis' or 'reflect'");
    return {};
  }
  p.gives = brdf ? Gives::brdf : mirror ? Gives::reflect : at_75 ? Gives::tis_75 : Gives::tis;
  bool whole = read_case_values(table[brdf     ? "brdf"
                                      : mirror ? "reflect"
                                               : "tis"],
                                brdf ? dim::brdf : dim::plain, p.values);
  if (p.gives == Gives::tis_75) whole = read_case_values(table["tis_at_75_deg"], dim::plain, p.at_75) && whole;
  if (!mirror) p.reflect = table.number("reflect", dim::plain, 0, 0, 1);
  p.through = table.number("through", dim::plain, 0, 0, 1);
  table.refuse_unknown("'preset'");
  return whole ? std::optional(p) : std::nullopt;
}

std::span<MaterialPreset const> material_presets() {
  static std::vector<MaterialPreset> const all = presets_of_library();
  return all;
}

// The law `table`: measured scatter from a file of any format that world/scatter_data reads.

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
