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

const isDecade = v => Math.abs(Math.log10(v) - Math.round(Math.log10(v))) < 1e-9;

// series: {name, x, y, kind: "line" | "points", colour, width, dash} or {name, x, low, high, kind: "band", colour}
// shades: {from, to, name} along x. x, y: {label, log}.
class Plot {
  constructor(parent, {x, y, series, shades = [], height}) {
    this.series = series;
    this.parent = parent;
    this.tall = height || plotSize.height;
    this.axes = {x, y};
    this.off = new Set(series.filter(s => s.off).map(s => s.name));
    this.shades = shades;
    this.full = {x: this.extent("x"), y: this.extent("y")};
    this.scale = {x: this.scaleOf("x"), y: this.scaleOf("y")};
    this.svg = d3.select(parent).append("svg").attr("class", "plot");
    this.clip = "clip" + Plot.count++;
    this.inside = this.svg.append("clipPath").attr("id", this.clip).append("rect");
    for (const name of ["grid", "marks", "axis"]) this[name + "Group"] = this.svg.append("g").attr("class", name);
    this.marksGroup.attr("clip-path", "url(#" + this.clip + ")");
    this.cursor = this.svg.append("line").attr("stroke", "#999").style("display", "none");
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
    x.label = spacedLabels(this.scale.x, x, widths.map(w => w + 6), v => !this.axes.x.log || isDecade(v));
    y.label = spacedLabels(this.scale.y, y, y.values.map(() => lineHeight), v => !this.axes.y.log || isDecade(v));
    this.size = {width, height, left, right, top, bottom};
    this.inside.attr("x", left).attr("y", top).attr("width", width - left - right)
        .attr("height", height - top - bottom);
    this.cursor.attr("y1", top).attr("y2", height - bottom);
    this.brushGroup.call(this.brush.extent([[left, top], [width - right, height - bottom]]));
    return {x, y};
  }
  extent(axis) {
    if (this.axes[axis].range) return this.axes[axis].range;
    const all = [], log = this.axes[axis].log;
    for (const s of this.series) {
      if (s.aside || s.kind === "band" && axis === "y") continue;
      for (const v of s[axis]) if (v !== null && (!log || v > 0)) all.push(v);
    }
    let [low, high] = d3.extent(all);
    if (low === undefined) [low, high] = [log ? 0.1 : 0, 1];
    if (!log) return axis === "y" ? [Math.min(low, 0), high + 0.05 * (high - low || 1)] : [low, high];
    if (axis === "x") return low < high ? [low, high] : [low / 2, high * 2];
    // Nine decades, and more where a curve would otherwise be out of sight.
    const tops = this.series.filter(s => !s.aside && s.kind !== "band").map(s => d3.max(s.y, v => v === null ? 0 : v));
    const floor = Math.min(high * 1e-9, d3.min(tops.filter(v => v > 0)) * 1e-2);
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
    if (x1 - x0 > 8 && y1 - y0 > 8)
      this.show([this.scale.x.invert(x0), this.scale.x.invert(x1)], [this.scale.y.invert(y1), this.scale.y.invert(y0)]);
  }
  // Decades get labels, and 2 and 5 where there is room.
  ticks(axis) {
    const scale = this.scale[axis];
    if (!this.axes[axis].log) return {values: scale.ticks(axis === "x" ? 9 : 7), label: v => digits(v, 4)};
    const [low, high] = scale.domain(), decades = Math.log10(high / low), all = [];
    const every = axis === "y" ? Math.ceil(decades / 10) : Math.ceil(decades / 12);
    for (let p = Math.floor(Math.log10(low)); p <= Math.ceil(Math.log10(high)); ++p)
      for (const m of decades < 3 ? [1, 2, 5] : [1]) {
        const v = m * Math.pow(10, p);
        if (v >= low * 0.999999 && v <= high * 1.000001 && p % every === 0) all.push(v);
      }
    const plain = v => isDecade(v) ? powerOfTen(v) : digits(v, 2);
    return {values: all, label: plain};
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
          .attr("fill", "#e2e2e2").append("title").text(s.name);
    }
    for (const s of this.series) {
      if (this.off.has(s.name)) continue;
      if (s.kind === "band") this.drawBand(g, s);
      else if (s.kind === "points") this.drawPoints(g, s);
      else
        g.append("path").attr("fill", "none").attr("stroke", s.colour).attr("stroke-width", s.width || 1.6)
            .attr("stroke-dasharray", s.dash || null)
            .attr("d", d3.line().defined((_, i) => this.good(s.y[i], "y") && this.good(s.x[i], "x"))
                .x((_, i) => x(s.x[i])).y((_, i) => y(s.y[i]))(s.x));
    }
  }
  drawBand(g, s) {
    const {x, y} = this.scale, floor = y.domain()[0] / 10;
    const at = v => y(this.axes.y.log ? Math.max(v, floor) : v);
    g.append("path").attr("fill", s.colour).attr("opacity", s.opacity || 0.25)
        .attr("d", d3.area().defined((_, i) => this.good(s.high[i], "y") && s.low[i] !== null)
            .x((_, i) => x(s.x[i])).y0((_, i) => at(s.low[i])).y1((_, i) => at(s.high[i]))(s.x));
  }
  drawPoints(g, s) {
    for (let i = 0; i < s.x.length; ++i) {
      if (!this.good(s.y[i], "y") || !this.good(s.x[i], "x")) continue;
      g.append("circle").attr("cx", this.scale.x(s.x[i])).attr("cy", this.scale.y(s.y[i])).attr("r", s.width || 3.4)
          .attr("fill", s.hollow ? "#fff" : s.colour).attr("stroke", s.colour);
    }
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
      const entry = el("span", {class: this.off.has(s.name) ? "off" : null, title: s.name,
                                on: {click: () => this.toggle(s)}}, sign.node(), s.name, s.reading);
      return entry;
    }));
  }
  toggle(s) {
    if (!this.off.delete(s.name)) this.off.add(s.name);
    this.drawLegend();
    this.draw();
  }
  // What the curves say below the pointer.
  read(px) {
    const {left, right, width} = this.size, inside = px !== null && px >= left && px <= width - right;
    this.cursor.attr("x1", px).attr("x2", px).style("display", inside ? "" : "none");
    const at = inside ? this.scale.x.invert(px) : null;
    for (const s of this.series) {
      if (!inside || s.kind) { s.reading.textContent = ""; continue; }
      const i = Math.min(d3.bisectLeft(s.x, at), s.x.length - 1);
      s.reading.textContent = this.good(s.y[i], "y") ? digits(s.y[i]) : "";
    }
  }
}
Plot.count = 0;

