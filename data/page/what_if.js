// SPDX-License-Identifier: BSD-3-Clause
// The noise with other strengths of BSDFs and other motion of one body, from the terms that the program stored
// (src/session/decide/what_if.hpp; docs/theory/decisions.md, eq. D.8 to D.11).
"use strict";

// The stored arrays, unpacked. All PSDs are over that of the total as traced.
class WhatIf {
  constructor(w) {
    this.w = w;
    this.terms = w.exponents.length;
    this.bins = w.band.length;
    this.shares = typedArray(Float32Array, w.shares);
    this.deviations = typedArray(Float32Array, w.deviations);
    this.replicas = this.deviations.length / this.terms;
    this.moved = w.moved.map(m => m.factors.length === 0 ? typedArray(Float32Array, m.rest) : typedArray(Int16Array, m.logarithms));
  }
  // Factor of each term, of the factors of the materials.
  factors(strengths) {
    return this.w.exponents.map(n => n.reduce((f, power, m) => power === 0 ? f : f * Math.pow(strengths[m], power), 1));
  }
  // Of a term in a bin: its PSD with the motion of the body of the setting over that as traced.
  ratio(setting, term, bin) {
    if (setting.body < 0) return 1;
    const {factors, of_term} = this.w.moved[setting.body], held = this.moved[setting.body], group = of_term[term];
    if (factors.length === 0) {
      const rest = held[group * this.bins + bin];
      return rest + setting.factor * setting.factor * (1 - rest);
    }
    return Math.exp(held[(group * factors.length + factors.indexOf(setting.factor)) * this.bins + bin] / 1000);
  }
  // Setting: {strengths: [..] of the materials, body: its number or -1, factor: of its motion}. Per bin the PSD over that as
  // traced, and one standard error of h, relative.
  curve(setting) {
    const {terms, bins, replicas} = this, f = this.factors(setting.strengths), psd = [], error = [];
    for (let i = 0; i < bins; ++i) {
      const off = new Float64Array(replicas);
      let sum = 0;
      for (let v = 0; v < terms; ++v) {
        if (f[v] === 0) continue;
        const own = f[v] * this.shares[v * bins + i] * this.ratio(setting, v, i);
        sum += own;
        for (let r = 0; r < replicas; ++r) off[r] += own * this.deviations[v * replicas + r];
      }
      psd.push(sum);
      error.push(sum > 0 ? Math.hypot(0.5 * Math.sqrt(off.reduce((s, d) => s + d * d, 0)) / sum * this.w.error_factor[i], this.w.error_kept[i]) : 0);
    }
    return {psd, error};
  }
  // What the program reads at a frequency of the table off values per bin: between two centres, in logarithms.
  at(place, value) {
    const {bin, next} = place, low = value(bin), high = next === 0 ? low : value(bin + 1);
    return low > 0 && high > 0 ? Math.exp((1 - next) * Math.log(low) + next * Math.log(high)) : low;
  }
  // Of a term in each place: the frequencies of the table, then its band.
  ratios(setting, term) {
    let above = 0, below = 0;
    this.w.band.forEach((weight, i) => {
      const share = (weight || 0) * this.shares[term * this.bins + i];
      above += share * this.ratio(setting, term, i);
      below += share;
    });
    return [...this.w.bins.map(place => place === null ? 1 : this.at(place, bin => this.ratio(setting, term, bin))), below > 0 ? above / below : 1];
  }
  // Of each row in each place the PSD over that of the total as traced.
  rows(setting) {
    const f = this.factors(setting.strengths), places = this.w.bins.length + 1, moved = this.w.exponents.map(() => null);
    return this.w.rows.map(row => {
      const out = {before: new Array(places).fill(0), now: new Array(places).fill(0)};
      row.terms.forEach((v, part) => {
        moved[v] = moved[v] || this.ratios(setting, v);
        for (let p = 0; p < places; ++p) {
          out.before[p] += row.shares[part * places + p];
          out.now[p] += f[v] * row.shares[part * places + p] * moved[v][p];
        }
      });
      return out;
    });
  }
  // Of the whole noise in the same places.
  total(curve) {
    const band = this.w.band.reduce((s, weight, i) => s + (weight || 0) * curve.psd[i], 0);
    return [...this.w.bins.map(place => place === null ? null : this.at(place, bin => curve.psd[bin])), band];
  }
}

