// SPDX-License-Identifier: BSD-3-Clause
// Tables that are printed as text, CSV or JSON.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <variant>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::results {

struct Sheet {
  struct Column {
    std::string key, unit;  // "power", "W"; without unit: text or a plain number
    int digits = 6;         // of a number in the text
    double scale = 1;       // of the text, to the unit `shown`
    std::string shown{};
  };
  using Cell = std::variant<std::string, double>;  // not a number: unknown
  std::string name, heading;                       // key of the JSON; line above the text
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
};

std::string text_of(std::vector<Sheet> const&);
std::string csv_of(std::vector<Sheet> const&);  // "# NAME" before each of several
// Titles, cells as in the text and which columns are text, for a page.
nlohmann::ordered_json page_of(std::vector<Sheet> const&);
nlohmann::ordered_json json_of(std::vector<Sheet> const&);

}  // namespace straytrace::results
