// SPDX-License-Identifier: BSD-3-Clause
#include "app/read_file.hpp"

#include "app/model.hpp"

namespace straytrace {

bool only_motion(Scene const& scene) {
  return scene.table("bodies") && !scene.root().has("scene") && !scene.root().has("beams");
}

Scene read_by_all(std::string const& file, std::vector<std::string> const& overrides, FileTexts const* texts) {
  if (Scene scene = read_scene(file, overrides, texts); only_motion(scene)) {
    read_motion_file(scene);
    return scene;
  }
  return std::move(read_model(file, overrides, texts).scene);
}

}  // namespace straytrace
