// SPDX-License-Identifier: BSD-3-Clause
// A network in the language of scenes.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ifo/network_interferometer.hpp"
#include "ifo/network_model.hpp"
#include "ifo/ports.hpp"

namespace straytrace::ifo {
namespace {

using Component = Network::Component;

std::string mass_text(Suspension const& s) {
  if (!(s.mass < infinity)) return "";
  return fmt::format(", mass: {} kg", s.mass) +
         (s.resonance > 0 ? fmt::format(", pendulum_frequency: {} Hz", s.resonance) : "");
}

std::string pair_text(std::array<double, 2> const& p, char const* unit) {
  return fmt::format("[{} {}, {} {}]", p[0], unit, p[1], unit);
}

std::string mirror_text(MirrorParameters const& p, bool splitter) {
  std::string text = fmt::format("transmission: {}, loss: {}", p.transmission, p.loss);
  if (p.displacement != 0) text += fmt::format(", displacement: {} m", p.displacement);
  if (splitter) text += fmt::format(", incidence: {} rad", p.incidence);
  if (p.curvature_across)
    text += ", curvature: " + pair_text({p.curvature, *p.curvature_across}, "/m");
  else if (p.curvature != 0)
    text += fmt::format(", curvature: {} /m", p.curvature);
  if (p.tilt != std::array<double, 2>{}) text += ", tilt: " + pair_text(p.tilt, "rad");
  return text + mass_text(p.suspension);
}

std::string modulator_text(ModulatorParameters const& p) {
  bool const amplitude = p.kind == ModulatorParameters::Kind::amplitude;
  std::string text = fmt::format("frequency: {} Hz, index: {}, order: {}, of: {}", p.hz, p.index, p.order,
                                 p.of == ModulatorParameters::Of::carrier ? "carrier" : "all");
  if (amplitude) text += ", kind: amplitude";
  return text + (p.phase != 0 ? fmt::format(", phase: {} rad", p.phase) : "");
}

std::string component_text(Component const& c) {
  using Kind = Component::Kind;
  switch (c.kind) {
    case Kind::mirror:
      return fmt::format("mirror: {{{}}}", mirror_text(std::get<MirrorParameters>(c.stated), false));
    case Kind::splitter:
      return fmt::format("splitter: {{{}}}", mirror_text(std::get<MirrorParameters>(c.stated), true));
    case Kind::laser: {
      auto const& p = std::get<LaserParameters>(c.stated);
      std::string const mode = p.mode ? fmt::format(", mode: {{radius: {} m, wavefront_curvature: {} /m}}",
                                                    p.mode->radius, p.mode->curvature)
                                      : "";
      return fmt::format("laser: {{power: {} W{}{}}}", p.power,
                         p.phase != 0 ? fmt::format(", phase: {} rad", p.phase) : "", mode);
    }
    case Kind::isolator: {
      auto const& p = std::get<IsolatorParameters>(c.stated);
      return fmt::format("isolator: {{isolation: {}, transmission: {}}}", p.isolation, p.transmission);
    }
    case Kind::modulator:
      return fmt::format("modulator: {{{}}}", modulator_text(std::get<ModulatorParameters>(c.stated)));
    case Kind::lens:
      return fmt::format("lens: {{focal_length: {} m}}", std::get<LensParameters>(c.stated).focal_length);
    case Kind::aperture: {
      auto const& p = std::get<ApertureParameters>(c.stated);
      return fmt::format("aperture: {{radius: {} m{}}}", p.radius,
                         p.offset != std::array<double, 2>{} ? ", offset: " + pair_text(p.offset, "m") : "");
    }
    case Kind::dump:
      return "dump: {}";
  }
  return "";
}

// What was taken from the scene, as a comment.
std::string origin_text(Component const& c) {
  auto const* const p = std::get_if<MirrorParameters>(&c.stated);
  return p && !p->origin.empty() ? "  # " + p->origin : "";
}

std::string readout_text(Network const& n, NamedReadout const& r) {
  std::string const at = beam_name(n, r.readout);
  if (r.is_power()) return fmt::format("power: {}", at);
  if (r.is_demodulated())
    return fmt::format("demodulate: {{at: {}, frequency: {} Hz, phase: {} rad}}", at, r.readout.hz, r.readout.angle);
  return fmt::format("homodyne: {{at: {}, angle: {} rad}}", at, r.readout.angle);
}

std::string noise_text(NamedNoise const& noise) {
  if (!noise.file.empty()) return fmt::format("file: {}, columns: [Hz, {}]", noise.file, noise.cause.density_unit());
  bool const force = noise.cause.kind == NetworkCause::Kind::force;
  std::string const unit = force                                               ? "kg*m/s^2"
                           : noise.cause.kind == NetworkCause::Kind::amplitude ? ""
                                                                               : noise.cause.unit();
  return fmt::format("asd: {} {}/sqrt(Hz), at: {} Hz, exponent: {}", noise.level, unit, noise.at, noise.exponent);
}

std::string modes_text(ModeSettings const& m) {
  std::string text = fmt::format("{{order: {}", m.order);
  if (m.even) text += ", parity: even";
  if (!m.cavities.empty()) {
    std::vector<std::string> cavities;
    for (auto const& names : m.cavities) cavities.push_back(fmt::format("[{}]", fmt::join(names, ", ")));
    text += fmt::format(", cavities: [{}]", fmt::join(cavities, ", "));
  }
  return text + "}";
}

bool same_way(StrayWay const& a, StrayWay const& b) {
  auto const same = [](BeamPlace const& p, BeamPlace const& q) {
    return p.beam.port == q.beam.port && p.beam.leaving == q.beam.leaving && p.distance == q.distance;
  };
  return a.alone == b.alone && a.both_sides == b.both_sides && a.turn == b.turn && same(a.lit, b.lit) &&
         same(a.fed, b.fed);
}

// The place of a preset by its name, any other by its beams.
std::string entrance_text(Network const& n, SteadyField const& field, NamedWay const& w) {
  auto const share = [](double field_share) {
    return field_share == 1 ? "" : fmt::format(", pick_off: {}", field_share);
  };
  for (std::size_t e = 0; e < entrance_names.size(); ++e) {
    auto const place = entrance_in(n, field, InjectionPoint(e));
    if (!place || !same_way(place->way, w.way)) continue;
    if ((place->share > 1) != (w.share > 1)) continue;  // `through-end` is `end-bench` with another reference
    return fmt::format("at: {}{}", place->name, share(w.share / place->share));
  }
  auto const distance = [](char const* key, double metres) {
    return metres == 0 ? "" : fmt::format(", {}: {} m", key, metres);
  };
  if (w.way.both_sides)
    return fmt::format("at: {}{}, both_sides: yes{}", beam_name(n, w.way.fed.beam),
                       distance("distance", w.way.fed.distance), share(w.share));
  return fmt::format("at: {}, lit_by: {}{}{}{}", beam_name(n, w.way.fed.beam), beam_name(n, w.way.lit.beam),
                     distance("distance", w.way.fed.distance), distance("lit_distance", w.way.lit.distance),
                     share(w.share));
}

std::string strain_text(NetworkModel const& model) {
  StrainScale const& s = *model.strain;
  for (NamedReadout const& r : model.readouts)
    if (beam_name(model.network, r.readout) == beam_name(model.network, s.readout) &&
        r.readout.kind == s.readout.kind && r.readout.angle == s.readout.angle && r.readout.hz == s.readout.hz)
      return fmt::format("  strain: {{readout: {}, freedom: {}, arm_length: {} m}}\n", r.name, s.freedom.name,
                         s.length);
  return "";
}

}  // namespace

std::string wave_text(Network const& n) {
  return n.modes() ? fmt::format("modes up to order {}", n.modes()->order) : "plane waves";
}

std::string network_text(NetworkModel const& model) {
  Network const& n = model.network;
  std::string text =
      fmt::format("straytrace: 1\ninterferometer:\n  preset: none\n  network:\n    wavelength: {} m\n", n.wavelength());
  if (n.polarisation() == LinearPolarisation::p) text += "    polarisation: p\n";
  if (n.modes()) text += fmt::format("    modes: {}\n", modes_text(*n.modes()));
  text += "    components:\n";
  for (Component const& c : n.components())
    text += fmt::format("      {}: {{{}}}{}\n", c.name, component_text(c), origin_text(c));
  if (!n.spaces().empty()) text += "    spaces:\n";
  for (Network::Space const& s : n.spaces())
    text += fmt::format("      - {{from: {}, to: {}, length: {} m{}}}{}\n", n.port_name(s.from), n.port_name(s.to),
                        s.length, s.phase != 0 ? fmt::format(", phase: {} rad", s.phase) : "",
                        s.origin.empty() ? "" : "  # length " + s.origin);
  if (!model.readouts.empty()) text += "    readouts:\n";
  for (NamedReadout const& r : model.readouts) text += fmt::format("      {}: {{{}}}\n", r.name, readout_text(n, r));
  if (!model.freedoms.empty()) text += "    freedoms:\n";
  for (NamedFreedom const& f : model.freedoms) {
    std::string moves;
    for (auto const& [id, factor] : f.moves)
      moves += fmt::format("{}{}: {}", moves.empty() ? "" : ", ", n.name(id), factor);
    text += fmt::format("      {}: {{{}}}\n", f.name, moves);
  }
  if (!model.noises.empty()) text += "    noises:\n";
  for (NamedNoise const& m : model.noises) text += fmt::format("      {}: {{{}}}\n", m.cause.name, noise_text(m));
  if (model.strain && model.preset == "none") text += strain_text(model);
  if (!model.entrances.empty()) text += "  ports:\n";
  SteadyField const field(n);
  for (NamedWay const& w : model.entrances) text += fmt::format("    {}: {{{}}}\n", w.name, entrance_text(n, field, w));
  return text;
}

}  // namespace straytrace::ifo
