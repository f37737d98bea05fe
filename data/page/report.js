// SPDX-License-Identifier: BSD-3-Clause
// The report of a run: puts its parts in order.
"use strict";

const measuredColours = ["var(--violet)", "var(--olive)", "var(--bad)"];

function budgetSeries(b) {
  const x = b.frequency, line = (name, y, more) => ({name, x, y, ...more});
  const series = [];
  if (b.speckle_05.length > 0)
    series.push({name: "speckle, 5 to 95 %", kind: "band", colour: "var(--sky)", opacity: 0.35, x, low: b.speckle_05, high: b.speckle_95});
  if (b.input_low.length > 0)
    series.push({name: data.inputs.sources.rows.length > 0 ? "inputs" : "inputs: nothing stated", kind: "band", colour: "var(--orange)", opacity: 0.4, x, low: b.input_low, high: b.input_high});
  series.push({name: "Monte Carlo, ± 1σ", kind: "band", colour: "var(--ink)", opacity: 0.35, x,
               low: b.total.asd.map((v, i) => v === null ? null : Math.max(v - b.total.sigma[i], 0)),
               high: b.total.asd.map((v, i) => v === null ? null : v + b.total.sigma[i])});
  b.routes.forEach((r, i) => series.push(line(r.name, r.asd, {id: r.id, colour: colours[i % colours.length], width: 1.2, aside: true})));
  const dashes = [null, "9 4", "3 3"];
  b.design.forEach((d, i) => {
    series.push(line(d.name, d.asd, {colour: "var(--grey)", width: 2.2, dash: dashes[i % 3]}));
    series.push(line("margin: " + digits(b.margin) + " × " + d.name, d.asd.map(v => v === null ? null : v * b.margin),
                     {colour: "var(--grey)", width: 1.4, dash: "2 3"}));
  });
  b.measured.forEach((m, i) => {
    const colour = measuredColours[i % measuredColours.length], name = "measured: " + m.name;
    if (m.high.some(v => v !== null)) series.push({name: name + ", ± 1σ", kind: "band", colour, opacity: 0.3, x: m.frequency, low: m.low, high: m.high});
    series.push({name, x: m.frequency, y: m.asd, colour, width: 1.6});
  });
  if (b.coherent.length > 0) series.push(line("all routes in phase: upper bound", b.coherent, {colour: "var(--faint)", width: 1, dash: "1 3", off: true, aside: true}));
  series.push(line("stray light, total" + boundText(b), b.total.asd, {colour: "var(--ink)", width: 2.6}));
  return series;
}

// The total without the rows that are off: in each bin the sum of squares of those that are on. Routes share histories, so
// their errors add up to at most their plain sum.
function budgetWithout(b, shares, off) {
  const on = i => !off.has(b.shares.ids[i]), rest = b.shares.rest_ids, restOff = rest.filter(id => off.has(id)).length;
  const withRest = restOff < rest.length, bins = b.frequency.length, h = [], low = [], high = [];
  for (let k = 0; k < bins; ++k) {
    let power = withRest ? shares.rest[k] : 0, error = withRest ? shares.restError[k] : 0;
    for (let i = 0; i < b.shares.ids.length; ++i)
      if (on(i)) {
        power += shares.share[i * bins + k];
        error += shares.error[i * bins + k];
      }
    const total = b.total.asd[k], known = total !== null && power > 0, root = Math.sqrt(power);
    h.push(known ? total * root : null);
    low.push(known ? total * Math.max(root - error / root, 0) : null);
    high.push(known ? total * (root + error / root) : null);
  }
  const name = "stray light without " + (off.size === 1 ? "the row" : "the " + off.size + " rows") + " switched off";
  const inside = restOff > 0 && withRest ? restOff + " of the rows switched off are too faint for a curve of their own and stay in it; all that " +
      "are that faint hold at most " + digits(100 * Math.max(...shares.rest), 2) + " % of the noise power at any frequency." : "";
  return {inside, series: [{name: name + ": error at most", kind: "band", colour: "var(--bad)", opacity: 0.25, x: b.frequency, low, high},
                           {name, colour: "var(--bad)", width: 2.2, x: b.frequency, y: h}]};
}

function boundText(b) {
  const missing = b.unresolved.length;
  if (missing === 0) return b.bound ? " (upper bound)" : "";
  return b.bound ? " (contains upper bounds; " + missing + (missing === 1 ? " route" : " routes") + " unresolved)" : " (lower bound)";
}

