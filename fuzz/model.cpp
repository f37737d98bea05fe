// SPDX-License-Identifier: BSD-3-Clause
// The same text as read by all rooms: geometry, materials, beams, motion, interferometer, noise.
#include "session/model.hpp"

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  using namespace straytrace;
  FileTexts const texts{{"model.yaml", std::string(fuzz::text_of(data, size))}};
  try {
    (void)read_model("model.yaml", {}, &texts);
  } catch (InputError const&) {
  }
  return 0;
}
