// SPDX-License-Identifier: BSD-3-Clause
#include "scene/merge.hpp"

namespace straytrace {

// Described in docs/reference/parts.md. Every part stands with its first face at the origin, that face looking along
// +z, the rest behind it. Normals point out of glass and metal; where a shape has them the other way round, `side` says
// which side is seen. sag_1, sag_2: height of the vertex over the rim, positive for a convex face.
char const* const builtin_parts = R"yaml(straytrace: 1
parts:
  mirror:
    params: {radius: 17.5 cm, radius_of_curvature: 0 m}
    limits:
      radius: {at_most: "1/max(abs(curvature(radius_of_curvature)), 1e-9 /m)",
               because: a face cannot be wider than the sphere it is cut from}
    faces:
      front: {shape: {cap: {curvature: curvature(radius_of_curvature), outer_radius: radius}}}

  lens:
    params:
      diameter: 25.4 mm
      thickness: 5 mm
      radius_1: 0 m
      radius_2: 0 m
      sag_1: "diameter^2/4*curvature(radius_1)/(1 + sqrt(max(0, 1 - (diameter/2*curvature(radius_1))^2)))"
      sag_2: "diameter^2/4*curvature(radius_2)/(1 + sqrt(max(0, 1 - (diameter/2*curvature(radius_2))^2)))"
    limits:
      diameter: {at_most: "2/max(abs(curvature(radius_1)), abs(curvature(radius_2)), 1e-9 /m)",
                 because: a face cannot be wider than the sphere it is cut from}
      thickness: {above: "max(0 m, sag_1 + sag_2)",
                  because: faces of these radii and this diameter would meet before the edge}
    faces:
      front: {shape: {cap: {curvature: -curvature(radius_1), outer_radius: diameter/2}}}
      barrel: {shape: {cylinder: {radius: diameter/2, from: sag_2 - thickness, to: -sag_1}}}
      back: {shape: {cap: {curvature: -curvature(radius_2), outer_radius: diameter/2}}, at: [0 m, 0 m, -thickness],
             facing: [0, 0, -1]}

  thick_mirror:
    params:
      radius: 17.5 cm
      radius_of_curvature: 0 m
      thickness: 20 cm
      wedge: 0 deg
      sag: "radius^2*curvature(radius_of_curvature)/(1 + sqrt(max(0, 1 - (radius*curvature(radius_of_curvature))^2)))"
    limits:
      radius: {at_most: "1/max(abs(curvature(radius_of_curvature)), 1e-9 /m)",
               because: a face cannot be wider than the sphere it is cut from}
      thickness: {above: "max(0 m, -sag)", because: the faces would meet before the edge}
      wedge: {at_most: "atan2(thickness + sag, radius)", at_least: "-atan2(thickness + sag, radius)",
              because: the tilted back would reach the front face}
    faces:
      front: {shape: {cap: {curvature: curvature(radius_of_curvature), outer_radius: radius}}}
      barrel: {shape: {cut_cylinder: {radius: radius, from: -sag, to: thickness, tilt: wedge}}, facing: [0, 0, -1]}
      back: {shape: {ellipse: {semi_x: radius/cos(wedge), semi_y: radius}}, at: [0 m, 0 m, -thickness],
             rotate: {axis: [0, 1, 0], angle: 180 deg + wedge}}

  flat_mirror:
    params: {radius: 12.7 mm, thickness: 6 mm}
    limits: {thickness: {above: 0 m}}
    faces:
      front: {shape: {disk: {outer_radius: radius}}}
      barrel: {shape: {cylinder: {radius: radius, from: -thickness, to: 0 m}}}
      back: {shape: {disk: {outer_radius: radius}}, at: [0 m, 0 m, -thickness], facing: [0, 0, -1]}

  plate:
    params: {radius: 12.7 mm, thickness: 5 mm, wedge: 0 deg}
    limits:
      thickness: {above: 0 m}
      wedge: {at_most: "atan2(thickness, radius)", at_least: "-atan2(thickness, radius)",
              because: the tilted back would reach the front face}
    faces:
      front: {shape: {disk: {outer_radius: radius}}}
      barrel: {shape: {cut_cylinder: {radius: radius, from: 0 m, to: thickness, tilt: wedge}}, facing: [0, 0, -1]}
      back: {shape: {ellipse: {semi_x: radius/cos(wedge), semi_y: radius}}, at: [0 m, 0 m, -thickness],
             rotate: {axis: [0, 1, 0], angle: 180 deg + wedge}}

  conical_baffle:
    params:
      inner_radius: 40 cm
      outer_radius: 50 cm
      half_angle: 35 deg
      thickness: 2 mm
      rise: "(outer_radius - inner_radius)/tan(max(half_angle, 1 urad))"
    limits:
      half_angle: {above: 0 deg, at_most: 89.9 deg, because: it is measured from the axis}
      outer_radius: {above: inner_radius, because: the hole is inside the rim}
      thickness: {above: 0 m}
    faces:
      inside: {shape: {cone: {inner_radius: inner_radius, outer_radius: outer_radius, half_angle: half_angle}},
               side: inner}
      outside: {shape: {cone: {inner_radius: inner_radius, outer_radius: outer_radius, half_angle: half_angle}},
                at: [0 m, 0 m, -thickness], side: outer}
      rim: {shape: {cylinder: {radius: inner_radius, from: -thickness, to: 0 m}}, side: inner}
      edge: {shape: {cylinder: {radius: outer_radius, from: rise - thickness, to: rise}}, side: outer}

  serrated_baffle:
    params: {inner_radius: 40 cm, outer_radius: 50 cm, half_angle: 35 deg, tooth_depth: 1 cm, teeth: 360}
    faces:
      sheet: {shape: {serrated_cone: {inner_radius: inner_radius, outer_radius: outer_radius, half_angle: half_angle,
                                      tooth_depth: tooth_depth, teeth: teeth}}}

