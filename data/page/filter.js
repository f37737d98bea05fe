// SPDX-License-Identifier: BSD-3-Clause
// The filter of the path table: via("NE_bench/*") and scatters == 2 and h(30 Hz) > 1e-25, or plain words.
"use strict";

// * stands for any characters.
function globTest(pattern) {
  const text = pattern.split("*").map(part => part.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")).join(".*");
  return new RegExp("^" + text + "$");
}

class Predicate {
  // `columns`: key -> values. Throws Error with what is wrong.
  constructor(text, columns) {
    this.columns = columns;
    this.words = [...text.matchAll(/"([^"]*)"|'([^']*)'|([0-9.]+(?:e[-+]?[0-9]+)?)|([A-Za-z_]\w*|%)|(==|!=|<=|>=|[<>=(),])|(\S)/gi)];
    this.at = 0;
    this.test = this.either();
    if (this.at < this.words.length) throw Error("'" + this.words[this.at][0] + "' is not expected here");
  }
  peek() { return this.at < this.words.length ? this.words[this.at][0] : ""; }
  next() { return this.words[this.at++]; }
  takes(word) {
    if (this.peek().toLowerCase() !== word) return false;
    ++this.at;
    return true;
  }
  expect(word) {
    if (!this.takes(word)) throw Error("expected '" + word + "'" + (this.peek() ? " before '" + this.peek() + "'" : ""));
  }
  either() {
    let left = this.both();
    while (this.takes("or")) {
      const a = left, b = this.both();
      left = i => a(i) || b(i);
    }
    return left;
  }
  both() {
    let left = this.one();
    while (this.takes("and")) {
      const a = left, b = this.one();
      left = i => a(i) && b(i);
    }
    return left;
  }
  one() {
    if (this.takes("not")) {
      const inner = this.one();
      return i => !inner(i);
    }
    if (this.takes("(")) {
      const inner = this.either();
      this.expect(")");
      return inner;
    }
    const word = this.next();
    if (!word || !word[4]) throw Error(word ? "'" + word[0] + "' is not a name" : "something is missing at the end");
    const name = word[4].toLowerCase();
    if (name === "h") return this.compared(this.strain());
    if (this.peek() === "(") return this.named(name);
    if (name === "resolved") return i => this.columns.get("verdict")[i] === "resolved";
    const values = this.columns.get(name);
    if (!values) throw Error("'" + name + "' is not known; known: " + Predicate.names);
    return this.compared(values);
  }
  strain() {
    this.expect("(");
    const hz = this.next();
    this.takes("hz");
    this.expect(")");
    const values = this.columns.get("h" + Number(hz[0]));
    const known = [...this.columns.keys()].filter(k => /^h[0-9.]+$/.test(k)).map(k => k.slice(1) + " Hz");
    if (!values) throw Error("h is listed at " + known.join(", "));
    return values;
  }
  named(name) {
    this.expect("(");
    const word = this.next();
    if (!word || (word[1] === undefined && word[2] === undefined)) throw Error(name + " takes a name in quotes");
    this.expect(")");
    const match = globTest(word[1] !== undefined ? word[1] : word[2]);
    const sequence = this.columns.get("sequence");
    if (name === "via") return i => objectsOf(sequence[i]).some(o => match.test(o));
    const key = {route: "sequence", first: "first", last: "last", body: "body", port: "port", kind: "kind"}[name];
    if (!key) throw Error("'" + name + "' is not known; known: " + Predicate.names);
    return i => match.test(this.columns.get(key)[i]);
  }
  compared(values) {
    const sign = this.next(), value = this.next();
    if (!sign || !sign[5] || !value || value[3] === undefined) throw Error("compare with a number, as in share > 1");
    const x = Number(value[3]);
    if (this.words[this.at] && this.words[this.at][4] && !/^(and|or|not)$/i.test(this.peek())) ++this.at;  // a unit
    switch (sign[5]) {
      case "<": return i => values[i] !== null && values[i] < x;
      case "<=": return i => values[i] !== null && values[i] <= x;
      case ">": return i => values[i] !== null && values[i] > x;
      case ">=": return i => values[i] !== null && values[i] >= x;
      case "!=": return i => values[i] !== null && values[i] !== x;
      default: return i => values[i] !== null && values[i] === x;
    }
  }
}
Predicate.names = "via() first() last() body() port() kind() route() h(30 Hz) share coupling scatters bounces rank opl " +
                  "delay lever fringes rms_phase histories resolved";

function objectsOf(sequence) { return sequence.split(" > ").map(step => step.split("·")[0]); }

// What rows a text lets through; plain words are looked for in route, body and port.
function rowTest(text, columns) {
  const wanted = text.trim();
  if (!wanted) return () => true;
  if (/[()<>=]/.test(wanted) || /^(not )?resolved$/i.test(wanted)) return new Predicate(wanted, columns).test;
  const words = wanted.toLowerCase().split(/\s+/);
  const texts = ["sequence", "body", "port", "kind"].map(key => columns.get(key));
  return i => words.every(word => texts.some(column => column[i].toLowerCase().includes(word)));
}
