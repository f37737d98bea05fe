// SPDX-License-Identifier: BSD-3-Clause
// Ghosts, first-order list, materials, assumptions, energy balance, convergence, provenance.
"use strict";

function addGhosts(reports) {
  const some = reports.filter(r => (r.ghosts || []).length > 0);
  if (some.length === 0) return;
  const part = section("Ghost beams", "ghosts");
  for (const r of some) {
    part.append(el("h3", {}, "Beam " + r.beam), listedTable(r.table));
    for (const note of (r.notes || []).concat(r.warnings || [])) part.append(el("p", {class: "note"}, note));
  }
  part.append(el("p", {class: "note"}, "Strongest first, order 0 is the main beam. Followed according to the scene's table 'ghosts'; " +
      "without one down to 1e-12 of the launched power and order 2. Spot: larger 1/e² radius at the end. Power, spot and fraction are " +
      "computed, without Monte-Carlo error; –: the ghost does not come back into a mode, or has no h. straytrace ghosts has all of them."));
}

function addFirstOrder(lists) {
  if (lists.length === 0) return;
  const part = section("First order", "first");
  part.append(el("p", {class: "note"}, "Surfaces that are lit and seen at once make stray light by a single scatter. Seen with: the part " +
      "of area times solid angle from which scattered light gets into the port or receiver. Single scatter: what would get in, were the surface " +
      "Lambertian with its own total scatter. Powers are over that of the main mode; (n): one standard error."));
  const text = e => e === null ? "unresolved" : withError(e.value, e.sigma);
  for (const list of lists.slice(0, 8))
    part.append(el("h3", {}, "Seen from " + list.ending), list.rows.length === 0 ?
                el("p", {class: "note"}, "No walk met a surface: narrow or distant ones may be missed. straytrace paths RUN --first-order " +
                    "--histories N walks more.") :
                simpleTable(["surface", "arriving / main mode", "seen with [m² sr]", "single scatter / main mode"],
                            list.rows.slice(0, 12).map(r => [r.name, text(r.power), text(r.seen), r.product && r.product.value === 0 ? "scatters nothing" : text(r.product)]), [0]));
}

function addMaterials(materials) {
  const part = section("Materials", "materials");
  part.append(el("p", {class: "note"}, "BSDF in the plane of incidence against |α − α₀|, the distance from the specular direction in " +
      "direction cosines. Points: as measured. Grey: nothing was measured there, the law is extrapolated. Band: what the " +
      "stated bracket leaves open."));
  const chooser = el("select", {"aria-label": "material"}, materials.map((m, i) =>
      el("option", {value: i}, m.material + (m.status === "assumed" ? " (assumed)" : ""))));
  const place = el("div");
  chooser.addEventListener("change", () => drawMaterial(place, materials[chooser.value], materials.length));
  part.append(el("div", {class: "bar"}, "material", chooser), place);
  if (materials.length > 0) drawMaterial(place, materials[0], materials.length);
}

function drawMaterial(parent, m, count) {
  parent.replaceChildren(el("h3", {}, m.material + (count > 1 ? ", one of " + count + " materials" : "")));
  const words = [m.source ? "source: " + m.source : "no source is given", m.status ? "status: " + m.status : "",
                 m.low < 1 || m.high > 1 ? "bracket: × " + digits(m.low, 2) + " to " + digits(m.high, 2) : "",
                 m.factor > 1 ? "one sigma: factor " + digits(m.factor, 2) : ""].filter(Boolean);
  parent.append(el("p", {}, words.join("; ")));
  for (const law of m.laws)
    parent.append(el("p", {class: "note"}, "law " + law.model + (law.through ? ", of transmitted light" : "") + "; source: " +
                     (law.source || "not given") + "; wavelength: " + (law.wavelength || "not given")));
  const series = [], shades = [];
  m.bsdf.forEach((curve, i) => {
    const colour = colours[i % colours.length], name = "incidence " + curve.deg + "°" + (curve.side < 0 ? ", transmitted" : "");
    if (i === 0 && (m.low < 1 || m.high > 1))
      series.push({name: "bracket", kind: "band", colour, x: curve.offset, low: curve.bsdf.map(v => v * m.low), high: curve.bsdf.map(v => v * m.high)});
    series.push({name, colour, x: curve.offset, y: curve.bsdf, dash: curve.side < 0 ? "5 4" : null});
  });
  const angles = [...new Set(m.points.map(p => p.deg))];
  angles.forEach((deg, i) => {
    const points = m.points.filter(p => p.deg === deg);
    series.push({name: "measured at " + digits(deg, 3) + "°", kind: "points", colour: colours[(i + 5) % colours.length],
                 x: points.map(p => p.offset), y: points.map(p => p.bsdf)});
  });
  if (m.points.length > 0) {
    const offsets = m.points.map(p => p.offset);
    shades.push({from: 1e-9, to: Math.min(...offsets.filter(o => o > 0)), name: "extrapolated"}, {from: Math.max(...offsets), to: 10, name: "extrapolated"});
  }
  if (series.length > 0)
    new Plot(parent, {height: 400, shades, series, x: {label: "|α − α₀|", log: true}, y: {label: "BSDF [1/sr]", log: true, decades: 16}});
  else parent.append(el("p", {class: "note"}, "scatters nothing"));
  parent.append(el("details", {}, el("summary", {}, "Shares of the light against incidence"),
      simpleTable(["incidence [°]", "scattered", "specular", "transmitted", "absorbed"],
                  m.tis.map(t => [t.deg, t.scattered, t.reflect, t.transmit, t.absorbed].map(v => digits(v, 4))))));
}

