// SPDX-License-Identifier: BSD-3-Clause
#include "motion/axis_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "io/delimited_text.hpp"
#include "motion/motion_files.hpp"
#include "motion/series_motion.hpp"
#include "spectra/spectrum.hpp"

namespace straytrace::motion {
namespace {

Dimension asd_of(int axis) { return is_rotation(axis) ? dim::angle_asd : dim::displacement_asd; }
Dimension speed_of(int axis) { return is_rotation(axis) ? Dimension{0, 0, -2, 2} : Dimension{2, 0, -2}; }
Dimension amplitude_of(int axis) { return is_rotation(axis) ? dim::angle : dim::length; }

// One specification: the keys common to all kinds of motion.
struct AxisSpec {
  Node spec;
  std::string_view kind;
  int axis;
  double scale, uncertainty;
};

Spectrum read_asd(Node const& spec, int axis) { return read_spectrum_file(spec, is_rotation(axis)); }

Spectrum read_power_law(Node const& spec, int axis) {
  Node const t = spec.table("power-law");
  double const asd = t.number("asd", asd_of(axis), required, 0), at = t.number("at", dim::frequency, required, 1e-9),
               exponent = t.number("exponent", dim::plain), from = t.number("from", dim::frequency, required, 1e-9),
               to = t.number("to", dim::frequency, required, 1e-9);
  t.refuse_unknown("motion 'power-law'");
  if (from >= to) t.problem("the power law has 'to' below 'from'", "write 'from' below 'to'");
  return from < to ? power_law_asd(asd, at, exponent, from, to) : Spectrum();
}

Spectrum read_peterson(Node const& spec, int axis) {
  constexpr std::array<std::string_view, 3> choices = {"low", "high", "typical"};
  std::string const model = spec.choice("peterson", choices);
  double const from = spec.number("from", dim::frequency, 0.01, 1e-5),
               to = spec.number("to", dim::frequency, 1000, 1e-5);
  if (is_rotation(axis))
    spec.problem("the Peterson models describe translations of the ground", "give an ASD in rad/sqrt(Hz)");
  if (from >= to) spec.problem("the ground model has 'to' below 'from'", "write 'from' below 'to'");
  if (model.empty() || is_rotation(axis) || !(from < to)) return {};
  return peterson(model == "low"    ? GroundModel::low
                  : model == "high" ? GroundModel::high
                                    : GroundModel::typical,
                  from, to);
}

Spectrum read_line(Node const& spec, int axis) {
  Node const t = spec.table("line");
  double const at = t.number("at", dim::frequency, required, 1e-6),
               width = t.number("width", dim::frequency, required, 1e-6);
  Quantity const rms = t.amplitude("rms", amplitude_of(axis));
  t.refuse_unknown("motion 'line'");
  if (rms.amplitude == Amplitude::peak || rms.amplitude == Amplitude::peak_to_peak) {
    t["rms"].problem("random motion has no peak value", "write its root mean square, for example '0.4 um rms'");
    return {};
  }
  return std::isfinite(at * width * rms.si) && rms.si > 0 ? gaussian_line(at, width, rms.si) : Spectrum();
}

void read_sine(AxisSpec const& a, AxisMotion& into) {
  Node const t = a.spec.table("sine");
  Quantity const size = t.amplitude("amplitude", amplitude_of(a.axis));
  double const frequency = t.number("frequency", dim::frequency, required, 1e-6),
               phase = t.number("phase", dim::angle, 0);
  t.refuse_unknown("motion 'sine'");
  Transfer const through = read_chain(a.spec["through"]);
  double const to_peak = size.amplitude == Amplitude::peak_to_peak ? 0.5
                         : size.amplitude == Amplitude::rms        ? std::sqrt(2)
                                                                   : 1;
  if (std::isfinite(size.si * frequency * phase) && size.si != 0)
    into.tones.push_back({frequency,
                          std::polar(1.0, phase) * (a.scale * to_peak * size.si) * at_tone(through, frequency, a.spec),
                          a.uncertainty});
}

// `like`, `same_as`: another coordinate of the body; `from`: one of another body, the same unless `axis` names it.
void read_reference(AxisSpec const& a, AxisMotion& into) {
  auto const& [spec, key, axis, scale, uncertainty] = a;
  Transfer const through = read_chain(spec["through"]);
  bool const elsewhere = key == "from";
  std::string const body = elsewhere ? spec.word(key) : "",
                    other = spec.choice(elsewhere ? "axis" : key, axis_names, elsewhere ? axis_names[axis] : "");
  if (other.empty()) return;
  int const target = static_cast<int>(std::ranges::find(axis_names, other) - axis_names);
  if (is_rotation(target) != is_rotation(axis))
    spec.problem(
        fmt::format("'{}' cannot move like '{}': one is a translation, one a rotation", axis_names[axis], other),
        "name a coordinate of the same kind, or give a spectrum");
  else
    into.references.push_back({body, target, scale, key != "like", through, elsewhere ? spec[key] : spec});
}

Spectrum with_resonance(Node const& spec, Spectrum const& s) {
  Node const t = spec.table("resonance");
  if (!t) return s;
  double const frequency = t.number("frequency", dim::frequency, required, 1e-6),
               quality = t.number("quality", dim::plain, required, 0.5);
  t.refuse_unknown("'resonance'");
  return std::isfinite(frequency * quality) && s.total() > 0 ? through_resonance(s, frequency, quality) : s;
}

// Motion with equal uncertainty becomes one input.
void add_own(OwnMotion motion, AxisMotion& into) {
  into.bands.push_back({motion.spectrum.lowest(), motion.spectrum.highest()});
  auto const same = std::ranges::find_if(into.own, [&](OwnMotion const& o) {
    return o.uncertainty == motion.uncertainty && !o.through && !motion.through && !o.recorded && !motion.recorded;
  });
  if (same == into.own.end())
    into.own.push_back(std::move(motion));
  else
    same->spectrum = same->spectrum + motion.spectrum;
}

// Records where a file ends, unless the scene states `beyond: zero`.
void note_file(Node const& spec, std::string_view kind, int axis, Band known, double psd_low, AxisMotion& into) {
  constexpr std::array<std::string_view, 1> only = {"zero"};
  if (spec.has("beyond") && !spec.choice("beyond", only).empty()) return;
  Node const file = spec[kind];
  into.files.push_back({file.text(), {}, known, known, is_rotation(axis) ? 0 : std::sqrt(psd_low), file.place()});
}

double psd_of(OwnMotion const& own, double hz) {
  return own.spectrum.at(hz) * own.scale * own.scale * (own.through ? std::norm((*own.through)(hz)) : 1);
}

void read_record(AxisSpec const& a, AxisMotion& into) {
  auto const& [spec, kind, axis, scale, uncertainty] = a;
  auto const record = read_recorded(spec, is_rotation(axis));
  Transfer const through = read_chain(spec["through"]);
  if (spec.has("resonance"))
    spec["resonance"].problem("a resonance of a record is a link of a chain",
                              "write 'through: {resonance: {frequency: ..., quality: ...}}'");
  if (!record || !covers(through, record->spectrum.lowest(), record->spectrum.highest(), spec["through"])) return;
  OwnMotion const own{record->spectrum, uncertainty, through, record->displacement, scale};
  double const low = own.spectrum.lowest();
  note_file(spec, kind, axis, {low, own.spectrum.highest()}, psd_of(own, low), into);
  into.own.push_back(own);
}

void read_member(AxisSpec const& a, AxisMotion& into) {
  auto const& [spec, kind, axis, scale, uncertainty] = a;
  auto joint = read_joint(spec, is_rotation(axis));
  Transfer const through = read_chain(spec["through"]);
  if (!joint || !covers(through, joint->unit.lowest(), joint->unit.highest(), spec["through"])) return;
  joint->scale = scale;
  joint->through = through;
  joint->uncertainty = uncertainty;
  double const low = joint->unit.lowest();
  note_file(spec, kind, axis, {low, joint->unit.highest()}, joint->psd(low), into);
  into.joint.push_back(std::move(*joint));
}

// Gaussian motion of the spectrum that `read` finds.
template <Spectrum (*read)(Node const& spec, int axis)>
void read_spectrum(AxisSpec const& a, AxisMotion& into) {
  auto const& [spec, kind, axis, scale, uncertainty] = a;
  Spectrum const written = read(spec, axis);
  Transfer const through = read_chain(spec["through"]);
  OwnMotion const own{with_resonance(spec, written.scaled(std::isfinite(scale) ? scale * scale : 0)), uncertainty,
                      through};
  if (!(own.spectrum.total() > 0)) return;
  double const low = own.spectrum.lowest(), high = own.spectrum.highest();
  if (!covers(through, low, high, spec["through"])) return;
  if (kind == "asd") note_file(spec, kind, axis, {low, high}, psd_of(own, low), into);
  add_own(own, into);
}

void read_drift(AxisSpec const& a, AxisMotion& into) {
  into.drift += a.scale * a.spec.number("drift", speed_of(a.axis));
}

// A kind of motion. A new one: its reader above and a row of the table below.
struct Kind {
  std::string_view name, example;      // the key that selects it; suggestion of a message
  std::vector<std::string_view> keys;  // besides that key and those of every kind, `scale` and `through`
  void (*read)(AxisSpec const&, AxisMotion&);
};
std::vector<Kind> const& all_kinds() {
  static std::vector<Kind> const all = {
      {"asd",
       "{asd: FILE, columns: [Hz, m/sqrt(Hz)]}",
       {"columns", "use", "calibration", "beyond", "resonance", "uncertainty"},
       read_spectrum<read_asd>},
      {"series",
       "{series: FILE}",
       {"channel", "unit", "highpass", "segment", "span", "segments", "calibration", "beyond", "resonance",
        "uncertainty"},
       read_record},
      {"csd", "{csd: FILE}", {"form", "units", "member", "beyond", "uncertainty"}, read_member},
      {"power-law", "{power-law: ...}", {"resonance", "uncertainty"}, read_spectrum<read_power_law>},
      {"peterson", "{peterson: typical}", {"from", "to", "resonance", "uncertainty"}, read_spectrum<read_peterson>},
      {"line", "{line: ...}", {"resonance", "uncertainty"}, read_spectrum<read_line>},
      {"sine", "{sine: ...}", {"uncertainty"}, read_sine},
      {"drift", "{drift: 2 um/h}", {}, read_drift},
      {"from", "{from: ground}", {"axis"}, read_reference},
      {"like", "{like: z}", {}, read_reference},
      {"same_as", "{same_as: z}", {}, read_reference}};
  return all;
}

// "write still, {asd: ...}, ... or {same_as: z}"
std::string suggested_kinds() {
  std::string text = "write still";
  for (Kind const& k : all_kinds()) text += fmt::format("{} {}", &k == &all_kinds().back() ? " or" : ",", k.example);
  return text;
}

std::string kind_meant(Node const& spec) {
  std::vector<std::string> words;
  for (Kind const& k : all_kinds()) words.emplace_back(k.name);
  for (auto const& entry : spec.items())
    if (std::string near = nearest_word(entry.first, words); !near.empty()) return near;
  return {};
}

// Exactly one of the keys that select a kind of motion; null and a problem otherwise.
Kind const* kind_of(Node const& spec) {
  Kind const* found = nullptr;
  for (Kind const& kind : all_kinds()) {
    bool const bound = found && std::ranges::count(found->keys, kind.name) > 0;
    if (bound || !spec.has(kind.name)) continue;
    if (found) {
      spec.problem(fmt::format("one motion cannot be both '{}' and '{}'", found->name, kind.name),
                   "write a list: [{...}, {...}] adds");
      return nullptr;
    }
    found = &kind;
  }
  if (found) return found;
  std::string const near = kind_meant(spec);
  spec.problem("the kind of motion is missing",
               near.empty() ? suggested_kinds() : fmt::format("did you mean '{}'?", near));
  return nullptr;
}

// Reported even when the rest cannot be read: a key is not unknown because another one is wrong.
void refuse_unknown(Node const& spec, Kind const& kind) {
  for (std::string_view const key : kind.keys) spec.has(key);
  for (std::string_view const key : {"scale", "through"}) spec.has(key);
  spec.refuse_unknown(fmt::format("motion '{}'", kind.name));
}

void read_one(Node const& spec, int axis, double uncertainty, AxisMotion& into) {
  if (spec.kind() == Node::Kind::scalar) {
    if (spec.text() != "still") spec.problem(fmt::format("'{}' is not a motion", spec.text()), suggested_kinds());
    return;
  }
  if (spec.kind() != Node::Kind::table) return;
  Kind const* const kind = kind_of(spec);
  if (!kind) return;
  refuse_unknown(spec, *kind);
  double const scale = spec.number("scale", dim::plain, 1);
  uncertainty = read_uncertainty(spec["uncertainty"], uncertainty);
  kind->read({spec, kind->name, axis, scale, uncertainty}, into);
}

}  // namespace

bool says_how_one_moves(std::string_view key) {
  constexpr std::array<std::string_view, 3> of_bodies_too = {"from", "like", "same_as"};
  auto const& all = all_kinds();
  return std::ranges::find(of_bodies_too, key) == of_bodies_too.end() &&
         std::ranges::any_of(all, [&](Kind const& k) { return k.name == key; });
}

void read_axis(Node const& node, int axis, double uncertainty, AxisMotion& into) {
  for (Node const& spec : node.as_list()) read_one(spec, axis, uncertainty, into);
}

std::array<bool, 6> add_suspended(Node const& suspended, std::array<AxisMotion, 6>& axes) {
  std::array<bool, 6> stated{};
  constexpr std::array<bool, 6> translations = {true, true, true};  // the intended ones are unknown
  if (suspended.kind() != Node::Kind::table) {
    suspended.problem("'suspended' is a table",
                      "write {from: ground, vertical: y, stages: [{frequency: 0.6 Hz, quality: 10}]}");
    return translations;
  }
  std::string const body = suspended.word("from");
  std::string const up = suspended.choice("vertical", std::span(axis_names).first(3));
  for (bool const vertical : {false, true}) {
    Node const stages = suspended[vertical ? "vertical_stages" : "stages"];
    if (!stages && !vertical)
      suspended.problem("'stages' of the suspension are missing", "add 'stages: [{frequency: 0.6 Hz, quality: 10}]'");
    if (!stages) continue;
    auto const through = std::make_shared<TransferFunction const>(read_stages(stages));
    if (body.empty() || up.empty()) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if ((axis_names[axis] == up) != vertical) continue;
      axes[axis].references.push_back({body, axis, 1, true, through, suspended["from"]});
      stated[axis] = true;
    }
  }
  suspended.refuse_unknown("'suspended'");
  return body.empty() || up.empty() || !suspended.has("stages") ? translations : stated;
}

