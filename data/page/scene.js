// SPDX-License-Identifier: BSD-3-Clause
// The scene in three dimensions with three.js. Nothing is shown to scale when a tube is long: the sides are stretched
// against the long axis, and the stage states by how much.
"use strict";

const surfaceColours = ["#7c9cb8", "#c9a06a", "#8fb38a", "#b58aa5", "#a8a8a8", "#d0b848", "#7ab5b0", "#c98b7a", "#8d8fc4",
                        "#a39a7a", "#6f8f6f", "#b3c4d6"];
const states = {solid: ["●", 1], glass: ["◐", 0.16], hidden: ["○", 0]};

class Stage {
  constructor(parent, scene) {
    this.scene = scene;
    this.measure();
    this.build(parent);
    if (!this.start()) return;
    this.unfinished = true;  // drawn once, when all is there
    this.addParts();
    this.addAxes();
    this.look();
    this.unfinished = false;
    this.resize();
    window.addEventListener("resize", () => this.resize());
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.resize());
  }
  // The box, the long axis, and how much the sides are stretched against it.
  measure() {
    const [low, high] = this.scene.box;
    this.low = low;
    this.centre = low.map((x, i) => (x + high[i]) / 2);
    this.size = low.map((x, i) => Math.max(high[i] - x, 1e-6));
    this.long = this.size.indexOf(Math.max(...this.size));
    const across = Math.max(...this.size.filter((_, i) => i !== this.long));
    const ratio = this.size[this.long] / across;
    this.stretch = ratio > 8 ? ratio / 5 : 1;
    this.usual = this.stretch;
  }
  build(parent) {
    this.view = el("div", {class: "view"});
    this.said = el("div", {class: "said"});
    this.scaleNote = el("div", {class: "scale"});
    this.list = el("div", {class: "parts"});
    this.bar = el("div", {class: "bar"});
    const stretch = el("input", {type: "range", min: 0, max: Math.log10(Math.max(this.stretch * 4, 10)), step: 0.01,
                                 value: Math.log10(this.stretch), "aria-label": "sides stretched"});
    stretch.addEventListener("input", () => { this.stretch = Math.pow(10, stretch.value); this.restretch(); });
    const by = el("select", {"aria-label": "colour by"}, ["name", "material", "body"].map(w => el("option", {}, w)));
    by.addEventListener("change", () => this.paint(by.value));
    const axis = el("select", {"aria-label": "cut across"}, ["no cut", "x", "y", "z"].map(w => el("option", {}, w)));
    const where = el("input", {type: "range", min: 0, max: 1, step: 0.002, value: 0.5, "aria-label": "cut at"});
    for (const input of [axis, where]) input.addEventListener("input", () => this.cut(axis.value, Number(where.value)));
    const names = el("input", {type: "checkbox", on: {change: () => { this.named = names.checked; this.draw(); }}});
    const looks = ["side", "front", "top", "oblique"].map(w => el("button", {on: {click: () => {
      if (this.focus) this.stretch = this.usual;
      this.look(w);
    }}}, w));
    looks.push(el("button", {title: "of the chosen part, to scale", on: {click: () => this.focusOn(this.chosen)}}, "near it"));
    const named = (text, ...inputs) => el("label", {}, text + " ", ...inputs);
    this.bar.append("view", ...looks, named("sides ×", stretch), named("colour by", by), named("cut", axis, where), el("label", {}, names, " names"));
    parent.append(this.bar, el("div", {class: "stage"}, this.view, this.list));
    this.view.append(this.said, this.scaleNote);
  }
  start() {
    if (typeof THREE === "undefined") {
      this.say("This browser cannot unpack the scripts of the scene (DecompressionStream, in browsers from 2023). For a fixed " +
               "picture: straytrace render");
      return false;
    }
    try {
      this.renderer = new THREE.WebGLRenderer({antialias: true, preserveDrawingBuffer: true});
    } catch (error) {
      this.said.textContent = "This browser has no WebGL, so the scene cannot be drawn. For a fixed picture: straytrace render";
      return false;
    }
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.view.prepend(this.renderer.domElement);
    this.three = new THREE.Scene();
    this.world = new THREE.Group();  // metres about the centre, stretched
    this.lines = new THREE.Group();
    this.world.add(this.lines);
    this.three.add(this.world, new THREE.HemisphereLight(0xffffff, 0x8a8a8a, 0.85));
    this.camera = new THREE.PerspectiveCamera(32, 1, 0.001, 1000);
    const light = new THREE.DirectionalLight(0xffffff, 0.45);
    this.camera.add(light);
    this.three.add(this.camera);
    this.controls = new THREE.OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => this.draw());
    this.controls.addEventListener("start", () => { this.side = null; });
    this.renderer.domElement.addEventListener("pointerdown", e => { this.pressed = [e.clientX, e.clientY]; });
    this.renderer.domElement.addEventListener("pointerup", e => {
      if (this.pressed && Math.hypot(e.clientX - this.pressed[0], e.clientY - this.pressed[1]) < 4) this.pick(e);
    });
    this.labels = [];
    return true;
  }
  at(p) { return new THREE.Vector3(p[0] - this.centre[0], p[1] - this.centre[1], p[2] - this.centre[2]); }
  geometryOf(mesh) {
    const g = new THREE.BufferGeometry();
    g.setAttribute("position", new THREE.BufferAttribute(typedArray(Float32Array, mesh.points), 3));
    g.setIndex(new THREE.BufferAttribute(typedArray(Uint32Array, mesh.corners), 1));
    g.computeBoundingBox();
    g.computeBoundingSphere();
    return g;
  }
  // One entry for each name with one material and body: the faces of a part that was read from a file are one entry.
  addParts() {
    const geometries = this.scene.meshes.map(mesh => this.geometryOf(mesh)), edges = new Map(), byKey = new Map();
    for (const part of this.scene.parts) {
      const key = JSON.stringify([part.name, part.front, part.back, part.body, part.clear]);
      byKey.set(key, [...byKey.get(key) || [], part]);
    }
    const entries = [...byKey.values()];
    this.files = new Set(entries.filter(faces => faces.length > 1 || ["cad_face", "mesh"].includes(faces[0].shape))
                             .map(faces => faces[0].name.split("/")[0]));
    this.parts = entries.map(faces => this.entryOf(faces, geometries, edges));
    this.paint("name");
  }
  entryOf(faces, geometries, edges) {
    const part = faces[0], material = new THREE.MeshPhongMaterial({
      side: THREE.DoubleSide, shininess: 0, specular: 0, flatShading: true,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1});
    const entry = {part, faces, material, group: new THREE.Group(), state: this.isGlass(faces, geometries) ? "glass" : "solid",
                   ink: this.inked(new THREE.LineBasicMaterial({transparent: true, opacity: 0.5}), "var(--edge)"),
                   radius: Math.max(...faces.map(face => geometries[face.mesh].boundingSphere.radius))};
    for (const face of faces) this.addFace(entry, face, geometries[face.mesh], edges);
    this.world.add(entry.group);
    return entry;
  }
  addFace(entry, face, geometry, edges) {
    const outline = this.scene.meshes[face.mesh].triangles < 20000 && face.places.length <= 200;
    if (outline && !edges.has(face.mesh)) edges.set(face.mesh, new THREE.EdgesGeometry(geometry, 32));
    for (const place of face.places) {
      const object = new THREE.Mesh(geometry, entry.material);
      object.position.copy(this.at(place));
      object.userData.entry = entry;
      entry.group.add(object);
      if (!outline) continue;
      const lines = new THREE.LineSegments(edges.get(face.mesh), entry.ink);
      lines.position.copy(object.position);
      entry.group.add(lines);
    }
  }
  // What would hide the rest: measuring planes, tubes and boxes around everything.
  isGlass(faces, geometries) {
    const part = faces[0], box = geometries[part.mesh].boundingBox.getSize(new THREE.Vector3());
    if (part.clear) return true;
    if (faces.length > 1) return false;
    const wide = box.toArray().filter((s, i) => s > 0.6 * this.size[i]).length, tube = part.shape === "cylinder";
    return wide === 3 || (tube && ((wide === 2 && this.scene.parts.length > 2) ||
                                   box.getComponent(this.long) > 0.1 * this.size[this.long]));
  }
  // Entries of the scene go by their name, parts of a file by their own.
  nameOf(part) {
    const first = part.name.split("/")[0];
    return this.files.has(first) ? part.name : first;
  }
  // One colour for each name, material or body.
  paint(by) {
    const key = part => by === "name" ? this.nameOf(part) : by === "body" ? part.body || "(none)" :
        part.front || part.back || "(none)";
    const known = [...new Set(this.scene.parts.map(key))].sort();
    for (const entry of this.parts) {
      entry.colour = surfaceColours[known.indexOf(key(entry.part)) % surfaceColours.length];
      entry.material.color.set(entry.colour);
      this.setState(entry, entry.state);
    }
    this.drawList();
    this.draw();
  }
  setState(entry, state) {
    entry.state = state;
    const opacity = states[state][1];
    entry.group.visible = opacity > 0;
    entry.material.transparent = opacity < 1;
    entry.material.depthWrite = opacity === 1;
    entry.material.opacity = opacity;
    entry.material.needsUpdate = true;
    entry.ink.opacity = opacity < 1 ? 0.18 : 0.5;
  }
  drawList() {
    const order = Object.keys(states);
    this.list.replaceChildren(
        el("div", {}, el("b", {}, "Parts"), el("span", {class: "note"}, this.parts.length + " names")),
        ...this.parts.map(entry => el("div", {class: entry === this.chosen ? "chosen" : null},
            el("button", {title: "solid, glass, hidden", on: {click: () => {
              this.setState(entry, order[(order.indexOf(entry.state) + 1) % order.length]);
              this.drawList();
              this.draw();
            }}}, states[entry.state][0]),
            el("i", {style: "background:" + entry.colour}),
            el("span", {title: this.about(entry), on: {click: () => this.choose(entry)}}, entry.part.name,
               entry.faces.length === 1 && entry.part.places.length > 1 ? " × " + entry.part.places.length : ""))));
  }
  about(entry) {
    const p = entry.part, meshes = entry.faces.map(face => this.scene.meshes[face.mesh]);
    const count = of => meshes.reduce((sum, m) => sum + m[of], 0), drawn = count("triangles"), all = count("of");
    const shape = entry.faces.length > 1 ? entry.faces.reduce((sum, f) => sum + f.places.length, 0) + " faces" : p.shape;
    const material = p.front === p.back || !p.back ? p.front : !p.front ? p.back + " (back)" :
        p.front + " (front), " + p.back + " (back)";
    return p.name + ": " + shape + ", material " + (material || "none") + ", body " + (p.body || "none") +
           (p.clear ? ", measuring plane" : "") + (this.lightOn ? this.lightOn(p.name) : "") +
           (drawn < all ? ", drawn with " + drawn + " of " + all + " triangles" : "");
  }
  choose(entry) {
    if (this.chosen) this.chosen.material.emissive.set(0);
    this.chosen = entry === this.chosen ? null : entry;
    if (this.chosen) this.chosen.material.emissive.set(0x664400);
    this.say(this.chosen ? this.about(entry) : "");
    this.drawList();
    this.draw();
  }
  say(text) { this.said.textContent = text; }
  pick(event) {
    const box = this.renderer.domElement.getBoundingClientRect();
    const mouse = new THREE.Vector2(2 * (event.clientX - box.left) / box.width - 1, 1 - 2 * (event.clientY - box.top) / box.height);
    const ray = new THREE.Raycaster();
    ray.setFromCamera(mouse, this.camera);
    const planes = this.renderer.clippingPlanes;
    const hits = ray.intersectObjects(this.world.children, true)
        .filter(h => h.object.isMesh && h.object.userData.entry && h.object.parent.visible)
        .filter(h => planes.every(plane => plane.distanceToPoint(h.point) >= 0));
    const solid = hits.find(h => h.object.userData.entry.state === "solid") || hits[0];
    if (solid && solid.object.userData.entry !== this.chosen) this.choose(solid.object.userData.entry);
    else if (this.chosen) this.choose(this.chosen);
  }
  draw() {
    if (!this.renderer || this.unfinished) return;
    this.renderer.render(this.three, this.camera);
    this.placeLabels();
  }
}
