// SPDX-License-Identifier: BSD-3-Clause
// Arrays that BSDF models, coatings and meshes point into, and pools: values of a closed list of types in one flat
// array per type, instead of virtual functions.
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/memory/ids.hpp"

namespace straytrace {

// An element of a pool: kind = position in the list of types, index in its array.
struct PoolRef {
  std::uint32_t kind = 0, index = 0;
};

// Position of a type in a list of types.
template <class T, class List, std::uint32_t I = 0>
constexpr std::uint32_t kind_of() {
  if constexpr (std::is_same_v<T, std::tuple_element_t<I, List>>)
    return I;
  else
    return kind_of<T, List, I + 1>();
}

template <class List>
struct Pool;
template <class... T>
struct Pool<std::tuple<T...>> {
  std::tuple<View<T const>...> arrays;

  template <std::size_t I = 0, class F>
  STRAY_HD auto visit(PoolRef r, F&& f) const {
    if constexpr (I + 1 < sizeof...(T))
      if (r.kind != I) return visit<I + 1>(r, std::forward<F>(f));
    return f(std::get<I>(arrays)[r.index]);
  }
};

// Memory in aligned pages of 2 MiB where the system has them: for large arrays with random access.
std::shared_ptr<void> large_block(std::size_t bytes);

// Owns arrays: a View stays valid as long as any copy of the storage lives.
class Storage {
 public:
  template <class T>
  View<T const> keep(std::vector<T> values) {
    auto const kept = std::make_shared<std::vector<T> const>(std::move(values));
    arrays_.push_back(kept);
    return {kept->data(), kept->size()};
  }

  // In a large block from 2 MiB on.
  template <class T>
  View<T const> keep_large(std::vector<T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::size_t const bytes = values.size() * sizeof(T);
    if (bytes < (std::size_t{1} << 21)) return keep(std::move(values));
    auto const block = large_block(bytes);
    std::memcpy(block.get(), values.data(), bytes);
    arrays_.push_back(block);
    return {static_cast<T const*>(block.get()), values.size()};
  }

 private:
  std::vector<std::shared_ptr<void const>> arrays_;
};

}  // namespace straytrace
