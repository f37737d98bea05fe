// SPDX-License-Identifier: BSD-3-Clause
// The page of a run while it is traced: asks the program that serves it once a second.
"use strict";

const page = document.getElementById("page"), between = 1000;  // ms
const status = el("p", {class: "verdict"}, "Connecting."), bar = el("progress", {"aria-label": "progress towards the target", max: 1});
const said = el("p", {class: "note", role: "status", "aria-live": "polite"});
const stop = el("button", {type: "button", on: {click: () => press("stop")}}, "Stop");
const target = el("input", {id: "target", size: 22, maxlength: 1000, autocomplete: "off", spellcheck: "false", "aria-describedby": "hint"});
const form = el("form", {class: "bar"}, stop, el("label", {for: "target"}, "trace until"), target, el("button", {type: "submit"}, "Extend"),
                el("span", {id: "hint", class: "note"}, "a number of histories, 2e6, or a stop rule, " +
                    (data.noise ? "h_total < 1\u00a0%" : "receiver:* < 1\u00a0%")));
const shown = el("p", {class: "note"}), report = el("div"), now = el("div", {}, shown);
page.append(status, bar, form, said, report, now);
form.addEventListener("submit", event => {
  event.preventDefault();
  press("extend", target.value);
});

// A sentence for everyone, screen readers included; announced once.
function tell(text) { if (said.textContent !== text) say(said, text); }

async function press(button, text = "") {
  try {
    const reply = await fetch(button, {method: "POST", body: text}), sentence = await reply.text();
    const answer = reply.headers.get("content-type")?.includes("json") ? JSON.parse(sentence) : {what: sentence.trim()};
    tell(answer.what + (answer.remedy ? ": " + answer.remedy : ""));
    said.classList.toggle("bad", !reply.ok);
    target.setAttribute("aria-invalid", button === "extend" && !reply.ok);
  } catch (error) {
    if (!(error instanceof TypeError)) throw error;
    lost();
  }
}

// A number and its unit stay on one line.
const count = x => digits(x, 4), percent = x => digits(100 * x, 2) + "\u00a0%";
function time(seconds) { return seconds < 90 ? Math.round(seconds) + "\u00a0s" : Math.round(seconds / 60) + "\u00a0min"; }

function errorText(s) {
  if (s.wanted_error === null) return "";
  const seen = s.error === null ? "error not resolved yet" : "error " + percent(s.error) + " at " + count(s.error_histories) + " histories";
  return "; " + seen + ", target " + percent(s.wanted_error);
}

// 1 where the target is met; null: not known. An error falls as the root of the histories.
function shareDone(s) {
  if (s.wanted_error !== null && s.error !== null) return Math.min(1, Math.pow(s.wanted_error / s.error, 2) * s.histories / s.error_histories);
  return s.wanted_histories !== null && s.wanted_error === null ? Math.min(1, s.histories / s.wanted_histories) : null;
}

function timeLeft(s) {
  const share = shareDone(s), left = share > 0 ? s.histories * (1 / share - 1) / s.histories_per_s : Infinity;
  return left > 0 && left < 1e6 ? "; about " + time(left) + " left" : "";
}

const phases = {
  preparing: () => "Preparing the trace.",
  tracing: s => "Tracing: " + count(s.histories) + (s.wanted_histories !== null ? " of " + count(s.wanted_histories) : "") + " histories in " +
      time(s.seconds) + errorText(s) + timeLeft(s) + ".",
  writing: () => "Writing the results.",
  finished: s => (s.early ? "Stopped early with a valid result of " : "Finished: ") + count(s.histories) + " histories" + errorText(s) + ".",
};

function showState(s) {
  const done = s.phase === "finished" ? 1 : shareDone(s);
  say(status, phases[s.phase](s));
  if (done === null) bar.removeAttribute("value");
  else bar.value = done;
  if (s.phase !== showState.phase) {
    said.classList.remove("bad");
    tell({preparing: "The trace begins.", tracing: "Tracing.", writing: "Writing the results.",
          finished: "The report is ready. Extend traces on; Close ends the program."}[s.phase]);
    stop.textContent = s.phase === "finished" ? "Close" : "Stop";
    showReport(s.phase === "finished");
  }
  stop.disabled = s.phase === "writing";
  if (document.activeElement !== target && target.value === "") target.value = suggestion(s);
  showState.phase = s.phase;
}

// Four times the histories halve the error.
function suggestion(s) {
  if (s.target) return s.target;
  if (s.wanted_histories !== null && s.wanted_error === null) return digits(4 * s.wanted_histories, 2);
  return s.wanted_error === null ? "" : (data.noise ? "h_total" : "receiver:*") + " < " + digits(50 * s.wanted_error, 2) + " %";
}

