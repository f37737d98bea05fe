# SPDX-License-Identifier: BSD-3-Clause
"""Contrast of the text and lines of a page with what is behind them (WCAG 2.2, 1.4.3 and 1.4.11), on screens and on paper."""
LEAST_TEXT, LEAST_LINE = 4.5, 3

FAINT = """
const [leastText, leastLine] = arguments, said = [];
document.querySelectorAll("details").forEach(d => { d.open = true; });
const parts = text => { const c = (text.match(/[\\d.]+/g) || []).map(Number); return c.length < 3 ? null : c.length < 4 ? [...c, 1] : c; };
const linear = v => v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4;
const light = c => 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2]);
const contrast = (a, b) => { const [x, y] = [light(a), light(b)]; return (Math.max(x, y) + 0.05) / (Math.min(x, y) + 0.05); };
const behind = node => {
  for (let n = node; n; n = n.parentElement) {
    const c = parts(getComputedStyle(n).backgroundColor);
    if (c && c[3] > 0.5) return c;
  }
  return [255, 255, 255, 1];
};
const hex = c => "#" + c.slice(0, 3).map(v => Math.round(v).toString(16).padStart(2, "0")).join("");
const look = (node, colour, least, what) => {
  const c = parts(colour), ground = behind(node);
  if (c && c[3] > 0.5 && contrast(c, ground) < least)
    said.push(`${what}: ${hex(c)} on ${hex(ground)} has a contrast of ${contrast(c, ground).toFixed(2)}`);
};
const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
for (let text = walk.nextNode(); text; text = walk.nextNode()) {
  const node = text.parentElement, style = getComputedStyle(node);
  if (!text.data.trim() || node.closest("script, style, noscript, option, .off, .ruler")) continue;
  if (style.visibility === "hidden" || node.getClientRects().length === 0) continue;
  look(node, node.closest("svg") ? style.fill : style.color, leastText, "'" + text.data.trim().slice(0, 30) + "'");
}
for (const mark of document.querySelectorAll("svg .marks *, .legend svg *, svg .axis path, svg .axis line")) {
  const style = getComputedStyle(mark);
  if (mark.closest(".off") || style.opacity < 0.9 || mark.tagName === "title" || mark.closest(".marks") && mark.tagName === "rect") continue;
  look(mark, style.stroke !== "none" ? style.stroke : style.fill, leastLine, "a " + mark.tagName + " of a plot");
}
if (window.stage && stage.renderer) {
  const ground = parts(getComputedStyle(document.querySelector(".stage .view")).backgroundColor);
  const drawn = stage.renderer.getClearColor(), clear = [drawn.r, drawn.g, drawn.b].map(v => 255 * v);
  if (contrast(clear, ground) > 1.02) said.push(`the scene is drawn on ${hex(clear)}, its frame is ${hex(ground)}`);
  stage.three.traverse(({material}) => {
    if (!material || !material.userData.colour || material.opacity < 0.7) return;
    const c = [material.color.r, material.color.g, material.color.b].map(v => 255 * v);
    if (contrast(c, ground) < leastLine) said.push(`a line of the scene: ${hex(c)} on ${hex(ground)}`);
  });
}
return [...new Set(said)];
"""


def faint(browser):
    """What cannot be seen well in the open page, as texts."""
    return browser.run(FAINT, LEAST_TEXT, LEAST_LINE)