namespace {

using C = std::complex<double>;

constexpr double rounding = 1e-6;
constexpr std::array<std::string_view, 3> forms = {"matrix", "cross", "coherence"};

std::size_t columns_of(std::string const& form, std::size_t n) { return 1 + (form == "matrix" ? 2 : 1) * n * n; }

// Row of a file as a matrix in the units of the file.
ComplexMatrix matrix_of(std::vector<double> const& row, std::string const& form, std::size_t n) {
  ComplexMatrix c(n, std::vector<C>(n));
  std::size_t at = 1;
  auto const next = [&] { return row[at++]; };
  for (std::size_t i = 0; i < n && form == "coherence"; ++i) c[i][i] = next();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = form == "matrix" ? 0 : i; j < n; ++j) {
      if (i == j && form == "coherence") continue;
      double const a = next(), b = i == j && form == "cross" ? 0 : next();
      c[i][j] =
          form == "coherence" ? std::polar(std::sqrt(a * c[i][i].real() * c[j][j].real()), b * pi / 180) : C(a, b);
      if (form != "matrix") c[j][i] = std::conj(c[i][j]);
    }
  return c;
}

bool is_hermitian(ComplexMatrix const& c) {
  for (std::size_t i = 0; i < c.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j)
      if (std::norm(c[i][j] - std::conj(c[j][i])) > rounding * rounding * std::abs(c[i][i] * c[j][j])) return false;
  return true;
}

