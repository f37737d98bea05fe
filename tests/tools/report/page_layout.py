# SPDX-License-Identifier: BSD-3-Clause
"""Possible faults of the layout of a page: wider than its window, numbers cut or broken, plots that cannot be read."""
WIDTHS = (360, 390, 800, 1300)  # phones, half a screen, a desktop
LEAST_LETTERS, LEAST_STAGE = 9, 250  # px

FAULTS = """
const [leastLetters, leastStage] = arguments, root = document.documentElement, said = [];
const words = node => "'" + node.textContent.trim().slice(0, 40) + "'";
const number = /[-−]?[\\d.]+(?:\\(\\d+\\))?e[-+]?\\d+/g;
document.querySelectorAll("details").forEach(d => { d.open = true; });

const wide = root.scrollWidth - root.clientWidth;
if (wide > 0) said.push(`the page is ${wide} px wider than its window`);

for (const cell of document.querySelectorAll(".routes .head span, .routes .row span, th, td")) {
  if (cell.scrollWidth > cell.clientWidth)
    said.push(`cut: ${words(cell)} needs ${cell.scrollWidth} px and has ${cell.clientWidth}`);
}

// Lines that a range of text occupies.
const lines = range => new Set([...range.getClientRects()].map(r => Math.round(r.top))).size;
const range = document.createRange();
for (const node of document.querySelectorAll("p, li, h3, figcaption, td, th, summary, label, .note, .legend span")) {
  const walk = document.createTreeWalker(node, NodeFilter.SHOW_TEXT);
  for (let text = walk.nextNode(); text; text = walk.nextNode())
    for (const found of text.data.matchAll(number)) {
      range.setStart(text, found.index);
      range.setEnd(text, found.index + found[0].length);
      if (lines(range) > 1) said.push(`broken: ${found[0]} of ${words(node)}`);
    }
}
// A short name of a surface in a table, with its event.
for (const cell of document.querySelectorAll("td.text"))
  for (const text of [...cell.childNodes].filter(n => n.nodeType === Node.TEXT_NODE))
    for (const found of text.data.matchAll(/(?<![\\w/.])[\\w/]{1,10}·[A-Z](?!\\w)/g)) {
      range.setStart(text, found.index);
      range.setEnd(text, found.index + found[0].length);
      if (lines(range) > 1) said.push(`broken: ${found[0]} of ${words(cell)}`);
    }

for (const svg of document.querySelectorAll("svg.plot")) {
  const box = svg.getBoundingClientRect(), texts = [...svg.querySelectorAll("text")].filter(t => t.textContent);
  const rects = texts.map(t => t.getBoundingClientRect());
  for (const axis of svg.querySelectorAll(".axis > g")) {
    const labels = [...axis.querySelectorAll("text")].filter(t => t.textContent && t.getBoundingClientRect().width > 0);
    if (labels.length < 2) said.push(`an axis has the labels [${labels.map(t => t.textContent)}]: nobody can read a value`);
  }
  texts.forEach((t, i) => {
    const r = rects[i], letters = parseFloat(getComputedStyle(t).fontSize) * t.getScreenCTM().a;
    const upright = Math.abs(t.getScreenCTM().b) < 1e-9;
    if (r.left < box.left - 1 || r.right > box.right + 1 || r.top < box.top - 1 || r.bottom > box.bottom + 1)
      said.push(`label ${words(t)} leaves its plot`);
    if (upright && letters < leastLetters) said.push(`label ${words(t)} has letters of ${letters.toFixed(1)} px`);
    for (let k = 0; k < i; ++k)
      if (Math.min(r.right, rects[k].right) - Math.max(r.left, rects[k].left) > 1 &&
          Math.min(r.bottom, rects[k].bottom) - Math.max(r.top, rects[k].top) > 3)
        said.push(`labels ${words(texts[k])} and ${words(t)} overlap`);
  });
}

for (const view of document.querySelectorAll(".stage .view")) {
  const box = view.getBoundingClientRect();
  if (box.width < leastStage) said.push(`the scene is ${Math.round(box.width)} px wide`);
  for (const label of [...view.querySelectorAll(".label")].filter(l => l.offsetWidth > 0)) {
    const r = label.getBoundingClientRect();
    if (r.left < box.left - 1 || r.right > box.right + 1) said.push(`label ${words(label)} leaves the scene`);
  }
}
return said;
"""


def faults(browser, width):
    """Faults of the open page in a window of this width, as texts."""
    browser.resize(width)
    return browser.run(FAULTS, LEAST_LETTERS, LEAST_STAGE)


def text_width(browser, text="rank route share 1.2345(67)e-89"):
    """The width that a text has in the font of the page, in px."""
    return browser.run("const s = document.createElement('span'); s.textContent = arguments[0];"
                       "s.style.whiteSpace = 'nowrap'; document.body.append(s);"
                       "const w = s.getBoundingClientRect().width; s.remove(); return w", text)


PAPER_FAULTS = """
const said = [], sheet = arguments[0];
const words = node => "'" + (node.textContent || node.tagName).trim().slice(0, 40) + "'";
for (const node of document.querySelectorAll("table, pre, .routes, th, td, .routes .head span, .routes .row span, .legend span"))
  if (node.offsetWidth > 0 && node.scrollWidth > node.clientWidth + 1 && getComputedStyle(node).display !== "inline")
    said.push(`cut: ${words(node)} needs ${node.scrollWidth} px and has ${node.clientWidth}`);
for (const node of document.querySelectorAll("body *")) {
  const r = node.getBoundingClientRect();
  if (r.width > 0 && r.right > sheet + 1 && !node.closest("svg")) said.push(`${words(node)} is wider than the sheet`);
}
for (const node of document.querySelectorAll("td, .routes .row span"))
  if (node.textContent && parseFloat(getComputedStyle(node).fontSize) < 4.5) said.push(`${words(node)} has letters that nobody can read`);
return said;
"""
SHEET = 718  # px: A4 with margins of 1 cm


def paper_faults(browser):
    """Faults of the open page on a sheet, as texts: formatted for a printer, then as for the screen again."""
    width = browser.run("return innerWidth")
    browser.run("window.dispatchEvent(new Event('beforeprint'))")
    browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    browser.set_width(SHEET)
    said = browser.run(PAPER_FAULTS, SHEET)
    browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
    browser.set_width(width)
    browser.run("window.dispatchEvent(new Event('afterprint'))")
    return said
