// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "io/delimited_text.hpp"
#include "motion/axis_motion.hpp"
#include "motion/motion_files.hpp"

namespace straytrace::motion {
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
