// SPDX-License-Identifier: BSD-3-Clause
#include "motion/calibration.hpp"

#include <fmt/format.h>

#include <cmath>

namespace straytrace {
namespace {

struct Scale {
  Quantity per_value{1, {}, {}};
  Transfer response = {};
};

// Nothing when a problem was told.
std::optional<Scale> read_scale(Node const& node) {
  if (!node) return Scale{};
  if (node.kind() != Node::Kind::table) {
    Quantity const q = node.as_quantity();
    return std::isfinite(q.si) && q.si != 0 ? std::optional(Scale{q, {}}) : std::nullopt;
  }
  std::string const text = node.word("unit");
  auto const unit = parse_unit(text);
  if (!text.empty() && !unit)
    node["unit"].problem(fmt::format("\"{}\" is not a unit", text),
                         "write motion per reading, for example 'um/s^2/count'");
  bool const flat = !node.has("file") && !node.has("gain") && !node.has("zeros") && !node.has("poles");
  if (flat && !node.has("resonance") && !node.has("pendulum") && !node.has("mode")) {
    node.problem("the calibration has a unit, and no response of the sensor",
                 fmt::format("write 'calibration: 1 {}', or add zeros, poles and gain, or a file", text));
    return {};
  }
  Transfer response = read_chain(node);
  return unit ? std::optional(Scale{*unit, std::move(response)}) : std::nullopt;
}

void refuse(Quantity const& unit, std::string const& written, bool of_density, bool rotation, bool calibrated,
            Node const& at) {
  char const* const good = rotation     ? (of_density ? "'rad/sqrt(Hz)' or 'rad^2/Hz'" : "'rad', 'rad/s' or 'rad/s^2'")
                           : of_density ? "'m/sqrt(Hz)' or 'm^2/Hz' (velocity and acceleration: 'm/s/sqrt(Hz)', "
                                          "'m/s^2/sqrt(Hz)')"
                                        : "'m', 'm/s' or 'm/s^2'";
  std::string const what = fmt::format("\"{}\" is not a unit of a {}{}", written, rotation ? "rotation" : "motion",
                                       of_density ? " spectrum" : "");
  bool const raw = unit.dimension.count != 0 || unit.dimension.volt != 0;
  if (calibrated)
    at.problem(what + ", nor is it with this calibration",
               "the calibration says how much motion one unit of the reading is, for example '6.1 um/s^2/count'");
  else
    at.problem(what, raw ? "add the motion that one unit stands for, for example 'calibration: 6.1 um/s^2/count'"
                         : fmt::format("write {}", good));
}

}  // namespace

std::optional<Calibration> read_calibration(Node const& spec, Quantity const& unit, std::string const& written,
                                            bool of_density, bool rotation, Node const& unit_at) {
  auto const scale = read_scale(spec["calibration"]);
  if (!scale) return {};
  for (int derivatives = 0; derivatives <= 2; ++derivatives) {
    Dimension motion = rotation ? dim::angle : dim::length;
    motion.second = static_cast<std::int8_t>(motion.second - 2 * derivatives);
    auto const reading = times(motion, scale->per_value.dimension, -1);
    if (!reading) continue;
    Dimension asd = *reading;
    asd.second = static_cast<std::int8_t>(asd.second + (of_density ? 1 : 0));
    if (unit.dimension == asd) return Calibration{unit.si * scale->per_value.si, false, derivatives, scale->response};
    auto const psd = times(asd, asd);
    if (of_density && psd && unit.dimension == *psd)
      return Calibration{std::sqrt(unit.si) * scale->per_value.si, true, derivatives, scale->response};
  }
  refuse(unit, written, of_density, rotation, spec.has("calibration"), unit_at);
  return {};
}

}  // namespace straytrace
