// SPDX-License-Identifier: BSD-3-Clause
// Arrays that laws, coatings and meshes point into: tables whose length is known only when the scene is read.
#pragma once

#include <cstring>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/memory/ids.hpp"

namespace straytrace {

// Memory in pages of 2 MiB where the system has them, aligned to them: for large arrays that are read all over.
std::shared_ptr<void> large_block(std::size_t bytes);

// Keeps arrays alive where they are: a View stays valid as long as any copy of the storage lives.
class Storage {
 public:
  template <class T>
  View<T const> keep(std::vector<T> values) {
    auto const kept = std::make_shared<std::vector<T> const>(std::move(values));
    arrays_.push_back(kept);
    return {kept->data(), kept->size()};
  }

  // In a large block once it is worth it.
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
