// SPDX-License-Identifier: BSD-3-Clause
// The picture of a scene that follows its files: asks the program that serves it for changes.
"use strict";

const page = document.getElementById("page"), between = 500;  // ms
const said = el("p", {class: "note", role: "status", "aria-live": "polite"}, "Waiting for the first picture.");
const problems = el("pre", {class: "bad", hidden: ""}), warnings = el("details", {hidden: ""}), frame = el("iframe", {class: "report", title: "the scene"});
page.append(said, problems, warnings, frame);

// The camera of the picture before, for the next one: a reader who has turned the scene keeps the side.
function cameraOf(stage) {
  return stage && {place: stage.camera.position.toArray(), to: stage.controls.target.toArray(), scale: stage.world.scale.toArray()};
}
function setCamera(stage, before) {
  if (before.scale.some((s, i) => s !== stage.world.scale.getComponent(i))) return;
  stage.side = null;
  stage.camera.position.fromArray(before.place);
  stage.controls.target.fromArray(before.to);
  stage.controls.update();
  if (stage.draw) stage.draw();
}

let turned = null;
frame.addEventListener("load", () => {
  const inside = frame.contentWindow, before = turned;
  const wait = () => {
    if (!inside.document.body || inside.document.body.dataset.ready !== "yes") return setTimeout(wait, 50);
    if (before && inside.stage) setCamera(inside.stage, before);
    document.body.dataset.shown = shown;
  };
  if (frame.src) wait();
});

let changes = -1, shown = 0, misses = 0;
function showState(s) {
  if (s.changes === changes) return;
  changes = s.changes;
  problems.hidden = s.problems === "";
  problems.textContent = s.problems;
  warnings.hidden = s.warnings === "";
  warnings.replaceChildren(el("summary", {}, "warnings"), el("pre", {}, s.warnings));
  if (s.pictures > shown) {
    if (frame.contentWindow && frame.contentWindow.stage) turned = cameraOf(frame.contentWindow.stage);
    shown = s.pictures;
    frame.src = "picture.html?" + shown;
  }
  frame.classList.toggle("old", s.problems !== "");
  const old = s.pictures > 0 ? " The picture is that of the last scene without errors." : "";
  say(said, s.problems !== "" ? "The scene has errors." + old : s.pictures > 0 ? "The picture follows the scene: save it to see it anew." : "Reading the scene.");
}

async function ask() {
  try {
    showState(await (await fetch("state.json")).json());
    misses = 0;
  } catch (error) {
    if (!(error instanceof TypeError)) throw error;
    if (++misses > 2) return say(said, "The program has ended: the picture no longer follows the scene.");
  }
  setTimeout(ask, between);
}
page.append(el("p", {class: "note"}, "straytrace " + data.version + ". This page speaks with the program on this machine alone."));
finish(ask);
