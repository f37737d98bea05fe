// SPDX-License-Identifier: BSD-3-Clause
// Scripts of others that pages carry, as CMake found them in packages.
#pragma once

#include <span>
#include <string_view>

namespace straytrace {

struct PageScript {
  std::string_view name, licence, text;
};
PageScript const& d3_script();                // https://d3js.org, BSD-3-Clause
std::span<PageScript const> three_scripts();  // https://threejs.org, MIT: the library, then its orbit controls

}  // namespace straytrace
