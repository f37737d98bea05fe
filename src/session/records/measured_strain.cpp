// SPDX-License-Identifier: BSD-3-Clause
#include "session/records/measured_strain.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/files/text_file.hpp"
#include "base/math/constants.hpp"
#include "io/delimited_text.hpp"

namespace straytrace::session {
namespace {

constexpr double joined_spacing = 0.0115;  // spacing over frequency: 200 points per decade
constexpr char const* measured_columns =
    "write columns: frequency [Hz], ASD [1/sqrt(Hz)], standard error of the ASD where it is known";

void add_point(MeasuredStrain& m, double hz, double psd, double sigma) {
  m.hz.push_back(hz);
  m.asd.push_back(std::sqrt(psd));
  m.low.push_back(std::sqrt(std::max(psd - sigma, 0.0)));
  m.high.push_back(std::sqrt(psd + sigma));
}

nlohmann::json numbers_or_null(std::vector<double> const& values) {
  nlohmann::json all = nlohmann::json::array();
  for (double const v : values)
    all.push_back(std::isfinite(v) ? nlohmann::json::parse(fmt::format("{:.6g}", v)) : nlohmann::json(nullptr));
  return all;
}

}  // namespace

MeasuredStrain measured_from(WelchSpectrum const& s, WelchSettings const& settings, double low, double high) {
  MeasuredStrain m;
  double const step = s.hz[1] - s.hz[0];
  for (std::size_t k = 1; k + 1 < s.hz.size();) {
    auto const joined = std::max<std::size_t>(1, std::size_t(joined_spacing * double(k)));
    std::size_t const end = std::min(k + joined, s.hz.size() - 1);
    double const from = s.hz[k] - step / 2, to = s.hz[end - 1] + step / 2, middle = (from + to) / 2;
    if (middle >= low && middle <= high) {
      if (end == k + 1) {
        add_point(m, s.hz[k], s.psd[k], s.sigma[k]);
      } else {
        BandPower const p = band_power(s, settings, from, to);
        add_point(m, middle, p.power / (to - from), p.sigma / (to - from));
      }
    }
    k = end;
  }
  return m;
}

MeasuredStrain parse_measured(std::string const& text, std::string const& file, double low, double high) {
  refuse_binary(text, file);
  NumberTable table = parse_numbers(text, NonFinite::refused, HeaderRow::allowed);
  for (Problem& p : table.problems) p.suggestion = measured_columns;
  if (table.problems.empty() && table.column.size() < 2)
    table.problems.push_back({{}, "it has one column, not frequency and ASD", measured_columns});
  MeasuredStrain m;
  for (std::size_t i = 0; table.problems.empty() && i < table.rows(); ++i) {
    double const hz = table.column[0][i], asd = table.column[1][i];
    double const sigma = table.column.size() > 2 ? table.column[2][i] : not_a_number;
    if (!(hz >= 0 && asd >= 0 && !(sigma < 0)) || (i > 0 && !(hz > table.column[0][i - 1]))) {
      table.problems.push_back(
          {{0, table.line[i], 1}, "frequencies rise from row to row, and no number is negative", measured_columns});
    } else if (hz >= low && hz <= high) {
      m.hz.push_back(hz);
      m.asd.push_back(asd);
      m.low.push_back(std::max(asd - sigma, 0.0) + 0 * sigma);
      m.high.push_back(asd + sigma);
    }
  }
  if (!table.problems.empty()) throw errors_in(file, std::move(table.problems));
  m.source = table.column.size() > 2 ? file : file + ", without errors";
  return m;
}

std::string measured_json(std::vector<MeasuredStrain> const& all) {
  nlohmann::json list = nlohmann::json::array();
  for (MeasuredStrain const& m : all)
    list.push_back({{"name", m.name},
                    {"source", m.source},
                    {"frequency", numbers_or_null(m.hz)},
                    {"asd", numbers_or_null(m.asd)},
                    {"low", numbers_or_null(m.low)},
                    {"high", numbers_or_null(m.high)}});
  return list.dump();
}

}  // namespace straytrace::session
