// SPDX-License-Identifier: BSD-3-Clause
#include "motion/spectrum_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/document.hpp"
#include "signal/text_table.hpp"

namespace straytrace {
namespace {

// How a value of the second column becomes a PSD: PSD = (factor * value)^power / (2 pi f)^(2 derivatives).
struct Conversion {
  double factor = 1;
  int power = 2, derivatives = 0;
  double psd(double hz, double value) const {
    double const x = power == 2 ? std::pow(factor * value, 2) : factor * value;
    return x / std::pow(2 * pi * hz, 2 * derivatives);
  }
};

std::optional<Conversion> conversion(Quantity const& unit, bool rotation) {
  for (int derivatives = 0; derivatives <= 2; ++derivatives) {
    Dimension asd = rotation ? dim::angle_asd : dim::displacement_asd,
              psd = rotation ? dim::angle_psd : dim::displacement_psd;
    asd.second = static_cast<std::int8_t>(asd.second - 2 * derivatives);
    psd.second = static_cast<std::int8_t>(psd.second - 4 * derivatives);
    if (unit.dimension == asd) return Conversion{unit.si, 2, derivatives};
    if (unit.dimension == psd) return Conversion{unit.si, 1, derivatives};
  }
  return {};
}

std::size_t column_number(Node const& node) {
  double const n = node.as_number(dim::plain, 1, 1000);
  if (std::isfinite(n) && n != std::floor(n))
    node.problem("columns are counted in whole numbers from 1", "write 'use: [1, 2]'");
  return std::isfinite(n) ? static_cast<std::size_t>(n) : 1;
}

struct Columns {
  std::size_t frequency = 1, value = 2;  // counted from 1
  double hz = 1;                         // unit of the frequency column
  Conversion conversion;
};

std::optional<Columns> read_columns(Node const& spec, bool rotation) {
  std::string const example = rotation ? "columns: [Hz, rad/sqrt(Hz)]" : "columns: [Hz, m/sqrt(Hz)]";
  std::vector<Node> units = spec.list("columns"), use = spec.list("use");
  if (units.size() < 2 || (units.size() > 2 && use.empty()) || (!use.empty() && use.size() != 2)) {
    spec.problem("the two columns to read and their units must be named",
                 fmt::format("write '{}', and 'use: [1, 3]' to pick two", example));
    return {};
  }
  Columns c;
  if (!use.empty()) {
    c.frequency = column_number(use[0]);
    c.value = column_number(use[1]);
    if (units.size() > 2 && std::max(c.frequency, c.value) > units.size()) {
      spec.problem(fmt::format("'use' asks for a column beyond the {} that 'columns' names", units.size()),
                   "name the unit of every column");
      return {};
    }
    if (units.size() > 2) units = {units[c.frequency - 1], units[c.value - 1]};
  }
  auto const hz = parse_unit(units[0].as_word()), value = parse_unit(units[1].as_word());
  auto const how = value ? conversion(*value, rotation) : std::nullopt;
  if (!hz || hz->dimension != dim::frequency)
    units[0].problem(fmt::format("\"{}\" is not a unit of frequency", units[0].text()), "write 'Hz'");
  if (!how)
    units[1].problem(
        fmt::format("\"{}\" is not a unit of a {} spectrum", units[1].text(), rotation ? "rotation" : "motion"),
        rotation ? "write 'rad/sqrt(Hz)' or 'rad^2/Hz'"
                 : "write 'm/sqrt(Hz)' or 'm^2/Hz' (velocity and acceleration: 'm/s/sqrt(Hz)', 'm/s^2/sqrt(Hz)')");
  if (!hz || hz->dimension != dim::frequency || !how) return {};
  c.hz = hz->si;
  c.conversion = *how;
  return c;
}

}  // namespace

Spectrum read_spectrum_file(Node const& spec, bool rotation) {
  Node const file = spec["asd"];
  std::string const name = file.as_word();
  auto const columns = read_columns(spec, rotation);
  if (name.empty() || !columns) return {};
  std::string const text = file.data_file(name);
  if (text.empty() && !file.document()->optional_file(file, name)) return {};  // said by data_file()
  Curve curve = parse_curve(text, columns->frequency, columns->value);
  if (!curve.error.empty()) {
    file.problem(fmt::format("'{}' is not a spectrum: {}", name, curve.error),
                 "give columns of numbers with increasing frequency");
    return {};
  }
  for (std::size_t i = 0; i < curve.hz.size(); ++i) {
    curve.hz[i] *= columns->hz;
    curve.value[i] = columns->conversion.psd(curve.hz[i], curve.value[i]);
  }
  return Spectrum(std::move(curve.hz), std::move(curve.value));
}

}  // namespace straytrace
