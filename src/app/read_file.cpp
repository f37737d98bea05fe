// SPDX-License-Identifier: BSD-3-Clause
#include "app/read_file.hpp"

#include "app/model.hpp"
#include "base/file_bytes.hpp"

namespace straytrace {

bool is_run_file(std::string const& file) {
  constexpr std::string_view seal = "straytrace-run ", hdf5 = "\x89HDF\r\n\x1a\n";
  std::string const head = head_of_file(file, seal.size());
  return head == seal || head.starts_with(hdf5);
}

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
