// SPDX-License-Identifier: BSD-3-Clause
// --invert "param(NAME)" NAME=lo..hi: traces at both ends and halves the range as far as the errors allow.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <iostream>

#include "app/interrupt.hpp"
#include "app/invert.hpp"
#include "app/output_folder.hpp"
#include "base/message.hpp"

namespace straytrace {
namespace {

constexpr double sure = 2;  // standard errors

struct Probe {
  double number;
  ScanPoint point;
  bool meets() const { return point.unresolved.empty() && point.ratio.value + sure * point.ratio.sigma < 1; }
  bool fails() const { return point.ratio.value - sure * point.ratio.sigma > 1; }
};

class Search {
 public:
  Search(Scanner& scanner, ScanAxis const& axis, bool quiet, std::atomic<bool> const& stop)
      : scanner_(scanner), axis_(axis), quiet_(quiet), stop_(stop) {}

  // None when stopped.
  std::optional<Probe> at(double number) {
    if (stop_) return {};
    std::string const value =
        axis_.unit.empty() ? fmt::format("{:.12g}", number) : fmt::format("{:.12g} {}", number, axis_.unit);
    if (!quiet_) std::cerr << fmt::format("scan  {} = {}\n", axis_.name, value);
    Probe p{number, scanner_.at({axis_.name + "=" + value})};
    if (!p.point.complete) return {};
    if (std::isnan(p.point.ratio.value))
      throw InputError("error: there is no line to stay under, or no answer\n  name a design curve: --against adv-lal");
    return p;
  }

