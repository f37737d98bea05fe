// SPDX-License-Identifier: BSD-3-Clause
#include "noise/bands/inversion.hpp"

#include <boost/math/tools/toms748_solve.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "base/errors.hpp"

namespace straytrace::noise {
namespace {

using Doubles = std::vector<double>;
using Verdict = Allowed::Verdict;

// sum of s^n A_n in one bin, with the squares of the errors of its terms.
struct Powers {
  std::map<int, double> psd;
  std::vector<std::pair<int, double>> errors;  // n, one standard error of the PSD of a route

  double at(double s) const {
    double sum = 0;
    for (auto const& [n, a] : psd) sum += a * std::pow(s, n);
    return sum;
  }
  double slope(double s) const {
    double sum = 0;
    for (auto const& [n, a] : psd) sum += n * a * std::pow(s, n - 1);
    return sum;
  }
  double sigma(double s) const {  // a route and its reverse may share their numbers: twice the squares
    double sum = 0;
    for (auto const& [n, e] : errors) sum += 2 * std::pow(e * std::pow(s, n), 2);
    return std::sqrt(sum);
  }
};

constexpr double most = 1e12, least = 1e-12;

// The sum rises with s, so there is one crossing at most.
Allowed crossing(Powers const& powers, double line) {
  Allowed out;
  double const limit = line * line, rest = powers.psd.contains(0) ? powers.psd.at(0) : 0;
  if (!(line > 0)) return out;
  out.rest = std::sqrt(rest) / line;
  if (rest > limit) {
    out.verdict = Verdict::never;
    out.scale = 0;
    return out;
  }
  if (powers.at(most) <= limit) {
    out.verdict = Verdict::always;
    out.scale = infinity;
    return out;
  }
  double low = std::log(least), high = std::log(most);
  for (int i = 0; i < 100; ++i) {
    double const middle = 0.5 * (low + high);
    (powers.at(std::exp(middle)) > limit ? high : low) = middle;
  }
  out.verdict = Verdict::found;
  out.scale = std::exp(0.5 * (low + high));
  out.sigma = powers.sigma(out.scale) / powers.slope(out.scale);
  return out;
}

// The strictest of the bins.
void decide(Inversion& out) {
  out.all = {};
  for (std::size_t i = 0; i < out.bins.size(); ++i) {
    Allowed const& a = out.bins[i];
    if (a.verdict == Verdict::no_answer) continue;
    if (a.verdict == Verdict::unknown) {
      out.all = a;
      out.decides = i;
      return;
    }
    bool const worse_rest = a.verdict == Verdict::never && out.all.verdict == Verdict::never && a.rest > out.all.rest;
    if (out.all.verdict == Verdict::no_answer || a.scale < out.all.scale || worse_rest) {
      out.all = a;
      out.decides = i;
    }
  }
}

void add_part(std::vector<Powers>& bins, NoiseTrace const& t, RowPart const& part) {
  int const n = part.scatters.front();
  for (std::size_t i = 0; i < bins.size(); ++i) {
    bins[i].psd[n] += part.at(i) * t.psd(i);
    if (t.sigma[i] > 0) bins[i].errors.emplace_back(n, part.at(i) * t.psd_sigma(i));
  }
}

// Replaces answers that routes of unknown composition could change: `mixed` is their PSD, `untouched` that of the
// others which do not scatter on the material.
void admit_unknown(Inversion& out, std::vector<Powers> const& bins, Doubles const& mixed, Doubles const& untouched) {
  for (std::size_t i = 0; i < bins.size(); ++i) {
    double const all = bins[i].at(1);
    if (!(all > 0)) continue;
    out.touched = std::max(out.touched, 1 - untouched[i] / all);
    out.mixed = std::max(out.mixed, mixed[i] / all);
    Allowed& one = out.bins[i];
    if (one.verdict != Verdict::no_answer && mixed[i] > composition_limit * all)
      one = {.verdict = Verdict::unknown, .rest = one.rest};
  }
  decide(out);
  if (out.all.verdict == Verdict::always && out.mixed > 0)
    out.all = {.verdict = Verdict::unknown, .rest = out.all.rest};
}

// Where noise first exceeds the line of a bin.
struct Crossed {
  double below = 0, above = 0;    // scales about it; above 0: nowhere
  double exactly = not_a_number;  // where noise is a polynomial of the scale
};

// Noise against the strength of the motion. Below the scale at which fringes begin to wrap, the PSD of every bin is
// A + B s + C s^2: three projections give it, a fourth confirms it. Above, a scan, then refinement.
class MotionInversion {
 public:
  MotionInversion(Projected const& projected, Doubles const& line, bool every_bin)
      : projected_(projected), line_(line), every_bin_(every_bin), crossed_(line.size()) {}

