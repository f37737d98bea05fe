// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/coupling/coupling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/input/document.hpp"
#include "base/math/constants.hpp"
#include "base/math/distributions.hpp"
#include "base/text/words.hpp"
#include "base/units/quantity.hpp"
#include "io/delimited_text.hpp"
#include "spectra/curve.hpp"
#include "spectra/files/unit_text.hpp"

namespace straytrace::analysis {
namespace {

// Relative variance of H^2. Witness and target of one stretch fluctuate together as far as they are coherent:
// cov(Sxx, Syy) = |Sxy|^2/n.
double relative_variance(CouplingLevels const& i, CouplingLevels const& q) {
  double const y = i.y - q.y, x = i.x - q.x;
  auto const own = [](CouplingLevels const& l, double from_x, double from_y) {
    return (squared(l.x / from_x) + squared(l.y / from_y) - 2 * l.coherence * (l.x / from_x) * (l.y / from_y)) /
           l.averages;
  };
  return own(i, x, y) + own(q, x, y);
}

// The share of the target's gain that is coherent with the witness bounds linear coupling. The rest of a linear
// coupling is quiet noise of the target, and sensor noise of the witness seen through the coupling.
bool is_not_linear(CouplingLevels const& i, CouplingLevels const& q, double raw_coherence, double threshold) {
  if (i.averages < 2) return false;
  double const left = i.y * (1 - raw_coherence) * i.averages / (i.averages - 1);
  double const allowed = q.y + i.y * q.x / i.x;
  double const sure = excess_significance({left, i.averages - 1}, {allowed, q.averages});
  return sure > threshold && left - allowed > (i.y - q.y) / 2;
}

CouplingPoint point(CouplingLevels const& i, CouplingLevels const& q, double raw_coherence,
                    CouplingThresholds const& t) {
  CouplingPoint p;
  if (!(i.x > 0 && i.y > 0 && q.x > 0 && q.y > 0)) return p;
  p.witness_ratio = std::sqrt(i.x / q.x);
  p.target_ratio = std::sqrt(i.y / q.y);
  p.coherence = i.coherence;
  p.significance = excess_significance({i.y, i.averages}, {q.y, q.averages});
  double const witness = excess_significance({i.x, i.averages}, {q.x, q.averages});
  p.flag = CouplingFlag::below_thresholds;
  if (!(p.witness_ratio >= t.witness && p.witness_ratio > 1 && witness >= t.significance)) return p;
  double const gained = i.x - q.x;
  if (p.target_ratio >= t.target && p.target_ratio > 1 && p.significance >= t.significance) {
    bool const wrapped = t.check_linear && is_not_linear(i, q, raw_coherence, t.not_linear);
    p.flag = wrapped ? CouplingFlag::not_linear : CouplingFlag::measured;
    p.factor = std::sqrt((i.y - q.y) / gained);
    p.sigma = p.factor / 2 * std::sqrt(std::max(0.0, relative_variance(i, q)));
    return p;
  }
  double const limit = coupling_limit(i, q, t.confidence);
  if (!std::isfinite(limit)) return p;
  p.flag = CouplingFlag::upper_limit;
  p.factor = limit;
  return p;
}

// One frequency of all injections.
CouplingPoint combined(std::vector<CouplingPoint const*> const& all) {
  CouplingPoint best = *all.front();
  double weight = 0, mean = 0, chi = 0;
  int measured = 0;
  for (CouplingPoint const* p : all) {
    if (p->flag == CouplingFlag::not_linear) return *p;
    if (p->flag == CouplingFlag::measured && p->sigma > 0) {
      weight += 1 / squared(p->sigma);
      mean += p->factor / squared(p->sigma);
      ++measured;
    }
    bool const lower = p->flag == best.flag && p->flag == CouplingFlag::upper_limit && p->factor < best.factor;
    bool const surer =
        p->flag == best.flag && p->significance > best.significance && p->flag != CouplingFlag::upper_limit;
    if (p->flag < best.flag || lower || surer) best = *p;
  }
  if (measured < 2) return best;
  best.factor = mean / weight;
  for (CouplingPoint const* p : all)
    if (p->flag == CouplingFlag::measured && p->sigma > 0) chi += squared((p->factor - best.factor) / p->sigma);
  best.sigma = std::sqrt(std::max(1.0, chi / (measured - 1)) / weight);
  return best;
}

}  // namespace

double coupling_limit(CouplingLevels const& i, CouplingLevels const& q, double confidence) {
  auto const above = [&](double psd, double n) { return psd * (upper_factor(n, confidence) - 1); };
  auto const below = [&](double psd, double n) { return psd * (1 - upper_factor(n, 1 - confidence)); };
  double const loud = std::max(i.y, q.y), y = loud - q.y, x = i.x - q.x;
  double const up = above(loud, i.averages), down = below(i.x, i.averages);
  double const a = x * x - squared(down) - squared(above(q.x, q.averages));
  double const b = x * y - i.coherence * up * down;
  double const c = y * y - squared(up) - squared(below(q.y, q.averages));
  return a > 0 ? std::sqrt((b + std::sqrt(b * b - a * c)) / a) : infinity;
}

char const* name_of(CouplingFlag flag) {
  switch (flag) {
    case CouplingFlag::measured:
      return "Real";
    case CouplingFlag::upper_limit:
      return "Upper Limit";
    case CouplingFlag::below_thresholds:
      return "Thresholds not met";
    case CouplingFlag::no_data:
      return "No data";
    case CouplingFlag::not_linear:
      return "Fringe wrapped";
  }
  return "";
}

std::string coupling_unit(std::string const& target, std::string const& witness) {
  return target == witness && target != "1" ? target + "/" + target : ratio_unit(target, witness);
}

double unbiased_coherence(double c, double averages) {
  double const chance = 1 / std::max(averages, 1.0);
  return chance < 1 ? std::max(0.0, (c - chance) / (1 - chance)) : 0;
}

std::vector<CouplingPoint> measure_coupling(CrossSpectra const& injection, CrossSpectra const& quiet,
                                            CouplingThresholds const& t) {
  if (injection.hz != quiet.hz)
    throw InputError("injection and quiet stretch have different frequencies", "use one segment length for both");
  std::vector<double> const loud = coherence(injection), still = coherence(quiet);
  auto const levels = [](CrossSpectra const& s, std::vector<double> const& c, std::size_t k) {
    return CouplingLevels{s.input[k], s.output[k], unbiased_coherence(c[k], s.effective_averages),
                          s.effective_averages};
  };
  std::vector<CouplingPoint> points;
  for (std::size_t k = 1; k < injection.hz.size(); ++k) {
    points.push_back(point(levels(injection, loud, k), levels(quiet, still, k), loud[k], t));
    points.back().hz = injection.hz[k];
  }
  return points;
}

CouplingFunction combine(std::span<CouplingFunction const> all) {
  if (all.empty()) return {};
  CouplingFunction out = all.front();
  for (CouplingFunction const& c : all)
    if (c.unit != out.unit || c.points.size() != out.points.size())
      throw InputError(fmt::format("cannot combine couplings of '{}' and '{}': different units or frequencies",
                                   out.witness, c.witness),
                       "use one segment length and one unit");
  for (std::size_t k = 0; k < out.points.size(); ++k) {
    std::vector<CouplingPoint const*> at;
    for (CouplingFunction const& c : all) {
      if (c.points[k].hz != out.points[k].hz)
        throw InputError("cannot combine couplings at different frequencies", "use one segment length");
      at.push_back(&c.points[k]);
    }
    out.points[k] = combined(at);
  }
  return out;
}

namespace {

constexpr CouplingFlag flags[] = {CouplingFlag::measured, CouplingFlag::upper_limit, CouplingFlag::below_thresholds,
                                  CouplingFlag::no_data, CouplingFlag::not_linear};

std::string plain(std::string_view text) {  // lower case, without blanks around and quotes
  std::string out;
  for (char const c : text)
    if (c != '"' && c != '\r') out += char(std::tolower(static_cast<unsigned char>(c)));
  out.erase(0, std::min(out.find_first_not_of(" \t"), out.size()));
  out.erase(out.find_last_not_of(" \t") + 1);
  return out;
}

std::optional<CouplingFlag> flag_of(std::string_view text) {
  std::string const word = plain(text);
  if (word == "measured") return CouplingFlag::measured;
  for (CouplingFlag const f : flags)
    if (word == plain(name_of(f))) return f;
  return {};
}

// Reads one file; messages state its name and the line.
class Reader {
 public:
  explicit Reader(std::string const& file) : file_(file) {}

