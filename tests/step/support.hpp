// SPDX-License-Identifier: BSD-3-Clause
// Sample STEP files, and scenes that hold one.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <unistd.h>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "scene/scene.hpp"
#include "step/samples/samples.hpp"
#include "world/import/cad_file.hpp"
#include "world/model/world.hpp"

namespace straytrace::test {

namespace fs = std::filesystem;

// A folder that is gone at the end of the test program, the cache of conversions in it.
inline fs::path const& folder() {
  struct Folder {
    fs::path path = fs::temp_directory_path() / ("straytrace_step_" + std::to_string(::getpid()));
    Folder() {
      fs::create_directories(path);
      ::setenv("XDG_CACHE_HOME", (path / "cache").c_str(), 1);
      ::setenv("STRAYTRACE_STEP", STRAY_PROGRAM "-step", 1);
    }
    ~Folder() { fs::remove_all(path); }
  };
  static Folder const one;
  return one.path;
}

inline std::string contents(fs::path const& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

template <class Add>
std::string sample(Add const& add, std::string const& unit = "MM", std::string const& schema = "AP214IS") {
  step::StepBuilder builder;
  add(builder);
  std::string const file = (folder() / "sample.step").string();
  EXPECT_TRUE(builder.write(file, unit, schema));
  return contents(file);
}

inline CadFile converted(std::string const& step) {
  folder();
  StepConversion const made = convert_step("sample.step", step);
  EXPECT_EQ(made.fault.what, "");
  CadFile file;
  EXPECT_EQ(read_cad_file(made.text, file).what, "");
  return file;
}

struct Built {
  World world;
  std::string errors, warnings;
  FileTexts files;
};
// `entry`: keys of the scene entry 'bench' except its name and body.
inline Built built(FileTexts files, std::string const& entry) {
  folder();
  files["arm.yaml"] =
      "straytrace: 1\nmaterials:\n  black: {scatter: {model: lambertian, tis: 1 %}}\n"
      "  grey: {scatter: {model: lambertian, tis: 20 %}}\nbodies: {bench: {motion: still}}\n"
      "beams: {spot: {on: lit, radius: 1 cm}}\nports: {lit: {beam: spot, at: lit}}\nscene:\n"
      "  - {name: lit, shape: {disk: {outer_radius: 2 cm}}, at: [0 m, 0 m, 90 m], body: bench, material: grey}\n"
      "  - {name: bench, body: bench, " +
      entry + "}\n";
  Built out;
  Scene const scene = read_scene("arm.yaml", {}, &files);
  out.world = build_world(scene);
  out.warnings = scene.warnings();
  out.files = scene.files();
  try {
    scene.throw_if_problems();
  } catch (InputError const& e) {
    out.errors = e.what();
  }
  return out;
}

}  // namespace straytrace::test