  Inversion answer() {
    NoiseTrace const &still = at(0), &as_is = at(1);
    for (std::size_t i = 0; i < line_.size(); ++i)
      if (still.asd[i] > line_[i]) crossed_[i].above = scale_of(first);
    scan(cross_linear());
    Inversion out;
    for (std::size_t i = 0; i < line_.size(); ++i) {
      out.bins.push_back(of_bin(i, still));
      if (line_[i] > 0 && as_is.asd[i] > 0)
        out.touched = std::max(out.touched, 1 - std::pow(still.asd[i] / as_is.asd[i], 2));
    }
    decide(out);
    if (out.all.verdict == Verdict::found && !(crossed_[out.decides].exactly > 0)) refine(out);
    return out;
  }

 private:
  static constexpr int steps = 8, first = -4 * steps, last = 2 * steps;  // per decade

  static double scale_of(int step) { return std::pow(10, double(step) / steps); }
  NoiseTrace const& at(double scale) {
    auto const hit = seen_.find(scale);
    return hit != seen_.end() ? hit->second : seen_.emplace(scale, projected_(scale)).first->second;
  }
  bool can(double scale) {  // the motion may be too strong for a transform
    try {
      at(scale);
    } catch (NumericalError const&) {
      return false;
    }
    return true;
  }
  bool done() const {
    std::size_t known = 0, wanted = 0;
    for (std::size_t i = 0; i < line_.size(); ++i) {
      bool const found = crossed_[i].above > 0;
      known += found;
      wanted += found || line_[i] > 0;
    }
    return every_bin_ ? known == wanted : known > 0;
  }

  // S - A = B s + C s^2 through two scales.
  struct Quadratic {
    double b, c;
    double at(double s) const { return s * (b + s * c); }
  };
  Quadratic fitted(std::size_t i, int step) {
    double const s1 = scale_of(step - steps / 2), s2 = scale_of(step), still = at(0).psd(i);
    double const y1 = (at(s1).psd(i) - still) / s1, y2 = (at(s2).psd(i) - still) / s2, c = (y2 - y1) / (s2 - s1);
    return {y1 - c * s1, c};
  }
  // Whether noise is a polynomial up to here: it predicts that of a tenth.
  bool linear(int step) {
    constexpr double accuracy = 1e-3, faint = 1e-3;  // of the PSD; of that of the line
    NoiseTrace const& tenth = at(scale_of(step - steps));
    for (std::size_t i = 0; i < line_.size(); ++i) {
      if (!(line_[i] > 0)) continue;
      double const psd = tenth.psd(i), predicted = at(0).psd(i) + fitted(i, step).at(scale_of(step - steps));
      if (!(std::fabs(predicted - psd) <= accuracy * std::max(psd, faint * line_[i] * line_[i]))) return false;
    }
    return true;
  }
  // Crossings up to the largest scale at which noise is a polynomial; that scale as a step, or `first`.
  int cross_linear() {
    int step = 0;
    while (step > first + steps && !linear(step)) step -= steps / 2;
    if (!linear(step)) return first;
    for (;; step += steps / 2) {
      cross_below(step);
      if (done() || step >= last || !can(scale_of(step + steps / 2)) || !linear(step + steps / 2)) return step;
    }
  }
  void cross_below(int step) {
    for (std::size_t i = 0; i < line_.size(); ++i) {
      double const room = line_[i] * line_[i] - at(0).psd(i);
      if (crossed_[i].above > 0 || !(room >= 0) || !(at(scale_of(step)).psd(i) - at(0).psd(i) > room)) continue;
      Quadratic const q = fitted(i, step);
      double const root = std::sqrt(std::max(0.0, q.b * q.b + 4 * q.c * room));
      double const scale = 2 * room / (q.b + root);
      crossed_[i] = {scale_of(step - steps / 2), scale_of(step), std::min(scale, scale_of(step))};
    }
  }

  // Every step: at a fixed frequency the lines of a tone come and go within half a decade.
  void scan(int from) {
    auto const cross = [&](int step) {
      NoiseTrace const& t = at(scale_of(step));
      for (std::size_t i = 0; i < line_.size(); ++i)
        if (crossed_[i].above == 0 && t.asd[i] > line_[i])
          crossed_[i] = {step == first ? 0 : scale_of(step - 1), scale_of(step)};
    };
    if (from == first) cross(first);
    for (int step = from + 1; step <= last && !done() && can(scale_of(step)); ++step) cross(step);
  }

