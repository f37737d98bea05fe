// SPDX-License-Identifier: BSD-3-Clause
// Curves and bands as SVG with D3: drag to zoom, double click to see all, click a name to switch it off.
"use strict";

const plotSize = {width: 1100, height: 520, top: 14, bottom: 52};  // the width where the page has none
const lineHeight = 20;  // of labels with exponents

// Writes 10^-24 with a raised exponent. Not every font has all superscripts.
function setLabel(node, label) {
  const [base, power] = label.split("^"), text = d3.select(node).text(base);
  if (power) text.append("tspan").attr("dy", "-0.45em").style("font-size", "0.75em").text(power.replace("-", "−"));
  return node;
}

// Widths of labels in the font in use, and the widest of them.
function textWidths(svg, labels) {
  const probe = svg.append("text").attr("visibility", "hidden");
  const widths = labels.map(label => setLabel(probe.node(), label).getComputedTextLength());
  probe.remove();
  return widths;
}
const widest = (svg, texts) => Math.max(0, ...textWidths(svg, texts));

// Labels of an axis, without those that would touch another; what is `first` is placed first. rooms: px that each
// takes along the axis.
function spacedLabels(scale, {values, label}, rooms, first = () => true) {
  const kept = new Map(), apart = (a, b) => Math.abs(scale(a) - scale(b));
  const fits = (v, room) => [...kept].every(([other, taken]) => apart(v, other) >= (room + taken) / 2);
  for (const wanted of [true, false])
    values.forEach((v, i) => { if (first(v) === wanted && fits(v, rooms[i])) kept.set(v, rooms[i]); });
  return v => kept.has(v) ? label(v) : "";
}

// Draws anew when the place has got another width, for as long as the drawing is part of the page.
function whenResized(parent, svg, draw) {
  let width = parent.clientWidth;
  const hear = () => {
    if (!svg.node().isConnected) return window.removeEventListener("resize", hear);
    if (parent.clientWidth === width) return;
    width = parent.clientWidth;
    draw();
  };
  window.addEventListener("resize", hear);
}

// Evenly spaced ticks and their labels, with as many digits as distinguish neighbours.
function evenTicks(low, high, count) {
  const values = d3.ticks(low, high, count), step = values.length > 1 ? values[1] - values[0] : high - low;
  const most = Math.max(Math.abs(low), Math.abs(high)), places = Math.floor(Math.log10(most)) - Math.floor(Math.log10(step));
  return {values, label: v => tickText(Math.abs(v) < step / 2 ? 0 : v, Math.max(1, places + 1))};
}

// Decades get labels, below three decades 2 and 5 too. Where fewer than three of these are in sight: evenly spaced ones.
function logTicks(low, high, most) {
  const decades = Math.log10(high / low), every = Math.ceil(decades / most), values = [];
  for (let p = Math.floor(Math.log10(low)); p <= Math.ceil(Math.log10(high)); ++p)
    for (const m of decades < 3 ? [1, 2, 5] : [1]) {
      const v = m * Math.pow(10, p);
      if (v >= low * 0.999999 && v <= high * 1.000001 && p % every === 0) values.push(v);
    }
  return values.length < 3 ? evenTicks(low, high, 5) : {values, label: v => tickText(v, 1)};
}

const isDecade = v => Math.abs(Math.log10(v) - Math.round(Math.log10(v))) < 1e-9;

