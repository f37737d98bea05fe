// SPDX-License-Identifier: BSD-3-Clause
// Maps of places by colour: cells of a chart, or the pixels of a receiver.
"use strict";

const uncertain = 0.3;  // relative error from which on a cell is hatched
const faintest = 1e-6;  // part of the brightest that has a colour of its own

// Cells (u low, u high, v low, v high) of a chart as the page has them, with the rectangle that they fill.
function chartCells({chart, whole, cells}) {
  const n = cells.length / 4, polar = chart === "polar", r = whole[1];
  const find = (x, y) => {
    const u = polar ? Math.hypot(x, y) : x, v = polar ? Math.atan2(y, x) : y;
    for (let i = 0; i < n; ++i)
      if (cells[4 * i] <= u && u < cells[4 * i + 1] && cells[4 * i + 2] <= v && v < cells[4 * i + 3]) return i;
    return null;
  };
  const corners = i => cells.slice(4 * i, 4 * i + 4);
  return {n, polar, corners, find, box: polar ? [-r, r, -r, r] : whole, square: chart !== "unrolled"};
}

// Pixels by rows from the lowest.
function pixelCells({columns, rows, x, y}) {
  const dx = (x[1] - x[0]) / columns, dy = (y[1] - y[0]) / rows;
  const corners = i => {
    const left = x[0] + dx * (i % columns), low = y[0] + dy * Math.floor(i / columns);
    return [left, left + dx, low, low + dy];
  };
  const find = (px, py) => {
    const i = Math.floor((px - x[0]) / dx), k = Math.floor((py - y[0]) / dy);
    return i >= 0 && i < columns && k >= 0 && k < rows ? k * columns + i : null;
  };
  return {n: columns * rows, polar: false, corners, find, box: [...x, ...y], square: true};
}

function cellArea(place, [a, b, c, d]) { return (place.polar ? (a + b) / 2 : 1) * (b - a) * (d - c); }

// Of an annular sector: its corners and where it crosses the axes.
function cellBox(place, [a, b, c, d]) {
  if (!place.polar) return [a, b, c, d];
  const angles = [c, d];
  for (let k = -2; k <= 2; ++k) if (c < k * Math.PI / 2 && k * Math.PI / 2 < d) angles.push(k * Math.PI / 2);
  const x = angles.flatMap(t => [a * Math.cos(t), b * Math.cos(t)]), y = angles.flatMap(t => [a * Math.sin(t), b * Math.sin(t)]);
  return [Math.min(...x), Math.max(...x), Math.min(...y), Math.max(...y)];
}

// The part with nearly all of the sum, where it is so small that it would not be seen in the whole; null: it is not.
function brightPart(place, values) {
  const parts = [], most = 0.95, small = 0.2;
  for (let i = 0; i < place.n; ++i) if (values[i] > 0) parts.push([values[i] * cellArea(place, place.corners(i)), i]);
  const total = d3.sum(parts, p => p[0]), box = [Infinity, -Infinity, Infinity, -Infinity];
  let sum = 0;
  for (const [part, i] of parts.sort((a, b) => b[0] - a[0])) {
    if (sum > most * total) break;
    sum += part;
    const [a, b, c, d] = cellBox(place, place.corners(i));
    box.splice(0, 4, Math.min(box[0], a), Math.max(box[1], b), Math.min(box[2], c), Math.max(box[3], d));
  }
  const [a, b, c, d] = box, whole = place.box, half = 0.75 * Math.max(b - a, d - c);
  if (!place.square || !(2 * half < small * Math.max(whole[1] - whole[0], whole[3] - whole[2]))) return null;
  return [(a + b) / 2 - half, (a + b) / 2 + half, (c + d) / 2 - half, (c + d) / 2 + half];
}

const lengthUnits = [[1, "m"], [1e-2, "cm"], [1e-3, "mm"], [1e-6, "µm"]];
function lengthUnit(size) { return lengthUnits.find(([metres]) => size >= metres) || lengthUnits[3]; }

