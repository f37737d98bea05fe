// SPDX-License-Identifier: BSD-3-Clause
#include "noise/interpolate/strength_sample.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <queue>

#include "base/math/constants.hpp"
#include "base/math/rng.hpp"

namespace straytrace::noise {
namespace {

constexpr double of_rate = 4;  // weight of the fringe rate among the coordinates

// Per class and unit of kappa, below the highest frequency that wraps the fringes of any path [Hz^2].
std::vector<double> square_rates(PhaseSpectra const& spectra, Strengths const& paths) {
  std::vector<double> most(paths.classes), rate;
  for (std::size_t i = 0; i < paths.size(); ++i)
    for (std::size_t c = 0; c < most.size(); ++c) most[c] = std::max(most[c], std::fabs(paths.of(i)[c]));
  double const highest = spectra.split_hz(most);
  for (MotionClass const& c : spectra.classes())
    rate.push_back(c.drift                ? 1 / (4 * pi * pi)
                   : c.tone_frequency > 0 ? c.tone_frequency * c.tone_frequency / 2
                                          : c.reference.rate_power(highest));
  return rate;
}

// kappa below which a class does not count.
double least_strength(PhaseSpectra const& spectra, std::size_t c) {
  return spectra.classes()[c].drift ? std::pow(pi * spectra.resolution(), 2) : PhaseSpectra::weak / spectra.variance(c);
}

}  // namespace

StrengthSample::StrengthSample(PhaseSpectra const& spectra, Strengths const& paths, std::size_t most)
    : axes_(paths.classes + 1), order_(paths.size()), of_(paths.size()) {
  place(spectra, paths);
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  for (Part const& p : parts(paths, most)) draw(paths, p);
}

void StrengthSample::place(PhaseSpectra const& spectra, Strengths const& paths) {
  std::vector<double> const rate = square_rates(spectra, paths);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    double square = 0, lowest = 0;
    for (std::size_t c = 0; c < paths.classes; ++c) {
      double const kappa = paths.of(i)[c], floor = least_strength(spectra, c);
      at_.push_back(std::log(std::max(std::fabs(kappa), floor)));
      square += rate[c] * kappa;
      lowest += rate[c] * floor;
    }
    at_.push_back(of_rate * std::log(std::max(square, lowest)));
    double const s = spectra.mean_square_phase(paths.of(i));
    noise_.push_back(paths.weight_of(i) * s / (1 + s));
  }
}

StrengthSample::Part StrengthSample::part(std::size_t begin, std::size_t end) const {
  Part out{begin, end};
  bool wide = false;
  double widest = 1e-9, noise = 0;  // less is rounding
  for (std::size_t k = begin; k < end; ++k) noise += noise_[order_[k]];
  for (std::size_t a = 0; a < axes_; ++a) {
    double low = infinity, high = -infinity;
    for (std::size_t k = begin; k < end; ++k) {
      double const x = at_[order_[k] * axes_ + a];
      low = std::min(low, x);
      high = std::max(high, x);
    }
    if (!(high - low > widest)) continue;
    wide = true;
    widest = high - low;
    out.axis = a;
    out.middle = low + widest / 2;
  }
  if (wide) out.urgency = widest * std::sqrt(noise);
  return out;
}

std::vector<StrengthSample::Part> StrengthSample::parts(Strengths const& paths, std::size_t most) {
  std::priority_queue<Part> waiting;
  std::vector<std::size_t> first = paths.first.empty() ? std::vector<std::size_t>{0} : paths.first;
  first.push_back(paths.size());
  std::size_t spectra = 0;
  auto const add = [&](Part const& p) {
    waiting.push(p);
    spectra += std::min<std::size_t>(2, p.end - p.begin);
  };
  for (std::size_t r = 0; r + 1 < first.size(); ++r)
    if (first[r + 1] > first[r]) add(part(first[r], first[r + 1]));
  std::vector<Part> done;
  while (!waiting.empty() && waiting.top().urgency > 0 && spectra < most) {
    Part const p = waiting.top();
    waiting.pop();
    spectra -= std::min<std::size_t>(2, p.end - p.begin);
    auto const from = order_.begin();
    auto const middle =
        std::partition(from + static_cast<std::ptrdiff_t>(p.begin), from + static_cast<std::ptrdiff_t>(p.end),
                       [&](std::size_t i) { return at_[i * axes_ + p.axis] <= p.middle; });
    auto const between = static_cast<std::size_t>(middle - from);
    add(part(p.begin, between));
    add(part(between, p.end));
  }
  for (; !waiting.empty(); waiting.pop()) {
    Part const p = waiting.top();
    bool const two = p.end - p.begin == 2;  // both, instead of two draws
    done.push_back({p.begin, two ? p.begin + 1 : p.end});
    if (two) done.push_back({p.begin + 1, p.end});
  }
  return done;
}

