// SPDX-License-Identifier: BSD-3-Clause
#include "noise/strength_sample.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>

#include "base/constants.hpp"
#include "base/rng.hpp"

namespace straytrace {
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

}  // namespace straytrace
