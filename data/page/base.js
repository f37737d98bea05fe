// SPDX-License-Identifier: BSD-3-Clause
// What all parts of a page use: its data, elements, numbers as text. Names from scenes only ever become text nodes.
"use strict";

const data = JSON.parse(document.getElementById("data").textContent);
// Those of page.css, after Okabe and Ito: distinguishable with every common kind of colour vision.
const colours = ["blue", "red", "green", "pink", "orange", "sky", "olive", "slate"].map(name => "var(--" + name + ")");
// The value that a colour of page.css has now; it changes with the scheme, and on paper.
function colourNow(colour) {
  const named = /^var\((--[\w-]+)\)$/.exec(colour);
  return named ? getComputedStyle(document.body).getPropertyValue(named[1]).trim() : colour;
}

// Elements whose text runs over several lines. Browsers break lines behind a minus sign, which cuts exponents:
// -1.2(3)e-24 stays on one line.
const wrapping = new Set(["p", "li", "h3", "figcaption", "td", "th", "summary", "label"]);
function whole(text) { return kept(text.split(/([-−]?[\d.]+(?:\(\d+\))?e[-+]?\d+)/)); }
// Puts a text in the place of what an element has.
function say(node, text) { node.replaceChildren(...whole(text)); }

// el("p", {class: "note"}, "text", otherElement): strings become text, never HTML.
function el(tag, attributes, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes || {})) {
    if (key === "on") for (const [event, action] of Object.entries(value)) node.addEventListener(event, action);
    else if (value !== undefined && value !== null && value !== false) node.setAttribute(key, value);
  }
  const parts = child => typeof child === "string" && wrapping.has(tag) ? whole(child) : [child];
  for (const child of children.flat()) if (child !== null && child !== undefined) node.append(...parts(child));
  return node;
}

// Three digits: 1.23e-24, 0.0123, 1230.
function digits(x, n = 3) {
  if (x === null || x === undefined || !Number.isFinite(x)) return "–";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size < 1e-3 || size >= 1e5) return x.toExponential(n - 1).replace("e+", "e").replace("-", "-");
  return String(Number(x.toPrecision(n)));
}

// 1.23(4)e-24: the error in units of the last digit, two digits of it when it begins with 1.
function withError(value, sigma) {
  if (value === null || value === undefined) return "unresolved";
  if (!(sigma > 0) || value === 0) return digits(value, 4);
  const place = Math.floor(Math.log10(sigma) + 1e-9), lead = sigma / Math.pow(10, place);
  const last = lead < 1.95 ? place - 1 : place, step = Math.pow(10, last);
  const rounded = Math.max(Math.abs(value), Math.round(Math.abs(value) / step) * step);  // 9.96(52) is 10.0(5)
  const power = Math.floor(Math.log10(rounded) + 1e-9);
  if (last > power) return digits(value, 1) + " ± " + digits(sigma, 1);
  const error = Math.round(sigma / Math.pow(10, last));
  if (power >= -3 && power < 6 && last <= 0) return value.toFixed(-last) + "(" + error + ")";
  return (value / Math.pow(10, power)).toFixed(power - last) + "(" + error + ")e" + power;
}

// Two digits, for upper bounds: 2.7e-24.
function roundedUp(x) {
  const unit = Math.pow(10, Math.floor(Math.log10(x) + 1e-9) - 1);
  return digits(Math.ceil(x / unit * (1 - 1e-12)) * unit, 2);
}

// A tick of an axis with n digits: 0.01, 1200, 10^-24, 2.5·10^-24.
function tickText(x, n) {
  const [mantissa, power] = x.toExponential(n - 1).split("e"), short = String(Number(mantissa));
  if (x === 0 || (power >= -2 && power <= 4)) return String(Number(x.toPrecision(n)));
  return (short === "1" ? "" : short + "·") + "10^" + Number(power);
}

// A part of the page with its entry in the list at the top.
function section(title, id) {
  const part = el("section", {id});
  part.append(el("h2", {}, title));
  document.getElementById("page").append(part);
  let nav = document.querySelector("nav");
  if (!nav) {
    nav = el("nav");
    document.querySelector("main").before(nav);
  }
  nav.append(el("a", {href: "#" + id}, title));
  return part;
}