  CouplingFunction read(std::string_view csv) {
    std::vector<InputError> errors;
    std::string const text = with_plain_spaces(csv);
    for (TextLine const& line : text_lines(text, Comments::whole_lines)) {
      line_ = line.number;
      bool const header = columns_.empty();
      try {
        header ? take_header(line) : take_row(line);
      } catch (InputError const& e) {
        errors.push_back(e);
      }
      if (errors.size() >= (header ? 1 : most_errors)) break;
    }
    throw_all(errors);
    line_ = 0;
    if (columns_.empty() || out_.points.empty()) refuse("no couplings in it", "the columns are " + std::string(wanted));
    return std::move(out_);
  }

  [[noreturn]] void refuse(std::string const& what, std::string const& suggestion, std::uint32_t column = 0) const {
    throw errors_in(file_, {{{0, line_, column}, what, suggestion}});
  }

 private:
  static constexpr std::string_view glued = "darmbgcoherence";  // pemcoupling omits a comma between two names
  static constexpr std::size_t most_errors = 10;
  static constexpr std::string_view wanted = "frequency, factor, factor_counts, flag";

  // Names contain no blanks, so a blank inside a name replaces an omitted comma. A cell without a name is a column too:
  // the row numbers of pandas.
  void take_header(TextLine const& line) {
    std::size_t at = 0;
    for (TextCell const& cell : comma_cells(line)) {
      std::size_t const before = at;
      for (TextCell const& word : words_of({cell.text, line.number}))
        if (std::string const name = plain(word.text); !name.empty()) {
          columns_.emplace(name == "freq" ? "frequency" : name, at++);
          if (name == glued) columns_.emplace("coherence", at++);
        }
      if (at == before) ++at;
    }
    named_ = at;
    for (char const* name : {"frequency", "factor", "flag"})
      if (!columns_.contains(name))
        refuse(fmt::format("no column '{}'", name), fmt::format("the first line names the columns: {}", wanted));
  }