struct Members {
  std::vector<Calibration> units;
  std::string names;
};

// Nothing and problems when a unit is not one of motion.
std::optional<Members> read_units(Node const& spec, std::size_t member, bool rotation) {
  Members m;
  bool sound = true;
  std::vector<Node> const list = spec.list("units");
  for (std::size_t i = 0; i < list.size(); ++i) {
    std::string const text = list[i].as_word();
    auto const unit = parse_unit(text);
    bool const angle = i + 1 == member ? rotation : unit && unit->dimension.radian != 0;
    if (unit && (unit->dimension.count != 0 || unit->dimension.volt != 0)) {
      list[i].problem(fmt::format("\"{}\" is the reading of a sensor, not a motion", text),
                      "write the cross spectra in 'm', 'm/s' or 'm/s^2' ('rad', ...)");
      sound = false;
      continue;
    }
    auto const how = read_calibration({}, unit.value_or(Quantity{}), text, false, angle, list[i]);
    m.units.push_back(how.value_or(Calibration{}));
    m.names += " " + text;
    sound = sound && how;
  }
  if (!sound) return {};
  if (m.units.size() >= member && m.units.size() >= 2) return m;
  if (m.units.size() >= 2) {
    spec["member"].problem(fmt::format("a matrix with {} units has no member {}", m.units.size(), member),
                           "name the unit of each member in 'units'; they count from 1");
    return {};
  }
  spec.problem("the units of all members of the matrix must be named, in their order", "write 'units: [m, m]'");
  return {};
}