// Parts of a text that was split at what is to stay on one line.
function kept(parts) { return parts.map((part, i) => i % 2 ? el("span", {class: "keep"}, part) : part); }

// rows: lists of cells; text columns are left-aligned. In titles h(10 Hz) and [1/√Hz] stay whole.
function simpleTable(titles, rows, text = []) {
  const side = i => ({class: text.includes(i) ? "text" : null}), whole = /(\S*\([^)]*\)|\[[^\]]*\])/;
  return el("table", {}, el("thead", {}, el("tr", {}, titles.map((t, i) => el("th", side(i), kept(t.split(whole)))))),
            el("tbody", {}, rows.map(row => el("tr", {}, row.map((c, i) => el("td", side(i), String(c)))))));
}

// A text, a number, or one with its error.
function cellText(x, n) { return typeof x === "string" ? x : x !== null && typeof x === "object" ? withError(x.value, x.sigma) : digits(x, n); }

// A table as the program lists it: columns {title, text, digits}, rows of cells.
function listedTable(table) {
  const columns = table.columns, cell = (x, i) => cellText(x, columns[i].digits);
  return simpleTable(columns.map(c => c.title), table.rows.map(row => row.map(cell)),
                     columns.map((c, i) => c.text ? i : -1).filter(i => i >= 0));
}

// Headings that are jumped to appear below the bar at the top, however many lines it has.
function clearBar() {
  const bar = document.querySelector("nav");
  if (bar) document.documentElement.style.setProperty("--bar", Math.ceil(bar.offsetHeight) + 8 + "px");
}

// On paper everything is drawn anew as wide as a sheet, and what is still wider gets smaller letters: nothing is cut.
function fitPaper() {
  document.documentElement.style.fontSize = "12px";
  document.body.classList.add("paper");
  window.dispatchEvent(new Event("resize"));
  for (const node of document.querySelectorAll("table, .routes, pre")) {
    const least = 5;  // px
    let size = parseFloat(getComputedStyle(node).fontSize);
    for (; node.scrollWidth > node.clientWidth && size > least; node.style.fontSize = size + "px") size *= 0.95;
    node.classList.toggle("narrow", node.scrollWidth > node.clientWidth);
  }
}
function leavePaper() {
  document.documentElement.style.fontSize = "";
  document.body.classList.remove("paper");
  for (const node of document.querySelectorAll("table, .routes, pre")) {
    node.style.fontSize = "";
    node.classList.remove("narrow");
  }
  window.dispatchEvent(new Event("resize"));
}

// Runs the scripts that the page holds packed.
async function unpackScripts() {
  for (const packed of document.querySelectorAll("script[type='application/gzip']")) {
    const bytes = new Blob([typedArray(Uint8Array, packed.textContent)]);
    const text = await new Response(bytes.stream().pipeThrough(new DecompressionStream("gzip"))).text();
    packed.replaceWith(el("script", {}, text));
  }
}

// What every page does when it is made. `later`: what needs the packed scripts, drawn when the rest can be used.
async function finish(later = () => {}) {
  clearBar();
  window.addEventListener("resize", clearBar);
  window.addEventListener("beforeprint", fitPaper);
  window.addEventListener("afterprint", leavePaper);
  document.body.dataset.usable = "yes";
  performance.mark("usable");
  await new Promise(painted => requestAnimationFrame(() => setTimeout(painted)));
  if (typeof DecompressionStream === "function") await unpackScripts();
  later();
  clearBar();
  document.body.dataset.ready = "yes";
}

// A file for the reader, made here and sent nowhere.
function offer(name, text) {
  const url = URL.createObjectURL(new Blob([text], {type: "text/plain"}));
  const link = el("a", {href: url, download: name});
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

function csvCell(x) {
  const text = x === null || x === undefined ? "nan" : String(x);
  return /[",\n]/.test(text) ? '"' + text.replace(/"/g, '""') + '"' : text;
}

// Float32Array or Uint32Array from base64.
function typedArray(Type, text) {
  const bytes = atob(text), out = new Uint8Array(bytes.length);
  for (let i = 0; i < bytes.length; ++i) out[i] = bytes.charCodeAt(i);
  return new Type(out.buffer);
}