// The report as it is on disk, in a frame of its own that cannot press buttons here.
function showReport(ready) {
  now.hidden = ready;
  report.replaceChildren(...(ready ? [
    el("p", {}, el("a", {href: "report.html", target: "_blank", rel: "noopener"}, "report.html in a tab of its own")),
    el("iframe", {class: "report", src: "report.html", title: "report", sandbox: "allow-scripts allow-downloads allow-modals allow-popups"})] : []));
}

function curves(b) {
  const x = b.frequency, curve = {x, brought: true};
  const series = [{...curve, name: "Monte Carlo, ± 1σ", kind: "band", colour: "var(--ink)", opacity: 0.3,
                   low: b.total.asd.map((v, i) => v === null ? null : Math.max(v - b.total.sigma[i], 0)),
                   high: b.total.asd.map((v, i) => v === null ? null : v + b.total.sigma[i])}];
  b.routes.forEach((r, i) => series.push({...curve, name: r.name, y: r.asd, colour: colours[i % colours.length], width: 1.2, aside: true}));
  b.design.forEach((d, i) => series.push({...curve, name: d.name, y: d.asd, colour: "var(--grey)", width: 2, dash: [null, "9 4", "3 3"][i % 3]}));
  const missing = b.unresolved.length, mark = missing > 0 ? " (" + missing + " unresolved " + (missing > 1 ? "routes" : "route") + ")" : b.bound ? " (upper bound)" : "";
  return [...series, {...curve, name: "stray light, total" + mark, y: b.total.asd, colour: "var(--ink)", width: 2.6}];
}

function errorCurves(e, wanted) {
  const x = e.histories, series = [{name: e.what, x, y: e.error.map(v => 100 * v), colour: "var(--blue)", width: 2.2, brought: true}];
  if (wanted !== null) series.push({name: "target", x, y: x.map(() => 100 * wanted), colour: "var(--grey)", dash: "6 4", brought: true});
  return series;
}

// Draws a plot once, then only what is in it, so that a zoom stays.
function redraw(place, axes, series) {
  if (place.plot) place.plot.bring(series, () => false);
  else place.plot = new Plot(place, {...axes, series});
}

const parts = {};
function part(title, id, tag = "figure") {
  if (!parts[id]) {
    parts[id] = el(tag);
    now.append(el("section", {id}, el("h2", {}, title), parts[id]));
  }
  return parts[id];
}

function showResult(r, s) {
  shown.textContent = "Below: the result of " + count(r.histories) + " histories.";
  if (r.budget) {
    part("Result so far", "sentence", "div").replaceChildren(el("p", {class: "verdict"}, r.verdict), el("p", {class: "headline"}, r.headline));
    redraw(part("Noise so far", "budget"), {x: {label: "frequency [Hz]", log: true}, y: {label: "strain, one-sided ASD [1/√Hz]", log: true}}, curves(r.budget));
  }
  if (r.errors.histories.length > 0)
    redraw(part("Relative error", "errors"), {x: {label: "histories", log: true}, y: {label: "relative error [%]", log: true}, height: 300}, errorCurves(r.errors, s.wanted_error));
  if (r.routes.rows.length > 0)
    part("Routes", "routes", "div").replaceChildren(el("p", {class: "note"}, r.routes.rows.length + " of " + r.routes.all + " routes, the loudest first."), listedTable(r.routes));
  for (const one of r.receivers)
    part("Light on " + one.name, "receiver-" + one.name, "div").replaceChildren(
        el("p", {}, cellText(one.light, 3) + " " + one.unit), listedTable(one.table));
}

function lost() {
  say(status, "The program has ended: nothing changes here any more.");
  tell("The program has ended. Its results are in the folder that it was given.");
  for (const node of form.elements) node.disabled = true;
  for (const node of [bar, ...report.querySelectorAll("a")]) node.hidden = true;
}

let results = 0, misses = 0;
async function ask() {
  try {
    const s = await (await fetch("state.json")).json();
    if (s.results !== results && s.phase !== "finished") {
      const reply = await fetch("result.json");
      if (reply.ok) showResult(await reply.json(), s);
      results = s.results;
    }
    showState(s);
    misses = 0;
  } catch (error) {
    if (!(error instanceof TypeError)) throw error;
    if (++misses > 2) return lost();
  }
  setTimeout(ask, between);
}
page.append(el("p", {class: "note"}, "straytrace " + data.version + ". This page speaks with the program on this machine alone; the run continues when it is closed."));
finish(ask);
