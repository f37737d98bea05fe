// SPDX-License-Identifier: BSD-3-Clause
// The language of filters, of columns to sort by and of stop rules.
#include "base/errors.hpp"
#include "fuzz.hpp"
#include "results/route_table/route_filter.hpp"
#include "session/model.hpp"
#include "unit/results/synthetic.hpp"

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  using namespace straytrace;
  static TraceResult const trace = test::trace_result();
  static NoiseBudget const noise = test::noise_budget(trace.coupling);
  static MotionSet const shake = test::motion();
  static PathTable const table = path_table(trace.coupling, &noise, &shake, {{10, 30, 100}, 10, 500, 12});
  static RouteColumns columns{table, &noise};
  std::string const text(fuzz::text_of(data, size));
  FilterAnswer const answer = filtered(text, columns);
  for (FilterProblem const& p : answer.problems) (void)error_in_filter("--where", text, p);
  (void)sorted_by(text, answer.rows, columns);
  try {
    (void)parse_stop_rule(text);
  } catch (InputError const&) {
  }
  return 0;
}
