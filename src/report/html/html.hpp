// SPDX-License-Identifier: BSD-3-Clause
// One self-contained HTML file: it loads nothing, and its content security policy forbids loading. A page of a program
// that runs may ask that program alone.
#pragma once

#include <nlohmann/json.hpp>

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "results/results.hpp"

namespace straytrace::report {

struct HtmlPage {
  std::string title, body;            // body: HTML shown without scripts
  nlohmann::json data;                // for the scripts
  std::vector<std::string> scripts;   // of data/page, in order
  bool plots = false, scene = false;  // libraries that they need
  bool live = false;                  // served by the program itself (io/loopback_server.hpp)
};
std::string html_text(HtmlPage const&);

// Summary sentence, picture, table and text of a run as HTML, for browsers without scripts.
struct Picture {
  std::string type, bytes;  // "png", "svg+xml"; no bytes: none
};
struct StaticReport {
  std::string verdict, headline, text;
  Picture picture;  // of the budget
  std::size_t most_rows = 5000;
};
std::string static_head(StaticReport const&);
std::string static_body(StaticReport const&, PathTable const&);

// Third-party scripts inside pages, from packages that CMake found.

struct PageScript {
  std::string_view name, licence, text;
};
PageScript const& d3_script();  // https://d3js.org, BSD-3-Clause
// https://threejs.org, MIT: the library, then its orbit controls; `text`: gzip as base64.
std::span<PageScript const> three_scripts();

}  // namespace straytrace::report
