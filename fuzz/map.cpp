// SPDX-License-Identifier: BSD-3-Clause
// Height maps of mirrors in HDF5 and texts, up to the parts that a cavity does not keep.
#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "fuzz.hpp"
#include "wave/heights/height_map.hpp"

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  using namespace straytrace;
  try {
    HeightMap map = height_map_of(std::string(fuzz::text_of(data, size)), "map");
    refuse_large_holes(map);
    remove(map, fit_low_orders(map, 0.06), {});
  } catch (InputError const&) {
  }
  return 0;
}
