// SPDX-License-Identifier: BSD-3-Clause
// The view of a scene before any run, or of a run with its paths.
"use strict";

document.body.classList.add("viewing");
const place = el("div");
document.getElementById("page").append(place);
finish(() => {
  const stage = new Stage(place, data.scene);
  window.stage = stage;
  const light = new Light(stage);
  place.append(el("p", {class: "legend"}, "Red: main beams and lit spots. Ghosts by order: orange 1, pink 2, brown 3. Sample rays: green until a " +
      "surface, light blue where they leave the scene. Click a part for its name, material and body; ● solid, ◐ transparent, ○ hidden."));
  if (light.halo) place.append(light.halo.scale(), light.halo.note());
  if (data.table && data.table.rows > 0) {
    const part = section("Routes", "routes");
    const table = new PathTable(part, data.table, ids => {
      const drawn = light.showPaths(ids);
      stage.say(ids.length === 0 ? "" : drawn + " paths of " + ids.length + " routes");
    });
    const drawn = [...new Set(data.scene.paths.map(p => p.id))];
    if (drawn.length > 0) table.choose(drawn[0]);
  }
  document.getElementById("page").append(el("p", {class: "note"}, "straytrace " + data.version + ", model " + data.model.slice(0, 12) +
      ". This file needs no network. It carries " + data.libraries.scene + "."));
});
