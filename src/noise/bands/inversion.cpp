// SPDX-License-Identifier: BSD-3-Clause
#include "noise/bands/inversion.hpp"

#include <algorithm>
#include <cmath>
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

struct Crossed {
  double below = 0, above = 0;  // scales around the first crossing; above 0: none
};

// Noise against the strength of the motion: a coarse scan, then refinement.
class MotionInversion {
 public:
  MotionInversion(Projected const& projected, Doubles const& line)
      : projected_(projected), line_(line), crossed_(line.size()) {}

  Inversion answer() {
    NoiseTrace const &still = at(0), &as_is = at(1);
    find_crossings();
    Inversion out;
    for (std::size_t i = 0; i < line_.size(); ++i) {
      out.bins.push_back(between_steps(i, still));
      if (line_[i] > 0 && as_is.asd[i] > 0)
        out.touched = std::max(out.touched, 1 - std::pow(still.asd[i] / as_is.asd[i], 2));
    }
    decide(out);
    if (out.all.verdict == Verdict::found) refine(out);
    return out;
  }

 private:
  static constexpr int steps = 8, first = -4 * steps, last = 2 * steps;  // per decade

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

  void find_crossings() {
    for (int k = first; k <= last; ++k) {
      double const scale = std::pow(10, double(k) / steps), before = std::pow(10, double(k - 1) / steps);
      if (std::ranges::all_of(crossed_, [](Crossed const& c) { return c.above > 0; })) return;
      if (scale > 1 && !can(scale)) return;
      NoiseTrace const& t = at(scale);
      for (std::size_t i = 0; i < line_.size(); ++i)
        if (crossed_[i].above == 0 && t.asd[i] > line_[i]) crossed_[i] = {k == first ? 0 : before, scale};
    }
  }

  // By the straight line of the logarithms: exact where noise is proportional to motion.
  Allowed between_steps(std::size_t i, NoiseTrace const& still) {
    Allowed a;
    if (!(line_[i] > 0)) return a;
    double const above = crossed_[i].above;
    a.rest = still.asd[i] / line_[i];
    a.verdict = still.asd[i] > line_[i] ? Verdict::never : above > 0 ? Verdict::found : Verdict::always;
    a.scale = a.verdict == Verdict::never ? 0 : infinity;
    if (a.verdict != Verdict::found) return a;
    double const lower = crossed_[i].below > 0 ? crossed_[i].below : above / std::pow(10, 1.0 / steps);
    double const low = at(lower).asd[i], high = at(above).asd[i];
    double const slope = std::log(high / low) / std::log(above / lower);
    a.scale = above * std::pow(line_[i] / high, 1 / slope);
    a.sigma = a.scale * (at(above).sigma[i] / high) / slope;
    return a;
  }

  void refine(Inversion& out) const {
    double low = crossed_[out.decides].below, high = crossed_[out.decides].above;
    auto const meets = [&](double scale) {
      NoiseTrace const t = projected_(scale);
      for (std::size_t i = 0; i < line_.size(); ++i)
        if (t.asd[i] > line_[i]) return false;
      return true;
    };
    for (int i = 0; i < 12 && low > 0; ++i) (meets(std::sqrt(low * high)) ? low : high) = std::sqrt(low * high);
    if (low > 0) out.all.scale = std::sqrt(low * high);
  }

  Projected const& projected_;
  Doubles const& line_;
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

Inversion invert_motion(Projected const& projected, Doubles const& line) {
  return MotionInversion(projected, line).answer();
}

MotionSet with_scaled_body(MotionSet const& motion, BodyId body, double scale) {
  MotionSet out = motion;
  for (MotionInput& input : out.inputs)
    for (Gain& gain : input.gains)
      if (gain.body == body) gain.value *= scale;
  return out;
}

}  // namespace straytrace::noise
