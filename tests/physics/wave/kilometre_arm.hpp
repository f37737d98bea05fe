// SPDX-License-Identifier: BSD-3-Clause
// A cavity of 1 km with a beam of 20.6 mm on both mirrors and two baffles that cut it: small enough that its field is
// computed within a second.
#pragma once

#include <string>

#include "base/every_module.hpp"
#include "scene/scene.hpp"
#include "world/model/world.hpp"

namespace straytrace::testing {

struct KilometreArm {
  std::string baffles =
      "  - {name: baffle_two, shape: {disk: {inner_radius: 45 mm, outer_radius: 30 cm}}, at: [0 m, 0 m, 600 m],"
      " facing: [0, 0, -1], body: pipe, material: black}\n"
      "  - {name: baffle_one, shape: {disk: {inner_radius: 45 mm, outer_radius: 30 cm}}, at: [0 m, 0 m, 400 m],"
      " facing: [0, 0, 1], body: pipe, material: black}\n";
  std::string wave =
      "wave: {beam: arm, baffles: \"baffle*\", crossover: 120 urad, grid: {points: 256, window: 0.5 m}}\n";
  std::string ports = "ports: {I: {beam: arm, at: I}, E: {beam: arm, at: E}}\n";
  std::string pipe = "{pivot: [0 m, 0 m, 0 m], motion: {x: {peterson: typical}, others: still}}";
  std::string bodies = "optics: {motion: still}", input_body = "optics", end_body = "optics";
  std::string end = "at: [0 m, 0 m, 1000 m], facing: [0, 0, -1]", input = "facing: [0, 0, 1]";

  std::string text() const {
    return "straytrace: 1\nmaterials:\n"
           "  polished: {specular: {reflect: 0.9999}, scatter: {model: power-law, kappa: 5e-7 /sr, exponent: 2,"
           " above: 1 urad}}\n"
           "  black: {}\n"
           "bodies: {pipe: " +
           pipe + ", " + bodies +
           "}\nscene:\n"
           "  - {name: I, use: mirror, radius: 75 mm, radius_of_curvature: 2500 m, at: [0 m, 0 m, 0 m], " +
           input + ", body: " + input_body +
           ", material: polished}\n"
           "  - {name: E, use: mirror, radius: 75 mm, radius_of_curvature: 2500 m, " +
           end + ", body: " + end_body + ", material: polished}\n" + baffles +
           "beams: {arm: {cavity: [I, E], power: 10 kW}}\n" + ports + wave;
  }
  World world() const {
    FileTexts const texts{{"a.yaml", text()}};
    Scene const scene = read_scene("a.yaml", {}, &texts);
    World world = build_world(scene);
    scene.throw_if_problems();
    return world;
  }
};

// With other settings of the table `wave`.
inline KilometreArm kilometre_arm(std::string const& settings) {
  KilometreArm arm;
  arm.wave = "wave: {beam: arm, baffles: \"baffle*\", " + settings + "}\n";
  return arm;
}

}  // namespace straytrace::testing