function addAssumptions(assumptions, inputs) {
  const part = section("Assumptions", "assumptions");
  part.append(el("ul", {}, assumptions.map(line => el("li", {}, line))));
  if (inputs.sources.rows.length > 0)
    part.append(el("h3", {}, "Inputs that are not exactly known"), listedTable(inputs.sources));
  if (inputs.exact.length > 0)
    part.append(el("p", {class: "note"}, "Taken as exact, because nothing is stated: " + inputs.exact.join(", ") + "."));
}

function addEnergyBalance(balance) {
  const part = section("Where the light went", "energy-balance"), emitted = balance.emitted.value;
  if (!(emitted > 0)) return part.append(el("p", {class: "note"}, "No history has been traced."));
  const terms = balance.terms.filter(f => f.power.value !== 0);
  const share = e => withError(100 * e.value / emitted, 100 * e.sigma / emitted);
  part.append(el("p", {class: "note"}, "Of the light that scatters out of the main mode and of free beams; (n): one standard error."),
              simpleTable(["term", "power / main mode", "share of emitted [%]"],
                          [["emitted", withError(emitted, balance.emitted.sigma), "100"],
                           ...terms.map(f => [f.name, withError(f.power.value, f.power.sigma), share(f.power)])], [0]),
              el("p", {class: "note"}, "escaped: left the scene. truncated: was still on its way at the largest number of surface events that " +
                 "is followed. roulette and sampling: what the random choices took and gave; zero on average."));
  const objects = balance.objects.filter(o => o.absorbed && o.absorbed.value > 0 || o.arriving && o.arriving.value > 0)
      .sort((a, b) => (b.absorbed ? b.absorbed.value : 0) - (a.absorbed ? a.absorbed.value : 0));
  const cell = e => e ? withError(e.value, e.sigma) : "–";
  part.append(el("h3", {}, "Objects"), simpleTable(["object", "arriving / main mode", "absorbed / main mode", "absorbed of emitted [%]"],
      objects.slice(0, 30).map(o => [o.name, cell(o.arriving), cell(o.absorbed), o.absorbed ? share(o.absorbed) : "–"]), [0]),
      el("details", {}, el("summary", {}, "Energy balance and closure"), el("pre", {}, balance.closure)));
}

function addConvergence(convergence) {
  const part = section("Convergence", "convergence");
  const all = [{...convergence.total, colour: "var(--ink)", width: 2.4}, ...convergence.routes.map((c, i) => ({...c, colour: colours[i % colours.length]}))];
  const series = all.filter(c => c.error.length > 1).map(c => ({...c, x: c.histories, y: c.error.map(e => 100 * e)}));
  if (series.length === 0) return part.append(el("p", {class: "note"}, "Too few blocks for a spread between replicas."));
  const first = series[0], n0 = first.x[first.x.length - 1], e0 = first.y[first.y.length - 1];
  series.push({name: "1/√N", colour: "var(--faint)", dash: "4 4", x: first.x, y: first.x.map(n => e0 * Math.sqrt(n0 / n))});
  const box = el("div");
  part.append(el("p", {class: "note"}, "Relative standard error from the spread of the first 4 to 32 replicas (blocks dealt in turn)."), box);
  new Plot(box, {height: 380, series, x: {label: "histories", log: true}, y: {label: "relative standard error [%]", log: true}});
  if (convergence.merit.length > 0)
    part.append(el("h3", {}, "Figure of merit"), el("p", {class: "note"}, "Of ε, the relative standard error, and t, the time of tracing: the larger the sooner it is known."),
                simpleTable(["of", "1/(ε² t) [1/s]"], convergence.merit.map(m => [m.name, digits(m.value)]), [0]));
}

function addProvenance(p, libraries) {
  const part = section("Provenance", "provenance");
  const rows = [["program", p.program + " " + p.version + " (" + p.commit + ")"], ["build", p.build], ["created", p.created], ["model", p.model],
                ["seed", p.seed], ["histories", p.histories], ["stop rule", p.stop_rule || "number of histories"],
                ["complete", p.complete ? "yes" : "no: a checkpoint"], ["tracing", digits(p.seconds) + " s"], ["interferometer", p.interferometer],
                ["main mode", p.beam_power === null ? "power not stated" : digits(p.beam_power, 6) + " W"],
                ["reverse routes", p.reverse_routes ? "added in amplitude (C_rev)" : "not added in amplitude"],
                ["parameters", p.parameters.join(", ") || "as in the scene"], ["motion or responses from", p.replaced_by || "the scene"]];
  part.append(simpleTable(["", ""], rows.filter(row => row[1] !== ""), [0, 1]), el("details", {}, el("summary", {}, "Input files"),
      simpleTable(["file", "bytes", "sha256"], p.files.map(f => [f.name, f.bytes, f.sha256]), [0, 2])),
      el("p", {class: "note"}, "This file needs no network and sends nothing. It carries " + Object.values(libraries).join("; ") + "."));
}
