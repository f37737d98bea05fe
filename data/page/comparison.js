// SPDX-License-Identifier: BSD-3-Clause
// Several runs side by side, each against the first. The program made all numbers and their words.
"use strict";

const runColour = i => colours[i % colours.length], runDashes = [null, "9 4", "3 3", "12 3 3 3"];
const runDash = i => runDashes[Math.floor(i / colours.length) % runDashes.length] || null;

function addCurves(runs) {
  const part = section("Noise", "noise"), box = el("figure"), series = [];
  part.append(box);
  const name = r => r.label + (r.bound ? " (" + r.bound + ")" : "");
  runs.forEach((r, i) => series.push({name: name(r) + ", ± 1σ", kind: "band", colour: runColour(i), opacity: 0.3, x: r.frequency, low: r.low, high: r.high}));
  const known = new Set();
  for (const r of runs)
    for (const d of r.design) {
      if (known.has(d.name)) continue;
      known.add(d.name);
      series.push({name: d.name, colour: "var(--grey)", width: 2, dash: "9 4", x: r.frequency, y: d.asd});
    }
  runs.forEach((r, i) => series.push({name: name(r), colour: runColour(i), dash: runDash(i), width: 2, x: r.frequency, y: r.asd}));
  new Plot(box, {x: {label: "frequency [Hz]", log: true}, y: {label: "strain, one-sided ASD [1/√Hz]", log: true}, series});
  box.append(el("figcaption", {}, "Totals with one Monte-Carlo standard error. Drag to zoom, double click to see all, click a name to hide it."));
  for (const r of runs)
    if (r.unresolved.length > 0)
      part.append(el("p", {}, el("span", {class: "mark"}, r.label + ":"), " these routes are unresolved; the total contains their observed part, with an equal error:"),
                  el("ul", {}, r.unresolved.map(u => el("li", {}, u))));
}

// One line at 1, and the ratio of each run with its error; logarithmic where ratios differ by more than ten.
function addRatios(runs, pairs) {
  const part = section("Ratio", "ratio"), box = el("figure"), series = [], first = pairs[0].ratio.frequency;
  part.append(box);
  const values = pairs.flatMap(p => p.ratio.value).filter(v => v > 0), log = Math.max(...values) > 10 * Math.min(...values);
  for (const p of pairs) {
    const {frequency, value, low, high} = p.ratio, colour = runColour(p.after), name = runs[p.after].label;
    series.push({name: name + ", ± 1σ", kind: "band", colour, opacity: 0.3, x: frequency, low, high},
                {name, colour, dash: runDash(p.after), width: 2, x: frequency, y: value});
  }
  series.push({name: runs[0].label, colour: runColour(0), width: 1.4, dash: "2 3", x: first, y: first.map(() => 1)});
  const sides = pairs.flatMap(p => [p.ratio.low, p.ratio.high]).flat().filter(v => v !== null);
  const lowest = Math.min(0.98, ...sides), highest = Math.max(1.02, ...sides), room = 0.05 * (highest - lowest);
  const range = log || sides.length === 0 ? undefined : [lowest - room, highest + room];  // off the frame
  new Plot(box, {height: 380, x: {label: "frequency [Hz]", log: true}, y: {label: "h / h of " + runs[0].label, log, range}, series});
  box.append(el("figcaption", {}, "Ratio of the totals with one standard error."));
  for (const p of pairs) part.append(el("p", {class: "note"}, runs[p.after].label + ": " + p.error + "."));
}

// A heading for each pair where there are several.
function addPairs(title, id, runs, pairs, fill) {
  if (pairs.length === 0) return;
  const part = section(title, id);
  for (const pair of pairs) {
    if (runs.length > 2) part.append(el("h3", {}, runs[pair.after].label + " against " + runs[0].label));
    part.append(...fill(pair));
  }
}

function routesOf(pair) {
  const notes = [pair.more > 0 ? pair.more + " more have smaller changes" : "", pair.still > 0 ? pair.still + " are still in both runs" : ""].filter(Boolean);
  return [listedTable(pair.routes), notes.length > 0 ? el("p", {class: "note"}, "Not listed: " + notes.join("; ") + ". straytrace diff --format json has all.") : ""];
}

function modelsOf(pair) {
  return [pair.models.rows.length > 0 ? listedTable(pair.models) : el("p", {}, "no physical difference between the models"),
          pair.motion ? el("p", {}, pair.motion) : ""];
}

function addRuns(runs) {
  const part = section("Runs", "runs"), all = runs.map(r => r.provenance);
  const row = (name, of) => [name, ...all.map(of)];
  part.append(simpleTable(["", ...runs.map(r => r.label)],
      [row("program", p => p.program + " " + p.version + " (" + p.commit + ")"), row("created", p => p.created), row("model", p => p.model.slice(0, 12)),
       row("seed", p => p.seed), row("histories", p => p.histories.toLocaleString("en")), row("complete", p => p.complete ? "yes" : "no: a checkpoint"),
       row("interferometer", p => p.interferometer), row("parameters", p => p.parameters.join(", ") || "as in the scene"),
       row("motion or responses from", p => p.replaced_by || "the scene")], [0, ...runs.map((_, i) => i + 1)]));
  for (const r of runs)
    if (r.warnings.length > 0)
      part.append(el("h3", {}, "Warnings of " + r.label), el("ul", {}, r.warnings.map(w => el("li", {}, w))));
  part.append(el("p", {class: "note"}, "This file needs no network and sends nothing. It carries " + Object.values(data.libraries).join("; ") + "."));
}

function build({runs, pairs}) {
  addCurves(runs);
  addRatios(runs, pairs);
  addPairs("Bands", "bands", runs, pairs, pair => [listedTable(pair.bands)]);
  addPairs("Routes", "routes", runs, pairs, routesOf);
  addPairs("Receivers", "receivers", runs, pairs.filter(pair => pair.receivers.rows.length > 0), pair => [listedTable(pair.receivers)]);
  addPairs("Models", "models", runs, pairs, modelsOf);
  addRuns(runs);
  finish();
}

build(data);
