// SPDX-License-Identifier: BSD-3-Clause
// Share of the lamp's light on the receiver `trap_wall` (bench/peers/real.py), by an analogue backward tracer that
// shares no code with the program: a path starts on the receiver by the cosine law, survives each surface with its
// albedo, and counts when it meets the front of the lamp. Reciprocity makes that the share times area of lamp / area of
// receiver. Usage: trap SEED PATHS; prints the share and its error.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

namespace {

using Vec = std::array<double, 3>;

struct Tube {
  double radius, from, to, albedo, specular;
};
struct Flat {  // a ring about z
  double z, inner, outer, albedo;
};
constexpr std::array<Tube, 3> tubes = {{{0.5, 0, 3, 0.395, 0}, {0.75, 3, 7, 0.957, 0.71}, {0.5, 7, 10, 0.395, 0}}};
constexpr std::array<Flat, 4> flats = {
    {{3, 0.5, 0.75, 0.0094}, {7, 0.5, 0.75, 0.0094}, {5, 0, 0.3, 0}, {0.01, 0, 0.175, 0}}};
constexpr int rings = 10, lamp = 13, receiver = 20, nothing = -1;
constexpr double pi = 3.14159265358979323846, side = 0.1, wall = 0.73, middle = 5.6, lamp_radius = 0.175;

std::mt19937_64 bits;
double uniform() { return double(bits() >> 11) * 0x1p-53; }
double dot(Vec const& a, Vec const& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vec cosine_law(Vec const& n) {
  double const u = uniform(), phi = 2 * pi * uniform(), r = std::sqrt(u), c = std::sqrt(1 - u);
  Vec const a = std::abs(n[2]) < 0.9 ? Vec{0, 0, 1} : Vec{1, 0, 0};
  Vec x = {a[1] * n[2] - a[2] * n[1], a[2] * n[0] - a[0] * n[2], a[0] * n[1] - a[1] * n[0]};
  double const length = std::sqrt(dot(x, x));
  for (double& v : x) v /= length;
  Vec const y = {n[1] * x[2] - n[2] * x[1], n[2] * x[0] - n[0] * x[2], n[0] * x[1] - n[1] * x[0]};
  Vec d;
  for (std::size_t i = 0; i < 3; ++i) d[i] = r * std::cos(phi) * x[i] + r * std::sin(phi) * y[i] + c * n[i];
  return d;
}

// The nearest surface but `last`, a tube from its own wall included.
int meets(Vec const& p, Vec const& d, int last, double& nearest) {
  int found = nothing;
  nearest = HUGE_VAL;
  auto const offer = [&](double t, int surface) {
    if (t > 1e-12 && t < nearest) nearest = t, found = surface;
  };
  double const a = d[0] * d[0] + d[1] * d[1], b = p[0] * d[0] + p[1] * d[1], square = p[0] * p[0] + p[1] * p[1];
  for (std::size_t i = 0; i < tubes.size(); ++i) {
    Tube const& tube = tubes[i];
    bool const own = int(i) == last;
    double const inside = own ? b * b : b * b - a * (square - tube.radius * tube.radius);
    if (inside < 0) continue;
    for (double const t : {own ? 0 : (-b - std::sqrt(inside)) / a, own ? -2 * b / a : (-b + std::sqrt(inside)) / a})
      if (double const z = p[2] + t * d[2]; z >= tube.from && z <= tube.to) offer(t, int(i));
  }
  for (std::size_t i = 0; i < flats.size(); ++i) {
    double const t = (flats[i].z - p[2]) / d[2], r = std::hypot(p[0] + t * d[0], p[1] + t * d[1]);
    if (int(i) + rings != last && r >= flats[i].inner && r <= flats[i].outer) offer(t, int(i) + rings);
  }
  double const t = (wall - p[0]) / d[0];
  if (last != receiver && std::abs(p[1] + t * d[1]) < side / 2 && std::abs(p[2] + t * d[2] - middle) < side / 2)
    offer(t, receiver);
  return found;
}

bool reaches_the_lamp() {
  Vec p = {wall, side * (uniform() - 0.5), middle + side * (uniform() - 0.5)}, d = cosine_law({-1, 0, 0});
  for (int last = receiver;;) {
    double t = 0;
    int const hit = meets(p, d, last, t);
    if (hit == lamp) return d[2] < 0;
    if (hit == nothing || hit == receiver) return false;
    bool const flat = hit >= rings;
    double const u = uniform(), albedo = flat ? flats[std::size_t(hit - rings)].albedo : tubes[std::size_t(hit)].albedo;
    if (u >= albedo) return false;
    for (std::size_t i = 0; i < 3; ++i) p[i] += t * d[i];
    double const r = std::hypot(p[0], p[1]);
    Vec const n = flat ? Vec{0, 0, d[2] > 0 ? -1.0 : 1.0} : Vec{-p[0] / r, -p[1] / r, 0};
    if (!flat && u < tubes[std::size_t(hit)].specular) {
      double const across = dot(d, n);
      for (std::size_t i = 0; i < 3; ++i) d[i] -= 2 * across * n[i];
    } else {
      d = cosine_law(n);
    }
    last = hit;
  }
}

}  // namespace

int main(int count, char** words) {
  if (count != 3) return 2;
  bits.seed(std::strtoull(words[1], nullptr, 10));
  double const paths = std::strtod(words[2], nullptr), scale = side * side / (pi * lamp_radius * lamp_radius);
  double hits = 0;
  for (double i = 0; i < paths; ++i) hits += reaches_the_lamp();
  std::printf("%.6e %.2e\n", hits / paths * scale, std::sqrt(hits) / paths * scale);
}
