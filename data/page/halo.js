// SPDX-License-Identifier: BSD-3-Clause
// Light of a cavity at small angles on the surfaces that it meets: a layer of coloured patches, with its scale.
"use strict";

const haloColours = ["#450054", "#3b528c", "#21918c", "#5ec962", "#fde824"];  // those of straytrace render

class Halo {
  constructor(stage, group) {
    this.stage = stage;
    this.data = stage.scene.halo;
    this.unit = this.data.in_watts ? "W" : "of the power of the mode";
    this.stops = haloColours.map(c => new THREE.Color(c));
    this.material = new THREE.MeshBasicMaterial({vertexColors: THREE.VertexColors, polygonOffset: true, polygonOffsetFactor: -2,
                                                 polygonOffsetUnits: -4});
    for (const surface of this.data.surfaces) group.add(this.mesh(surface));
    stage.lightOn = name => this.textOf(name);
  }
  share(irradiance) {
    const {low, high} = this.data;
    return high > low ? Math.max(0, Math.min(1, Math.log(irradiance / low) / Math.log(high / low))) : 1;
  }
  colour(irradiance) {
    const at = 4 * this.share(irradiance), i = Math.min(3, Math.floor(at));
    return this.stops[i].clone().lerp(this.stops[i + 1], at - i);
  }
  // Seen from the side that the light comes from, and lifted towards it, so that the flat triangles of the part do not hide it.
  mesh(surface) {
    const patches = typedArray(Float32Array, surface.patches), points = [], colours = [], corners = [], chords = 4;
    const [x, y, z] = this.data.axes, turn = 2 * Math.PI / this.data.sectors;
    const vector = (r, t, along) => [0, 1, 2].map(i => r * (Math.cos(t) * x[i] + Math.sin(t) * y[i]) + along * z[i]);
    for (let p = 0; p < patches.length; p += 6) {
      const [sector, inner, outer, from, to, irradiance] = patches.slice(p, p + 6), c = this.colour(irradiance);
      if (!(irradiance > 0)) continue;
      const lift = 0.005 * outer * (surface.forward ? -1 : 1);
      for (let k = 0; k <= chords; ++k) {
        const t = (sector + k / chords) * turn, n = points.length / 3;
        points.push(...vector(inner, t, from + lift), ...vector(outer, t, to + lift));
        colours.push(c.r, c.g, c.b, c.r, c.g, c.b);
        if (k < chords) corners.push(...(surface.forward ? [n, n + 3, n + 1, n, n + 2, n + 3] : [n, n + 1, n + 3, n, n + 3, n + 2]));
      }
    }
    const g = new THREE.BufferGeometry();
    g.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
    g.setAttribute("color", new THREE.BufferAttribute(new Float32Array(colours), 3));
    g.setIndex(corners);
    const mesh = new THREE.Mesh(g, this.material);
    mesh.position.copy(this.stage.at(this.data.origin.map((o, i) => o + surface.place * z[i])));
    return mesh;
  }
  // On all surfaces of a name, for each way of the light; empty: none.
  textOf(name) {
    const by = new Map();
    for (const s of this.data.surfaces) if (s.name === name) by.set(s.towards, (by.get(s.towards) || 0) + s.power);
    return [...by].map(([towards, power]) => ", " + digits(power) + " " + this.unit + " of light towards " + towards).join("");
  }
  scale() {
    const {low, high, in_watts} = this.data, ticks = [], first = Math.ceil(Math.log10(low) - 1e-9), last = Math.floor(Math.log10(high) + 1e-9);
    for (let power = first; power <= last; ++power)
      ticks.push(el("span", {style: "left:" + 100 * this.share(Math.pow(10, power)) + "%"}, digits(Math.pow(10, power), 1)));
    return el("div", {class: "halo-scale"}, el("span", {}, "irradiance [" + (in_watts ? "W/m²" : "1/m²") + "]"),
              el("div", {class: "ramp"}, el("i", {style: "background: linear-gradient(to right, " + haloColours.join(", ") + ")"}), ...ticks));
  }
  note() {
    const sum = this.data.surfaces.reduce((all, s) => all + s.power, 0);
    return el("p", {class: "note"}, "Light at small angles: the field of cavity " + this.data.beam + " below the crossover angle of " +
        digits(1e6 * this.data.crossover) + " µrad, as irradiance of the surfaces that it meets, seen from the side that it comes from. In all " +
        digits(sum) + " " + this.unit + "; click a part for its share. Light beyond that angle is not in it.");
  }
}