void StrengthSample::draw(Strengths const& paths, Part const& p) {
  double weight = 0;
  for (std::size_t k = p.begin; k < p.end; ++k) weight += paths.weight_of(order_[k]);
  auto const number = static_cast<std::uint32_t>(strata_.size());
  Rng rng(1, number, 0, Stream::static_phase);
  auto const drawn = [&] {
    double left = rng.uniform() * weight;
    std::size_t k = p.begin;
    while (k + 1 < p.end && (left -= paths.weight_of(order_[k])) >= 0) ++k;
    return order_[k];
  };
  std::size_t const one = drawn(), two = drawn();
  strata_.push_back({one, two, p.end - p.begin == 1});
  for (std::size_t k = p.begin; k < p.end; ++k) of_[order_[k]] = number;
}

namespace {

constexpr double near_rounding = 1e-12;  // fringes there are near the rounding of a transform

struct Chosen {
  std::vector<std::size_t> route;         // of each path
  std::map<std::size_t, bool> at_random;  // by path
};

std::vector<std::size_t> routes_of(Strengths const& paths) {
  std::vector<std::size_t> route(paths.size());
  std::size_t next = 0;
  for (std::size_t i = 0; i < route.size(); ++i) {
    while (next + 1 < paths.first.size() && paths.first[next + 1] <= i) ++next;
    route[i] = next;
  }
  return route;
}

// Half of `count` at equal steps of the summed noise, the others the strongest of their routes.
Chosen choose(PhaseSpectra const& spectra, Strengths const& paths, std::size_t count) {
  Chosen chosen{routes_of(paths), {}};
  std::vector<double> noise;
  double sum = 0, strongest = -1;
  std::size_t most_moved = 0;
  std::map<std::size_t, std::pair<double, std::size_t>> best;  // by route: noise and path
  std::map<std::size_t, double> of_route;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    double const s = spectra.mean_square_phase(paths.of(i));
    noise.push_back(paths.weight_of(i) * s / (1 + s));
    if (s > strongest) most_moved = i;
    strongest = std::max(s, strongest);
    std::size_t const r = chosen.route[i];
    of_route[r] += noise[i];
    if (noise[i] > best[r].first) best[r] = {noise[i], i};
  }
  for (double n : noise) sum += n;
  if (!(sum > 0)) return chosen;
  std::vector<std::pair<double, std::size_t>> ranked;
  for (auto const& [r, total] : of_route) ranked.emplace_back(-total, r);
  std::ranges::sort(ranked);
  chosen.at_random[most_moved] = false;
  for (std::size_t k = 0; k < ranked.size() && k + 1 < count / 2; ++k)
    if (ranked[k].first < 0) chosen.at_random[best[ranked[k].second].second] = false;
  double const step = sum / static_cast<double>(count - count / 2);
  double at = step / 2;
  for (std::size_t i = 0; i < noise.size(); ++i)
    if ((at -= noise[i]) < 0) {
      chosen.at_random[i] = true;
      while (at < 0) at += step;
    }
  return chosen;
}

}  // namespace