// Returns what redraws the curves: with rows of the table switched off, and with series of other inputs.
function addBudget(b) {
  const part = section("Noise budget", "budget"), box = el("figure");
  part.append(box);
  const plot = new Plot(box, {x: {label: "frequency [Hz]", log: true}, y: {label: "strain, one-sided ASD [1/√Hz]", log: true}, series: budgetSeries(b)});
  const p = data.provenance;
  box.append(el("figcaption", {}, p.program + " " + p.version + " (" + p.commit + "), model " + p.model.slice(0, 12) + ", seed " + p.seed + ", " +
      p.histories.toLocaleString("en") + " histories, " + p.created + ". Mean over static phases. Drag to zoom, double click to see all, click a name to hide it."));
  if (b.measured.length > 0)
    box.append(el("p", {class: "note"}, "Measured: " + b.measured.map(m => m.source).join("; ") + "."));
  if (b.unresolved.length > 0)
    part.append(el("p", {}, el("span", {class: "mark"}, b.bound ? "No bound, since it contains upper bounds:" : "Lower bound:"), " the total contains the observed part of these unresolved routes, with an equal error:"), el("ul", {}, b.unresolved.map(u => el("li", {}, u))));
  const rows = () => ["frequency [Hz]", ...["mean", "sigma", "input_low", "input_high", "speckle_05", "speckle_50", "speckle_95"], ...b.design.map(d => d.name)];
  part.append(el("div", {class: "bar"}, el("button", {on: {click: () => {
    const columns = [b.frequency, b.total.asd, b.total.sigma, b.input_low, b.input_high, b.speckle_05, b.speckle_50, b.speckle_95, ...b.design.map(d => d.asd)];
    const lines = b.frequency.map((_, i) => columns.map(c => csvCell(c[i])).join(","));
    offer("budget.csv", rows().map(csvCell).join(",") + "\n" + lines.join("\n") + "\n");
  }}}, "CSV of these curves")));
  const shares = {}, left = el("p", {class: "note"});
  for (const key of ["share", "error", "rest", "restError"]) shares[key] = typedArray(Float32Array, b.shares[key]);
  box.append(left);
  let off = new Set(), other = [];
  const redraw = () => {
    const without = off.size > 0 ? budgetWithout(b, shares, off) : {inside: "", series: []};
    plot.bring(without.series.concat(other), s => s.id && off.has(s.id));
    say(left, without.inside);
  };
  return {
    switched: rows => { off = rows; redraw(); },
    whatIf: series => { other = series; redraw(); },
  };
}

function addRoutes(switched) {
  const part = section("Routes", "routes");
  part.append(el("p", {class: "note"}, "Click a row to see its paths in the scene; with Ctrl several. Click a title to sort."));
  const details = el("div");
  let light = null;
  const table = new PathTable(part, data.table, ids => {
    details.replaceChildren();
    if (light) {
      const drawn = light.showPaths(ids);
      light.stage.say(ids.length === 0 ? "" : drawn + " paths of " + ids.length + (ids.length > 1 ? " routes" : " route"));
    }
    if (data.scene) for (const id of ids) details.append(pathDetails(data.scene, id));
  }, switched);
  part.append(details);
  return {table, attach: made => { light = made; }};
}

// Returns what draws it.
function addScene(routes) {
  const part = section("Scene", "scene");
  part.append(el("p", {class: "note"}, "Turn with the left button, move with the right one, zoom with the wheel. Click a part for its name, " +
      "material and body. Light is drawn to where it truly ends."));
  return () => {
    const stage = new Stage(part, data.scene);
    window.stage = stage;
    const light = new Light(stage);
    if (!routes) return;
    routes.attach(light);
    const first = routes.table.columns.get("id")[0];
    if (routes.table.chosen.size > 0) routes.table.tell([...routes.table.chosen]);
    else if (data.scene.paths.some(p => p.id === first)) routes.table.choose(first);
  };
}

function build() {
  if (data.warnings.length > 0) {
    const note = el("p", {class: "headline"}, el("a", {href: "#warnings"}, data.warnings.length + (data.warnings.length > 1 ? " warnings" : " warning")));
    document.getElementById("page").append(note);
  }
  const curves = data.budget ? addBudget(data.budget) : null;
  if (data.what_if && curves) addWhatIf(data.what_if, data.budget, curves.whatIf);
  const routes = data.table.rows > 0 ? addRoutes(curves ? curves.switched : () => {}) : null;
  const later = data.scene ? addScene(routes) : () => {};
  if (data.maps && data.maps.length > 0) addMaps(data.maps);
  if (data.wave) addWave(data.wave);
  if (data.receivers.list.length > 0) addReceivers(data.receivers);
  if (data.ghosts) addGhosts(data.ghosts);
  addFirstOrder(data.first_order);
  if (data.materials) addMaterials(data.materials);
  addAssumptions(data.assumptions, data.inputs);
  addEnergyBalance(data.energy_balance);
  if (data.convergence) addConvergence(data.convergence);
  const warnings = section("Warnings", "warnings");
  warnings.append(data.warnings.length === 0 ? el("p", {}, "none") : el("ul", {}, data.warnings.map(w => el("li", {}, w))));
  addProvenance(data.provenance, data.libraries);
  finish(later);
}

build();
