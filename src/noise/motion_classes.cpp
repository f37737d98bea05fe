// SPDX-License-Identifier: BSD-3-Clause
#include "noise/motion_classes.hpp"

#include <algorithm>
#include <cmath>

#include "signal/shapes.hpp"

namespace straytrace {
namespace {

using Transfer = MotionClass::Transfer;

std::complex<double> at(Transfer const& t, double hz) { return t ? (*t)(hz) : 1; }

std::vector<Transfer> distinct_transfers(MotionInput const& input) {
  std::vector<Transfer> found;
  for (Gain const& gain : input.gains)
    if (std::find(found.begin(), found.end(), gain.transfer) == found.end()) found.push_back(gain.transfer);
  return found;
}

Spectrum seen_through(Spectrum const& s, Transfer const& t) {
  return t ? filtered(
                 s, [&](double f) { return std::norm((*t)(f)); }, t->features())
           : s;
}

Spectrum of_difference(Spectrum const& s, Transfer const& a, Transfer const& b) {
  std::vector<double> features = a ? a->features() : std::vector<double>();
  std::vector<double> const more = b ? b->features() : std::vector<double>();
  features.insert(features.end(), more.begin(), more.end());
  return filtered(
      s, [&](double f) { return std::norm(at(a, f) - at(b, f)); }, features,
      [&](double f) { return std::norm(at(a, f)) + std::norm(at(b, f)); });
}

void add(std::vector<MotionClass>& classes, Spectrum spectrum, MotionClass::Member member) {
  if (!(spectrum.total() > 0)) return;
  auto const same = std::find_if(classes.begin(), classes.end(), [&](MotionClass const& c) {
    return c.tone_frequency == 0 && !c.drift && same_shape(c.reference, spectrum);
  });
  member.scale = same == classes.end() ? 1 : spectrum.total() / same->reference.total();
  if (same != classes.end())
    same->members.push_back(std::move(member));
  else
    classes.push_back({std::move(spectrum), 0, {std::move(member)}});
}

// A sum of terms; zero when only their rounding is left.
class Sum {
 public:
  void add(std::complex<double> x) {
    sum_ += x;
    size_ += std::fabs(x.real()) + std::fabs(x.imag());
  }
  std::complex<double> value() const { return std::norm(sum_) > 1e-28 * size_ * size_ ? sum_ : 0; }

 private:
  std::complex<double> sum_ = 0;
  double size_ = 0;
};

double kappa_of(MotionInput const& input, MotionClass::Member const& member, std::span<Lever const> levers) {
  Sum all, first, second;
  for (Lever const& lever : levers)
    for (Gain const& gain : input.gains) {
      if (gain.body != lever.body) continue;
      std::complex<double> const term = lever.d[gain.axis] * gain.value;
      all.add(term);
      if (gain.transfer == member.first) first.add(term);
      if (gain.transfer == member.second) second.add(term);
    }
  if (member.difference) return -(first.value() * std::conj(second.value())).real();
  return (first.value() * std::conj(all.value())).real();
}

}  // namespace

std::vector<MotionClass> group_by_shape(MotionSet const& motion) {
  std::vector<MotionClass> classes;
  for (std::size_t i = 0; i < motion.inputs.size(); ++i) {
    MotionInput const& input = motion.inputs[i];
    if (input.tone_frequency > 0 || input.drift) {
      classes.push_back({{}, input.tone_frequency, {{i, 1, {}, {}}}, input.drift});
      continue;
    }
    std::vector<Transfer> const transfers = distinct_transfers(input);
    for (std::size_t k = 0; k < transfers.size(); ++k) {
      add(classes, seen_through(input.spectrum, transfers[k]), {i, 1, transfers[k], transfers[k]});
      for (std::size_t l = 0; l < k; ++l)
        add(classes, of_difference(input.spectrum, transfers[k], transfers[l]),
            {i, 1, transfers[k], transfers[l], true});
    }
  }
  return classes;
}

std::vector<double> kappa_of(MotionSet const& motion, std::vector<MotionClass> const& classes,
                             std::span<Lever const> levers) {
  std::vector<double> kappa(classes.size());
  for (std::size_t c = 0; c < classes.size(); ++c)
    for (MotionClass::Member const& m : classes[c].members)
      kappa[c] += m.scale * kappa_of(motion.inputs[m.input], m, levers);
  return kappa;
}

}  // namespace straytrace
