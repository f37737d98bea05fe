// SPDX-License-Identifier: BSD-3-Clause
// The stage's camera, cut, stretch, axes and labels.
"use strict";

Object.assign(Stage.prototype, {
  restretch() {
    const s = [this.stretch, this.stretch, this.stretch];
    s[this.long] = 1;
    this.world.scale.set(...s.map(x => 2 / this.size[this.long] * x));
    const shown = this.stretch < 1.05 ? "to scale" : "not to scale: the sides are drawn " + digits(this.stretch, 2) +
        " times larger than along " + "xyz"[this.long];
    const thinned = this.scene.triangles < this.scene.of_triangles ? "; meshes are thinned out: " + this.scene.triangles +
        " of " + this.scene.of_triangles + " triangles, moved by at most " + digits(1000 * this.scene.moved, 2) + " mm" : "";
    this.scaleNote.textContent = shown + thinned;
    const f = this.focus ? this.at(this.focus).multiply(this.world.scale) : new THREE.Vector3();
    this.world.position.copy(f.negate());
    this.draw();
  },
  // About one part, to scale: a bench at the end of a long arm.
  focusOn(entry) {
    if (!entry) return this.say("choose a part first: click on it, or on its name in the list");
    const radius = entry.radius;
    this.focus = entry.part.places[0];
    this.side = null;
    this.stretch = 1;
    this.restretch();
    const size = radius * this.world.scale.x;
    this.camera.position.set(-6 * size, 3 * size, -5 * size);
    this.camera.near = size / 50;
    this.camera.far = size * 1e5;
    this.camera.updateProjectionMatrix();
    this.controls.target.set(0, 0, 0);
    this.controls.update();
    this.draw();
  },
  // From a side, with the long axis from left to right. As long as the reader has not turned it, the scene fits any window.
  look(from = "side") {
    this.side = from;
    const wide = this.long === 0 ? [0, 0, 1] : [-1, 0, 0];
    const directions = {side: [wide[0] * 0.95, 0.22, wide[2] * 0.95], oblique: [wide[0] * 0.7 - 0.35 * wide[2], 0.45, wide[2] * 0.7 - 0.5 * Math.abs(wide[0])],
                        top: [wide[0] * 0.01, 1, wide[2] * 0.01], front: [0, 0.02, 0].map((x, i) => i === this.long ? -1 : x)};
    if (this.long === 1) directions.side = [0.7, 0.3, 0.7];
    this.focus = null;
    this.restretch();
    const d = new THREE.Vector3(...directions[from]).normalize();
    const s = this.size.map((x, i) => x * this.world.scale.getComponent(i));
    const aspect = Math.max(this.view.clientWidth / Math.max(this.view.clientHeight, 1), 0.5);
    const radius = 0.5 * Math.hypot(...s), tangent = Math.tan(this.camera.fov / 360 * Math.PI);
    const fit = from === "side" || from === "top"
        ? 0.5 * Math.max(s[this.long] / aspect, Math.hypot(...s.filter((_, i) => i !== this.long))) * 1.18 + 0.25 * s[0] * tangent
        : radius * 1.05;
    this.camera.position.copy(d.multiplyScalar(fit / tangent + (from === "front" ? s[this.long] / 2 : 0)));
    this.camera.near = radius * 1e-3;
    this.camera.far = radius * 60;
    this.camera.updateProjectionMatrix();
    this.controls.target.set(0, 0, 0);
    this.controls.update();
    this.draw();
  },
  // What lies beyond the plane, on the side of the camera, is not drawn.
  cut(axis, where) {
    const i = "xyz".indexOf(axis);
    if (i < 0 || axis.length > 1) {
      this.renderer.clippingPlanes = [];
      return this.draw();
    }
    const normal = [0, 0, 0], offset = (where - 0.5) * this.size[i] * 1.02 * this.world.scale.getComponent(i);
    const sign = this.camera.position.getComponent(i) > 0 ? -1 : 1;
    normal[i] = sign;
    this.renderer.clippingPlanes = [new THREE.Plane(new THREE.Vector3(...normal), -sign * offset)];
    this.say("cut at " + axis + " = " + digits(this.centre[i] + (where - 0.5) * this.size[i] * 1.02, 4) + " m");
    this.draw();
  },
  // A material of a colour of page.css, which follows the scheme.
  inked(material, colour) {
    material.userData.colour = colour;
    material.color.set(colourNow(colour));
    return material;
  },
  recolour() {
    this.renderer.setClearColor(colourNow("var(--ground)"));
    this.three.traverse(({material}) => {
      if (material && material.userData.colour) material.color.set(colourNow(material.userData.colour));
    });
  },
  resize() {
    if (!this.renderer) return;
    this.recolour();
    const width = this.view.clientWidth, height = this.view.clientHeight;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (this.side) this.look(this.side);
    else this.draw();
  },
  // Three edges of the box with ticks in metres.
  addAxes() {
    const points = [], low = this.low;
    for (let i = 0; i < 3; ++i) {
      const size = this.size[i], raw = size / (i === this.long ? 6 : 3), power = Math.pow(10, Math.floor(Math.log10(raw)));
      const step = [1, 2, 5, 10].map(m => m * power).find(s => s >= raw);
      const end = low.slice();
      end[i] += size;
      points.push(this.at(low), this.at(end));
      const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
      for (let v = Math.ceil(low[i] / step - 1e-9) * step; v <= low[i] + size * 1.0001; v += step) {
        const from = low.slice(), to = low.slice(), side = i === 1 ? 0 : 1;
        from[i] = to[i] = v;
        to[side] -= this.size[side] * 0.03;
        points.push(this.at(from), this.at(to));
        const place = to.slice();
        place[side] -= this.size[side] * 0.06;
        this.label(Number(v.toFixed(decimals)) + " m", place);
      }
      const middle = low.slice();
      middle[i] += size * (i === this.long ? 0.5 : 1.12);
      middle[i === 1 ? 0 : 1] -= this.size[i === 1 ? 0 : 1] * (i === this.long ? 0.2 : 0.06);
      this.label("xyz"[i], middle, "name axis");
    }
    const geometry = new THREE.BufferGeometry().setFromPoints(points);
    this.world.add(new THREE.LineSegments(geometry, this.inked(new THREE.LineBasicMaterial(), "var(--faint)")));
    this.nameLabels();
  },
  label(text, place, kind = "") {
    const node = el("div", {class: "label " + kind}, text);
    this.view.append(node);
    this.labels.push({node, place: this.at(place), kind, wide: node.offsetWidth});
  },
  // Names of parts, at the first of each.
  nameLabels() {
    const known = new Set();
    for (const entry of this.parts || []) {
      const name = this.nameOf(entry.part);
      if (known.has(name) || known.size >= 40) continue;
      known.add(name);
      this.label(name, entry.part.places[0], "name part");
    }
  },
  placeLabels() {
    const width = this.view.clientWidth, height = this.view.clientHeight, taken = [];
    this.world.updateMatrixWorld();
    for (const l of this.labels) {
      const p = l.place.clone().applyMatrix4(this.world.matrixWorld).project(this.camera);
      const at = (p.x + 1) / 2 * width, y = (1 - p.y) / 2 * height, half = l.wide / 2 + 2;
      const x = Math.max(half, Math.min(at, width - half));  // whole, where its place is at the edge
      const free = taken.every(t => Math.abs(t.x - x) > t.half + half || Math.abs(t.y - y) > 14);
      const wanted = !l.kind.includes("part") || this.named;
      const shown = wanted && p.z < 1 && at > 0 && y > 0 && at < width && y < height && free;
      l.node.style.display = shown ? "" : "none";
      if (!shown) continue;
      taken.push({x, y, half});
      l.node.style.left = x + "px";
      l.node.style.top = y + "px";
    }
  },
});
