// SPDX-License-Identifier: BSD-3-Clause
// Fail for a formula of the documents that KaTeX cannot set. Usage: node check_formulas.js FOLDER
const fs = require("fs");
const path = require("path");
const katex = require("/usr/share/nodejs/katex");

const code = /^```.*?^```|`[^`\n]*`/gms;
const formula = /\$\$(.+?)\$\$|\$(?!\s)([^$]+?)(?<!\s)\$(?!\d)/gs;

let formulas = 0;
let problems = 0;
function check(file) {
  // What is cut out leaves its lines behind, so that places stay true.
  const text = fs.readFileSync(file, "utf8").replace(code, (cut) => cut.replace(/[^\n]/g, " "));
  for (const found of text.matchAll(formula)) {
    ++formulas;
    try {
      katex.renderToString(found[1] ?? found[2], {displayMode: found[1] !== undefined, strict: "ignore"});
    } catch (error) {
      ++problems;
      console.log(`${file}:${text.slice(0, found.index).split("\n").length}: ${error.message}`);
    }
  }
}

function walk(folder) {
  for (const entry of fs.readdirSync(folder, {withFileTypes: true})) {
    const name = path.join(folder, entry.name);
    if (entry.isDirectory()) walk(name);
    else if (name.endsWith(".md")) check(name);
  }
}

walk(process.argv[2]);
console.log(`${formulas} formulas, ${problems} that cannot be set`);
process.exit(problems || !formulas ? 1 : 0);
