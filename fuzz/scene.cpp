// SPDX-License-Identifier: BSD-3-Clause
// YAML of a model up to its tree: includes, parts, repeats, parameters. The disk is never touched.
#include "scene/scene.hpp"

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  using namespace straytrace;
  FileTexts const texts{{"model.yaml", std::string(fuzz::text_of(data, size))}};
  try {
    Scene const scene = read_scene("model.yaml", {}, &texts);
    (void)scene.warnings();
    scene.throw_if_problems();
    (void)scene.resolved();
  } catch (InputError const&) {
  }
  return 0;
}
