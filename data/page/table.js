// SPDX-License-Identifier: BSD-3-Clause
// The path table. Only the rows in sight are elements of the page, so 1e5 rows scroll like ten.
"use strict";

const rowHeight = 24, spareRows = 6, printedRows = 40;
const measuredRows = 4000;  // at most as many rows determine the width of a column

// All row numbers, or `most` of them, spread by the golden ratio: rows that repeat with any period are met.
function sampledRows(rows, most) {
  return Array.from({length: Math.min(rows, most)}, (_, k) => rows <= most ? k : Math.floor(k * 0.6180339887498949 % 1 * rows));
}

class PathTable {
  // Calls `chosen(ids)` with the clicked rows and `switched(off)` with all that are off.
  constructor(parent, table, chosen, switched = () => {}) {
    this.table = table;
    this.columns = new Map(table.columns.map(c => [c.key, c.values]));
    this.about = new Map(table.columns.map(c => [c.key, c]));
    this.texts = new Set(table.columns.filter(c => typeof c.values.find(v => v !== null) === "string").map(c => c.key));
    this.shown = table.columns.filter(c => c.shown).map(c => c.key);
    this.sortKey = "rank";
    this.falling = false;
    this.widest = new Map();
    this.chosen = new Set();
    this.off = new Set();  // ids of rows that are switched off
    this.tell = chosen;
    this.switched = switched;
    this.order = Array.from({length: table.rows}, (_, i) => i);
    this.build(parent);
    this.refresh();
  }
  build(parent) {
    this.input = el("input", {class: "filter", type: "search", "aria-label": "filter",
                              placeholder: 'words, or  via("baffle*") and scatters == 2 and h(30 Hz) > 1e-26',
                              on: {input: () => this.refresh()}});
    this.said = el("span", {class: "note"});
    const save = el("button", {on: {click: () => offer("paths.csv", this.csv())}}, "CSV of these rows");
    const off = (name, title, ids) => el("button", {title, on: {click: () => this.switchOff(ids())}}, name);
    const all = () => this.order.map(i => this.columns.get("id")[i]);
    const buttons = [off("Switch chosen off", "the total without the rows that are chosen", () => [...this.chosen]),
                     off("Switch these off", "the total without the rows that the filter lets through", all)];
    const on = el("button", {on: {click: () => { this.off.clear(); this.resum(); this.draw(); }}}, "All on");
    this.sums = el("div", {class: "note sums"});
    this.onPaper = el("div", {class: "note printed"});
    this.box = el("div", {class: "routes", tabindex: "0", on: {scroll: () => this.draw()}});
    this.head = el("div", {class: "head"});
    this.ruler = el("div", {class: "ruler", "aria-hidden": "true"});
    this.above = el("div", {class: "space"});
    this.below = el("div", {class: "space"});
    this.body = el("div", {class: "body"});
    this.box.append(el("div", {class: "grid"}, this.head, this.ruler, this.above, this.body, this.below));
    parent.append(el("div", {class: "bar"}, this.input, save, buttons, on), this.said, this.sums, this.onPaper, this.box, this.choices());
    window.addEventListener("resize", () => this.draw());
    window.addEventListener("beforeprint", () => this.print(printedRows));
    window.addEventListener("afterprint", () => this.print(null));
  }
  choices() {
    const list = el("div", {class: "choices"});
    for (const [key, column] of this.about) {
      const box = el("input", {type: "checkbox", on: {change: () => this.toggle(key)}});
      box.checked = this.shown.includes(key);
      list.append(el("label", {title: column.help}, box, " ", column.title, column.unit ? " [" + column.unit + "]" : ""));
    }
    return el("details", {class: "options"}, el("summary", {}, "Columns"), list,
              el("p", {class: "note"}, "The filter knows: " + Predicate.numbers(this.about).join(" ") + " " + textNames.map(n => n + "()").join(" ") +
                 " resolved; and, or, not, brackets; units, as in opl > 2 km."));
  }
  print(rows) {
    this.printed = rows;
    this.box.scrollTop = 0;
    this.onPaper.textContent = rows && this.order.length > rows ? "Printed: the first " + rows + " of these rows." : "";
    this.draw();
  }
  switchOff(ids) {
    for (const id of ids) this.off.add(id);
    this.resum();
    this.draw();
  }
  // The total without rows that are off. Routes share histories, so their errors add up to at most their plain sum.
  resum() {
    const parts = [], ids = this.columns.get("id");
    for (const [key, values] of this.columns) {
      const sigma = this.columns.get(key + "_sigma");
      if (!isStrain({key}) || !values.some(v => v !== null)) continue;
      let all = 0, left = 0, error = 0;
      for (let i = 0; i < values.length; ++i) {
        if (values[i] === null) continue;
        all += values[i] * values[i];
        if (this.off.has(ids[i])) continue;
        left += values[i] * values[i];
        error += values[i] * sigma[i];
      }
      const h = Math.sqrt(left);
      parts.push("h(" + key.slice(1) + " Hz) " + (left > 0 ? withError(h, error / h) + " (error at most), " +
                 digits(h / Math.sqrt(all)) + " of the whole" : "nothing resolved is left"));
    }
    this.switched(this.off);
    say(this.sums, this.off.size === 0 ? "" : "Without the " + this.off.size + (this.off.size === 1 ? " row that is off: " : " rows that are off: ") + parts.join("; ") +
        ". Unresolved rows are in none of these sums.");
  }
  toggle(key) {
    this.shown = [...this.about.keys()].filter(k => (k === key) !== this.shown.includes(k));
    this.refresh();
  }
  sortBy(key) {
    this.falling = this.sortKey === key ? !this.falling : !this.isText(key) && key !== "rank";
    this.sortKey = key;
    this.refresh();
  }
  refresh() {
    let test = () => true;
    this.said.classList.remove("bad");
    this.input.removeAttribute("aria-invalid");
    try {
      test = rowTest(this.input.value, this.table);
    } catch (error) {
      this.said.classList.add("bad");
      this.input.setAttribute("aria-invalid", "true");
      say(this.said, error.message);
      return;
    }
    const values = this.columns.get(this.sortKey), sign = this.falling ? -1 : 1, order = [];
    for (let i = 0; i < this.table.rows; ++i) if (test(i)) order.push(i);
    const text = typeof values.find(v => v !== null) === "string";
    order.sort((a, b) => {
      const x = values[a], y = values[b];
      if (x === null || y === null) return (x === null) - (y === null) || a - b;  // unresolved ones last
      return sign * (text ? (x < y ? -1 : x > y ? 1 : 0) : x - y) || a - b;
    });
    this.order = order;
    const share = this.columns.get("share");
    const sum = order.reduce((s, i) => s + (share[i] || 0), 0);
    say(this.said, order.length + " of " + this.table.rows + " rows" +
        (share.some(x => x !== null) ? ", " + digits(sum, 4) + " % of the resolved noise power between " +
         digits(this.table.band[0]) + " and " + digits(this.table.band[1]) + " Hz" : ""));
    this.drawHead();
    this.draw();
  }
  isText(key) { return this.texts.has(key); }
  drawHead() {
    this.head.replaceChildren(...this.shown.map(key => {
      const c = this.about.get(key), mark = key === this.sortKey ? (this.falling ? " ▼" : " ▲") : "";
      return el("span", {class: this.side(key), title: c.help, "data-key": key, on: {click: () => this.sortBy(key)}}, c.title + mark,
                el("small", {}, c.unit ? "[" + c.unit + "]" : "\u00a0"));
    }));
    this.ruler.replaceChildren(...this.shown.map(key =>
        el("span", {class: this.side(key)}, el("b", {}, this.about.get(key).title + " ▼"), el("i", {}, this.widestText(key)))));
  }
  // The layout makes columns as wide as what they hold, in any font. This text is held always, so that columns do not
  // change their widths while rows come and go.
  widestText(key) {
    if (!this.widest.has(key)) {
      const texts = new Set(), context = document.createElement("canvas").getContext("2d");
      const style = getComputedStyle(this.box);
      context.font = style.fontSize + " " + style.fontFamily;
      for (const i of sampledRows(this.table.rows, measuredRows)) texts.add(this.cell(key, i));
      const widths = [...texts].map(text => [context.measureText(text).width, text]);
      this.widest.set(key, widths.reduce((a, b) => b[0] > a[0] ? b : a)[1]);
    }
    return this.widest.get(key);
  }
  side(key) { return this.isText(key) ? "text" : null; }
  cell(key, i) {
    const values = this.columns.get(key), errors = this.columns.get(key + "_sigma");
    if (errors && this.isStill(key, i)) return "still";
    if (errors) return this.isBound(key, i) ? "at most " + roundedUp(values[i]) : withError(values[i], errors[i]);
    const x = values[i];
    return typeof x === "number" ? (Number.isInteger(x) ? String(x) : digits(x, 4)) : x === null ? "–" : x;
  }
  // Nothing on the route moves, so it makes exactly no noise.
  isStill(key, i) { return this.columns.get(key)[i] === 0 && this.columns.get("share")[i] === 0 && (key === "share" || isStrain({key})); }
  // Rims are computed as the most there can be.
  isBound(key, i) {
    return this.columns.get("kind")[i] === "edge" && this.columns.get(key)[i] > 0 && (key === "coupling" || key === "share" || isStrain({key}));
  }
  draw() {
    const rows = this.printed, first = Math.max(0, Math.floor(this.box.scrollTop / rowHeight) - spareRows);
    const count = rows || Math.ceil(this.box.clientHeight / rowHeight) + 2 * spareRows;
    const shown = this.order.slice(first, first + count).map(i => this.row(i));
    this.above.style.height = first * rowHeight + "px";
    this.below.style.height = (rows ? 0 : Math.max(0, this.order.length - first - shown.length) * rowHeight) + "px";
    this.body.replaceChildren(...shown);
  }
  row(i) {
    const id = this.columns.get("id")[i], bad = this.columns.get("status")[i] !== "resolved";
    return el("div", {class: "row" + (this.chosen.has(id) ? " chosen" : "") + (bad ? " faint" : "") + (this.off.has(id) ? " off" : ""), "data-id": id,
                      title: bad ? this.columns.get("status")[i] : null,
                      on: {click: event => this.choose(id, event.ctrlKey || event.shiftKey || event.metaKey)}},
              this.shown.map(key => {
                const text = this.cell(key, i);
                return el("span", {class: this.side(key), title: this.isText(key) && !bad ? text : null}, text);
              }));
  }
  choose(id, more) {
    const had = this.chosen.has(id);
    if (!more) this.chosen.clear();
    if (had) this.chosen.delete(id); else this.chosen.add(id);
    this.draw();
    this.tell([...this.chosen]);
  }
  csv() {
    const keys = [...this.about.keys()];
    const title = key => this.about.get(key).unit ? key + " [" + this.about.get(key).unit + "]" : key;
    const lines = [keys.map(key => csvCell(title(key))).join(",")];
    for (const i of this.order) lines.push(keys.map(key => csvCell(this.columns.get(key)[i])).join(","));
    return lines.join("\n") + "\n";
  }
}
