// SPDX-License-Identifier: BSD-3-Clause
#include "motion/axis_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/document.hpp"
#include "motion/series_motion.hpp"
#include "motion/spectrum_file.hpp"
#include "signal/shapes.hpp"

namespace straytrace {
namespace {

constexpr char const* kinds =
    "write still, {asd: FILE, columns: [Hz, m/sqrt(Hz)]}, {series: FILE}, {csd: FILE}, {power-law: ...}, {peterson: "
    "typical}, "
    "{line: ...}, "
    "{sine: ...}, {drift: 2 um/h}, {from: ground}, {like: z} or {same_as: z}";

Dimension asd_of(int axis) { return is_rotation(axis) ? dim::angle_asd : dim::displacement_asd; }
Dimension speed_of(int axis) { return is_rotation(axis) ? Dimension{0, 0, -2, 2} : Dimension{2, 0, -2}; }
Dimension amplitude_of(int axis) { return is_rotation(axis) ? dim::angle : dim::length; }

Spectrum read_power_law(Node const& t, int axis) {
  double const asd = t.number("asd", asd_of(axis), required, 0), at = t.number("at", dim::frequency, required, 1e-9),
               exponent = t.number("exponent", dim::plain), from = t.number("from", dim::frequency, required, 1e-9),
               to = t.number("to", dim::frequency, required, 1e-9);
  t.refuse_unknown("motion 'power-law'");
  if (from >= to) t.problem("the power law ends before it begins", "write 'from' below 'to'");
  return from < to ? power_law_asd(asd, at, exponent, from, to) : Spectrum();
}

Spectrum read_peterson(Node const& spec, int axis) {
  constexpr std::array<std::string_view, 3> choices = {"low", "high", "typical"};
  std::string const model = spec.choice("peterson", choices);
  double const from = spec.number("from", dim::frequency, 0.01, 1e-5),
               to = spec.number("to", dim::frequency, 1000, 1e-5);
  if (is_rotation(axis))
    spec.problem("the Peterson models describe translations of the ground", "give an ASD in rad/sqrt(Hz)");
  if (from >= to) spec.problem("the ground model ends before it begins", "write 'from' below 'to'");
  if (model.empty() || is_rotation(axis) || !(from < to)) return {};
  return peterson(model == "low"    ? GroundModel::low
                  : model == "high" ? GroundModel::high
                                    : GroundModel::typical,
                  from, to);
}

Spectrum read_line(Node const& t, int axis) {
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

void read_sine(Node const& spec, int axis, double scale, double uncertainty, AxisMotion& into) {
  Node const t = spec["sine"];
  Quantity const size = t.amplitude("amplitude", amplitude_of(axis));
  double const frequency = t.number("frequency", dim::frequency, required, 1e-6),
               phase = t.number("phase", dim::angle, 0);
  t.refuse_unknown("motion 'sine'");
  Transfer const through = read_chain(spec["through"]);
  double const to_peak = size.amplitude == Amplitude::peak_to_peak ? 0.5
                         : size.amplitude == Amplitude::rms        ? std::sqrt(2)
                                                                   : 1;
  if (std::isfinite(size.si * frequency * phase) && size.si != 0)
    into.tones.push_back({frequency,
                          std::polar(1.0, phase) * (scale * to_peak * size.si) * at_tone(through, frequency, spec),
                          uncertainty});
}

// `like`, `same_as`: another coordinate of the body; `from`: one of another body, the same unless `axis` names it.
void read_reference(Node const& spec, std::string_view key, int axis, double scale, Transfer const& through,
                    AxisMotion& into) {
  bool const elsewhere = key == "from";
  std::string const body = elsewhere ? spec.word(key) : "",
                    other = spec.choice(elsewhere ? "axis" : key, axis_names, elsewhere ? axis_names[axis] : "");
  if (other.empty()) return;
  int const target = static_cast<int>(std::find(std::begin(axis_names), std::end(axis_names), other) - axis_names);
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

// Exactly one of the keys that say what kind of motion it is.
std::string kind_of(Node const& spec) {
  std::string found;
  for (char const* key :
       {"asd", "series", "csd", "power-law", "peterson", "line", "sine", "drift", "from", "like", "same_as"}) {
    if (!spec.has(key)) continue;
    if (!found.empty())
      spec.problem(fmt::format("one motion cannot be '{}' and '{}' at once", found, key),
                   "write a list: [{...}, {...}] adds");
    found = key;
  }
  if (found.empty()) spec.problem("this does not say how the body moves", kinds);
  return found;
}

// Motion known equally well makes one input.
void add_own(OwnMotion motion, AxisMotion& into) {
  auto const same = std::find_if(into.own.begin(), into.own.end(), [&](OwnMotion const& o) {
    return o.uncertainty == motion.uncertainty && !o.through && !motion.through && !o.recorded && !motion.recorded;
  });
  if (same == into.own.end())
    into.own.push_back(std::move(motion));
  else
    same->spectrum = same->spectrum + motion.spectrum;
}

Spectrum read_gaussian(Node const& spec, std::string_view kind, int axis) {
  if (kind == "asd") return read_spectrum_file(spec, is_rotation(axis));
  if (kind == "power-law") return read_power_law(spec["power-law"], axis);
  if (kind == "peterson") return read_peterson(spec, axis);
  if (kind == "line") return read_line(spec["line"], axis);
  return {};
}

void read_record(Node const& spec, int axis, double scale, double uncertainty, AxisMotion& into) {
  auto const record = read_recorded(spec, is_rotation(axis));
  Transfer const through = read_chain(spec["through"]);
  if (spec.has("resonance"))
    spec["resonance"].problem("a record goes through a resonance as a link of a chain",
                              "write 'through: {resonance: {frequency: ..., quality: ...}}'");
  if (record && covers(through, record->spectrum.lowest(), record->spectrum.highest(), spec["through"]))
    into.own.push_back({record->spectrum, uncertainty, through, record->displacement, scale});
}

void read_member(Node const& spec, int axis, double scale, AxisMotion& into) {
  auto joint = read_joint(spec, is_rotation(axis));
  Transfer const through = read_chain(spec["through"]);
  if (!joint || !covers(through, joint->unit.lowest(), joint->unit.highest(), spec["through"])) return;
  joint->scale = scale;
  joint->through = through;
  into.joint.push_back(std::move(*joint));
}

void read_one(Node const& spec, int axis, double uncertainty, AxisMotion& into) {
  if (spec.kind() == Node::Kind::scalar) {
    if (spec.text() != "still") spec.problem(fmt::format("'{}' is not a motion", spec.text()), kinds);
    return;
  }
  if (spec.kind() != Node::Kind::table) return;
  std::string const kind = kind_of(spec);
  double const scale = spec.number("scale", dim::plain, 1);
  uncertainty = read_uncertainty(spec, uncertainty);
  if (kind == "like" || kind == "same_as" || kind == "from")
    read_reference(spec, kind, axis, scale, read_chain(spec["through"]), into);
  else if (kind == "sine")
    read_sine(spec, axis, scale, uncertainty, into);
  else if (kind == "drift")
    into.drift += scale * spec.number("drift", speed_of(axis));
  else if (kind == "csd")
    read_member(spec, axis, scale, into);
  else if (kind == "series")
    read_record(spec, axis, scale, uncertainty, into);
  else if (Spectrum const s = read_gaussian(spec, kind, axis); s.total() > 0 && std::isfinite(scale)) {
    Transfer const through = read_chain(spec["through"]);
    if (covers(through, s.lowest(), s.highest(), spec["through"]))
      add_own({with_resonance(spec, s.scaled(scale * scale)), uncertainty, through}, into);
  }
  if (!kind.empty()) spec.refuse_unknown(fmt::format("motion '{}'", kind));
}

}  // namespace

void read_axis(Node const& node, int axis, double uncertainty, AxisMotion& into) {
  for (Node const& spec : node.as_list()) read_one(spec, axis, uncertainty, into);
}

double read_uncertainty(Node const& table, double fallback) {
  Node const value = table["uncertainty"];
  if (!value) return fallback;
  constexpr std::string_view word = "factor ";
  if (value.kind() == Node::Kind::scalar && value.text().starts_with(word) &&
      is_number(value.text().substr(word.size()))) {
    double const factor = std::stod(value.text().substr(word.size()));
    if (factor >= 1) return factor;
    value.problem("a factor of uncertainty is at least 1", "write 'factor 1.5': from 1/1.5 to 1.5 times the ASD");
    return fallback;
  }
  double const share = value.as_number(dim::plain, 0);
  return std::isfinite(share) ? 1 + share : fallback;
}

}  // namespace straytrace