  chamber:
    params: {width: 1 m, height: 1 m, depth: 1 m, wall: 5 mm}
    limits: {wall: {above: 0 m, because: 'a single thin box is a shape: {box: ...}'}}
    faces:
      inside: {shape: {box: {width: width, height: height, depth: depth}}, side: inner}
      outside: {shape: {box: {width: width + 2*wall, height: height + 2*wall, depth: depth + 2*wall}}, side: outer}

  tube_section:
    params: {radius: 50 cm, length: 1 m, wall: 4 mm}
    limits: {length: {above: 0 m}, wall: {above: 0 m}}
    faces:
      inside: {shape: {cylinder: {radius: radius, from: -length, to: 0 m}}, side: inner}
      outside: {shape: {cylinder: {radius: radius + wall, from: -length, to: 0 m}}, side: outer}
      front: {shape: {disk: {inner_radius: radius, outer_radius: radius + wall}}, side: front}
      back: {shape: {disk: {inner_radius: radius, outer_radius: radius + wall}}, side: front, at: [0 m, 0 m, -length],
             facing: [0, 0, -1]}

  dump:
    params: {width: 5 cm, height: 5 cm, depth: 15 cm}
    faces:
      upper: {shape: {rectangle: {width: width, height: sqrt(depth^2 + height^2/4)}}, at: [0 m, height/4, -depth/2],
              rotate: {axis: [1, 0, 0], angle: "atan2(depth, height/2)"}}
      lower: {shape: {rectangle: {width: width, height: sqrt(depth^2 + height^2/4)}}, at: [0 m, -height/4, -depth/2],
              rotate: {axis: [1, 0, 0], angle: "-atan2(depth, height/2)"}}
      left: {shape: {rectangle: {width: depth, height: height}}, at: [-width/2, 0 m, -depth/2], facing: [1, 0, 0]}
      right: {shape: {rectangle: {width: depth, height: height}}, at: [width/2, 0 m, -depth/2], facing: [-1, 0, 0]}

  photodiode:
    params:
      window_radius: 5 mm
      window_thickness: 1 mm
      sensor_radius: 1.5 mm
      gap: 1 mm
      can_radius: 7 mm
      depth: window_thickness + gap
    limits:
      sensor_radius: {at_most: can_radius, because: the sensor stands on the base of the can}
      window_radius: {at_most: can_radius, because: the window sits in the lid of the can}
      window_thickness: {above: 0 m}
      gap: {above: 0 m, because: the sensor stands behind the window}
    faces:
      window: {use: plate, radius: window_radius, thickness: window_thickness}
      sensor: {shape: {disk: {outer_radius: sensor_radius}}, at: [0 m, 0 m, -depth], medium: none}
      base: {shape: {disk: {inner_radius: sensor_radius, outer_radius: can_radius}}, at: [0 m, 0 m, -depth],
             medium: none}
      can: {shape: {cylinder: {radius: can_radius, from: -depth, to: 0 m}}, medium: none}
      lid: {shape: {disk: {inner_radius: window_radius, outer_radius: can_radius}}, medium: none}

  mount:
    params: {size: 75 mm, thickness: 15 mm, aperture: 24 mm, base_height: 10 mm, base_depth: 40 mm}
    limits: {aperture: {at_most: size/2, because: the bore lies within the plate}}
    faces:
      front: {shape: {polygon: {sides: 4, radius: size/sqrt(2), rotation: 45 deg, hole_radius: aperture}}, side: front}
      back: {shape: {polygon: {sides: 4, radius: size/sqrt(2), rotation: 45 deg, hole_radius: aperture}}, side: front,
             at: [0 m, 0 m, -thickness], facing: [0, 0, -1]}
      bore: {shape: {cylinder: {radius: aperture, from: -thickness, to: 0 m}}, side: inner}
      top: {shape: {rectangle: {width: size, height: thickness}}, side: front, at: [0 m, size/2, -thickness/2],
            facing: [0, 1, 0]}
      left: {shape: {rectangle: {width: thickness, height: size}}, side: front, at: [-size/2, 0 m, -thickness/2],
             facing: [-1, 0, 0]}
      right: {shape: {rectangle: {width: thickness, height: size}}, side: front, at: [size/2, 0 m, -thickness/2],
              facing: [1, 0, 0]}
      base: {shape: {box: {width: size, height: base_height, depth: base_depth}}, side: outer,
             at: [0 m, -(size + base_height)/2, -thickness/2]}

  motor_mount:
    params:
      size: 75 mm
      thickness: 15 mm
      aperture: 24 mm
      base_height: 10 mm
      base_depth: 40 mm
      motor_width: 20 mm
      motor_length: 60 mm
      hand: 1
    words: {hand: {right: 1, left: -1}}
    limits:
      motor_width: {above: 0 m, at_most: size/2 - aperture/sqrt(2), because: the motors would reach into the bore}
      motor_length: {above: 0 m}
    faces:
      frame: {use: mount, size: size, thickness: thickness, aperture: aperture, base_height: base_height,
              base_depth: base_depth}
      upper_motor: {shape: {box: {width: motor_width, height: motor_width, depth: motor_length}}, side: outer,
                    at: [-hand*(size - motor_width)/2, (size - motor_width)/2, -thickness - motor_length/2]}
      lower_motor: {shape: {box: {width: motor_width, height: motor_width, depth: motor_length}}, side: outer,
                    at: [hand*(size - motor_width)/2, -(size - motor_width)/2, -thickness - motor_length/2]}
)yaml";

}  // namespace straytrace
