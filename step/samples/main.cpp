// SPDX-License-Identifier: BSD-3-Clause
// Writes one of the sample files: straytrace-step-sample WHAT FILE [UNIT] [SCHEMA]. examples/data/bench.step is
// 'bench'.
#include <iostream>
#include <map>

#include "step/samples/samples.hpp"

int main(int argc, char** argv) {
  using straytrace::step::StepBuilder;
  namespace step = straytrace::step;
  std::map<std::string, void (*)(StepBuilder&)> const known = {
      {"solids", step::add_solids}, {"nested", step::add_nested},
      {"mirror", step::add_mirror}, {"crossing", step::add_crossing},
      {"sheet", step::add_sheet},   {"wire", step::add_wire},
      {"lens", step::add_lens},     {"thread", step::add_thread},
      {"bench", step::add_bench},   {"breadboard", [](StepBuilder& b) { step::add_breadboard(b, 40, 25); }}};
  if (argc < 3 || !known.contains(argv[1])) {
    std::cerr << "usage: straytrace-step-sample WHAT FILE [MM|INCH|M] [AP203|AP214IS|AP242DIS]; WHAT is one of";
    for (auto const& [name, add] : known) std::cerr << ' ' << name;
    std::cerr << '\n';
    return 2;
  }
  StepBuilder builder;
  known.at(argv[1])(builder);
  if (builder.write(argv[2], argc > 3 ? argv[3] : "MM", argc > 4 ? argv[4] : "AP214IS")) return 0;
  std::cerr << "cannot write " << argv[2] << '\n';
  return 1;
}
