// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/window.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <span>

#include "base/errors.hpp"
#include "base/input/table.hpp"
#include "base/math/constants.hpp"

namespace straytrace::spectra {
namespace {

struct Known {
  std::string_view name;
  Window window;
};
constexpr std::array known{Known{"hann", Window::hann},         Known{"hamming", Window::hamming},
                           Known{"blackman", Window::blackman}, Known{"blackmanharris", Window::blackman_harris},
                           Known{"flattop", Window::flat_top},  Known{"tukey", Window::tukey},
                           Known{"kaiser", Window::kaiser},     Known{"rectangular", Window::rectangular}};

// sum of (-1)^j a_j cos(2 pi j turn)
double cosines(std::span<double const> a, double turn) {
  double sum = 0;
  for (std::size_t j = 0; j < a.size(); ++j) sum += (j % 2 == 0 ? 1 : -1) * a[j] * std::cos(2 * pi * double(j) * turn);
  return sum;
}

constexpr std::array hann{0.5, 0.5}, hamming{0.54, 0.46};
constexpr std::array blackman{0.42, 0.5, 0.08};
constexpr std::array blackman_harris{0.35875, 0.48829, 0.14128, 0.01168};  // Harris 1978, -92 dB
constexpr std::array flat_top{0.21557895, 0.41663158, 0.277263158, 0.083578947, 0.006947368};

double tukey(double share, double turn) {
  double const edge = std::min(turn, 1 - turn);
  return share > 0 && edge < share / 2 ? 0.5 - 0.5 * std::cos(2 * pi * edge / share) : 1;
}

double weight(Window window, double parameter, double turn) {  // turn: place in the segment, 0 to 1
  switch (window) {
    case Window::rectangular:
      return 1;
    case Window::hann:
      return cosines(hann, turn);
    case Window::hamming:
      return cosines(hamming, turn);
    case Window::blackman:
      return cosines(blackman, turn);
    case Window::blackman_harris:
      return cosines(blackman_harris, turn);
    case Window::flat_top:
      return cosines(flat_top, turn);
    case Window::tukey:
      return tukey(parameter, turn);
    case Window::kaiser:
      return std::cyl_bessel_i(0, parameter * std::sqrt(4 * turn * (1 - turn))) / std::cyl_bessel_i(0, parameter);
  }
  return not_a_number;
}

[[noreturn]] void refuse(std::string const& text, std::string const& suggestion) {
  throw InputError(fmt::format("'{}' is not a window", text), suggestion);
}

double parameter_of(Window window, std::string const& text, std::string const& inside) {
  double value = 0;
  auto const [end, code] = std::from_chars(inside.data(), inside.data() + inside.size(), value);
  bool const number = code == std::errc() && end == inside.data() + inside.size();
  if (window == Window::tukey && !(number && value >= 0 && value <= 1))
    refuse(text, "the tapered share is from 0 to 1: tukey(0.25)");
  if (window == Window::kaiser && !(number && value >= 0 && value <= 100))
    refuse(text, "beta is from 0 to 100: kaiser(14)");
  return value;
}

}  // namespace

std::vector<double> window_weights(Window window, double parameter, std::size_t samples) {
  std::vector<double> w(samples);
  for (std::size_t i = 0; i < samples; ++i) w[i] = weight(window, parameter, double(i) / double(samples));
  return w;
}

NamedWindow parse_window(std::string const& text) {
  auto const bracket = text.find('(');
  std::string const name = text.substr(0, bracket);
  std::vector<std::string> names;
  for (Known const& k : known) {
    names.emplace_back(k.name);
    if (name != k.name) continue;
    bool const takes = k.window == Window::tukey || k.window == Window::kaiser;
    if (bracket == text.npos && k.window == Window::kaiser) refuse(text, "it needs its beta: kaiser(14)");
    if (bracket == text.npos) return {k.window, k.window == Window::tukey ? 0.5 : 0};
    if (!takes || text.back() != ')') refuse(text, fmt::format("write {}", takes ? name + "(0.25)" : name));
    return {k.window, parameter_of(k.window, text, text.substr(bracket + 1, text.size() - bracket - 2))};
  }
  std::string const near = nearest_word(name, names);
  refuse(text,
         near.empty() ? fmt::format("there are {}", fmt::join(names, ", ")) : fmt::format("did you mean '{}'?", near));
}

std::string window_text(NamedWindow w) {
  for (Known const& k : known)
    if (k.window == w.window) {
      bool const takes = k.window == Window::tukey || k.window == Window::kaiser;
      return takes ? fmt::format("{}({:g})", k.name, w.parameter) : std::string(k.name);
    }
  return "";
}

}  // namespace straytrace::spectra
