// SPDX-License-Identifier: BSD-3-Clause
// Light at small angles: the field of a cavity, where its power goes, and what moving edges couple back.
"use strict";

const fieldDepth = 1e-12;  // part of the brightest cell that has a colour of its own

function addWave(w) {
  const part = section("Light at small angles", "wave"), watts = w.power !== null;
  const unit = watts ? "W/m²" : "1/m²";
  part.append(el("p", {class: "note"}, "Field of the cavity of beam " + w.beam + ", " + digits(w.length, 6) + " m, on a grid of " + w.points + " × " +
      w.points + " points over " + digits(w.window, 4) + " m. Light at angles above the crossover of " + digits(1e6 * w.crossover, 4) +
      " µrad is traced as rays." + (watts ? " Power of the mode: " + digits(w.power, 3) + " W." : " The power of the mode is not stated: irradiances are over it.")));
  addWavePlanes(part, w, unit);
  addWaveLedger(part, w, watts);
  if (w.by_frequency) addBands(part, w.by_frequency);
  if (w.edges.z.length > 0) {
    addBafflePower(part, w, watts);
    addLevers(part, w);
  }
  if (w.photodiodes.length > 0) addPhotodiodes(part, w, watts);
  addModes(part, w);
}

function addWavePlanes(part, w, unit) {
  const chooser = el("select", {"aria-label": "plane"}, w.planes.map((p, i) => el("option", {value: i}, planeTitle(p))));
  const place = el("div"), draw = () => drawPlane(place, w, w.planes[chooser.value], unit);
  chooser.addEventListener("change", draw);
  part.append(el("h3", {}, "Irradiance"), el("div", {class: "bar"}, "plane", chooser), place);
  draw();
}

function planeTitle(p) { return p.name + " at " + digits(p.z, 5) + " m, light towards " + p.towards; }

function drawPlane(parent, w, p, unit) {
  const pair = el("div", {class: "columns"}), map = el("figure"), curve = el("figure"), reading = el("b");
  parent.replaceChildren(pair);
  pair.append(el("div", {}, map), el("div", {}, curve));
  const values = Array.from(typedArray(Float32Array, p.values)), cells = [], errors = new Array(values.length).fill(0);
  for (let r = 0; r < p.rings; ++r)
    for (let s = 0; s < p.sectors; ++s)
      cells.push(r * p.step, (r + 1) * p.step, sectorStart(s, p.sectors), sectorStart(s, p.sectors) + 2 * Math.PI / p.sectors);
  const wide = p.rings * p.step;
  heatMap(map, {xLabel: "x across the axis", yLabel: "y across the axis", unit, values, errors, depth: fieldDepth, whole: true,
                circle: p.rim, place: chartCells({chart: "polar", whole: [0, wide], cells}),
                tell: i => say(reading, i === null ? "" : " " + digits(values[i]) + " " + unit)});
  map.append(el("figcaption", {}, "Light that arrives at " + p.name + ", before its opening. Ring: " +
                (p.mirror ? "clear aperture." : "inner edge."), reading));
  const series = [{name: "field, mean over the azimuth", colour: "var(--ink)", width: 2, x: p.radius, y: p.profile}];
  if (p.scattered.some(v => v !== null))
    series.push({name: "mean over random mirrors, eq. W.17", colour: "var(--red)", dash: "6 4", width: 2, x: p.scattered_radius, y: p.scattered});
  new Plot(curve, {height: 430, series, shades: edgeShades(p), x: {label: "distance from the axis [m]", range: [0, p.radius[p.radius.length - 1]]},
                   y: {label: "irradiance [" + unit + "]", log: true, decades: 14}});
  curve.append(el("figcaption", {}, "Grey line: " + (p.mirror ? "clear aperture" : "inner edge") + " at " + digits(p.rim, 4) + " m. Eq. W.17 has the " +
      "light that the mirror scatters and not the mode itself; the field ends at the crossover angle, " + digits(p.crossover, 3) + " m here."));
}

// Azimuth where a sector begins, from -π to π.
function sectorStart(s, sectors) { return 2 * Math.PI * (s < sectors / 2 ? s : s - sectors) / sectors; }
function edgeShades(p) {
  const half = 0.003 * p.radius[p.radius.length - 1];
  return [{from: p.rim - half, to: p.rim + half, name: p.mirror ? "clear aperture" : "inner edge"}];
}

