// SPDX-License-Identifier: BSD-3-Clause
// The filter of the path table: via("NE_bench/*") and scatters == 2 and h(30 Hz) > 1e-25, or plain words. The same
// language as `straytrace paths --where` (src/results/route_table/route_filter.cpp), message for message: both are tested by the
// cases of tests/support/filter_cases.json. Names, units and values are those of the table.
"use strict";

const textNames = ["via", "route", "first", "last", "body", "port", "kind", "status", "regime", "id"];
const kindNames = ["scattered", "ghost", "edge", "wave", "speckle", "halo", "rim"];
const deepest = 64;

// * stands for any characters.
function globTest(pattern) {
  const text = pattern.split("*").map(part => part.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")).join(".*");
  return new RegExp("^" + text + "$", "s");
}

// Names of the objects in the column `via`; none of a row `other`, which sums many routes.
function objectsOf(text) { return text ? text.split("; ") : []; }

// The nearest by edit distance with transpositions, "" when nothing is close.
function nearestWord(word, words) {
  const w = word.toLowerCase(), n = w.length;
  let best = "", bestDistance = Math.max(1, Math.floor((n + 1) / 3)) + 1;
  if (n === 0 || n > 64) return best;
  for (const other of words) {
    const o = other.toLowerCase(), m = o.length, rows = [Array.from({length: m + 1}, (_, j) => j)];
    if (m === 0 || m > 64) continue;
    for (let i = 1; i <= n; ++i) {
      const row = [i];
      for (let j = 1; j <= m; ++j) {
        row.push(Math.min(rows[i - 1][j] + 1, row[j - 1] + 1, rows[i - 1][j - 1] + (w[i - 1] === o[j - 1] ? 0 : 1)));
        if (i > 1 && j > 1 && w[i - 1] === o[j - 2] && w[i - 2] === o[j - 1]) row[j] = Math.min(row[j], rows[i - 2][j - 2] + 1);
      }
      rows.push(row);
    }
    if (rows[n][m] < bestDistance) [best, bestDistance] = [other, rows[n][m]];
  }
  return best;
}

class FilterProblem extends Error {
  constructor(text, word, what, suggestion) {
    super("column " + ([...text.slice(0, word.begin)].length + 1) + ": " + what + ": " + suggestion);
  }
}

class FilterWords {
  constructor(text) {
    this.text = text;
    this.at = 0;
    this.read();
  }
  next() {
    const word = this.here;
    if (word.kind !== "end") this.read();
    return word;
  }
  takes(word) {
    if (this.here.kind === "quoted" || this.here.text.toLowerCase() !== word) return false;
    this.read();
    return true;
  }
  // The longest of the units directly behind the number just read; "": none.
  unit(units) {
    let longest = "";
    for (const [name] of units) {
      const after = this.text[this.here.begin + name.length] || "";
      const ends = !/\w$/.test(name) || !/\w/.test(after);
      if (name.length > longest.length && this.text.startsWith(name, this.here.begin) && ends) longest = name;
    }
    if (longest) {
      this.at = this.here.begin + longest.length;
      this.read();
    }
    return longest;
  }
  // Of the number just read, with its decimals, where a decimal comma follows; otherwise "".
  withComma(number) {
    const comma = number.begin + number.text.length, decimals = /^,[0-9]+/.exec(this.text.slice(comma));
    return decimals ? number.text + decimals[0] : "";
  }
  read() {
    const begin = this.at + this.text.slice(this.at).search(/\S|$/), rest = this.text.slice(begin);
    const forms = [["quoted", /^"([^"]*)"|^'([^']*)'/], ["number", /^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?/],
                   ["name", /^\w+/], ["sign", /^(==|!=|<=|>=|[<>(),])/], ["stray", /^./su]];
    this.here = {kind: "end", text: "", begin};
    for (const [kind, form] of forms) {
      const hit = form.exec(rest);
      if (!hit) continue;
      this.here = {kind, text: kind === "quoted" ? hit[0].slice(1, -1) : hit[0], begin};
      this.at = begin + hit[0].length;
      return;
    }
    this.at = begin;
  }
}

