// SPDX-License-Identifier: BSD-3-Clause
#include "support/recorded.hpp"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace straytrace::testing::recorded {
namespace {

constexpr std::size_t kept_samples = 16;

// One comparison of the source with what it saw: the first numbers and those nearest to the limit.
struct Seen {
  Kind kind;
  std::string at, what, against;
  std::vector<Comparison> samples;
  Comparison worst;
  double nearest;
  long long count = 0;
};

// Share of what is allowed that is used up: 1 at the limit. Of a mean in standard errors.
double used(Comparison const& c) {
  double const gap = std::fabs(c.obtained - c.expected);
  switch (c.kind) {
    case Kind::near:
    case Kind::mean:
      return gap == 0 ? 0 : gap / c.allowed;
    case Kind::below:
      return c.expected > 0 ? c.obtained / c.expected : 0;
    case Kind::above:
      return c.obtained > 0 ? c.expected / c.obtained : 0;
    default:
      return 0;
  }
}

std::mutex guard;
std::vector<Seen> seen;  // in the order of the test
std::map<std::tuple<char const*, unsigned, std::string>, std::size_t> places;

// "tests/unit/a.cpp" of any path to it: a compiler cache writes it relative to the build folder.
std::string in_tree(std::string const& file) {
  auto const tests = file.rfind("/tests/");
  return tests == std::string::npos ? file : file.substr(tests + 1);
}

nlohmann::json numbers(Comparison const& c) { return {c.obtained, c.expected, c.allowed}; }

nlohmann::json json_of(Seen const& s) {
  static constexpr char const* names[] = {"near", "mean", "below", "above", "equal"};
  nlohmann::json samples = nlohmann::json::array();
  for (Comparison const& c : s.samples) samples.push_back(numbers(c));
  return {{"kind", names[int(s.kind)]}, {"at", s.at},       {"what", s.what},
          {"against", s.against},       {"count", s.count}, {"samples", samples},
          {"worst", numbers(s.worst)},  {"used", s.nearest}};
}

class Writer final : public ::testing::EmptyTestEventListener {
  void OnTestStart(::testing::TestInfo const&) override {
    seen.clear();
    places.clear();
  }
  void OnTestEnd(::testing::TestInfo const& test) override {
    std::string const name = std::string(test.test_suite_name()) + "." + test.name();
    std::string file = name + ".json";
    for (char& c : file)
      if (c == '/') c = '-';
    auto const target = std::filesystem::path(STRAY_RECORDS) / file;
    std::error_code ignored;
    if (!test.result()->Passed() || test.result()->Skipped()) {
      std::filesystem::remove(target, ignored);
      return;
    }
    nlohmann::json record = {{"test", name}, {"comparisons", nlohmann::json::array()}};
    for (Seen const& s : seen) record["comparisons"].push_back(json_of(s));
    std::filesystem::create_directories(target.parent_path(), ignored);
    auto const half = target.string() + ".part";
    std::ofstream(half) << record.dump(1) << '\n';
    std::filesystem::rename(half, target, ignored);
    for (Seen const& s : seen) print(s);
  }
  static void print(Seen const& s) {
    Comparison const& c = s.worst;
    std::printf("  %s: obtained %.8g, %s %.8g", s.what.c_str(), c.obtained,
                c.kind == Kind::below   ? "at most"
                : c.kind == Kind::above ? "at least"
                                        : "expected",
                c.expected);
    if (c.kind == Kind::mean) std::printf(" +- %.2g, error %.2f sigma", c.allowed, s.nearest);
    if (c.kind == Kind::near) std::printf(", error %.2g of %.2g", c.obtained - c.expected, c.allowed);
    if (s.count > 1) std::printf(" (the nearest to its limit of %lld)", s.count);
    std::printf("\n");
  }
};

[[maybe_unused]] bool const listening = [] {
  ::testing::UnitTest::GetInstance()->listeners().Append(new Writer);  // which takes it
  return true;
}();

}  // namespace

void record(Comparison const& c) {
  std::lock_guard const lock(guard);
  auto const [place, fresh] = places.try_emplace({c.file, c.line, c.what}, seen.size());
  if (fresh) {
    seen.push_back({c.kind, in_tree(c.file) + ":" + std::to_string(c.line), c.what, c.against, {}, c, -1});
  }
  Seen& s = seen[place->second];
  ++s.count;
  if (s.samples.size() < kept_samples) s.samples.push_back(c);
  if (double const share = used(c); share > s.nearest) s.nearest = share, s.worst = c;
}

}  // namespace straytrace::testing::recorded