  // Between two steps by the straight line of the logarithms.
  Allowed of_bin(std::size_t i, NoiseTrace const& still) {
    Allowed a;
    if (!(line_[i] > 0)) return a;
    auto const& [below, above, exactly] = crossed_[i];
    a.rest = still.asd[i] / line_[i];
    a.verdict = still.asd[i] > line_[i] ? Verdict::never : above > 0 ? Verdict::found : Verdict::always;
    a.scale = a.verdict == Verdict::never ? 0 : infinity;
    if (a.verdict != Verdict::found) return a;
    double const lower = below > 0 ? below : above / scale_of(1);
    double const low = at(lower).asd[i], high = at(above).asd[i];
    double slope = std::log(high / low) / std::log(above / lower);
    a.scale = above * std::pow(line_[i] / high, 1 / slope);
    if (exactly > 0) {
      int const step = int(std::lround(steps * std::log10(above)));
      Quadratic const q = fitted(i, step);
      a.scale = exactly;
      slope = exactly * (q.b + 2 * q.c * exactly) / (2 * line_[i] * line_[i]);
    }
    double const relative = at(above).sigma[i] / high, relative_below = at(lower).sigma[i] / low;
    double const part = std::log(above / a.scale) / std::log(above / lower);
    a.sigma = a.scale * (relative + std::clamp(part, 0.0, 1.0) * (relative_below - relative)) / slope;
    return a;
  }

  // The first scale at which any bin crosses, in the interval in which the deciding one does.
  void refine(Inversion& out) {
    Crossed const interval = crossed_[out.decides];
    if (!(interval.below > 0)) return;
    auto const excess = [&](double scale) {
      NoiseTrace const& t = at(scale);
      double largest = -infinity;
      for (std::size_t i = 0; i < line_.size(); ++i)
        if (line_[i] > 0) largest = std::max(largest, std::log(std::max(t.asd[i], 1e-300) / line_[i]));
      return largest;
    };
    std::uintmax_t most = 20;
    auto const close = [](double a, double b) { return std::fabs(a - b) < 1e-4; };
    double const at_low = excess(interval.below), at_high = excess(interval.above);
    if (!(at_low < 0 && at_high > 0)) return;
    auto const [a, b] = boost::math::tools::toms748_solve([&](double log_scale) { return excess(std::exp(log_scale)); },
                                                          std::log(interval.below), std::log(interval.above), at_low,
                                                          at_high, close, most);
    out.all.scale = std::exp(0.5 * (a + b));
  }

  Projected const& projected_;
  Doubles const& line_;
  bool every_bin_;
  std::vector<Crossed> crossed_;
  std::map<double, NoiseTrace> seen_;
};

}  // namespace

Inversion invert_scatter(NoiseBudget const& b, Composition const& composition, Doubles const& line) {
  Inversion out;
  std::vector<Powers> bins(b.grid.size());
  Doubles mixed(bins.size()), untouched(bins.size());
  for (std::size_t r = 0; r < b.routes.size(); ++r) {
    for (RowPart const& part : composition.parts(r)) add_part(bins, b.routes[r], part);
    for (std::size_t i = 0; i < bins.size(); ++i) {
      double const psd = b.routes[r].psd(i), unknown = composition.unknown(r, i, 0);
      mixed[i] += unknown * psd;
      out.first_order = out.first_order || unknown * psd > 0;
      for (RowPart const& part : composition.parts(r))
        if (part.scatters.front() == 0 && !(unknown > 0 && part.by_coupling)) untouched[i] += part.at(i) * psd;
    }
  }
  for (std::size_t i = 0; i < bins.size(); ++i) out.bins.push_back(crossing(bins[i], line[i]));
  admit_unknown(out, bins, mixed, untouched);
  return out;
}

Inversion invert_motion(Projected const& projected, Doubles const& line, bool every_bin) {
  return MotionInversion(projected, line, every_bin).answer();
}

MotionSet with_scaled_body(MotionSet const& motion, BodyId body, double scale) {
  MotionSet out = motion;
  for (MotionInput& input : out.inputs)
    for (Gain& gain : input.gains)
      if (gain.body == body) gain.value *= scale;
  return out;
}

}  // namespace straytrace::noise
