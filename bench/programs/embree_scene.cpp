// SPDX-License-Identifier: BSD-3-Clause
#include "embree_scene.hpp"

#include <atomic>
#include <cmath>

namespace straytrace::bench {
namespace {

std::atomic<std::ptrdiff_t> bytes_taken = 0;
bool count(void*, ssize_t bytes, bool) {
  bytes_taken += bytes;
  return true;
}

constexpr float near_distance = 1e-4f;  // m: floats hit the surface they start on without it

// Double hit of a user primitive, in addition to Embree's float ray.
struct DoubleContext {
  RTCIntersectContext base;
  WorldView const* world;
  BenchRay const* ray;
  Hit best;
};

void bounds_of(RTCBoundsFunctionArguments const* args) {
  auto const& world = *static_cast<WorldView const*>(args->geometryUserPtr);
  Box const b = world.shapes.visit(world.surfaces[args->primID].shape, [](auto const& s) { return s.bounds(); });
  auto const down = [](double x) { return std::nextafter(float(x), -INFINITY); };
  auto const up = [](double x) { return std::nextafter(float(x), INFINITY); };
  RTCBounds& out = *args->bounds_o;
  out.lower_x = down(b.lower.x);
  out.lower_y = down(b.lower.y);
  out.lower_z = down(b.lower.z);
  out.upper_x = up(b.upper.x);
  out.upper_y = up(b.upper.y);
  out.upper_z = up(b.upper.z);
}

__attribute__((flatten)) void intersect(RTCIntersectFunctionNArguments const* args) {
  if (!args->valid[0]) return;
  auto& context = *reinterpret_cast<DoubleContext*>(args->context);
  Ray bounded = context.ray->ray;
  bounded.t_max = context.best.distance;
  Crossing const c = context.world->cross(args->primID, bounded, context.ray->from);
  if (!(c.distance < context.best.distance)) return;
  context.best = {{args->primID}, c.distance, c.piece};
  RTCRayHit& out = *reinterpret_cast<RTCRayHit*>(args->rayhit);
  out.ray.tfar = std::nextafter(float(c.distance), INFINITY);
  out.hit.geomID = args->geomID;
  out.hit.primID = args->primID;
}

RTCScene new_scene(RTCDevice device, RTCGeometry geometry, RTCSceneFlags flags,
                   RTCBuildQuality quality = RTC_BUILD_QUALITY_HIGH) {
  RTCScene const scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, flags);
  rtcSetSceneBuildQuality(scene, quality);
  rtcSetGeometryBuildQuality(geometry, quality);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

RTCRay float_ray(BenchRay const& r) {
  RTCRay out{};
  out.org_x = float(r.ray.origin.x);
  out.org_y = float(r.ray.origin.y);
  out.org_z = float(r.ray.origin.z);
  out.dir_x = float(r.ray.dir.x);
  out.dir_y = float(r.ray.dir.y);
  out.dir_z = float(r.ray.dir.z);
  out.tnear = near_distance;
  out.tfar = INFINITY;
  out.mask = ~0u;
  return out;
}

template <class Packet, int n, class Trace>
std::size_t packets(std::span<BenchRay const> rays, Trace trace) {
  alignas(64) int valid[n];
  for (int& v : valid) v = -1;
  std::size_t hits = 0;
  for (std::size_t first = 0; first + n <= rays.size(); first += n) {
    alignas(64) Packet p;
    for (int i = 0; i < n; ++i) {
      RTCRay const r = float_ray(rays[first + std::size_t(i)]);
      p.ray.org_x[i] = r.org_x;
      p.ray.org_y[i] = r.org_y;
      p.ray.org_z[i] = r.org_z;
      p.ray.dir_x[i] = r.dir_x;
      p.ray.dir_y[i] = r.dir_y;
      p.ray.dir_z[i] = r.dir_z;
      p.ray.tnear[i] = r.tnear;
      p.ray.tfar[i] = r.tfar;
      p.ray.time[i] = 0;
      p.ray.mask[i] = ~0u;
      p.ray.flags[i] = 0;
      p.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      p.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    trace(valid, p);
    for (int i = 0; i < n; ++i) hits += p.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
  }
  return hits;
}

RTCIntersectContext plain_context() {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  return context;
}

}  // namespace

RTCDevice counting_device() {
  RTCDevice const device = rtcNewDevice("threads=1");
  rtcSetDeviceMemoryMonitorFunction(device, count, nullptr);
  return device;
}

EmbreeScene::EmbreeScene(RTCDevice device, std::vector<Triangle> const& triangles, Mode mode) {
  std::ptrdiff_t const before = bytes_taken;
  RTCGeometry const g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* const corners = static_cast<float*>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                    3 * sizeof(float), 3 * triangles.size()));
  auto* const numbers = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), triangles.size()));
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (std::size_t k = 0; k < 9; ++k) corners[9 * i + k] = triangles[i].corner[k / 3][k % 3];
  for (std::size_t i = 0; i < 3 * triangles.size(); ++i) numbers[i] = unsigned(i);
  scene_ = new_scene(device, g, mode == Mode::fast ? RTC_SCENE_FLAG_NONE : RTC_SCENE_FLAG_ROBUST,
                     mode == Mode::robust_default ? RTC_BUILD_QUALITY_MEDIUM : RTC_BUILD_QUALITY_HIGH);
  bytes_ = std::size_t(bytes_taken - before);
}

EmbreeScene::EmbreeScene(RTCDevice device, World const& world) : world_(world.view()) {
  std::ptrdiff_t const before = bytes_taken;
  RTCGeometry const g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(g, unsigned(world_.surfaces.size));
  rtcSetGeometryUserData(g, &world_);
  rtcSetGeometryBoundsFunction(g, bounds_of, nullptr);
  rtcSetGeometryIntersectFunction(g, intersect);
  scene_ = new_scene(device, g, RTC_SCENE_FLAG_ROBUST);
  bytes_ = std::size_t(bytes_taken - before);
}

std::size_t EmbreeScene::single(std::span<BenchRay const> rays) const {
  RTCIntersectContext context = plain_context();
  std::size_t hits = 0;
  for (BenchRay const& r : rays) {
    RTCRayHit h;
    h.ray = float_ray(r);
    h.hit.geomID = h.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context, &h);
    hits += h.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  }
  return hits;
}

std::size_t EmbreeScene::packets_of_8(std::span<BenchRay const> rays) const {
  RTCIntersectContext context = plain_context();
  return packets<RTCRayHit8, 8>(rays, [&](int const* v, RTCRayHit8& p) { rtcIntersect8(v, scene_, &context, &p); });
}

std::size_t EmbreeScene::packets_of_16(std::span<BenchRay const> rays) const {
  RTCIntersectContext context = plain_context();
  return packets<RTCRayHit16, 16>(rays, [&](int const* v, RTCRayHit16& p) { rtcIntersect16(v, scene_, &context, &p); });
}

std::size_t EmbreeScene::double_callbacks(std::span<BenchRay const> rays) const {
  DoubleContext context{};
  rtcInitIntersectContext(&context.base);
  context.world = &world_;
  std::size_t hits = 0;
  for (BenchRay const& r : rays) {
    context.ray = &r;
    context.best = {{}, infinity};
    RTCRayHit h;
    h.ray = float_ray(r);
    h.ray.tnear = 0;
    h.hit.geomID = h.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context.base, &h);
    hits += context.best.surface.valid();
  }
  return hits;
}

}  // namespace straytrace::bench
