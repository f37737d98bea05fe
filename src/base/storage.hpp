// SPDX-License-Identifier: BSD-3-Clause
// Arrays that laws, coatings and meshes point into: tables whose length is known only when the scene is read.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "base/ids.hpp"

namespace straytrace {

// Keeps arrays alive where they are: a View stays valid as long as any copy of the storage lives.
class Storage {
 public:
  template <class T>
  View<T const> keep(std::vector<T> values) {
    auto const kept = std::make_shared<std::vector<T> const>(std::move(values));
    arrays_.push_back(kept);
    return {kept->data(), kept->size()};
  }

 private:
  std::vector<std::shared_ptr<void const>> arrays_;
};

}  // namespace straytrace