SpotChecks::SpotChecks(PhaseSpectra const& spectra, Strengths const& paths, std::size_t count) {
  if (count == 0 || paths.size() == 0) return;
  Chosen const chosen = choose(spectra, paths, count);
  for (auto const& [path, at_random] : chosen.at_random)
    own_.push_back({path, chosen.route[path], at_random, spectra(paths.of(path))});
}

// Over the paths at equal steps, which represent all; a route without one has its strongest.
std::vector<double> SpotChecks::mean(std::size_t route) const {
  auto const has = [&](Own const& o, bool only_random) { return o.route == route && (o.at_random || !only_random); };
  bool const random = std::ranges::any_of(own_, [&](Own const& o) { return has(o, true); });
  std::vector<double> sum(own_.front().spectrum.psd.size());
  double paths = 0;
  for (Own const& o : own_) {
    if (!has(o, random)) continue;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += o.spectrum.psd[i];
    ++paths;
  }
  for (double& s : sum) s /= paths;
  return sum;
}

std::vector<SpotCheck> SpotChecks::compared(std::function<std::vector<double>(std::size_t)> const& shared) const {
  std::vector<SpotCheck> out;
  for (Own const& o : own_) {
    SpotCheck& found = out.emplace_back();
    found.path = o.path;
    std::vector<double> const psd = shared(o.path), mean_psd = mean(o.route);
    std::vector<double> const &own = o.spectrum.psd, &linear = o.spectrum.linear;
    double const floor = near_rounding * *std::ranges::max_element(own);
    for (std::size_t i = 0; i < own.size(); ++i) {
      double const size = std::max(own[i], mean_psd[i]);
      if (!(size > 0) || (size < floor && !(linear[i] > 0.5 * own[i]))) continue;
      double const error = std::fabs(psd[i] - own[i]) / size;
      if (!(error <= found.error)) found = {o.path, error, i};
    }
  }
  return out;
}

void MixtureLattice::Axis::place(int points) {
  if (!(high > low + 1e-9)) points = 1;
  for (int k = 0; k < points; ++k) {
    double const cosine = points == 1 ? 0 : std::cos(pi * k / (points - 1));
    at.push_back((low + high) / 2 - (high - low) / 2 * cosine);
    scale.push_back((k % 2 ? -1 : 1) * (k == 0 || k == points - 1 ? 0.5 : 1));
  }
}

void MixtureLattice::Axis::weights(double q, std::vector<double>& out) const {
  out.assign(at.size(), 0);
  double sum = 0;
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (at.size() == 1 || q == at[k]) {
      out.assign(at.size(), 0);
      out[k] = 1;
      return;
    }
    sum += out[k] = scale[k] / (q - at[k]);
  }
  for (double& w : out) w /= sum;
}

double MixtureLattice::square_rate(std::span<double const> kappa) const {
  double sum = 0;
  for (std::size_t c = 0; c < rate_.size(); ++c) sum += rate_[c] * kappa[c];
  return sum;
}

// Of each axis; 0 where no strength remains.
void MixtureLattice::coordinates(std::span<double const> kappa, std::vector<double>& q) const {
  q.clear();
  double left = rate_[main_] * kappa[main_];
  for (std::size_t i = axes_.size(); i-- > 0;) {
    double const own = rate_[axes_[i].of] * kappa[axes_[i].of];
    left += own;
    q.push_back(left > 0 ? own / left : 0);
  }
  std::ranges::reverse(q);
}

