// SPDX-License-Identifier: BSD-3-Clause
// Kinds instead of virtual functions: values of a closed list of types in one flat array per type.
#pragma once

#include <cstdint>
#include <tuple>
#include <type_traits>
#include <utility>

#include "base/memory/ids.hpp"

namespace straytrace {

// Which element of which array: kind = position in the list of types.
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

}  // namespace straytrace