// Bars on a logarithmic scale of shares of the power.
function addWaveLedger(part, w, watts) {
  part.append(el("h3", {}, "Power lost per round trip"));
  const all = w.ledger.reduce((sum, row) => sum + Math.max(row.share, 0), 0), box = el("div", {class: "bars"});
  const least = Math.max(1e-12, Math.min(...w.ledger.map(r => r.share).filter(s => s > 0)) / 10), most = Math.max(all, 10 * least);
  const width = s => s > least ? 100 * Math.log(s / least) / Math.log(most / least) : 0;
  const text = s => s > 1e-12 ? digits(1e6 * s, 4) + " ppm" + (watts ? ", " + digits(s * w.power, 3) + " W" : "") : "below 1e-6 ppm";
  for (const row of [...w.ledger, {name: "all", share: all}])
    box.append(el("span", {}, row.name), el("span", {class: "bar-line"}, el("i", {style: "width:" + width(row.share).toFixed(1) + "%"})), el("span", {}, text(row.share)));
  part.append(box, el("p", {class: "note"}, "Length of the bars: logarithmic. " + (w.smooth_loss === null ? "" :
      "Smooth mirrors without baffles lose " + digits(1e6 * w.smooth_loss, 4) + " ppm (eq. W.10). ") +
      "Transmission and absorption of the coatings are not part of it. " + lossErrors(w)));
}

function lossErrors(w) {
  const d = w.loss_of_draws, g = w.finer_grid, ppm = s => digits(1e6 * s, 4) + " ppm";
  return (d ? "Mean over " + d.draws + " draws of the heights: median " + ppm(d.median) + ", " +
                  (d.draws < 20 ? "from " : "5 to 95 % from ") + ppm(d.low) + " to " + ppm(d.high) + ". "
            : "One draw of the heights; 'map_draws' in the scene gives the range over draws. ") +
      (g ? "A grid of " + g.points + " × " + g.points + " points changes the loss by " + ppm(g.loss) + "."
         : "Error of the grid: not checked; straytrace wave --grid-check does.");
}

function addBands(part, f) {
  const ppm = s => digits(1e6 * s, 3), loss = s => Math.abs(s) > f.resolved ? ppm(s) : "within " + digits(1e6 * f.resolved, 1);
  part.append(el("h3", {}, "Loss by the spatial frequency of the heights"),
              simpleTable(["heights from [1/m]", "to [1/m]", "scattered [ppm]", "loss [ppm]"],
                          f.from.map((from, i) => [digits(from, 3), digits(f.to[i], 3), ppm(f.scattered[i]), loss(f.loss[i])])),
              el("p", {class: "note"}, "Of the first draw. In each row the mirrors have these heights alone; light that both scatter, to first order; what the " +
                 "cavity loses over smooth mirrors (eq. W.34). Beyond the crossover angle both scatter " + ppm(f.beyond) + " ppm; smooth mirrors lose " +
                 loss(f.smooth) + " ppm."));
}

function addBafflePower(part, w, watts) {
  const scale = watts ? w.power : 1, points = (name, y, colour) => ({name, kind: "points", colour, x: w.edges.z, y: y.map(v => scale * v)});
  const box = el("div");
  part.append(el("h3", {}, "Light on baffles"), box);
  const [one, two] = w.mirrors;
  new Plot(box, {height: 360, x: {label: "distance from " + one + " [m]"}, y: {label: watts ? "power [W]" : "share of the power of the mode", log: true, decades: 12},
                 series: [points("light towards " + two, w.edges.towards2, "var(--blue)"), points("light towards " + one, w.edges.towards1, "var(--red)")]});
}

