// SPDX-License-Identifier: BSD-3-Clause
// Which square centimetre makes the noise, and where the light is; maps of receivers.
"use strict";

const fewPaths = 4;

function addMaps(maps) {
  const part = section("Noise and light on surfaces", "maps");
  part.append(el("p", {class: "note"}, "Each route's share of the strain noise power in the band is spread over its kept " +
      "paths by their coupling, and counted where they meet the body whose motion makes most of its noise, in equal parts if more " +
      "than once. That is exact where all paths of a route shake alike, a picture where they do not. Surfaces of one name are laid " +
      "over one another. Pale: fewer than " + fewPaths + " paths, a hint only. Light: power arriving, of " +
      (maps[0] ? maps[0].histories : 0) + " histories traced again; grey: none seen."));
  const chooser = el("select", {"aria-label": "surface"}, maps.map((m, i) =>
      el("option", {value: i}, m.name + " (" + digits(m.noise_sum) + " % of the noise is made here)")));
  const place = el("div");
  chooser.addEventListener("change", () => drawMap(place, maps[chooser.value]));
  part.append(el("div", {class: "bar"}, "surface", chooser), place);
  drawMap(place, maps[0]);
}

function drawMap(parent, map) {
  parent.replaceChildren();
  const pair = el("div", {class: "columns"});
  parent.append(pair);
  const labels = map.unrolled ? {xLabel: "along its axis [m]", yLabel: "around its axis [m]"} : {xLabel: "x across its axis [m]", yLabel: "y across its axis [m]"};
  const shape = {columns: map.columns, rows: map.rows, x: map.x, y: map.y, ...labels};
  const area = map.unrolled ? "area of the unrolled surface" : "area as seen along its axis; of a surface that is tilted to it, its own area is larger";
  const figure = (values, errors, unit, title, pale, more) => {
    const caption = el("figcaption", {}, title), reading = el("span");
    const box = el("figure");
    pair.append(el("div", {}, box));
    heatMap(box, {...shape, values, unit, pale, tell: i => {
      reading.textContent = i === null || !(values[i] > 0) ? "" :
          " " + digits(values[i]) + " ± " + digits(errors[i], 2) + " " + unit + more(i);
    }});
    caption.append(reading);
    box.append(caption);
  };
  figure(map.noise, map.noise_error, "%/cm²", "Noise: share of the strain noise power per " + area + ".", i => map.paths[i] < fewPaths,
         i => ", " + map.paths[i] + " paths");
  figure(map.light, map.light_error, map.light_unit, "Light: power arriving per " + area + ". Mean of " + map.surfaces + (map.surfaces > 1 ? " surfaces." : " surface."),
         i => !(map.light_error[i] < 0.5 * map.light[i]), () => "");
  if (map.surfaces < 2) return;
  const along = [0, 1, 2].sort((a, b) => spread(map.places, b) - spread(map.places, a))[0];
  const box = el("div");
  parent.append(el("h3", {}, "Which of the " + map.surfaces), box);
  new Plot(box, {height: 300, x: {label: "place of the surface along " + "xyz"[along] + " [m]"},
                 y: {label: "share of the noise power [%]"},
                 series: [{name: map.name, kind: "points", colour: colours[0], x: map.places.map(p => p[along]), y: map.noise_by_place}]});
}

function spread(places, axis) {
  const all = places.map(p => p[axis]);
  return Math.max(...all) - Math.min(...all);
}

function addReceivers(receivers) {
  const part = section("Receivers", "receivers");
  for (const r of receivers.list) {
    part.append(el("h3", {}, r.name + ": " + (r.power === null ? "unresolved: " + r.why : withError(r.power, r.sigma) + " " + r.unit)),
                simpleTable(["rank", "route", "power [" + r.unit + "]", "share [%]"], r.routes.slice(0, 12).map(row =>
                    [row.rank, row.route, row.power === null ? "unresolved: " + row.why : withError(row.power, row.sigma), digits(row.share)]), [1]));
    const map = receivers.maps.find(m => m.name === r.name);
    if (!map) continue;
    const reading = el("span"), box = el("figure", {style: "max-width: 32rem"});
    part.append(box);
    heatMap(box, {...map, xLabel: "x on the receiver [m]", yLabel: "y on the receiver [m]",
                  pale: i => !(map.errors[i] < 0.5 * map.values[i]), tell: i => {
      reading.textContent = i === null || map.values[i] === null ? "" : " " + digits(map.values[i]) + " ± " + digits(map.errors[i], 2) + " " + map.unit;
    }});
    box.append(el("figcaption", {}, "Irradiance, seen from the front. Pale: error above half of the value.", reading));
  }
}