// values by rows from the lowest; null: nothing known. `pale(i)`: too few to be trusted.
function heatMap(parent, map) {
  const svg = d3.select(parent).append("svg").attr("class", "plot");
  const draw = () => drawHeat(svg, parent.clientWidth, map);
  draw();
  whenResized(parent, svg, draw);
}

function drawHeat(svg, room, {columns, rows, x, y, values, unit, xLabel, yLabel, pale = () => false, tell}) {
  const width = Math.max(300, Math.min(620, room || 460));
  const size = tall => svg.attr("viewBox", "0 0 " + width + " " + tall);
  svg.selectAll("*").remove();
  size(width);  // before text is measured: letters scale with it
  const known = values.filter(v => v > 0), [least, most] = d3.extent(known);
  const floor = Math.max(least || 1, (most || 1) * 1e-4);
  const colour = v => d3.interpolateViridis(most > floor ? Math.max(0, Math.log(v / floor) / Math.log(most / floor)) : 1);
  const canvas = el("canvas", {width: columns, height: rows}), context = canvas.getContext("2d");
  values.forEach((v, i) => {
    if (!(v > 0)) return;
    context.globalAlpha = pale(i) ? 0.45 : 1;
    context.fillStyle = colour(v);
    context.fillRect(i % columns, rows - 1 - Math.floor(i / columns), 1, 1);
  });
  const sx = d3.scaleLinear().domain(x), sy = d3.scaleLinear().domain(y);
  const sv = d3.scaleLog().domain([floor, Math.max(most || 0, floor * 1.01)]);
  const tv = {values: sv.ticks(4), label: sv.tickFormat(4, v => digits(v, 1))};
  const left = 30 + widest(svg, sy.ticks(6).map(sy.tickFormat(6)));
  const beside = most > 0 ? widest(svg, tv.values.map(tv.label)) : 0;
  const right = Math.max(72, 36 + beside, 8 + widest(svg, ["[" + unit + "]"]));
  const top = 12, side = width - left - right, tall = side;
  size(tall + 66);
  sx.range([left, left + side]);
  sy.range([top + tall, top]);
  sv.range([top + tall, top]);
  svg.append("rect").attr("x", left).attr("y", top).attr("width", side).attr("height", tall).attr("fill", "#f0f0f0");
  svg.append("image").attr("x", left).attr("y", top).attr("width", side).attr("height", tall)
      .attr("preserveAspectRatio", "none").attr("style", "image-rendering: pixelated").attr("href", canvas.toDataURL())
      .on("mousemove", function () {
        const [px, py] = d3.mouse(svg.node());
        const i = Math.floor((py - top) / tall * rows), k = Math.floor((px - left) / side * columns);
        tell((rows - 1 - i) * columns + k);
      }).on("mouseleave", () => tell(null));
  const axis = svg.append("g").attr("class", "axis"), tx = {values: sx.ticks(5), label: sx.tickFormat(5)};
  const rooms = textWidths(svg, tx.values.map(tx.label)).map(w => w + 6);
  axis.append("g").attr("transform", "translate(0," + (top + tall) + ")")
      .call(d3.axisBottom(sx).tickValues(tx.values).tickFormat(spacedLabels(sx, tx, rooms)));
  axis.append("g").attr("transform", "translate(" + left + ",0)").call(d3.axisLeft(sy).ticks(6));
  axis.append("text").attr("x", left + side / 2).attr("y", top + tall + 40).attr("text-anchor", "middle").text(xLabel);
  axis.append("text").attr("transform", "translate(14," + (top + tall / 2) + ") rotate(-90)")
      .attr("text-anchor", "middle").text(yLabel);
  const bar = svg.append("g"), steps = 40;
  for (let i = 0; i < steps && most > 0; ++i)
    bar.append("rect").attr("x", left + side + 14).attr("width", 12).attr("height", tall / steps + 0.5)
        .attr("y", top + tall - (i + 1) * tall / steps).attr("fill", d3.interpolateViridis((i + 0.5) / steps));
  if (most > 0)
    axis.append("g").attr("transform", "translate(" + (left + side + 26) + ",0)")
        .call(d3.axisRight(sv).tickValues(tv.values).tickFormat(tv.label));
  axis.append("text").attr("x", left + side + 6).attr("y", tall + 60).text("[" + unit + "]");
}