  TextCell cell(char const* column) const {
    auto const found = columns_.find(column);
    return found == columns_.end() || found->second >= cells_.size() ? TextCell() : cells_[found->second];
  }
  double number(char const* column) const {
    TextCell const written = cell(column);
    std::string const word = plain(written.text);
    if (word.empty() || word == "nan") return not_a_number;
    double value = 0;
    auto const [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (status != std::errc{} || end != word.data() + word.size())
      refuse(fmt::format("'{}' {} in column '{}'", written.text, number_fault(word), column), "write it as 1.5e-3",
             written.column);
    return value;
  }
  // All wrong numbers of a row at once.
  void check_numbers(bool known) const {
    std::vector<InputError> wrong;
    for (char const* column : {"frequency", "factor", "factor_error", "witness_ratio", "target_ratio", "significance",
                               "coherence", "factor_counts"})
      try {
        if (known || column != std::string_view("factor_counts")) number(column);
      } catch (InputError const& e) {
        wrong.push_back(e);
      }
    throw_all(wrong);
  }
  void agree(std::string& kept, char const* column) const {
    std::string_view const word = cell(column).text;
    if (kept.empty()) kept = word;
    if (!word.empty() && word != kept)
      refuse(fmt::format("two different entries in column '{}'", column), "split the file");
  }

  void take_row(TextLine const& line) {
    cells_ = comma_cells(line);
    if (cells_.size() > named_ && !plain(cells_[named_].text).empty())
      refuse(fmt::format("more values than the {} columns that have a name", named_), surplus_remedy(cells_));
    TextCell const written = cell("flag");
    auto const flag = flag_of(written.text);
    if (!flag)
      refuse(fmt::format("'{}' is not a flag", written.text),
             "flags are Real or Measured, Upper Limit, Thresholds not met, No data, Fringe wrapped", written.column);
    CouplingPoint p;
    p.flag = *flag;
    bool const known = p.flag == CouplingFlag::measured || p.flag == CouplingFlag::upper_limit;
    check_numbers(known);
    p.hz = number("frequency");
    if (!(p.hz >= 0) || (!out_.points.empty() && p.hz <= out_.points.back().hz))
      refuse("the frequency does not increase", "sort the rows by frequency", cell("frequency").column);
    double const factor = number("factor");
    if (known && !(factor > 0 && std::isfinite(factor)))
      refuse(std::isfinite(factor) ? "the factor is not positive" : "the factor is not a finite number",
             "correct it, or flag it 'No data'", cell("factor").column);
    if (known || (p.flag == CouplingFlag::not_linear && factor > 0)) p.factor = factor;
    if (known) p.factor_counts = number("factor_counts");
    p.sigma = number("factor_error");
    p.witness_ratio = number("witness_ratio");
    p.target_ratio = number("target_ratio");
    p.significance = number("significance");
    p.coherence = number("coherence");
    agree(out_.unit, "unit");
    agree(out_.witness_unit, "witness_unit");
    agree(out_.witness, "witness");
    agree(out_.target, "target");
    out_.points.push_back(p);
  }

  std::string const& file_;
  std::uint32_t line_ = 0;
  std::map<std::string, std::size_t> columns_;
  std::size_t named_ = 0;  // columns of the header
  std::vector<TextCell> cells_;
  CouplingFunction out_;
};

std::string number_text(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

// One unit from the file, the caller or both; they must agree.
void settle(Reader const& reader, std::string& found, std::string const& said, char const* what, char const* option) {
  if (found.empty()) found = said;
  if (found.empty())
    reader.refuse(fmt::format("the file does not state the unit of its {}", what), fmt::format("add {}", option));
  if (!parse_unit(found)) reader.refuse(fmt::format("'{}' is not a unit", found), "write for example m, m/s^2, 1/m");
  if (!said.empty() && said != found)
    reader.refuse(fmt::format("its {} are in {}, not in {}", what, found, said), "leave the unit to the file");
}

}  // namespace

CouplingFunction parse_coupling(std::string_view csv, std::string const& file, std::string const& unit,
                                std::string const& witness_unit) {
  Reader reader(file);
  CouplingFunction c = reader.read(csv);
  settle(reader, c.unit, unit, "factors", "--coupling-unit, for example 1/m");
  settle(reader, c.witness_unit, witness_unit, "witness", "--witness-unit, for example m");
  return c;
}

std::string coupling_csv(CouplingFunction const& c) {
  std::string out =
      "frequency,factor,factor_counts,flag,factor_error,unit,witness,witness_unit,target,witness_ratio,target_ratio,"
      "significance,coherence\n";
  for (CouplingPoint const& p : c.points)
    out += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", p.hz, number_text(p.factor),
                       number_text(p.factor_counts), name_of(p.flag), number_text(p.sigma), c.unit, c.witness,
                       c.witness_unit, c.target, number_text(p.witness_ratio), number_text(p.target_ratio),
                       number_text(p.significance), number_text(p.coherence));
  return out;
}

namespace {

void refuse_wrapped(CouplingFunction const& c, double low, double high) {
  std::size_t count = 0;
  CouplingPoint const* first = nullptr;
  for (CouplingPoint const& p : c.points)
    if (p.flag == CouplingFlag::not_linear && p.hz >= low && p.hz <= high && ++count == 1) first = &p;
  if (count > 0)
    throw InputError(
        fmt::format("the coupling of '{}' is not linear at {} frequencies, the first of them {:g} Hz: its noise "
                    "does not grow with the level of the witness",
                    c.witness, count, first->hz),
        "project the motion in the time domain: straytrace project RUN --body BODY --channel FILE::CHANNEL");
}

// The coupling at a frequency between two points.
CouplingPoint between(CouplingPoint const& a, CouplingPoint const& b, double hz) {
  CouplingPoint p = a;
  p.hz = hz;
  if (!a.has_factor() || !b.has_factor()) {
    p.factor = p.sigma = not_a_number;
    p.flag = std::max(a.flag, b.flag);
    return p;
  }
  double const share = log_share(hz, a.hz, b.hz);
  p.factor = std::exp((1 - share) * std::log(a.factor) + share * std::log(b.factor));
  p.flag = std::max(a.flag, b.flag);
  p.sigma = p.factor * std::max(a.sigma / a.factor, b.sigma / b.factor);
  return p;
}

CouplingPoint at(CouplingFunction const& c, double hz) {
  auto const next = std::lower_bound(c.points.begin(), c.points.end(), hz,
                                     [](CouplingPoint const& p, double f) { return p.hz < f * (1 - 1e-9); });
  if (next == c.points.end()) return {};
  if (next->hz <= hz * (1 + 1e-9)) return *next;
  if (next == c.points.begin()) return {};
  return between(*(next - 1), *next, hz);
}

struct Conversion {
  double scale = 1;
  int integrations = 0;  // an ASD of m/s^2 over (2 pi f)^2 is one of m
};

// Converts the unit of the spectrum to that of the coupling's witness.
Conversion conversion(CouplingFunction const& c, QuietWitness const& w) {
  auto const have = parse_unit(w.unit), want = parse_unit(c.witness_unit);
  for (int n = 0; have && want && n <= 2; ++n)
    if (auto const reached = times(have->dimension, *power_of(dim::time, n)); reached && *reached == want->dimension)
      return {have->si / want->si, n};
  throw InputError(
      fmt::format("the coupling is per {}, and the witness is in {}", c.witness_unit, w.unit),
      "give the witness in the unit of the coupling or its time derivatives; for counts, give the calibration: "
      "--unit \"2e-6 m/s^2\"");
}

}  // namespace

ProjectedCoupling project_coupling(CouplingFunction const& c, QuietWitness const& w) {
  Conversion const to = conversion(c, w);
  ProjectedCoupling out{c.witness, c.target, {}};
  if (w.hz.empty()) return out;
  refuse_wrapped(c, w.hz.front(), w.hz.back());
  for (std::size_t k = 0; k < w.hz.size(); ++k) {
    CouplingPoint const p = w.hz[k] > 0 ? at(c, w.hz[k]) : CouplingPoint{};
    ProjectedPoint q{w.hz[k], not_a_number, not_a_number, p.flag};
    if (p.has_factor()) q.asd = p.factor * integrated_asd(w.asd[k], w.hz[k], to.integrations) * to.scale;
    if (p.flag == CouplingFlag::measured)
      q.sigma = q.asd * std::hypot(p.sigma / p.factor, w.asd[k] > 0 ? w.sigma[k] / w.asd[k] : 0);
    out.points.push_back(q);
  }
  return out;
}

QuietWitness level_of(WelchSpectrum const& w, std::string const& unit) {
  QuietWitness level{unit, {}, {}, {}};
  for (std::size_t k = 1; k < w.hz.size(); ++k) {
    level.hz.push_back(w.hz[k]);
    level.asd.push_back(std::sqrt(w.psd[k]));
    level.sigma.push_back(w.psd[k] > 0 ? w.sigma[k] / (2 * level.asd.back()) : 0);
  }
  return level;
}

std::string unit_below(std::string const& unit, TimeSeries const& witness) {
  auto const stroke = unit.find('/');
  std::string below = stroke == unit.npos ? "1" : unit.substr(stroke + 1);
  if (below.starts_with('(') && below.ends_with(')')) below = below.substr(1, below.size() - 2);
  auto const whole = parse_unit(unit), above = parse_unit(unit.substr(0, stroke)), part = parse_unit(below),
             have = parse_unit(witness.unit);
  bool const split = whole && above && part && times(above->dimension, part->dimension, -1) == whole->dimension;
  if (!split || !have || !(part->dimension == have->dimension))
    throw InputError(
        fmt::format("--coupling-unit: '{}' is not per {}, the unit of '{}'", unit, witness.unit, witness.name),
        fmt::format("write for example {}", ratio_unit("1", witness.unit)));
  return below;
}

std::string unit_above(CouplingFunction const& c) {
  for (std::string const& below : {"/" + c.witness_unit, "/(" + c.witness_unit + ")"})
    if (c.unit.ends_with(below)) return c.unit.substr(0, c.unit.size() - below.size());
  return c.unit;
}

void rescale(ProjectedCoupling& p, CouplingFunction const& c, TimeSeries const& target) {
  std::string const unit = unit_above(c);
  auto const have = parse_unit(unit), want = parse_unit(target.unit);
  if (!have || !want || !(have->dimension == want->dimension))
    throw InputError(fmt::format("--target: '{}' is in {}, but the coupling gives {}", target.name, target.unit, unit),
                     "choose the target of the measured coupling");
  for (ProjectedPoint& q : p.points) {
    q.asd *= have->si / want->si;
    q.sigma *= have->si / want->si;
  }
}

namespace {

// Sums of PSDs over lines, and the variance of their difference: each level varies by S/sqrt(n).
struct Sums {
  double loud = 0, quiet = 0, loud_squares = 0, quiet_squares = 0;
  void add(double injection, double still) {
    loud += injection;
    quiet += still;
    loud_squares += injection * injection;
    quiet_squares += still * still;
  }
  double gained() const { return loud - quiet; }
  double variance(double shared, double n_loud, double n_quiet) const {
    return shared * (loud_squares / n_loud + quiet_squares / n_quiet);
  }
};

// Sum over m of the squared correlation of lines m apart: N sum w^4/(sum w^2)^2, 35/18 for a Hann window.
double lines_shared(WelchSettings const& s) {
  double two = 0, four = 0;
  for (double const w : window_weights(s.window, s.window_parameter, s.segment)) {
    two += w * w;
    four += w * w * w * w;
  }
  return double(s.segment) * four / (two * two);
}

}  // namespace

BandCoupling band_coupling(CrossSpectra const& injection, CrossSpectra const& quiet, double low, double high,
                           WelchSettings const& settings) {
  constexpr double clear = 3, low_density = 0.1;  // standard errors; of the mean density over the band
  std::vector<std::size_t> lines;
  for (std::size_t k = 1; k < injection.hz.size(); ++k)
    if (injection.hz[k] >= low && injection.hz[k] <= high) lines.push_back(k);
  BandCoupling out;
  if (lines.empty()) return out;
  double const shared = lines_shared(settings), n = injection.effective_averages, m = quiet.effective_averages;
  Sums x, y, first, last;
  std::size_t const end = lines.size() / 10;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::size_t const k = lines[i];
    x.add(injection.input[k], quiet.input[k]);
    y.add(injection.output[k], quiet.output[k]);
    if (i < end) first.add(injection.output[k], quiet.output[k]);
    if (i + end >= lines.size()) last.add(injection.output[k], quiet.output[k]);
  }
  out.witness_ratio = std::sqrt(x.loud / x.quiet);
  out.target_ratio = std::sqrt(y.loud / y.quiet);
  double const vx = x.variance(shared, n, m), vy = y.variance(shared, n, m);
  if (!(x.gained() > clear * std::sqrt(vx) && y.gained() > clear * std::sqrt(vy))) return out;
  double const square = y.gained() / x.gained();
  out.factor = std::sqrt(square);
  out.sigma = out.factor / 2 * std::sqrt(vx / (x.gained() * x.gained()) + vy / (y.gained() * y.gained()));
  out.share = square * x.quiet / y.quiet;
  auto const rises = [&](Sums const& s) {
    return s.gained() > clear * std::sqrt(s.variance(shared, n, m)) &&
           s.gained() / double(end) > low_density * y.gained() / double(lines.size());
  };
  out.rises_at_low = end > 0 && rises(first);
  out.rises_at_high = end > 0 && rises(last);
  return out;
}

namespace {

constexpr double as_good_as_known = 1e7;  // averages; above, F is chi-square to the precision of its quantiles

// Probability of a ratio beyond `ratio`, above or below.
double tail(double ratio, double loud, double quiet, bool above) {
  double const n = 2 * std::min(loud, as_good_as_known);
  if (quiet >= as_good_as_known) {
    return above ? chi_squared_tail(n, n * ratio) : chi_squared_cdf(n, n * ratio);
  }
  return above ? fisher_tail(n, 2 * quiet, ratio) : fisher_cdf(n, 2 * quiet, ratio);
}

}  // namespace

double sigmas_of_probability(double p) {
  if (!(p > probability_of_sigmas(largest_significance))) return largest_significance;
  if (p >= 1) return -largest_significance;
  return normal_tail_quantile(p);
}

double probability_of_sigmas(double s) { return std::erfc(s / std::sqrt(2)) / 2; }

double excess_significance(AveragedPsd const& loud, AveragedPsd const& quiet) {
  if (!(loud.psd > 0 && quiet.psd > 0 && loud.averages > 0 && quiet.averages > 0)) return not_a_number;
  double const ratio = loud.psd / quiet.psd, above = tail(ratio, loud.averages, quiet.averages, true);
  if (above < 0.5) return sigmas_of_probability(above);
  return -sigmas_of_probability(tail(ratio, loud.averages, quiet.averages, false));
}

double upper_factor(double averages, double confidence) {
  double const n = 2 * averages;
  return n / chi_squared_quantile(n, 1 - confidence);
}

}  // namespace straytrace::analysis