// values: null where nothing is known. Starts with the bright part where there is one; a button shows the whole. depth: part of
// the brightest that still has a colour; whole: the bright part is no matter; circle: radius of a ring about the middle.
function heatMap(parent, map) {
  const part = map.whole ? null : brightPart(map.place, map.values), svg = d3.select(parent).append("svg").attr("class", "plot");
  let shown = part;
  const note = el("p", {class: "note"});
  const draw = () => {
    drawHeat(svg, parent.clientWidth, map, shown || map.place.box);
    const size = metres => { const [unit, name] = lengthUnit(metres); return digits(metres / unit, 2) + " " + name; };
    if (part) say(note, shown ? "Shown: " + size(part[1] - part[0]) + " of " + size(map.place.box[1] - map.place.box[0]) +
                                ", where 95 % of it is." : "Shown: all; the bright part is small.");
  };
  if (part) parent.append(note, el("div", {class: "bar"}, [["bright part", part], ["whole", null]].map(([name, box]) =>
      el("button", {on: {click: () => { shown = box; draw(); }}}, name))));
  draw();
  whenResized(parent, svg, draw);
}

// Corners of a cell; arcs have one every two degrees, so that they stay round when they are drawn large.
function outline(place, [a, b, c, d]) {
  if (!place.polar) return [[a, c], [b, c], [b, d], [a, d]];
  const steps = Math.max(1, Math.ceil((d - c) / 0.035)), points = [];
  for (let k = 0; k <= steps; ++k) points.push([b, c + (d - c) * k / steps]);
  for (let k = steps; k >= 0; --k) points.push([a, c + (d - c) * k / steps]);
  return points.map(([r, t]) => [r * Math.cos(t), r * Math.sin(t)]);
}

// Cells as a picture of some px a side, of what lies within a box.
function cellPicture({place, values, errors}, [x0, x1, y0, y1], wide, tall, colour) {
  const canvas = el("canvas", {width: wide, height: tall}), g = canvas.getContext("2d", {willReadFrequently: true});
  const across = x => (x - x0) / (x1 - x0) * wide, down = y => (y1 - y) / (y1 - y0) * tall;
  for (let i = 0; i < place.n; ++i) {
    if (!(values[i] > 0)) continue;
    const corners = place.corners(i), [a, b, c, d] = cellBox(place, corners);
    if (b < x0 || a > x1 || d < y0 || c > y1) continue;
    g.beginPath();
    const whole = place.polar ? v => v : Math.round;  // no seams between rectangles
    for (const [x, y] of outline(place, corners)) g.lineTo(whole(across(x)), whole(down(y)));
    g.closePath();
    g.fillStyle = colour(values[i]);
    g.fill();
    if (!(errors[i] < uncertain * values[i]))
      hatch(g, Math.max(0, across(a)), Math.min(wide, across(b)), Math.max(0, down(d)), Math.min(tall, down(c)));
  }
  return canvas.toDataURL();
}

// Slanted white lines within the path that was drawn last, which lies in this box; in step from cell to cell.
function hatch(g, left, right, top, bottom) {
  const step = 9;
  g.save();
  g.clip();
  g.beginPath();
  for (let k = Math.floor((left + top) / step) * step; k < right + bottom + step; k += step) {
    g.moveTo(k - top, top);
    g.lineTo(k - bottom, bottom);
  }
  g.strokeStyle = "#fff";
  g.lineWidth = 2;
  g.stroke();
  g.restore();
}