const isComparison = word => word.kind === "sign" && !"(),".includes(word.text);
const joins = word => /^(and|or|not)$/i.test(word.text);
const unitNames = units => units.map(u => u[0]).join(", ");
const factorOf = (name, units) => (units.find(u => u[0] === name) || [name, 1])[1];
const sixDigits = x => Number(x.toPrecision(6));
const isStrain = column => /^h[0-9.e+-]+$/.test(column.key);

class Predicate {
  // `table`: as the page has it. Throws FilterProblem.
  constructor(text, table) {
    this.about = new Map(table.columns.map(c => [c.key, c]));
    this.hertz = table.hertz;
    this.words = new FilterWords(text);
    this.depth = 0;
    this.test = this.either();
    if (this.words.here.kind !== "end") this.unexpected("join conditions with 'and' or 'or'");
  }
  fail(word, what, suggestion) { throw new FilterProblem(this.words.text, word, what, suggestion); }
  refuseDecimalComma(number) {
    const written = this.words.withComma(number);
    if (written) this.fail(number, "'" + written + "' has a decimal comma", "write " + written.replace(",", "."));
  }
  unexpected(suggestion) {
    const word = this.words.here;
    if (word.kind === "end") this.fail(word, "the condition ends too early", suggestion);
    if (word.text === "=") this.fail(word, "'=' is not a comparison", "write ==");
    if (word.text === '"' || word.text === "'") this.fail(word, "a quotation is not closed", "add " + word.text);
    this.fail(word, "'" + word.text + "' is not expected here", suggestion);
  }
  either() {
    let left = this.both();
    while (this.words.takes("or")) {
      const a = left, b = this.both();
      left = i => a(i) || b(i);
    }
    return left;
  }
  both() {
    let left = this.one();
    while (this.words.takes("and")) {
      const a = left, b = this.one();
      left = i => a(i) && b(i);
    }
    return left;
  }
  one() {
    const word = this.words.here;
    if (++this.depth > deepest) this.fail(word, "the condition is nested too deeply", "remove brackets");
    const test = this.inside(word);
    --this.depth;
    return test;
  }
  inside(word) {
    if (this.words.takes("not")) {
      const inner = this.one();
      return i => !inner(i);
    }
    if (this.words.takes("(")) {
      const inner = this.either();
      if (!this.words.takes(")")) {
        if (this.words.here.kind !== "end") this.unexpected("join conditions with 'and' or 'or'");
        this.fail(word, "a bracket is not closed", "add ')'");
      }
      return inner;
    }
    if (word.kind === "number") this.fail(word, "a number comes first", "write the name first: scatters == 2");
    if (word.kind !== "name") this.unexpected("write a condition: scatters == 2");
    this.words.next();
    return this.named(word, word.text.toLowerCase());
  }
  named(word, name) {
    if (name === "resolved") return i => this.about.get("status").values[i] === "resolved";
    if (name === "h") return this.compared(word, name, this.strain());
    if (textNames.includes(name)) return this.texts(name);
    const numbers = Predicate.numbers(this.about);
    if (numbers.includes(name)) return this.compared(word, name, this.about.get(name));
    const all = [...numbers, ...textNames, "resolved"], near = nearestWord(name, all);
    this.fail(word, "'" + word.text + "' is not known", near ? "did you mean '" + near + "'?" : "known are " + all.join(", "));
  }
  strain() {
    if (!this.words.takes("(")) this.unexpected("write h(30 Hz)");
    const number = this.words.here;
    if (number.kind !== "number") this.unexpected("write h(30 Hz)");
    this.words.next();
    this.refuseDecimalComma(number);
    const unit = this.words.unit(this.hertz), word = this.words.here;
    if (!unit && word.kind === "name") this.fail(word, "'" + word.text + "' is not a unit of a frequency", "write " + unitNames(this.hertz));
    if (!unit) this.fail(number, "the frequency has no unit", "write h(" + number.text + " Hz)");
    if (!this.words.takes(")")) this.unexpected("add ')'");
    const hz = Number(number.text) * factorOf(unit, this.hertz), column = this.about.get("h" + hz);
    if (column) return column;
    const known = [...this.about.values()].filter(isStrain).map(c => c.key.slice(1) + " Hz").join(", ");
    this.fail(number, "h is not known there", known ? "h is listed at " + known
                                                      : "this run has no noise yet; write: straytrace noise RUN");
  }
  texts(name) {
    const example = "write " + name + '("*")', tests = [];
    if (!this.words.takes("(")) this.unexpected(example);
    do {
      if (this.words.here.kind !== "quoted") this.unexpected(example);
      const word = this.words.next(), test = globTest(word.text);
      if (name === "kind" && !kindNames.some(kind => test.test(kind))) {
        const near = nearestWord(word.text, kindNames);
        this.fail(word, "no route is of the kind '" + word.text + "'",
                  near ? "did you mean '" + near + "'?" : "kinds are " + kindNames.join(", "));
      }
      tests.push(test);
    } while (this.words.takes(","));
    if (!this.words.takes(")")) this.unexpected("add ')'");
    const values = this.about.get(name === "route" ? "sequence" : name).values;
    const listed = name === "via" ? i => objectsOf(values[i]) : i => [values[i]];
    return i => listed(i).some(value => tests.some(t => t.test(value)));
  }
  compared(word, name, column) {
    const shown = name === "h" ? "h(30 Hz) > 1e-25" : name + " > 1" + (column.needs_unit ? " " + column.units[0][0] : "");
    if (!isComparison(this.words.here)) {
      if (this.words.here.text === "=") this.unexpected("");
      this.fail(word, "'" + word.text + "' needs a comparison", "write for example " + shown);
    }
    const sign = this.words.next().text, number = this.words.here;
    if (number.kind !== "number") this.unexpected("write for example " + shown);
    this.words.next();
    this.refuseDecimalComma(number);
    const limit = Number(number.text) * factorOf(this.unitBehind(number, name, column), column.units);
    return Predicate.ordered(column, sign, column.whole ? limit : sixDigits(limit));
  }
  unitBehind(number, name, column) {
    const unit = this.words.unit(column.units), word = this.words.here;
    if (unit) return unit;
    if ((word.kind === "name" && !joins(word)) || word.text === "%" || word.text === "/")
      this.fail(word, "'" + word.text + "' is not a unit of " + name, column.units.length > 0
          ? "write " + unitNames(column.units) : "leave it out: " + name + " is a plain number");
    if (column.needs_unit) this.fail(number, name + " needs a unit", "write " + number.text + " " + column.units[0][0]);
    return unit;
  }
  static ordered(column, sign, x) {
    const values = column.values;
    switch (sign) {
      case "<": return i => values[i] !== null && values[i] < x;
      case "<=": return i => values[i] !== null && values[i] <= x;
      case ">": return i => values[i] !== null && values[i] > x;
      case ">=": return i => values[i] !== null && values[i] >= x;
      case "!=": return i => values[i] !== null && values[i] !== x;
      default: return i => values[i] !== null && values[i] === x;
    }
  }
  static numbers(about) {
    return ["h", ...[...about.values()].filter(c => c.units && !c.key.endsWith("_sigma") && !isStrain(c)).map(c => c.key)];
  }
}

// What rows a text lets through; plain words are looked for in route, body, port and kind.
function rowTest(text, table) {
  const words = text.toLowerCase().split(/\s+/).filter(w => w);
  if (words.length === 0) return () => true;
  if (/[()<>=!"']/.test(text) || words.some(w => ["resolved", "not", "and", "or"].includes(w))) return new Predicate(text, table).test;
  const texts = table.columns.filter(c => ["sequence", "body", "port", "kind"].includes(c.key)).map(c => c.values);
  return i => words.every(word => texts.some(column => column[i].toLowerCase().includes(word)));
}
