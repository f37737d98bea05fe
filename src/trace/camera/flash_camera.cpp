// SPDX-License-Identifier: BSD-3-Clause
#include "trace/camera/flash_camera.hpp"

#include <cmath>

#include "base/process/threads.hpp"
#include "trace/step/scatter.hpp"

namespace straytrace::trace {
namespace {

constexpr std::uint32_t flash_rays = 3;  // rays per pixel along each side

// Whether the sphere around the eye is what a ray meets, when the next surface is `free` metres away.
bool comes_back(Ray const& ray, Vec3 eye, double radius, double free) {
  double const along = dot(eye - ray.origin, ray.dir);
  return along > 0 && along < free + radius && length(ray.origin + along * ray.dir - eye) < radius;
}

struct FlashWay {
  PathState path;       // power: share that passes one way
  double distance = 0;  // m from the eye to the start of the ray
  int mirrors = 0;
};

// The next directions of the path; straight ahead through surfaces that are not drawn.
void follow(WorldView const& world, FlashWay const& way, Vertex const& at, Flash const& flash,
            std::vector<FlashWay>& waiting) {
  for (bool const through : {false, true}) {
    double const power = way.path.power * (through ? at.transmit : at.reflect);
    if (!(power > flash.faintest)) continue;
    FlashWay next = way;
    ++next.mirrors;
    next.path.power = power;
    next.path.from = {at.surface, at.piece, at.contact};
    next.path.ray.origin = at.point;
    next.path.media = at.before;
    leave_specular(world, next.path, at, through);
    waiting.push_back(next);
  }
}

}  // namespace

FlashLight flash_along(WorldView const& world, Ray ray, Departure from, Vec3 eye, Flash const& flash,
                       std::vector<Look> const& looks) {
  FlashLight seen;
  FlashWay start;
  start.path.ray = ray;
  start.path.from = from;
  start.path.power = 1;
  std::vector<FlashWay> waiting{start};
  while (!waiting.empty()) {
    FlashWay way = waiting.back();
    waiting.pop_back();
    Hit const hit = world.closest(way.path.ray, way.path.from);
    double const free = hit.surface.valid() ? hit.distance : infinity;
    if (way.mirrors > 0 && comes_back(way.path.ray, eye, flash.radius, free)) {
      seen.glint += way.path.power / (pi * flash.radius * flash.radius);
      continue;
    }
    if (!hit.surface.valid()) continue;
    Vertex at = vertex_at(world, way.path, hit);
    way.distance += hit.distance;
    if (!looks.empty() && looks[2 * at.surface.value + (at.front ? 0 : 1)] == Look::open) {
      way.path.from = {at.surface, at.piece};
      way.path.ray.origin = at.point;
      waiting.push_back(way);
      continue;
    }
    if (!seen.first.valid()) seen.first = at.surface;
    lost_in_medium(world, way.path, hit.distance);
    evaluate_scattering(world, way.path, way.path.ray.dir, at);
    if (at.albedo > 0)
      seen.scattered += way.path.power * way.path.power *
                        scatter_eval(world.laws, *at.optic, at.wi, at.wi, at.n_in, at.n_out) * at.wi.z /
                        (way.distance * way.distance);
    if (way.mirrors < flash.most_mirrors) follow(world, way, at, flash, waiting);
  }
  return seen;
}

std::vector<FlashLight> flash_picture(WorldView const& world, Camera const& camera, Flash const& flash,
                                      LookSettings const& settings) {
  std::vector<FlashLight> picture(std::size_t{camera.rows} * camera.columns);
  in_parallel(camera.rows, settings.threads, [&](std::size_t row) {
    for (std::uint32_t column = 0; column < camera.columns; ++column) {
      FlashLight& pixel = picture[row * camera.columns + column];
      for (std::uint32_t k = 0; k < flash_rays * flash_rays; ++k) {
        Ray const ray =
            camera.ray(column + (k % flash_rays + 0.5) / flash_rays, double(row) + (k / flash_rays + 0.5) / flash_rays);
        if (!(ray.t_max > 0)) continue;
        FlashLight const one = flash_along(world, ray, camera.from, camera.eye, flash, settings.looks);
        pixel.scattered += one.scattered / (flash_rays * flash_rays);
        pixel.glint += one.glint / (flash_rays * flash_rays);
        if (k == flash_rays * flash_rays / 2) pixel.first = one.first;
      }
    }
  });
  return picture;
}

double solid_angle(Camera const& c, std::uint32_t column, std::uint32_t row) {
  double const x = (2 * (column + 0.5) / c.columns - 1) * c.half_width,
               y = (1 - 2 * (row + 0.5) / c.rows) * c.half_height,
               area = 4 * c.half_width * c.half_height / (double(c.columns) * c.rows), r = std::sqrt(x * x + y * y);
  if (c.lens == Camera::Lens::perspective) return area / std::pow(1 + r * r, 1.5);
  return r > 0 && c.lens == Camera::Lens::fisheye ? area * std::sin(std::min(r, pi)) / r : area;
}

}  // namespace straytrace::trace
