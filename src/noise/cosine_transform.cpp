// SPDX-License-Identifier: BSD-3-Clause
#include "noise/cosine_transform.hpp"

#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>

#include "base/constants.hpp"

namespace straytrace {

struct CosineTransform::Plan {
  std::size_t m;
  Eigen::FFT<double> fft;
  std::vector<double> cosine, sine;         // of pi k/(2m), k <= m/2
  std::vector<double> shuffled;             // even points forwards, then odd points backwards
  std::vector<std::complex<double>> lines;  // of them, m/2 + 1
};

CosineTransform::CosineTransform(std::size_t m) : plan_(std::make_unique<Plan>()) {
  Plan& p = *plan_;
  p.m = m;
  p.fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  p.shuffled.resize(m);
  p.lines.resize(m / 2 + 1);
  for (std::size_t k = 0; k <= m / 2; ++k) {
    double const angle = pi * static_cast<double>(k) / static_cast<double>(2 * m);
    p.cosine.push_back(std::cos(angle));
    p.sine.push_back(std::sin(angle));
  }
}

CosineTransform::~CosineTransform() = default;

CosineTransform const& CosineTransform::of(std::size_t m) {
  thread_local std::map<std::size_t, CosineTransform> kept;
  return kept.try_emplace(m, m).first->second;
}

void CosineTransform::values(std::vector<double> const& a, std::vector<double>& x) const {
  Plan& p = *plan_;
  auto const at = [&](std::size_t k) { return k < a.size() ? a[k] : 0; };
  auto const half = 0.5 * static_cast<double>(p.m);
  p.lines[0] = 2 * half * at(0);
  for (std::size_t k = 1; k <= p.m / 2; ++k) {  // (c + i s) (a_k - i a_(m-k))
    double const c = p.cosine[k], s = p.sine[k], re = half * at(k), im = -half * at(p.m - k);
    p.lines[k] = {c * re - s * im, c * im + s * re};
  }
  p.fft.inv(p.shuffled, p.lines, static_cast<Eigen::Index>(p.m));
  x.resize(p.m);
  for (std::size_t i = 0; i < p.m / 2; ++i) {
    x[2 * i] = p.shuffled[i];
    x[2 * i + 1] = p.shuffled[p.m - 1 - i];
  }
}

void CosineTransform::amplitudes(std::vector<double> const& x, std::vector<double>& a) const {
  Plan& p = *plan_;
  for (std::size_t i = 0; i < p.m / 2; ++i) {
    p.shuffled[i] = x[2 * i];
    p.shuffled[p.m - 1 - i] = x[2 * i + 1];
  }
  p.fft.fwd(p.lines, p.shuffled);
  double const step = 2 / static_cast<double>(p.m);
  a.resize(p.m);
  a[0] = step / 2 * p.lines[0].real();
  for (std::size_t k = 1; k <= p.m / 2; ++k) {
    double const c = p.cosine[k], s = p.sine[k], re = p.lines[k].real(), im = p.lines[k].imag();
    a[k] = step * (c * re + s * im);
    a[p.m - k] = step * (s * re - c * im);
  }
}

}  // namespace straytrace
