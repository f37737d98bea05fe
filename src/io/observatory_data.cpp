// SPDX-License-Identifier: BSD-3-Clause
#include "io/observatory_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <vector>

#include "base/files/read_write.hpp"
#include "base/process/child_process.hpp"

namespace straytrace::io {
namespace {

constexpr std::string_view server = "nds2://";
constexpr double unbounded = 1e299;

std::string lower(std::string_view text) {
  std::string out(text);
  std::ranges::transform(out, out.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return out;
}

std::string without_end(std::string text) {
  text.erase(text.find_last_not_of(" \n\r") + 1);
  return text;
}

// "error: WHAT\n  REMEDY" of the module, or the last line of Python's own message.
ObservatoryData failed(PythonChild const& child) {
  if (!child.has_package)
    return {"", "", "the folder python/straytrace, which reads it, was not found near the program",
            "set STRAYTRACE_PYTHONPATH to the folder that contains it"};
  if (child.start_error != 0)
    return {"", "",
            fmt::format("cannot start '{}', which reads it: {}", child.python, std::strerror(child.start_error)),
            "install Python with numpy, h5py and gwframe, and name it in STRAYTRACE_PYTHON"};
  constexpr std::string_view mark = "error: ";
  std::string const text = without_end(child.output);
  if (std::size_t const at = text.starts_with(mark) ? 0 : text.find("\nerror: "); at != text.npos) {
    std::size_t const begin = at + mark.size() + (at > 0 ? 1 : 0),
                      end = std::min(text.find("\n  ", begin), text.size());
    return {"", "", text.substr(begin, end - begin), end < text.size() ? text.substr(end + 3) : "see the manual"};
  }
  std::string const last = text.substr(text.rfind('\n') + 1);
  if (text.find("ModuleNotFoundError") != text.npos)
    return {"", "", fmt::format("{} says '{}'", child.python, last),
            fmt::format("{} -m pip install numpy h5py gwframe", child.python)};
  return {"", "", fmt::format("{} says '{}'", child.python, last), "check the file, or copy it again"};
}

std::string warnings_in(std::string const& output) {
  std::string found;
  for (std::size_t at = 0; at < output.size();) {
    std::size_t const end = std::min(output.find('\n', at), output.size());
    std::string_view const line = std::string_view(output).substr(at, end - at);
    if (line.starts_with("warning: ") || line.starts_with("note: ")) found += fmt::format("{}\n", line);
    at = end + 1;
  }
  return found;
}

ObservatoryData run(std::vector<std::string> words, std::string const& result) {
  TemporaryFolder const place("the data of the frames");
  std::string const out = place.path(result);
  words.insert(words.begin(), "straytrace.observatory");
  words.insert(words.end(), {"-o", out});
  PythonChild const child = run_python(std::move(words), PythonChoice::path);
  if (!child.has_package || child.start_error != 0 || child.status != 0) return failed(child);
  FileBytes read = bytes_of_file(out);
  return {std::move(read.bytes), warnings_in(child.output), read.why,
          read.why.empty() ? "" : "free some space in TMPDIR"};
}

// Enough digits for every double.
std::string digits(double gps) { return fmt::format("{}", gps); }

std::optional<double> end_of_span(std::string_view text, double otherwise) {
  if (text.empty()) return otherwise;
  double value = 0;
  auto const [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

}  // namespace

bool is_observatory_data(std::string_view source) {
  std::string const name = lower(source);
  return name.starts_with(server) || std::ranges::any_of(std::array{".gwf", ".ffl", ".lcf", ".cache"},
                                                         [&](char const* ending) { return name.ends_with(ending); });
}

ObservatoryData observatory_record(ObservatoryRequest const& asked) {
  std::vector<std::string> words{"record", asked.source, "--channel=" + asked.channel};
  if (asked.from > -unbounded) words.push_back("--from=" + digits(asked.from));
  if (asked.to < unbounded) words.push_back("--to=" + digits(asked.to));
  if (asked.gaps) words.emplace_back("--gaps");
  return run(std::move(words), "record.hdf5");
}

ObservatoryData observatory_segments(std::string const& file, std::string const& flag) {
  return run({"segments", file, "--flag=" + flag}, "segments.txt");
}

std::string kept_name(ObservatoryRequest const& r) {
  return fmt::format("{}::{}@{}..{}", r.source, r.channel, r.from > -unbounded ? digits(r.from) : "",
                     r.to < unbounded ? digits(r.to) : "");
}

std::optional<ObservatoryRequest> request_of_name(std::string const& name) {
  std::size_t const colons = name.find("::"), at = name.rfind('@');
  if (colons == name.npos || at == name.npos || at < colons || !is_observatory_data(name.substr(0, colons))) return {};
  std::size_t const dots = name.find("..", at);
  if (dots == name.npos) return {};
  auto const from = end_of_span(std::string_view(name).substr(at + 1, dots - at - 1), -1e300);
  auto const to = end_of_span(std::string_view(name).substr(dots + 2), 1e300);
  if (!from || !to) return {};
  return ObservatoryRequest{name.substr(0, colons), name.substr(colons + 2, at - colons - 2), *from, *to};
}

}  // namespace straytrace::io