// The speckle of one draw against mean and spread over mirrors; curves end where a set of photodiodes does.
function addPhotodiodes(part, w, watts) {
  const box = el("div"), unit = watts ? "W" : "share of the power of the mode", mm = x => Math.abs(x) < 1e-9 ? 0 : digits(1e3 * x, 4);
  const set = d => d.name.replace(/_\d+$/, ""), gap = {mean: null, spread: null, power: null}, rows = [];
  w.photodiodes.forEach((d, i) => {
    if (i > 0 && set(d) !== set(w.photodiodes[i - 1])) rows.push({...gap, number: i + 0.5});
    rows.push({...d, number: i + 1});
  });
  const all = name => rows.map(d => d[name]), off = sign => rows.map(d => d.mean === null ? null : Math.max(d.mean + sign * d.spread, 0)), drawn = all("power");
  part.append(el("h3", {}, "Light on photodiodes"), box);
  new Plot(box, {height: 360, x: {label: "number of the photodiode"}, y: {label: "power [" + unit + "]", log: true, decades: 6},
                 series: [{name: "mean over mirrors, less and plus one standard deviation", kind: "band", colour: "var(--sky)", opacity: 0.5, x: all("number"), low: off(-1), high: off(1)},
                          {name: "mean over mirrors (eq. W.41)", colour: "var(--blue)", x: all("number"), y: all("mean")},
                          ...(drawn.some(v => v !== null) ? [{name: "heights as first drawn", kind: "points", colour: "var(--red)", x: all("number"), y: drawn}] : [])]});
  part.append(simpleTable(["photodiode", "x [mm]", "y [mm]", (watts ? "power [W]" : "share") + " as drawn", "mean", "standard deviation"],
                          w.photodiodes.map(d => [d.name, mm(d.x), mm(d.y), digits(d.power, 4), digits(d.mean, 4), digits(d.spread, 2)]), [0]),
              el("p", {class: "note"}, "Mean and standard deviation over all heights of the mirrors that no map states (eq. W.41, W.43). A dash: the grid does not hold the light that meets it."));
}

function addLevers(part, w) {
  const {z, across, low, high, along, speckle, speckle_along} = w.edges, box = el("div");
  const points = (name, y, colour, more) => ({name, kind: "points", x: z, y, colour, ...more}), some = list => list.some(v => v !== null);
  const bands = some(low) ? [{name: "across, 5 to 95 % of the draws", kind: "band", colour: "var(--sky)", opacity: 0.5, x: z, low, high}] : [];
  part.append(el("h3", {}, "Edges that move"), box);
  new Plot(box, {height: 430, x: {label: "distance from " + w.mirrors[0] + " [m]"}, y: {label: "|stray field over main field| per displacement [1/m]", log: true, decades: 9},
                 series: [...bands, ...(some(across) ? [points("across the beam, in the field (eq. W.14)", across, "var(--blue)"),
                                                        points("along the beam, in the field", along, "var(--green)", {off: true})] : []),
                          {name: "across, expected over random mirrors (eq. W.29)", colour: "var(--red)", dash: "6 4", x: z, y: speckle},
                          {name: "along, expected over random mirrors", colour: "var(--pink)", dash: "6 4", x: z, y: speckle_along, off: true}]});
  part.append(el("p", {class: "note"}, w.edges.solved + " of " + z.length + " edges are in the field: both mirrors see them within the crossover angle. For the " +
      "others the expectation stands. Rms over x and y, and over the draws where there are any."));
}

// The eigenvalues in polar form: all are next to the unit circle, so their distance from it is on a logarithmic scale.
function addModes(part, w) {
  const rows = w.modes.filter(m => m.loss > 0);
  if (rows.length === 0) return;
  const box = el("div"), orders = [...new Set(rows.map(m => m.order))];
  part.append(el("h3", {}, "Modes"), box);
  new Plot(box, {height: 360, x: {label: "phase of the eigenvalue [turns]", range: [-0.5, 0.5]}, y: {label: "loss of power per round trip, 1 − |γ|²", log: true, decades: 12},
                 series: orders.map((order, i) => {
                   const some = rows.filter(m => m.order === order);
                   return {name: "order " + order, kind: "points", colour: colours[i % colours.length], x: some.map(m => m.phase), y: some.map(m => m.loss)};
                 })});
  part.append(simpleTable(["mode", "shared [%]", "in order [%]", "loss [ppm]", "phase [turns]", "alike"],
                          rows.map(m => ["HG" + m.n + m.m, digits(100 * m.shared, 4), digits(100 * m.in_order, 6), digits(1e6 * m.loss, 4), digits(m.phase, 4), m.alike > 1 ? m.alike : "–"]), [0]),
              el("p", {class: "note"}, "Of the mirrors without baffles, next to Hermite-Gauss modes, and the power shared with them and with all modes of the order; phase of the " +
                 "round trip over that of the fundamental mode. Alike: so many modes of one eigenvalue, with any combination of them."));
}
