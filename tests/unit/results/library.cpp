// SPDX-License-Identifier: BSD-3-Clause
// The library describes a detector for scenes, data/detectors and ifo/interferometer.cpp describe it for budgets and
// networks. Common values must agree, except for the differences listed here.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/every_module.hpp"
#include "base/files/read_write.hpp"
#include "ifo/dual_recycled.hpp"
#include "results/pygwinc/pygwinc_ifo.hpp"
#include "scene/model_tree.hpp"

namespace straytrace::report_library {
namespace {

struct Difference {
  std::string_view preset, key, reason;
};
constexpr std::array<Difference, 1> differences = {{
    {"adv", "transmission_end", "library: design, 1 ppm, as the budget; preset: 4.4 ppm as built"},
}};

struct Value {
  std::string key;
  double number, tolerance;
};

std::vector<Value> of_preset(DualRecycledParameters const& p, Detector const& budget) {
  return {{"L", p.arm_length, 1e-9},
          {"lambda", p.wavelength, 1e-9},
          {"mirror_mass", p.mirror_mass, 1e-9},
          {"transmission_in", p.input_transmission, 1e-9},
          {"transmission_end", p.end_transmission, 1e-9},
          {"transmission_srm", p.signal_recycling_transmission, 1e-9},
          {"round_trip_loss", p.round_trip_loss, 1e-9},
          {"arm_power", DualRecycled(p).arm_power(), 0.04},
          {"mirror_radius", budget.mirror_radius, 1e-9}};
}

Scene scene_of(std::string const& name, std::vector<Value> const& keys) {
  std::string ask;
  for (Value const& v : keys) ask += (ask.empty() ? "" : ", ") + v.key + ": " + v.key;
  FileTexts texts{{"a.yaml", "straytrace: 1\ninclude: [library/detectors/" + name + ".yaml]\nreport: {" + ask + "}\n"}};
  for (EmbeddedFile const& file : embedded_files())
    if (is_library(file.name)) texts[std::string(file.name)] = file.text;
  return read_scene("a.yaml", {}, &texts);
}

TEST(LibraryDetectors, AgreeWithPresets) {
  for (DualRecycledPreset const& preset : dual_recycled_presets()) {
    std::vector<Value> const wanted = of_preset(preset.parameters, read_ifo(std::string(preset.name)).detector);
    Scene const scene = scene_of(std::string(preset.name), wanted);
    for (Value const& v : wanted) {
      double const got = scene.table("report")[v.key].as_quantity().si;
      bool const listed = std::any_of(differences.begin(), differences.end(),
                                      [&](Difference const& d) { return d.preset == preset.name && d.key == v.key; });
      bool const agrees = std::fabs(got - v.number) <= v.tolerance * std::fabs(v.number);
      EXPECT_EQ(agrees, !listed) << preset.name << " " << v.key << ": " << got << ", preset " << v.number;
    }
    EXPECT_NO_THROW(scene.throw_if_problems());
  }
}

}  // namespace
}  // namespace straytrace::report_library
