// SPDX-License-Identifier: BSD-3-Clause
// Which square centimetre makes the noise, and where the light is; maps of receivers.
"use strict";

const hatched = "Hatched: error above " + 100 * uncertain + " %. Grey: none seen. Darkest: a millionth of the brightest or less. ";

function addMaps(maps) {
  const part = section("Noise and light on surfaces", "maps");
  part.append(el("p", {class: "note"}, "Each route's share of the strain noise power in the band is spread over its kept " +
      "paths by their coupling, and counted where they meet the body whose motion makes most of its noise, in equal parts if more " +
      "than once. That is exact where all paths of a route shake alike, a picture where they do not. Surfaces of one name are laid " +
      "over one another. Cells are as small as the number of paths or arrivals allows. " + hatched + "Light: power arriving, of " +
      (maps[0] ? maps[0].histories : 0) + " histories traced again."));
  const title = m => m.name + " (" + digits(m.noise_sum) + " % of the noise is made here)";
  const chooser = el("select", {"aria-label": "surface"}, maps.map((m, i) => el("option", {value: i}, title(m))));
  const place = el("div"), draw = () => drawMap(place, maps[chooser.value], title(maps[chooser.value]));
  chooser.addEventListener("change", draw);
  part.append(el("div", {class: "bar"}, "surface", chooser), place);
  draw();
}

function vectorText(v) { return "(" + v.map(x => digits(Math.abs(x) < 1e-6 ? 0 : x, 3)).join(", ") + ")"; }

function drawMap(parent, map, title) {
  const pair = el("div", {class: "columns"}), unrolled = map.chart === "unrolled";
  parent.replaceChildren(el("h3", {}, title), pair);
  const labels = unrolled ? {xLabel: "along its axis", yLabel: "around its axis"} : {xLabel: "x across its axis", yLabel: "y across its axis"};
  const area = unrolled ? "area of the unrolled surface" : "area as seen along its axis; of a surface that is tilted to it, its own area is larger";
  const figure = (cells, unit, words, counted) => {
    const caption = el("figcaption", {}, words), reading = el("b"), box = el("figure");
    pair.append(el("div", {}, box));
    heatMap(box, {...labels, place: chartCells({...map, cells: cells.cells}), values: cells.values, errors: cells.errors, unit, tell: i =>
      say(reading, i === null ? "" : cells.values[i] === null ? " none seen" : " " + digits(cells.values[i]) + " ± " +
          digits(cells.errors[i], 2) + " " + unit + ", " + cells.count[i] + " " + counted)});
    caption.append(reading);
    box.append(caption);
  };
  const axes = (unrolled ? "The middle of the arc is towards " + vectorText(map.x_axis) + ", it grows towards " + vectorText(map.y_axis)
                         : "x is " + vectorText(map.x_axis) + ", y is " + vectorText(map.y_axis)) + " of the scene" +
      (map.surfaces > 1 ? ", of the first surface. " : ". ");
  figure(map.noise, "%/cm²", "Noise: share of the strain noise power per " + area + ". " + axes, "paths");
  figure(map.light, map.light_unit, "Light: power arriving per " + area + "." + (map.surfaces > 1 ? " Mean of " + map.surfaces + " surfaces." : ""),
         "arrivals");
  if (map.surfaces > 1) addInstances(parent, map);
}

// Which of many: the share of each, with the error that the number of its paths leaves.
function addInstances(parent, map) {
  const along = [0, 1, 2].sort((a, b) => spread(map.places, b) - spread(map.places, a))[0], box = el("div");
  const label = "place along " + "xyz"[along] + " [m]", unseen = map.noise_by_place.filter(x => x === 0).length;
  parent.append(el("h3", {}, "Which of the " + map.surfaces), box);
  new Plot(box, {height: 300, x: {label: "place of the surface along " + "xyz"[along] + " [m]"}, y: {label: "share of the noise power [%]"},
                 series: [{name: map.name, kind: "points", colour: colours[0], x: map.places.map(p => p[along]),
                           y: map.noise_by_place.map(x => x === 0 ? null : x), error: map.noise_by_place_error}]});
  const rows = map.places.map((p, i) => [i, digits(p[along], 6), map.noise_by_place[i] === 0 ? "none seen" : withError(map.noise_by_place[i], map.noise_by_place_error[i])]);
  const csv = el("button", {on: {click: () => offer("instances.csv", ["number", label, "share [%]", "sigma [%]"].map(csvCell).join(",") + "\n" +
      map.places.map((p, i) => [i, p[along], map.noise_by_place[i], map.noise_by_place_error[i]].map(csvCell).join(",")).join("\n") + "\n")}}, "CSV");
  parent.append(el("p", {class: "note"}, "Bars: one standard error of the number of kept paths." +
                   (unseen > 0 ? " No kept path meets " + unseen + " of them: they are not drawn." : "")),
                el("details", {}, el("summary", {}, "Numbers"), simpleTable(["number", label, "share of the noise power [%]"], rows), csv));
}

function spread(places, axis) {
  const all = places.map(p => p[axis]);
  return Math.max(...all) - Math.min(...all);
}

function addReceivers(receivers) {
  const part = section("Receivers", "receivers");
  for (const r of receivers.list) {
    part.append(el("h3", {}, r.name + ": " + cellText(r.light) + (typeof r.light === "string" ? "" : " " + r.unit)), listedTable(r.table));
    const map = receivers.maps.find(m => m.name === r.name);
    if (!map) continue;
    const reading = el("b"), box = el("figure", {style: "max-width: 32rem"});
    part.append(box);
    heatMap(box, {...map, place: map.cells ? chartCells(map) : pixelCells(map), xLabel: "x on the receiver", yLabel: "y on the receiver", tell: i =>
      say(reading, i === null ? "" : map.values[i] === null ? " none seen" :
          " " + digits(map.values[i]) + " ± " + digits(map.errors[i], 2) + " " + map.unit)});
    box.append(el("figcaption", {}, "Irradiance, seen from the front. " + hatched, reading));
  }
}