// Factors of all frequencies; empty and a problem when the file does not match.
std::vector<ComplexMatrix> factors_of(Node const& file, NumberTable const& table, std::string const& form,
                                      std::vector<Calibration> const& units) {
  std::vector<ComplexMatrix> factors;
  double before = 0;
  for (std::size_t line = 0; line < table.rows(); ++line) {
    std::vector<double> const row = table.row(line);
    auto const refuse = [&](std::string what, std::string suggestion) {
      file.file_problem(file.text(), table.line[line], 1, fmt::format("at {:g} Hz: {}", row[0], what),
                        std::move(suggestion));
      return std::vector<ComplexMatrix>();
    };
    if (!(row[0] > before)) return refuse("frequencies must be positive and rise", "sort the lines by frequency");
    before = row[0];
    ComplexMatrix c = matrix_of(row, form, units.size());
    if (!is_hermitian(c)) return refuse("the matrix is not Hermitian", "S_ji is the conjugate of S_ij");
    for (std::size_t i = 0; i < c.size(); ++i)
      for (std::size_t j = 0; j < c.size(); ++j) {
        C const w{0, -2 * pi * row[0]};
        c[i][j] *= units[i].factor * units[j].factor / std::pow(w, units[i].derivatives) /
                   std::conj(std::pow(w, units[j].derivatives));
      }
    auto factor = cholesky(c);
    if (!factor)
      return refuse("the matrix is not positive semidefinite, so it is not a spectrum of any motion",
                    "coherences are at most 1, of all members together; print more digits, or average over more");
    factors.push_back(std::move(*factor));
  }
  return factors;
}

