// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/files/gps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <regex>

#include "base/text/bounded_regex.hpp"

namespace straytrace::spectra {
namespace {

namespace ch = std::chrono;
using ch::sys_days;

constexpr sys_days epoch{ch::year{1980} / 1 / 6};

// Days at whose beginning one more leap second had been added since the GPS epoch (IERS Bulletin C).
constexpr std::array<sys_days, 18> leaps{
    sys_days{ch::year{1981} / 7 / 1}, sys_days{ch::year{1982} / 7 / 1}, sys_days{ch::year{1983} / 7 / 1},
    sys_days{ch::year{1985} / 7 / 1}, sys_days{ch::year{1988} / 1 / 1}, sys_days{ch::year{1990} / 1 / 1},
    sys_days{ch::year{1991} / 1 / 1}, sys_days{ch::year{1992} / 7 / 1}, sys_days{ch::year{1993} / 7 / 1},
    sys_days{ch::year{1994} / 7 / 1}, sys_days{ch::year{1996} / 1 / 1}, sys_days{ch::year{1997} / 7 / 1},
    sys_days{ch::year{1999} / 1 / 1}, sys_days{ch::year{2006} / 1 / 1}, sys_days{ch::year{2009} / 1 / 1},
    sys_days{ch::year{2012} / 7 / 1}, sys_days{ch::year{2015} / 7 / 1}, sys_days{ch::year{2017} / 1 / 1}};

double days_in_seconds(sys_days day) { return 86400.0 * double((day - epoch).count()); }

std::ptrdiff_t leaps_before(sys_days day) { return std::ranges::upper_bound(leaps, day) - leaps.begin(); }

}  // namespace

std::optional<double> gps_of_utc(std::string const& text) {
  static std::regex const form(R"((\d{4})-(\d\d)-(\d\d)(?:[T ](\d\d):(\d\d)(?::(\d\d)(\.\d*)?)?)?Z?)");
  std::smatch m;
  if (!bounded_regex_match(text, m, form)) return {};
  auto const whole = [&](std::size_t i) { return m[i].matched ? std::stoi(m[i]) : 0; };
  ch::year_month_day const date{ch::year{whole(1)}, ch::month{unsigned(whole(2))}, ch::day{unsigned(whole(3))}};
  if (!date.ok() || whole(4) > 23 || whole(5) > 59 || whole(6) > 60) return {};
  sys_days const day{date};
  bool const leap_day = std::ranges::find(leaps, day + ch::days{1}) != leaps.end();
  if (day < epoch || (whole(6) == 60 && !(leap_day && whole(4) == 23 && whole(5) == 59))) return {};
  double const fraction = m[7].matched && m[7].length() > 1 ? std::stod("0" + m[7].str()) : 0;
  return days_in_seconds(day) + 3600 * whole(4) + 60 * whole(5) + whole(6) + double(leaps_before(day)) + fraction;
}

std::string utc_of_gps(double gps) {
  double second = std::floor(gps), fraction = std::round((gps - second) * 1e6);
  if (fraction >= 1e6) second += 1, fraction = 0;
  // The last day that has begun by then, leap seconds counted.
  sys_days day = epoch + ch::days{std::int64_t(std::floor(second / 86400))};
  while (days_in_seconds(day) + double(leaps_before(day)) > second) day -= ch::days{1};
  auto const rest = int(second - days_in_seconds(day) - double(leaps_before(day)));
  ch::year_month_day const date{day};
  int const hour = std::min(rest / 3600, 23), minute = std::min((rest - 3600 * hour) / 60, 59);
  std::string const part = fraction > 0 ? fmt::format(".{:06.0f}", fraction) : "";
  return fmt::format("{:04d}-{:02d}-{:02d}T{:02d}:{:02d}:{:02d}{}Z", int(date.year()), unsigned(date.month()),
                     unsigned(date.day()), hour, minute, rest - 3600 * hour - 60 * minute, part);
}

std::string gps_text(double gps) {
  std::string text = fmt::format("{:.7f}", gps);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

}  // namespace straytrace::spectra
