// SPDX-License-Identifier: BSD-3-Clause
// Light on the stage: main beams and lit spots, ghosts, sample rays, and paths traced again.
"use strict";

const lightColours = {beam: "var(--beam)", ghost: ["var(--orange)", "var(--pink)", "var(--olive)", "var(--slate)"],
                      escaped: "var(--sky)", met: "var(--green)"};

class Light {
  constructor(stage) {
    this.stage = stage;
    this.layers = new Map();
    if (!stage.renderer) return;
    this.addBeams();
    this.addGhosts();
    this.addRays();
    if (stage.scene.halo) this.halo = new Halo(stage, this.layer("light at small angles", true));
    this.layer("paths", true);
    this.buildBar();
    stage.draw();
  }
  layer(name, shown) {
    if (!this.layers.has(name)) {
      const group = new THREE.Group();
      group.visible = shown;
      this.stage.lines.add(group);
      this.layers.set(name, group);
    }
    return this.layers.get(name);
  }
  // Pairs of points, one colour and opacity. Lines of a higher order are drawn over those of a lower one, and solid parts hide all.
  segments(group, points, colour, opacity = 1, order = 0) {
    if (points.length === 0) return;
    const geometry = new THREE.BufferGeometry().setFromPoints(points.map(p => this.stage.at(p)));
    const material = this.stage.inked(new THREE.LineBasicMaterial({transparent: opacity < 1 || order > 0, opacity, depthWrite: false}), colour);
    const lines = new THREE.LineSegments(geometry, material);
    lines.renderOrder = order;
    group.add(lines);
  }
  dots(group, points, colour, size = 6) {
    if (points.length === 0) return;
    const geometry = new THREE.BufferGeometry().setFromPoints(points.map(p => this.stage.at(p)));
    group.add(new THREE.Points(geometry, this.stage.inked(new THREE.PointsMaterial({size, sizeAttenuation: false}), colour)));
  }
  // Rings of the 1/e^2 radius where beams light surfaces, and the modes between the mirrors of cavities.
  addBeams() {
    const group = this.layer("beams", true), rings = [], lines = [], standing = new Map();
    for (const spot of this.stage.scene.lit) {
      const t = new THREE.Vector3(...spot.travel), e = Math.abs(t.x) < 0.6 ? new THREE.Vector3(1, 0, 0) : new THREE.Vector3(0, 1, 0);
      const a = e.clone().cross(t).normalize(), b = t.clone().cross(a);
      const point = k => spot.at.map((x, i) => x + spot.radius * (a.getComponent(i) * Math.cos(k * Math.PI / 12) +
                                                                  b.getComponent(i) * Math.sin(k * Math.PI / 12)));
      for (let k = 0; k < 24; ++k) rings.push(point(k), point(k + 1));
      if (!spot.standing) continue;
      const before = standing.get(spot.beam);
      if (before) lines.push(before.at, spot.at);
      standing.set(spot.beam, spot);
    }
    for (const report of this.stage.scene.ghosts)
      for (const row of report.ghosts || []) if (row.order === 0) this.polyline(lines, row);
    this.segments(group, lines, lightColours.beam, 1, 2);
    this.segments(group, rings, lightColours.beam, 0.8, 2);
  }
  polyline(points, row) {
    const all = row.points_m.concat([row.point_m]);
    for (let i = 1; i < all.length; ++i) points.push(all[i - 1], all[i]);
  }
  addGhosts() {
    const by = new Map();
    for (const report of this.stage.scene.ghosts)
      for (const row of report.ghosts || []) {
        if (row.order === 0) continue;
        if (!by.has(row.order)) by.set(row.order, []);
        this.polyline(by.get(row.order), row);
      }
    for (const [order, points] of by)
      this.segments(this.layer("ghosts", data.kind === "view"), points, lightColours.ghost[Math.min(order, 4) - 1], 0.75, 1);
  }
  addRays() {
    const rays = this.stage.scene.rays;
    if (!rays) return;
    const group = this.layer("sample rays", true), met = [], escaped = [];
    for (const r of rays) (r.end === "escaped" ? escaped : met).push(r.from, r.to);
    this.segments(group, met, lightColours.met, 0.35);
    this.segments(group, escaped, lightColours.escaped, 0.35);
  }
  buildBar() {
    const boxes = [];
    for (const [name, group] of this.layers) {
      if (group.children.length === 0 && name !== "paths") continue;
      const box = el("input", {type: "checkbox", on: {change: () => { group.visible = box.checked; this.stage.draw(); }}});
      box.checked = group.visible;
      boxes.push(el("label", {}, box, " " + name));
    }
    this.stage.bar.append(el("span", {}, "show"), ...boxes);
  }
  // Paths of some routes, each route in its own colour; returns how many are drawn.
  showPaths(ids) {
    const group = this.layer("paths", true);
    for (const child of [...group.children]) {
      group.remove(child);
      child.geometry.dispose();
    }
    let drawn = 0;
    ids.forEach((id, k) => {
      const lines = [], dots = [];
      for (const path of this.stage.scene.paths) {
        if (path.id !== id) continue;
        ++drawn;
        for (let i = 1; i < path.points.length; ++i) lines.push(path.points[i - 1], path.points[i]);
        dots.push(...path.points);
      }
      this.segments(group, lines, colours[k % colours.length], 1, 3);
      this.dots(group, dots, colours[k % colours.length]);
    });
    this.stage.drawnPaths = drawn;
    this.stage.draw();
    return drawn;
  }
}

// The events of the drawn paths of a route, as text.
function pathDetails(scene, id) {
  const paths = scene.paths.filter(p => p.id === id);
  if (paths.length === 0) return el("p", {class: "note"}, "No path of this route is kept here: it is a sum of many, or of ghosts beyond " +
      "those listed, or it is not among the rows whose paths are drawn (--paths).");
  const rows = [];
  paths.forEach((path, n) => path.points.forEach((point, i) => {
    const leg = i > 0 ? Math.hypot(...point.map((x, k) => x - path.points[i - 1][k])) : null;
    rows.push([i === 0 ? n + 1 : "", i === 0 ? path.address + (path.reversed ? " (reversed)" : "") : "", path.steps[i],
               point.map(x => digits(x, 7)).join(", "), leg === null ? "" : digits(leg, 6),
               i === 0 ? digits(path.weight) : "", i === 0 ? digits(path.length, 8) : ""]);
  }));
  return el("details", {}, el("summary", {}, "Events of these " + paths.length + " paths"),
            el("p", {class: "note"}, "Address: history:event:connection, to follow with straytrace trace --history. " +
               "Couplings are the parts of the route that the path represents."),
            simpleTable(["path", "address", "event", "place [m]", "leg [m]", "coupling", "optical path [m]"], rows, [1, 2, 3]));
}