// Element (i, j) of the factors as a transfer function; none where it is zero throughout.
Transfer element(std::string const& name, std::vector<double> const& hz, std::vector<ComplexMatrix> const& factors,
                 std::size_t i, std::size_t j) {
  constexpr double nothing = 1e-30;  // a zero has no logarithm
  double largest = 0;
  for (ComplexMatrix const& l : factors) largest = std::max(largest, std::abs(l[i][j]));
  if (largest == 0) return {};
  std::vector<C> values;
  for (ComplexMatrix const& l : factors) values.push_back(l[i][j] == 0.0 ? nothing * largest : l[i][j]);
  return std::make_shared<TransferFunction const>(name, hz, std::move(values));
}

}  // namespace

double JointMotion::psd(double hz) const {
  double sum = 0;
  for (Transfer const& part : row)
    if (part) sum += std::norm((*part)(hz));
  return sum * scale * scale * (through ? std::norm((*through)(hz)) : 1);
}

std::optional<ComplexMatrix> cholesky(ComplexMatrix const& c) {
  std::size_t const n = c.size();
  ComplexMatrix l(n, std::vector<C>(n));
  for (std::size_t j = 0; j < n; ++j) {
    double pivot = c[j][j].real();
    for (std::size_t k = 0; k < j; ++k) pivot -= std::norm(l[j][k]);
    if (!(pivot >= -rounding * c[j][j].real())) return {};
    bool const singular = pivot <= 1e-9 * c[j][j].real();
    l[j][j] = singular ? 0 : std::sqrt(pivot);
    for (std::size_t i = j + 1; i < n; ++i) {
      C left = c[i][j];
      for (std::size_t k = 0; k < j; ++k) left -= l[i][k] * std::conj(l[j][k]);
      if (singular && std::norm(left) > rounding * std::abs(c[i][i] * c[j][j])) return {};
      if (!singular) l[i][j] = left / l[j][j];
    }
  }
  return l;
}

std::optional<JointMotion> read_joint(Node const& spec, bool rotation) {
  Node const file = spec["csd"];
  std::string const name = file.as_word(), form = spec.choice("form", forms);
  auto const member = spec.whole("member", required, 1, 50);
  if (name.empty() || form.empty() || member == 0) return {};
  auto const members = read_units(spec, member, rotation);
  if (!members) return {};
  std::size_t const n = members->units.size(), columns = columns_of(form, n);
  auto const table = read_numbers(
      file, columns, fmt::format("'form: {}' of {} members has {} columns: Hz and the elements", form, n, columns));
  if (!table) return {};
  if (table->rows() < 2) {
    file.file_problem(name, 0, 0, "cross spectra need at least two frequencies", "give more lines");
    return {};
  }
  std::vector<ComplexMatrix> const factors = factors_of(file, *table, form, members->units);
  if (factors.empty()) return {};
  std::vector<double> const& hz = table->column[0];
  JointMotion joint{fmt::format("{} {}{}", name, form, members->names), {}, {}};
  for (std::size_t j = 0; j < n; ++j) joint.row.push_back(element(name, hz, factors, member - 1, j));
  joint.unit = Spectrum({hz.front(), hz.back()}, {1, 1});
  return joint;
}

}  // namespace straytrace::motion
