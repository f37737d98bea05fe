// SPDX-License-Identifier: BSD-3-Clause
#include "wave/line_transform.hpp"

#include <algorithm>
#include <vector>

#ifdef STRAYTRACE_DUCC0

#include "base/math/constants.hpp"
#include "base/math/functions.hpp"

// DUCC0 finds these before those of the C library, whose bits depend on the processor.
namespace ducc0::detail_unity_roots {
inline double cos(double angle) { return straytrace::sincos_turn(angle / (2 * straytrace::pi)).cos; }
inline double sin(double angle) { return straytrace::sincos_turn(angle / (2 * straytrace::pi)).sin; }
}  // namespace ducc0::detail_unity_roots

#include <ducc0/fft/fft1d_impl.h>

namespace straytrace::wave {

// A pack holds the same element of as many lines as the processor treats at once.
struct LineTransform::Engine {
  using Pack = ducc0::native_simd<double>;
  using Element = ducc0::Cmplx<Pack>;
  static constexpr std::size_t lanes = Pack::size();
  static_assert(lanes > 1 && at_once % lanes == 0, "DUCC0 has no vectors for this processor: build without it");
  static constexpr std::size_t gap = 8;  // elements between lines, so that they do not fall into one set of the cache

  std::size_t points, stride;
  ducc0::pocketfft_c<double> plan;
  std::vector<Element> elements, scratch;

  explicit Engine(int count)
      : points(std::size_t(count)),
        stride(points + gap),
        plan(points),
        elements(at_once / lanes * stride),
        scratch(plan.bufsize()) {}

  // `lines` of a whole number of packs.
  void gather(std::span<Complex* const> lines, std::ptrdiff_t step, ElementRange given) {
    std::size_t const packs = lines.size() / lanes;
    Element const zero(Pack(0.0), Pack(0.0));
    for (std::size_t p = 0; p < packs; ++p) {
      Element* const to = elements.data() + p * stride;
      std::fill(to, to + given.first, zero);
      std::fill(to + given.last, to + points, zero);
    }
    for (std::ptrdiff_t i = given.first; i < given.last; ++i)
      for (std::size_t p = 0; p < packs; ++p) {
        auto* const to = reinterpret_cast<double*>(elements.data() + p * stride + i);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
          Complex const value = lines[p * lanes + lane][i * step];
          to[lane] = value.real();
          to[lanes + lane] = value.imag();
        }
      }
  }

  void scatter(std::span<Complex* const> lines, std::ptrdiff_t step, ElementRange wanted, Element const* from) const {
    std::size_t const packs = lines.size() / lanes;
    for (std::ptrdiff_t i = wanted.first; i < wanted.last; ++i)
      for (std::size_t p = 0; p < packs; ++p) {
        auto const* const values = reinterpret_cast<double const*>(from + p * stride + i);
        for (std::size_t lane = 0; lane < lanes; ++lane)
          lines[p * lanes + lane][i * step] = Complex(values[lane], values[lanes + lane]);
      }
  }

  void run(std::span<Complex* const> lines, std::ptrdiff_t step, ElementRange given, ElementRange wanted, bool forward,
           double factor) {
    // The last pack is filled up with its last line.
    Complex* filled[at_once];
    std::size_t const count = (lines.size() + lanes - 1) / lanes * lanes;
    for (std::size_t j = 0; j < count; ++j) filled[j] = lines[std::min(j, lines.size() - 1)];
    // Elements of neighbouring columns lie in one line of the cache and are moved together.
    std::size_t const together = step == 1 ? lanes : count;
    for (std::size_t first = 0; first < count; first += together) {
      std::span<Complex* const> const some(filled + first, together);
      gather(some, step, given);
      Element* from = elements.data();
      if (together == lanes) {
        from = plan.exec(from, scratch.data(), factor, forward);
      } else {
        for (std::size_t p = 0; p * lanes < count; ++p)
          plan.exec_copyback(from + p * stride, scratch.data(), factor, forward);
      }
      scatter(some, step, wanted, from);
    }
  }
};

char const* LineTransform::library() { return "DUCC0"; }

}  // namespace straytrace::wave

#else

#include "spectra/fourier.hpp"

namespace straytrace::wave {

struct LineTransform::Engine {
  spectra::Fourier fourier;
  spectra::Complexes before, after;

  explicit Engine(int points) : before(std::size_t(points)), after(std::size_t(points)) {}

  void run(std::span<Complex* const> lines, std::ptrdiff_t step, ElementRange given, ElementRange wanted, bool forward,
           double factor) {
    if (!forward) factor *= double(before.size());  // of `inverse`, which divides by it
    for (Complex* const line : lines) {
      std::fill(before.begin(), before.end(), Complex());
      for (int i = given.first; i < given.last; ++i) before[std::size_t(i)] = line[i * step];
      if (forward)
        fourier.forward(before, after);
      else
        fourier.inverse(before, after);
      for (int i = wanted.first; i < wanted.last; ++i) line[i * step] = factor * after[std::size_t(i)];
    }
  }
};

char const* LineTransform::library() { return "Eigen"; }

}  // namespace straytrace::wave

#endif

namespace straytrace::wave {

LineTransform::LineTransform(int points) : engine_(std::make_unique<Engine>(points)) {}
LineTransform::~LineTransform() = default;

void LineTransform::forward(std::span<Complex* const> lines, std::ptrdiff_t step, ElementRange given,
                            ElementRange wanted, double factor) {
  engine_->run(lines, step, given, wanted, true, factor);
}

void LineTransform::inverse(std::span<Complex* const> lines, std::ptrdiff_t step, ElementRange given,
                            ElementRange wanted, double factor) {
  engine_->run(lines, step, given, wanted, false, factor);
}

}  // namespace straytrace::wave
