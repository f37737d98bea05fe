// SPDX-License-Identifier: BSD-3-Clause
#include <bit>
#include <cstddef>
#include <cstring>

#include "world/model/world.hpp"

namespace straytrace::world {
namespace {

// Appends plain numbers as bytes and texts with their length in front.
class Bytes {
 public:
  void add(double x) { append(&x, sizeof x); }
  void add(std::uint64_t x) { append(&x, sizeof x); }
  void add(Vec3 v) {
    add(v.x);
    add(v.y);
    add(v.z);
  }
  void add(std::string const& s) {
    add(std::uint64_t(s.size()));
    text += s;
  }
  template <class T>
  void add_doubles(T const& t) {  // a struct of nothing but doubles
    static_assert(sizeof(T) % sizeof(double) == 0 && std::is_trivially_copyable_v<T>);
    append(&t, sizeof t);
  }
  std::string text;

 private:
  void append(void const* data, std::size_t size) { text.append(static_cast<char const*>(data), size); }
};

void add(Bytes& out, Footprint const& f) {
  out.add(std::uint64_t(f.surface.value));
  out.add(f.centre);
  out.add(f.travel);
  out.add(std::uint64_t(f.profile));
  for (double x : {f.radius, f.curvature, f.share}) out.add(x);
  for (std::uint64_t x : {std::uint64_t(f.port.value), std::uint64_t(f.beam), std::uint64_t(f.standing),
                          std::uint64_t(f.emits), std::uint64_t(f.receives), std::uint64_t(f.free)})
    out.add(x);
  if (f.profile == Profile::astigmatic) out.add_doubles(f.astigmatism);
  if (f.index != 1) out.add(f.index);
  if (f.hollow != 1) out.add(f.hollow);
  if (!f.returns) out.add(std::uint64_t(f.returns));
  if (f.free) out.add(std::uint64_t(f.origin.value));
  out.add_doubles(f.polarisation);
}

void add(Bytes& out, Receiver const& r) {
  for (std::uint64_t x :
       {std::uint64_t(r.surface.value), std::uint64_t(r.front), std::uint64_t(r.back), std::uint64_t(r.clear),
        std::uint64_t(r.columns), std::uint64_t(r.rows), std::uint64_t(r.angle_bins), std::uint64_t(r.quadrants)})
    out.add(x);
  if (r.by_light) out.add(std::uint64_t(r.chart));
  for (double x : {r.half_width, r.half_height, r.half_angle_sine, r.gap}) out.add(x);
  out.add_doubles(r.frame);
  out.add_doubles(r.quadrant_frame);
}

template <class Plain>
void add(Bytes& out, Plain const& shape_or_law) {
  out.add_doubles(shape_or_law);
}
void add(Bytes& out, Roughness const& law) {
  struct Plain {
    char bytes[offsetof(Roughness, stack)];
  };
  static_assert(sizeof(Roughness) == sizeof(Plain) + sizeof law.stack);
  Plain plain;
  std::memcpy(&plain, static_cast<void const*>(&law), sizeof plain);
  out.add_doubles(plain);
  StackFactor const& stack = law.stack;
  if (stack.table.size == 0) return;
  for (double x : {double(stack.nodes), double(stack.interfaces), stack.common}) out.add(x);
  for (std::int64_t const node : {stack.nodes / 4, stack.nodes / 2, stack.nodes - 1})  // they depend on every layer
    for (std::int64_t j = 0; j < stack.interfaces; ++j)
      out.add_doubles(stack.table[std::size_t(node * stack.interfaces + j)]);
}
void add(Bytes& out, Dust const& dust) {
  for (double x : {dust.optical_depth, dust.reflectance, dust.smallest}) out.add(x);
  for (std::size_t i = 0; i < dust.scatter.panel.size; ++i) out.add(std::uint64_t(dust.scatter.panel[i].cells));
  for (std::size_t i = 0; i < dust.scatter.term.size; ++i) out.add(dust.scatter.term[i]);
  out.add_doubles(dust.lobe);
}
void add(Bytes& out, TriangleMesh const& mesh) {
  out.add_doubles(mesh.pose);
  out.add(mesh.unit);
  for (std::uint64_t x : mesh.content.digest) out.add(x);
}
void add(Bytes& out, CadFace const& face) {
  out.add(std::uint64_t(face.carrier));
  out.add_doubles(face.pose);
  out.add(face.radius);
  out.add(face.second);
  out.add(face.sense);
  for (std::uint64_t x : face.outline.digest) out.add(x);
}

void add(Bytes& out, Optic const& o, WorldView const& v) {
  out.add(o.reflect);
  out.add(o.transmit);
  out.add(o.depolarise);
  if (o.lay != Lay::free) {
    out.add(std::uint64_t(o.lay));
    out.add(o.lay_direction);
  }
  if (o.has_interface) {
    out.add(std::uint64_t(o.interface.kind));
    v.interfaces.visit(o.interface, [&](auto const& i) { i.numbers([&](double x) { out.add(x); }); });
  }
  for (int i = 0; i < o.laws; ++i) {
    out.add(std::uint64_t(o.law[i].kind));
    v.laws.visit(o.law[i], [&](auto const& law) { add(out, law); });
    out.add(std::uint64_t(o.through[i]));
    if (o.weight[i].size) out.add_doubles(o.weight[i][0]);
  }
  if (o.crossover > 0) out.add(o.crossover);
}

}  // namespace

std::string World::fingerprint() const {
  static_assert(std::endian::native == std::endian::little);
  Bytes out;
  WorldView const v = view();
  out.add(std::string("straytrace world 1"));
  for (Surface const& s : surfaces_) {
    out.add(std::uint64_t(s.shape.kind));
    v.shapes.visit(s.shape, [&](auto const& shape) { add(out, shape); });
    for (std::uint32_t x : {s.front, s.back, s.body.value, s.group.value, s.volume}) out.add(std::uint64_t(x));
  }
  for (Optic const& o : optics_) add(out, o, v);
  for (Volume const& volume : volumes_) {
    out.add(media_[volume.medium].index);
    out.add(media_[volume.medium].absorption);
  }
  for (Footprint const& f : lit_) add(out, f);
  for (Receiver const& r : receivers_) add(out, r);
  for (Body const& b : bodies_) {
    out.add(b.name);
    out.add(b.pivot);
    for (ElasticMode const& mode : b.modes) out.add(mode.description);
  }
  for (auto const* names : {&groups_, &ports_, &receiver_names_})
    for (std::string const& name : *names) out.add(name);
  out.add(std::uint64_t(limits.max_order));
  out.add(limits.roulette_below);
  out.add(std::uint64_t(limits.route_vertices));
  for (double x : {double(limits.targets), limits.law_share, double(limits.window)}) out.add(x);
  if (limits.children > 1) out.add(std::uint64_t(limits.children));
  out.add(std::uint64_t(reverse_routes));
  out.add(std::uint64_t(polarised));
  out.add(wavelength);
  return std::move(out.text);
}

}  // namespace straytrace::world
