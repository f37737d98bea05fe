// SPDX-License-Identifier: BSD-3-Clause
#include "trace/backend/device/world_image.hpp"

#include <cstring>
#include <map>
#include <tuple>
#include <type_traits>
#include <utility>

namespace straytrace::trace {
namespace {

// The arrays of a type: calls f(view) for each of them. A type that is not listed has none; the test device_world
// detects omissions.
template <class T, class F>
void arrays_of(T const&, F const&) {}

template <class F>
void arrays_of(Film const& x, F const& f) {
  f(x.layers);
  f(x.passing);
  f(x.total);
}
template <class F>
void arrays_of(Coating const& x, F const& f) {
  f(x.table.knots);
}
template <class F>
void arrays_of(Dust const& x, F const& f) {
  f(x.scatter.panel);
  f(x.scatter.term);
}
template <class F>
void arrays_of(Roughness const& x, F const& f) {
  f(x.stack.table);
}
template <class F>
void arrays_of(Optic const& x, F const& f) {
  for (View<AngleWeight const> const& weight : x.weight) f(weight);
}
template <class F>
void arrays_of(CadFace const& x, F const& f) {
  f(x.outline.edges);
  f(x.outline.band_start);
}
template <class F>
void arrays_of(TriangleMesh const& x, F const& f) {
  MeshContent const& c = x.content;
  f(c.vertices);
  f(c.triangles);
  f(c.normals);
  f(c.packs);
  f(c.by_area);
  f(c.in_order);
  f(c.place);
  f(c.area_before);
  f(c.tree.nodes);
}
template <class F>
void arrays_of(Receiver const& x, F const& f) {
  f(x.nodes);
  f(x.cells);
}
template <class List, class F>
void arrays_of(Pool<List> const& pool, F const& f) {
  std::apply([&](auto const&... view) { (f(view), ...); }, pool.arrays);
}
template <class F>
void arrays_of(SearchView const& x, F const& f) {
  f(x.tubes.tubes);
  f(x.tubes.items);
  f(x.tubes.plain);
  f(x.tubes.behind);
  f(x.tubes.starts);
  f(x.clusters);
  f(x.nodes);
  f(x.packs);
}
template <class F>
void arrays_of(Steering const& x, F const& f) {
  f(x.strips);
  f(x.patches);
  f(x.members);
  f(x.sides);
  f(x.first_of_surface);
  f(x.targets);
  f(x.connections);
}
template <class F>
void arrays_of(Halo const& x, F const& f) {
  f(x.sources);
  f(x.sections);
  f(x.cells);
}
template <class F>
void arrays_of(WorldView const& x, F const& f) {
  arrays_of(x.shapes, f);
  arrays_of(x.laws, f);
  arrays_of(x.interfaces, f);
  f(x.volumes);
  f(x.media);
  f(x.surfaces);
  f(x.optics);
  f(x.lit);
  f(x.lit_of_surface);
  f(x.emitters);
  f(x.receivers);
  f(x.receiver_of_surface);
  arrays_of(x.tree, f);
  arrays_of(x.steering, f);
  arrays_of(x.halo, f);
}

}  // namespace

// Instances of one mesh share their arrays, which are stored once.
class WorldImage::Writer {
 public:
  explicit Writer(WorldImage& image) : image_(image) {}

  template <class T>
  std::size_t put(T const* from, std::size_t count) {
    static_assert(std::is_trivially_copy_constructible_v<T> && std::is_trivially_destructible_v<T>);
    static_assert(alignof(T) <= alignment);
    auto const [known, fresh] = placed_.try_emplace({from, count * sizeof(T)}, 0);
    if (!fresh) return known->second;
    std::vector<std::byte>& bytes = image_.bytes_;
    std::size_t const at = (bytes.size() + alignment - 1) / alignment * alignment;
    known->second = at;
    bytes.resize(at + count * sizeof(T));
    std::memcpy(bytes.data() + at, static_cast<void const*>(from), count * sizeof(T));
    for (std::size_t i = 0; i < count; ++i) follow(from[i], at + i * sizeof(T));
    return at;
  }

 private:
  template <class T>
  void follow(T const& original, std::size_t at) {
    arrays_of(original, [&]<class E>(View<E const> const& view) {
      std::size_t const inside =
          std::size_t(reinterpret_cast<char const*>(&view.data) - reinterpret_cast<char const*>(&original));
      if (view.size > 0) image_.pointers_.push_back({at + inside, put(view.data, view.size)});
    });
  }

  WorldImage& image_;
  std::map<std::pair<void const*, std::size_t>, std::size_t> placed_;
};

WorldImage::WorldImage(WorldView const& world) { Writer(*this).put(&world, 1); }

std::vector<std::byte> WorldImage::placed_at(void const* address) const {
  std::vector<std::byte> bytes = bytes_;
  for (Pointer const& p : pointers_) {
    void const* const target = static_cast<std::byte const*>(address) + p.to;
    std::memcpy(bytes.data() + p.at, &target, sizeof target);
  }
  return bytes;
}

}  // namespace straytrace::trace
