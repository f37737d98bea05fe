// SPDX-License-Identifier: BSD-3-Clause
// What all parts of a page use: its data, elements, numbers as text. Names from scenes only ever become text nodes.
"use strict";

const data = JSON.parse(document.getElementById("data").textContent);
// Okabe and Ito: told apart by every common kind of colour vision.
const colours = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#8A6D00", "#555555"];

// el("p", {class: "note"}, "text", otherElement): strings become text, never HTML.
function el(tag, attributes, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes || {})) {
    if (key === "on") for (const [event, action] of Object.entries(value)) node.addEventListener(event, action);
    else if (value !== undefined && value !== null && value !== false) node.setAttribute(key, value);
  }
  for (const child of children.flat()) if (child !== null && child !== undefined) node.append(child);
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
  const last = lead < 1.95 ? place - 1 : place, power = Math.floor(Math.log10(Math.abs(value)) + 1e-9);
  if (last > power) return digits(value, 1) + " ± " + digits(sigma, 1);
  const error = Math.round(sigma / Math.pow(10, last));
  if (power >= -3 && power < 6 && last <= 0) return value.toFixed(-last) + "(" + error + ")";
  return (value / Math.pow(10, power)).toFixed(power - last) + "(" + error + ")e" + power;
}

// 0.01, 10000, 10^-24.
function powerOfTen(x) {
  const power = Math.round(Math.log10(x));
  if (power >= -2 && power <= 4) return String(Number(Math.pow(10, power).toPrecision(1)));
  return "10^" + power;
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

// rows: lists of cells; text columns stand to the left. In titles h(10 Hz) and [1/√Hz] stay whole.
function simpleTable(titles, rows, text = []) {
  const side = i => ({class: text.includes(i) ? "text" : null}), whole = /(\S*\([^)]*\)|\[[^\]]*\])/;
  return el("table", {}, el("thead", {}, el("tr", {}, titles.map((t, i) => el("th", side(i), kept(t.split(whole)))))),
            el("tbody", {}, rows.map(row => el("tr", {}, row.map((c, i) => el("td", side(i), String(c)))))));
}

// Browsers break lines behind a minus sign, which cuts exponents: 1.2(3)e-24 stays on one line.
function keepNumbers(root) {
  for (const node of root.querySelectorAll("p, li, h3, figcaption"))
    for (const text of [...node.childNodes].filter(n => n.nodeType === Node.TEXT_NODE)) {
      const parts = text.data.split(/([\d.]+(?:\(\d+\))?e-\d+)/);
      if (parts.length > 1) text.replaceWith(...kept(parts));
    }
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
