// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/transfer_function.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/delimited_text.hpp"
#include "spectra/curve.hpp"

namespace straytrace::spectra {
namespace {

using C = std::complex<double>;
constexpr double edge = 1e-9;  // relative: allows for the rounding of printed frequencies

bool covers(std::vector<double> const& samples, double hz) {
  return hz >= samples.front() * (1 - edge) && hz <= samples.back() * (1 + edge);
}

}  // namespace

TransferFunction::TransferFunction(std::string name, std::vector<double> hz, std::vector<C> values) : gain_(1) {
  Table t{std::move(name), std::move(hz), {}, {}};
  for (C const& v : values) {
    t.log_modulus.push_back(std::log(std::abs(v)));
    double const turn = t.phase.empty() ? 0 : std::remainder(std::arg(v) - t.phase.back(), 2 * pi);
    t.phase.push_back(t.phase.empty() ? std::arg(v) : t.phase.back() + turn);
  }
  tables_.push_back(std::move(t));
}

TransferFunction TransferFunction::oscillator(double hz, double quality, Response response) {
  TransferFunction t({}, {}, 1);
  t.oscillators_.push_back({hz, quality, response});
  return t;
}

TransferFunction TransferFunction::product(TransferFunction const& a, TransferFunction const& b) {
  TransferFunction both = a;
  auto const append = [](auto& to, auto const& more) { to.insert(to.end(), more.begin(), more.end()); };
  append(both.zeros_, b.zeros_);
  append(both.poles_, b.poles_);
  append(both.oscillators_, b.oscillators_);
  append(both.tables_, b.tables_);
  both.gain_ *= b.gain_;
  both.delay_ += b.delay_;
  return both;
}

C TransferFunction::operator()(double hz) const {
  C value = gain_;
  C const s{0, -hz};
  for (double const z : zeros_) value *= z == 0 ? s : 1.0 + s / z;
  for (double const p : poles_) value /= p == 0 ? s : 1.0 + s / p;
  for (Oscillator const& o : oscillators_) {
    double const x = hz / o.hz;
    C const drag{0, -x / o.quality};
    C const above = o.response == Response::support ? 1.0 + drag : o.response == Response::relative ? x * x : 1;
    value *= above / (1 - x * x + drag);
  }
  for (Table const& t : tables_) value *= t(hz);
  if (delay_ != 0) value *= std::polar(1.0, 2 * pi * hz * delay_);
  return value;
}

C TransferFunction::Table::operator()(double f) const {
  if (!covers(hz, f) && !holds)
    throw InputError(
        fmt::format("'{}' covers {:g} Hz to {:g} Hz, not the requested {:g} Hz", name, hz.front(), hz.back(), f),
        "give a file that covers the band, or choose 'band' in 'noise' inside it");
  if (holds) f = std::clamp(f, hz.front(), hz.back());
  auto const above = std::clamp<std::ptrdiff_t>(std::ranges::upper_bound(hz, f) - hz.begin(), 1, std::ssize(hz) - 1);
  auto const b = std::size_t(above), a = b - 1;
  double const share = log_share(f, hz[a], hz[b]);
  return std::polar(std::exp(std::lerp(log_modulus[a], log_modulus[b], share)), std::lerp(phase[a], phase[b], share));
}

TransferFunction TransferFunction::delayed(double seconds) const {
  TransferFunction t = *this;
  t.delay_ += seconds;
  return t;
}

TransferFunction TransferFunction::holding_ends() const {
  TransferFunction t = *this;
  for (Table& table : t.tables_) table.holds = true;
  return t;
}

Band TransferFunction::range() const {
  Band range{0, infinity};
  for (Table const& t : tables_)
    if (!t.holds) range = {std::max(range.low, t.hz.front()), std::min(range.high, t.hz.back())};
  return range;
}

std::vector<double> TransferFunction::features() const {
  std::vector<double> hz = zeros_;
  hz.insert(hz.end(), poles_.begin(), poles_.end());
  for (Oscillator const& o : oscillators_) hz.push_back(o.hz);
  for (Table const& t : tables_) hz.insert(hz.end(), t.hz.begin(), t.hz.end());
  return hz;
}

TransferFunction read_response_file(Node const& file, bool decibels, std::optional<Band> const& band) {
  auto const table = read_numbers(file, 3,
                                  decibels ? "write frequency in Hz, modulus in dB, phase in degrees"
                                           : "write frequency in Hz, real part, imaginary part");
  if (!table) return {};
  std::string const& name = file.text();
  std::vector<double> hz;
  std::vector<C> values;
  for (std::size_t i = 0; i < table->rows(); ++i) {
    double const f = table->column[0][i], a = table->column[1][i], b = table->column[2][i];
    C const value = decibels ? std::polar(std::pow(10, a / 20), -b * pi / 180) : C(a, -b);
    if (!(f > (hz.empty() ? 0 : hz.back())) || value == 0.0) {
      file.file_problem(name, table->line[i], 1,
                        value == 0.0 ? "a response of zero has no logarithm" : "frequencies must be positive and rise",
                        value == 0.0 ? "remove the line" : "sort the lines by frequency, each one once");
      return {};
    }
    hz.push_back(f);
    values.push_back(value);
  }
  if (hz.size() < 2) {
    file.file_problem(name, 0, 0, "a response needs at least two frequencies", "give more lines: Hz and two numbers");
    return {};
  }
  if (band && (!covers(hz, band->low) || !covers(hz, band->high)))
    file.problem(fmt::format("'{}' covers {:g} Hz to {:g} Hz, and the band of the noise needs {:.4g} Hz to {:.4g} Hz",
                             name, hz.front(), hz.back(), band->low, band->high),
                 "give a file that covers the band, or choose 'band' in 'noise' inside it");
  return {name, std::move(hz), std::move(values)};
}

bool read_columns_are_decibels(Node const& table) {
  std::string columns;
  for (Node const& word : table.list("columns")) columns += word.text() + " ";
  if (columns == "Hz dB deg ") return true;
  if (columns != "Hz re im ")
    (table.has("columns") ? table["columns"] : table)
        .problem("name the columns of the file", "write 'columns: [Hz, re, im]' or 'columns: [Hz, dB, deg]'");
  return false;
}

TransferFunction read_transfer_function(Node const& table, std::optional<Band> const& band) {
  if (table.kind() != Node::Kind::table) {
    table.problem("a transfer function is a table", "write {gain: 1000, poles: [10 Hz]} or {file: loop.txt}");
    return {};
  }
  if (Node const file = table["file"]) {
    bool const decibels = read_columns_are_decibels(table);
    table.refuse_unknown("a transfer function");
    return read_response_file(file, decibels, band);
  }
  std::vector<double> roots[2];
  for (int i : {0, 1})
    if (Node const list = table[i == 0 ? "zeros" : "poles"])
      for (Node const& root : list.as_list()) roots[i].push_back(root.as_number(dim::frequency, 0));
  double const gain = table.number("gain", dim::plain);
  table.refuse_unknown("a transfer function");
  return {roots[0], roots[1], gain};
}

}  // namespace straytrace::spectra