// Three digits, never above x: a command with the result must not be rejected.
function roundedDown(x) {
  const unit = Math.pow(10, Math.floor(Math.log10(x)) - 2);
  return Number((Math.floor(x / unit * (1 + 1e-12)) * unit).toPrecision(3));
}

// "--set steel=x0.5 --set tube.motion=x2"; empty: all as traced.
function settingWords(w, setting) {
  const factor = x => String(Number(x.toPrecision(3)));
  const words = w.materials.map((m, i) => setting.strengths[i] === 1 ? "" : "--set '" + m.name + "=" + (setting.strengths[i] === 0 ? "black" : "x" + factor(setting.strengths[i])) + "'");
  if (setting.body >= 0 && setting.factor !== 1) words.push("--set '" + w.moved[setting.body].name + ".motion=x" + factor(setting.factor) + "'");
  return words.filter(Boolean).join(" ");
}

// Draws the sliders. `show`: gets the series to draw over the curves.
function addWhatIf(w, b, show) {
  const part = section("What if", "what-if");
  if (w.none) {
    part.append(el("p", {class: "note"}, w.none));
    return;
  }
  const state = new WhatIf(w), resets = [];
  const setting = {strengths: w.materials.map(() => 1), body: -1, factor: 1};
  part.append(el("p", {class: "note"}, "Without a trace: the BSDF of a material times a factor, exact for every named route; the motion of one body times a factor. " +
      "The light keeps its way."));
  const result = el("p", {"aria-live": "polite"}), rows = el("div"), command = el("code"), box = el("div", {class: "sliders"});
  const three = x => Number(x.toPrecision(3));

  // `steps`: the only factors, whose numbers are the values of the slider; otherwise these are logarithms of the factor.
  function slider(name, low, most, change, {black = false, steps = []} = {}) {
    const high = Math.log10(most);
    const stepped = steps.length > 0, start = stepped ? steps.indexOf(1) : 0;
    const shown = el("output");
    const range = el("input", {type: "range", min: stepped ? 0 : low, max: stepped ? steps.length - 1 : high, step: stepped ? 1 : 0.01, value: start, "aria-label": name + ": factor"});
    const dark = black ? el("input", {type: "checkbox", "aria-label": name + " black"}) : null;
    const value = () => dark && dark.checked ? 0 : stepped ? steps[Number(range.value)] : Number(range.value) === 0 ? 1 : Math.min(three(Math.pow(10, Number(range.value))), most);
    const show = x => {
      shown.textContent = x === 0 ? "black" : "× " + digits(x);
      range.setAttribute("aria-valuetext", shown.textContent);
    };
    show(1);
    const moved = () => {
      range.disabled = Boolean(dark && dark.checked);
      const now = value();
      show(now);
      change(now);
    };
    range.addEventListener("input", moved);
    if (dark) dark.addEventListener("change", moved);
    const reset = () => {
      range.value = start;
      range.disabled = false;
      if (dark) dark.checked = false;
      show(1);
    };
    resets.push(reset);
    box.append(el("label", {}, name), range, shown, dark ? el("label", {class: "dark"}, dark, " black") : el("span"));
    return reset;
  }

  w.materials.forEach((m, i) => slider(m.name, -2, roundedDown(m.most === null ? 100 : Math.min(Math.max(m.most, 1), 100)),
                                       factor => { setting.strengths[i] = factor; draw(); }, {black: true}));
  const bodies = [];
  w.moved.forEach((m, i) => bodies.push(slider("motion of " + m.name, -Math.log10(4), 4, factor => {
    bodies.forEach((reset, other) => { if (other !== i) reset(); });
    setting.body = factor === 1 ? -1 : i;
    setting.factor = factor;
    draw();
  }, {steps: m.factors})));

  function draw() {
    const words = settingWords(w, setting);
    if (words === "") {
      show([]);
      result.replaceChildren("All as traced.");
      command.textContent = "";
      rows.replaceChildren();
      return;
    }
    const curve = state.curve(setting), total = state.total(curve), none = curve.psd.every(x => x === 0);
    const h = b.total.asd.map((v, i) => v === null || curve.psd[i] === 0 ? null : v * Math.sqrt(curve.psd[i]));
    show([{name: "what if: ± 1σ", kind: "band", colour: "var(--red)", opacity: 0.3, x: b.frequency, low: h.map((v, i) => v === null ? null : v * Math.max(0, 1 - curve.error[i])),
           high: h.map((v, i) => v === null ? null : v * (1 + curve.error[i]))},
          {name: "what if: stray light, total" + boundText(b), colour: "var(--red)", width: 2.4, x: b.frequency, y: h}]);
    const at = w.frequencies.map((hz, k) => total[k] === null ? "" : (total[k] > 0 ? "× " + digits(Math.sqrt(total[k])) : "dark") + " at " + digits(hz) + " Hz").filter(Boolean);
    result.replaceChildren(none ? "No light is left on the paths that were found: h is below what this run can see." : "h is " + at.join(", ") + ".");
    if (setting.body >= 0 && w.moved[setting.body].factors.length > 0)
      result.append(" Fringes wrap: spectra stored for each step.");
    command.textContent = "straytrace noise RUN.h5 " + words;
    drawRows(total);
  }
  function drawRows(total) {
    const places = w.bins.length, list = state.rows(setting).map((row, k) => ({row, name: w.rows[k].name})).filter(({row}) => row.before[places] > 0);
    const share = (x, whole) => !(x > 0 && whole > 0) ? "–" : x < 1e-4 * whole ? "< 0.01 %" : digits(100 * x / whole, 2) + " %";
    const factor = (r, p) => r.before[p] > 0 ? r.now[p] === 0 ? "dark" : "× " + digits(Math.sqrt(r.now[p] / r.before[p])) : "–";
    list.sort((x, y) => y.row.now[places] - x.row.now[places]);
    rows.replaceChildren(simpleTable(["path", "share as traced", "share now", ...w.frequencies.map(hz => "h at " + digits(hz) + " Hz")],
        list.map(({row, name}) => [name, share(row.before[places], 1), share(row.now[places], total[places]), ...w.frequencies.map((_, p) => factor(row, p))]), [0]));
  }
  const copy = el("button", {on: {click: () => navigator.clipboard && command.textContent && navigator.clipboard.writeText(command.textContent)}}, "copy the command");
  const back = el("button", {on: {click: () => {
    resets.forEach(reset => reset());
    setting.strengths.fill(1);
    setting.body = -1;
    setting.factor = 1;
    draw();
  }}}, "all as traced");
  part.append(box, el("div", {class: "bar"}, back, copy), result, el("p", {}, command), rows);
  const notes = [w.moved.length > 1 ? "One body at a time: straytrace noise RUN.h5 --set moves several." : "",
                 "Error band: the replicas of the trace, averaged over frequency for each term; as traced it is that of the run.",
                 w.moved.length > 0 ? "Motion is exact to 0.2 % of h while the materials are near what was traced. Paths that make less than 0.1 % of the noise " +
                   "as traced follow the others: where a material that makes most of it is black, ask straytrace noise RUN.h5 --set. Bodies that change h by less than 0.1 % have no slider." : "",
                 w.unnamed > 1e-3 ? "Routes without a name carry up to " + digits(100 * w.unnamed, 2) + " % of the noise power: how often their light scatters is not known, and they follow the named routes of their row." : "",
                 ...w.left_out.map(what => "No slider for " + what + ".")];
  part.append(el("ul", {class: "note"}, notes.filter(Boolean).map(text => el("li", {}, text))));
  draw();
}