// series: {name, x, y, kind: "line" | "points", colour, width, dash, error} or {name, x, low, high, kind: "band", colour}
// shades: {from, to, name} along x. x, y: {label, log}.
class Plot {
  constructor(parent, {x, y, series, shades = [], height}) {
    this.series = series;
    this.parent = parent;
    this.tall = height || plotSize.height;
    this.axes = {x, y};
    this.off = new Set(series.filter(s => s.off).map(s => s.name));
    this.gone = () => false;
    this.shades = shades;
    this.full = {x: this.extent("x"), y: this.extent("y")};
    this.scale = {x: this.scaleOf("x"), y: this.scaleOf("y")};
    this.svg = d3.select(parent).append("svg").attr("class", "plot");
    this.clip = "clip" + Plot.count++;
    this.inside = this.svg.append("clipPath").attr("id", this.clip).append("rect");
    for (const name of ["grid", "marks", "axis"]) this[name + "Group"] = this.svg.append("g").attr("class", name);
    this.marksGroup.attr("clip-path", "url(#" + this.clip + ")");
    this.cursor = this.svg.append("line").attr("stroke", "var(--faint)").style("display", "none");
    this.brush = d3.brush().on("end", () => this.zoom());
    this.brushGroup = this.svg.append("g");
    this.brushGroup.on("mousemove", () => this.read(d3.mouse(this.svg.node())[0])).on("mouseleave", () => this.read(null))
        .on("dblclick", () => this.show(this.full.x, this.full.y));
    this.legend = el("div", {class: "legend"});
    parent.append(this.legend);
    this.drawLegend();
    this.draw();
    whenResized(parent, this.svg, () => this.draw());
  }
  // As wide as its place, with margins for the labels in the font in use. One unit is one px, so text stays readable.
  fit() {
    const width = this.parent.clientWidth || plotSize.width, {top, bottom} = plotSize;
    const height = Math.round(Math.min(this.tall, Math.max(300, 0.75 * width)));
    this.svg.attr("viewBox", [0, 0, width, height].join(" "));  // before text is measured: letters scale with it
    this.scale.y.range([height - bottom, top]);
    const y = this.ticks("y"), x = this.ticks("x");
    const left = 36 + widest(this.svg, y.values.map(y.label)), widths = textWidths(this.svg, x.values.map(x.label));
    const right = Math.max(18, 2 + Math.max(0, ...widths) / 2);
    this.scale.x.range([left, width - right]);
    x.label = this.readableLabels(x, widths.map(w => w + 6));
    y.label = spacedLabels(this.scale.y, y, y.values.map(() => lineHeight), v => !this.axes.y.log || isDecade(v));
    this.size = {width, height, left, right, top, bottom};
    this.inside.attr("x", left).attr("y", top).attr("width", width - left - right)
        .attr("height", height - top - bottom);
    this.cursor.attr("y1", top).attr("y2", height - bottom);
    this.brushGroup.call(this.brush.extent([[left, top], [width - right, height - bottom]]));
    return {x, y};
  }
  // Of the labels that would touch another some go, but never all but one: then the two at the ends are left.
  readableLabels(x, rooms) {
    const label = spacedLabels(this.scale.x, x, rooms, v => !this.axes.x.log || isDecade(v));
    if (x.values.filter(v => label(v)).length > 1) return label;
    return v => v === x.values[0] || v === x.values[x.values.length - 1] ? x.label(v) : "";
  }
  extent(axis) {
    if (this.axes[axis].range) return this.axes[axis].range;
    const all = [], log = this.axes[axis].log;
    for (const s of this.series) {
      if (s.aside || s.kind === "band" && axis === "y") continue;
      for (const v of s[axis]) if (v !== null && (!log || v > 0)) all.push(v);
      if (axis === "y" && s.error) s.error.forEach((e, i) => all.push((s.y[i] || 0) + e));
    }
    let [low, high] = d3.extent(all);
    if (low === undefined) [low, high] = [log ? 0.1 : 0, 1];
    const points = this.series.some(s => s.kind === "points"), room = (points ? 0.03 : 0) * (high - low);
    if (!log && axis === "y") return [Math.min(low, 0), high + 0.05 * (high - low || 1)];
    if (!log) return low < high ? [low - room, high + room] : [low - Math.max(1, Math.abs(low)) / 2, low + Math.max(1, Math.abs(low)) / 2];
    if (axis === "x") return low < high ? [low, high] : [low / 2, high * 2];
    // Nine decades unless requested otherwise, more where a curve would be out of sight.
    const tops = this.series.filter(s => !s.aside && s.kind !== "band").map(s => d3.max(s.y, v => v === null ? 0 : v));
    const floor = Math.min(high * Math.pow(10, -(this.axes[axis].decades || 9)), d3.min(tops.filter(v => v > 0)) * 1e-2);
    return [Math.max(low / 2, floor), high * 3];
  }
  scaleOf(axis) { return (this.axes[axis].log ? d3.scaleLog() : d3.scaleLinear()).domain(this.full[axis]); }
  show(x, y) {
    this.scale.x.domain(x);
    this.scale.y.domain(y);
    this.draw();
  }
  zoom() {
    const box = d3.event.selection;
    if (!box) return;
    this.brushGroup.call(this.brush.move, null);
    const [[x0, y0], [x1, y1]] = box;
    const finest = 1e-6, fine = (a, b) => Math.abs(b - a) > finest * Math.max(Math.abs(a), Math.abs(b));
    const {x, y} = this.scale;
    if (x1 - x0 > 8 && y1 - y0 > 8 && fine(x.invert(x0), x.invert(x1)) && fine(y.invert(y0), y.invert(y1)))
      this.show([this.scale.x.invert(x0), this.scale.x.invert(x1)], [this.scale.y.invert(y1), this.scale.y.invert(y0)]);
  }
  ticks(axis) {
    const [low, high] = this.scale[axis].domain();
    return this.axes[axis].log ? logTicks(low, high, axis === "y" ? 10 : 12) : evenTicks(low, high, axis === "x" ? 9 : 7);
  }
  drawAxes() {
    const {x: tx, y: ty} = this.fit(), {width, height, left, right, top, bottom} = this.size;
    this.axisGroup.selectAll("*").remove();
    this.gridGroup.selectAll("*").remove();
    const add = (axis, place, length, t) => {
      this.gridGroup.append("g").attr("transform", place)
          .call(axis.tickValues(t.values).tickSize(length).tickFormat("")).select(".domain").remove();
      this.axisGroup.append("g").attr("transform", place).call(axis.tickSize(5).tickFormat(t.label))
          .selectAll("text").each(function () { setLabel(this, this.textContent); });
    };
    const below = d3.axisBottom(this.scale.x).tickPadding(6);
    add(below, "translate(0," + (height - bottom) + ")", top + bottom - height, tx);
    add(d3.axisLeft(this.scale.y), "translate(" + left + ",0)", left + right - width, ty);
    const label = this.axisGroup.append("text").attr("text-anchor", "middle").attr("font-size", 14);
    label.attr("x", (left + width - right) / 2).attr("y", height - 10).text(this.axes.x.label);
    this.axisGroup.append("text").attr("text-anchor", "middle")
        .attr("transform", "translate(20," + (top + height - bottom) / 2 + ") rotate(-90)").text(this.axes.y.label);
  }
  good(v, axis) { return v !== null && v !== undefined && (!this.axes[axis].log || v > 0); }
  draw() {
    this.drawAxes();
    const g = this.marksGroup, {x, y} = this.scale;
    g.selectAll("*").remove();
    for (const s of this.shades) {
      const [a, b] = [x(Math.max(s.from, x.domain()[0])), x(Math.min(s.to, x.domain()[1]))];
      if (b > a) g.append("rect").attr("x", a).attr("width", b - a).attr("y", 0).attr("height", this.size.height)
          .attr("fill", "var(--unknown)").append("title").text(s.name);
    }
    for (const s of this.series) {
      if (this.off.has(s.name) || this.gone(s)) continue;
      if (s.kind === "band") this.drawBand(g, s);
      else if (s.kind === "points") this.drawPoints(g, s);
      else this.drawLine(g, s);
    }
  }
  // A value between two that are not known is a dot: a line of one point would not be seen.
  drawLine(g, s) {
    const {x, y} = this.scale, known = s.x.map((v, i) => this.good(s.y[i], "y") && this.good(v, "x"));
    g.append("path").attr("fill", "none").attr("stroke", s.colour).attr("stroke-width", s.width || 1.6)
        .attr("stroke-dasharray", s.dash || null)
        .attr("d", d3.line().defined((_, i) => known[i]).x((_, i) => x(s.x[i])).y((_, i) => y(s.y[i]))(s.x));
    known.forEach((here, i) => {
      if (here && !known[i - 1] && !known[i + 1])
        g.append("circle").attr("cx", x(s.x[i])).attr("cy", y(s.y[i])).attr("r", 1.5 + (s.width || 1.6)).attr("fill", s.colour);
    });
  }
  // Series shown with the others until the next call; those that are `gone` are not drawn.
  bring(series, gone) {
    const all = axis => this.scale[axis].domain().every((v, i) => v === this.full[axis][i]);
    const whole = all("x") && all("y");
    this.series = this.series.filter(s => !s.brought).concat(series.map(s => ({...s, brought: true})));
    this.gone = gone;
    this.full = {x: this.extent("x"), y: this.extent("y")};
    this.drawLegend();
    if (whole) this.show(this.full.x, this.full.y);
    else this.draw();
  }
  drawBand(g, s) {
    const {x, y} = this.scale, floor = y.domain()[0] / 10;
    const at = v => y(this.axes.y.log ? Math.max(v, floor) : v);
    const known = s.x.map((_, i) => this.good(s.high[i], "y") && s.low[i] !== null);
    known.forEach((here, i) => {
      if (here && !known[i - 1] && !known[i + 1])
        g.append("line").attr("x1", x(s.x[i])).attr("x2", x(s.x[i])).attr("y1", at(s.low[i])).attr("y2", at(s.high[i]))
            .attr("stroke", s.colour).attr("stroke-width", 8).attr("opacity", s.opacity || 0.25);
    });
    g.append("path").attr("fill", s.colour).attr("opacity", s.opacity || 0.25)
        .attr("d", d3.area().defined((_, i) => known[i])
            .x((_, i) => x(s.x[i])).y0((_, i) => at(s.low[i])).y1((_, i) => at(s.high[i]))(s.x));
  }
  drawPoints(g, s) {
    for (let i = 0; i < s.x.length; ++i) {
      if (!this.good(s.y[i], "y") || !this.good(s.x[i], "x")) continue;
      if (s.error) this.drawError(g, s, i);
      g.append("circle").attr("cx", this.scale.x(s.x[i])).attr("cy", this.scale.y(s.y[i])).attr("r", s.width || 3.4)
          .attr("fill", s.hollow ? "var(--paper)" : s.colour).attr("stroke", s.colour);
    }
  }
  drawError(g, s, i) {
    const at = this.scale.x(s.x[i]), low = s.y[i] - s.error[i], {y} = this.scale;
    g.append("line").attr("class", "error").attr("x1", at).attr("x2", at).attr("stroke", s.colour)
        .attr("y1", y(this.axes.y.log ? Math.max(low, y.domain()[0] / 10) : low)).attr("y2", y(s.y[i] + s.error[i]));
  }
  drawLegend() {
    this.legend.replaceChildren(...this.series.map(s => {
      const sign = d3.create("svg").attr("width", 26).attr("height", 12);
      if (s.kind === "band") sign.append("rect").attr("width", 26).attr("height", 12).attr("fill", s.colour)
          .attr("opacity", s.opacity || 0.25);
      else if (s.kind === "points") sign.append("circle").attr("cx", 13).attr("cy", 6).attr("r", 4).attr("fill", s.colour);
      else sign.append("line").attr("x2", 26).attr("y1", 6).attr("y2", 6).attr("stroke", s.colour)
          .attr("stroke-width", s.width || 1.6).attr("stroke-dasharray", s.dash || null);
      s.reading = el("b");
      const entry = el("span", {class: this.off.has(s.name) || this.gone(s) ? "off" : null, title: s.name,
                                on: {click: () => this.toggle(s)}}, sign.node(), s.name, s.reading);
      return entry;
    }));
  }
  toggle(s) {
    if (!this.off.delete(s.name)) this.off.add(s.name);
    this.drawLegend();
    this.draw();
  }
  // Values of the curves below the pointer.
  read(px) {
    const {left, right, width} = this.size, inside = px !== null && px >= left && px <= width - right;
    this.cursor.attr("x1", px).attr("x2", px).style("display", inside ? "" : "none");
    const at = inside ? this.scale.x.invert(px) : null;
    for (const s of this.series) {
      if (!inside || s.kind === "band" || (s.kind && !s.error)) { s.reading.textContent = ""; continue; }
      const i = s.kind ? d3.scan(s.x, (a, b) => Math.abs(a - at) - Math.abs(b - at)) : Math.min(d3.bisectLeft(s.x, at), s.x.length - 1);
      s.reading.textContent = !this.good(s.y[i], "y") ? "" : s.error ? withError(s.y[i], s.error[i]) : digits(s.y[i]);
    }
  }
}
Plot.count = 0;