 private:
  Scanner& scanner_;
  ScanAxis const& axis_;
  bool quiet_;
  std::atomic<bool> const& stop_;
};

std::string words(Probe const& p, std::string const& unit) {
  return fmt::format("{:.6g}{}{} (h/line {}{})", p.number, unit.empty() ? "" : " ", unit,
                     p.point.unresolved.empty() || p.point.ratio.at_most ? "" : "> ", with_error(p.point.ratio));
}

struct Bracket {
  Probe meets, fails;        // the nearest known ends
  std::vector<Probe> doubt;  // between them, from `meets` to `fails`, within two standard errors of the line
  bool stopped = false;
};

struct Gap {
  double from, to;
  double width() const { return std::fabs(to - from); }
};

// Beside the doubt, where an answer is still to be had; the wider one of both sides.
Gap widest(Bracket const& b) {
  if (b.doubt.empty()) return {b.meets.number, b.fails.number};
  Gap const near{b.meets.number, b.doubt.front().number}, far{b.doubt.back().number, b.fails.number};
  return near.width() > far.width() ? near : far;
}

void place(Bracket& b, Probe const& p, bool before_doubt) {
  if (!p.meets() && !p.fails()) {
    b.doubt.insert(before_doubt ? b.doubt.begin() : b.doubt.end(), p);
    return;
  }
  if (p.meets() != before_doubt) b.doubt.clear();  // it lies beyond them
  (p.meets() ? b.meets : b.fails) = p;
}

// The ratio between two probes lies between theirs, within errors.
void refuse_other_shapes(Bracket const& b, Probe const& p, ScanAxis const& axis) {
  auto const above = [](Probe const& x, Probe const& y) {  // x clearly above y
    return x.point.ratio.value - y.point.ratio.value > 3 * std::hypot(x.point.ratio.sigma, y.point.ratio.sigma);
  };
  if (!above(p, b.fails) && !above(b.meets, p)) return;
  throw InputError(
      fmt::format("error: h/line does not go one way with '{}': {}, {} and {}\n  scan the range first, and ask where "
                  "it is monotonic",
                  axis.name, words(b.meets, axis.unit), words(p, axis.unit), words(b.fails, axis.unit)));
}

// Halves what is not known; about the line itself the errors leave a doubt that no halving removes.
void narrow(Bracket& b, Search& search, ScanAxis const& axis, double wanted) {
  for (Gap gap = widest(b); gap.width() > wanted; gap = widest(b)) {
    std::optional<Probe> const p = search.at(0.5 * (gap.from + gap.to));
    b.stopped = !p;
    if (b.stopped) return;
    refuse_other_shapes(b, *p, axis);
    place(b, *p, gap.from == b.meets.number);
  }
}

std::string text_of(Bracket const& b, ScanAxis const& axis, std::string const& what, std::string const& line) {
  std::string text = fmt::format("{}: the total stays under {} at {} and exceeds it at {}.\n", what, line,
                                 words(b.meets, axis.unit), words(b.fails, axis.unit));
  if (!b.doubt.empty())
    text += fmt::format("{}{} it is within two standard errors of the line: trace longer for a narrower answer.\n",
                        b.doubt.size() > 1 ? "Between, as at " : "At ", words(b.doubt[b.doubt.size() / 2], axis.unit));
  if (b.stopped) text += "Stopped before it was as narrow as wanted.\n";
  return text;
}

nlohmann::ordered_json json_of(Bracket const& b, ScanAxis const& axis) {
  return {{"verdict", "found"}, {"meets", b.meets.number}, {"exceeds", b.fails.number},
          {"unit", axis.unit},  {"complete", !b.stopped},  {"limited_by_errors", !b.doubt.empty()}};
}

int stopped_early(Options const& options) {
  if (!options.quiet) std::cerr << (options.out.empty() ? no_way_to_go_on : how_to_go_on);
  return checkpointed;
}

}  // namespace

int invert_parameter(Options const& options, Requirement const& requirement, InvertOrder const& order,
                     std::string const& name, std::vector<ScanAxis> const& axes) {
  if (axes.size() != 1 || axes.front().name != name || !axes.front().range)
    throw InputError(
        fmt::format("error: --invert \"param({0})\" needs one range to look in\n  write {0}=lo..hi", name));
  ScanAxis const& axis = axes.front();
  std::optional<OutputFolder> folder;
  if (!options.out.empty()) folder.emplace(options.out + "/runs");
  InterruptGuard const guard;
  Scanner scanner(options, requirement, options.out);
  Search search(scanner, axis, options.quiet, guard.stop());
  std::optional<Probe> const low = search.at(axis.numbers.front()),
                             high = low ? search.at(axis.numbers.back()) : std::nullopt;
  if (!high) return stopped_early(options);  // one end is no answer
  std::string const ends = fmt::format("{} and {}", words(*low, axis.unit), words(*high, axis.unit));
  nlohmann::ordered_json answer;
  std::string text;
  bool stopped = false;
  if (low->meets() && high->meets()) {
    answer["verdict"] = "always";
    text = fmt::format("{}: both ends stay under {}: {}.\n", order.what, scanner.line(), ends);
  } else if (!low->meets() && !high->meets()) {
    answer["verdict"] = low->fails() && high->fails() ? "never" : "undecided";
    text = fmt::format("{}: neither end is known to stay under {}: {}.\n", order.what, scanner.line(), ends);
  } else if (!low->fails() && !high->fails()) {
    answer["verdict"] = "undecided";
    text = fmt::format("{}: neither end is known to exceed {}: {}. Trace longer.\n", order.what, scanner.line(), ends);
  } else {
    Bracket b{low->meets() ? *low : *high, low->meets() ? *high : *low, {}};
    narrow(b, search, axis, order.tolerance * std::fabs(high->number - low->number));
    answer = json_of(b, axis);
    text = text_of(b, axis, order.what, scanner.line());
    stopped = b.stopped;
  }
  nlohmann::ordered_json const j{{"question", order.what}, {"line", scanner.line()}, {"answer", answer}};
  std::cout << (options.json() ? j.dump(2) + "\n" : text);
  return stopped ? stopped_early(options) : done;
}

}  // namespace straytrace