MixtureLattice::MixtureLattice(std::vector<double> rate, std::span<double const> kappa, double least, double step,
                               std::size_t most)
    : rate_(std::move(rate)), least_(least), step_(step) {
  std::size_t const classes = rate_.size();
  std::vector<double> share(classes);
  double low = infinity, high = -infinity;
  for (std::size_t i = 0; i + classes <= kappa.size(); i += classes) {
    double const t = square_rate(kappa.subspan(i, classes));
    if (t < least_) continue;
    for (std::size_t c = 0; c < classes; ++c) share[c] += rate_[c] * kappa[i + c] / t;
    low = std::min(low, t);
    high = std::max(high, t);
  }
  main_ = static_cast<std::size_t>(std::ranges::max_element(share) - share.begin());
  for (std::size_t c = 0; c < classes; ++c)
    if (c != main_ && rate_[c] > 0) axes_.emplace_back().of = c;
  if (!(low <= high)) return;
  lowest_ = static_cast<int>(std::lround(std::log(low) / step_)) - reach;
  std::vector<bool> used(static_cast<std::size_t>(std::lround(std::log(high) / step_)) + 1 + reach - lowest_);
  std::vector<double> q;
  for (std::size_t i = 0; i + classes <= kappa.size(); i += classes) {
    auto const one = kappa.subspan(i, classes);
    double const t = square_rate(one);
    if (t < least_) continue;
    auto const level = std::lround(std::log(t) / step_) - lowest_;
    std::fill(used.begin() + level - reach, used.begin() + level + reach + 1, true);
    coordinates(one, q);
    for (std::size_t a = 0; a < axes_.size(); ++a) {
      axes_[a].low = std::min(axes_[a].low, q[a]);
      axes_[a].high = std::max(axes_[a].high, q[a]);
    }
  }
  place_points(most / static_cast<std::size_t>(std::ranges::count(used, true)));
  for (std::size_t level = 0; level < used.size(); ++level) {
    of_level_.push_back(static_cast<std::uint32_t>(kappa_.size()));
    if (used[level]) add_nodes(lowest_ + static_cast<int>(level));
  }
}

// Fewer on the narrowest axes when there would be more than `most` together.
void MixtureLattice::place_points(std::size_t most) {
  std::vector<Axis*> by_width;
  for (Axis& axis : axes_) by_width.push_back(&axis);
  std::ranges::sort(by_width, [](auto* a, auto* b) { return a->high - a->low < b->high - b->low; });
  std::vector<int> points;
  for (Axis const* axis : by_width)
    points.push_back(std::max(4, 3 + static_cast<int>(std::ceil((most_points - 3) * (axis->high - axis->low)))));
  auto const together = [&] {
    return std::accumulate(points.begin(), points.end(), 1.0, [](double n, int p) { return n * p; });
  };
  for (int fewer = most_points - 1; fewer >= 2; --fewer)
    for (std::size_t a = 0; a < points.size() && together() > static_cast<double>(most); ++a)
      points[a] = std::min(points[a], fewer);
  for (std::size_t a = 0; a < points.size(); ++a) {
    by_width[a]->place(points[a]);
    across_ *= by_width[a]->at.size();
  }
}

// The first axis varies fastest.
void MixtureLattice::add_nodes(int level) {
  for (std::size_t n = 0; n < across_; ++n) {
    std::vector<double>& node = kappa_.emplace_back(rate_.size());
    double left = std::exp(level * step_);
    std::size_t rest = n;
    for (Axis const& axis : axes_) {
      double const own = left * axis.at[rest % axis.at.size()];
      rest /= axis.at.size();
      node[axis.of] = own / rate_[axis.of];
      left -= own;
    }
    node[main_] = std::max(0.0, left) / rate_[main_];
  }
}

void MixtureLattice::shares(std::span<double const> kappa, std::vector<Share>& out) const {
  thread_local std::vector<double> q, one, product;
  double const u = std::log(square_rate(kappa)) / step_;
  auto const level = std::lround(u);
  auto const along = lagrange(u - static_cast<double>(level), reach);
  coordinates(kappa, q);
  product.assign(1, 1);
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    axes_[a].weights(q[a], one);
    std::size_t const inner = product.size();
    product.resize(inner * one.size());
    for (std::size_t k = one.size(); k-- > 0;)
      for (std::size_t i = 0; i < inner; ++i) product[k * inner + i] = product[i] * one[k];
  }
  out.clear();
  for (int k = -reach; k <= reach; ++k) {
    std::uint32_t const first = of_level_[static_cast<std::size_t>(level + k - lowest_)];
    for (std::size_t i = 0; i < across_; ++i)
      out.push_back({first + static_cast<std::uint32_t>(i), along[static_cast<std::size_t>(k + reach)] * product[i]});
  }
}

}  // namespace straytrace::noise