function drawHeat(svg, room, map, box) {
  const {place, values, unit, xLabel, yLabel, tell} = map, width = Math.max(300, Math.min(620, room || 460));
  const resize = tall => svg.attr("viewBox", "0 0 " + width + " " + tall);
  svg.selectAll("*").remove();
  resize(width);  // before text is measured: letters scale with it
  const [least, most] = d3.extent(values.filter(v => v > 0)), floor = Math.max(least || 1, (most || 1) * (map.depth || faintest));
  const colour = v => d3.interpolateViridis(most > floor ? Math.max(0, Math.log(v / floor) / Math.log(most / floor)) : 1);
  const [metres, name] = lengthUnit((box[1] - box[0]) / 2), [upMetres, upName] = place.square ? [metres, name] : lengthUnit((box[3] - box[2]) / 2);
  const sx = d3.scaleLinear().domain([box[0] / metres, box[1] / metres]), sy = d3.scaleLinear().domain([box[2] / upMetres, box[3] / upMetres]);
  const sv = d3.scaleLog().domain([floor, Math.max(most || 0, floor * 1.01)]);
  const tx = evenTicks(...sx.domain(), 5), ty = evenTicks(...sy.domain(), 6), tv = logTicks(...sv.domain(), 8);
  const left = 30 + widest(svg, ty.values.map(ty.label)), beside = most > 0 ? widest(svg, tv.values.map(tv.label)) : 0;
  const right = Math.max(72, 40 + beside, 10 + widest(svg, ["[" + unit + "]"]));
  const top = 30, side = width - left - right;
  const tall = place.square ? Math.max(60, side * (box[3] - box[2]) / (box[1] - box[0])) : side;
  resize(top + tall + 54);
  sx.range([left, left + side]);
  sy.range([top + tall, top]);
  sv.range([top + tall, top]);
  svg.append("rect").attr("x", left).attr("y", top).attr("width", side).attr("height", tall).attr("fill", "var(--nothing)");
  svg.append("image").attr("x", left).attr("y", top).attr("width", side).attr("height", tall)
      .attr("preserveAspectRatio", "none").attr("href", cellPicture(map, box, 2 * Math.round(side), 2 * Math.round(tall), colour))
      .on("mousemove", function () {
        const [px, py] = d3.mouse(svg.node());
        tell(place.find(sx.invert(px) * metres, sy.invert(py) * upMetres));
      }).on("mouseleave", () => tell(null));
  if (map.circle)
    svg.append("circle").attr("cx", sx(0)).attr("cy", sy(0)).attr("r", sx(map.circle / metres) - sx(0)).attr("class", "ring");
  const axis = svg.append("g").attr("class", "axis"), raised = function () { setLabel(this, this.textContent); };
  const rooms = textWidths(svg, tx.values.map(tx.label)).map(w => w + 6);
  const add = (at, made) => axis.append("g").attr("transform", "translate(" + at + ")").call(made).selectAll("text").each(raised);
  add([0, top + tall], d3.axisBottom(sx).tickValues(tx.values).tickFormat(spacedLabels(sx, tx, rooms)));
  add([left, 0], d3.axisLeft(sy).tickValues(ty.values).tickFormat(spacedLabels(sy, ty, ty.values.map(() => lineHeight))));
  axis.append("text").attr("x", left + side / 2).attr("y", top + tall + 40).attr("text-anchor", "middle").text(xLabel + " [" + name + "]");
  axis.append("text").attr("transform", "translate(14," + (top + tall / 2) + ") rotate(-90)")
      .attr("text-anchor", "middle").text(yLabel + " [" + upName + "]");
  if (!(most > 0)) {
    axis.append("text").attr("x", left + side / 2).attr("y", top + tall / 2).attr("text-anchor", "middle").text("nothing seen here");
    return;
  }
  const bar = svg.append("g"), steps = 40;
  for (let i = 0; i < steps; ++i)
    bar.append("rect").attr("x", left + side + 14).attr("width", 12).attr("height", tall / steps + 0.5)
        .attr("y", top + tall - (i + 1) * tall / steps).attr("fill", d3.interpolateViridis((i + 0.5) / steps));
  add([left + side + 26, 0], d3.axisRight(sv).tickValues(tv.values)
      .tickFormat(spacedLabels(sv, tv, tv.values.map(() => lineHeight), isDecade)));
  axis.append("text").attr("x", width - 4).attr("y", 16).attr("text-anchor", "end").text("[" + unit + "]");
}
