// SPDX-License-Identifier: BSD-3-Clause
#include "scene/diagnostics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "scene/diagnostics.hpp"

namespace straytrace::scene {
namespace {

constexpr std::uint32_t widest = 200;  // code points of a source line that are shown

// One printable element per code point; control characters and broken bytes become harmless.
std::vector<std::string> printable(std::string_view text) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char const c = text[i];
    auto const byte = static_cast<unsigned char>(c);
    bool const lead = byte >= 0xc0, continued = i + 1 < text.size() && (text[i + 1] & 0xc0) == 0x80;
    if ((byte & 0xc0) == 0x80 && !out.empty() && static_cast<unsigned char>(out.back()[0]) >= 0xc0)
      out.back() += c;
    else if (byte == '\t')
      out.emplace_back(" ");
    else if (byte < 0x20 || byte == 0x7f || (byte & 0xc0) == 0x80 || (lead && !continued))
      out.emplace_back("?");
    else
      out.emplace_back(1, c);
  }
  return out;
}

std::string printable_text(std::string_view text) {
  std::string out;
  for (std::string const& c : printable(text)) out += c;
  return out;
}

// Keeps line ends; further lines are aligned below the first.
std::string printable_lines(std::string_view text) {
  std::string out;
  for (std::size_t end; (end = text.find('\n')) != text.npos; text.remove_prefix(end + 1))
    out += printable_text(text.substr(0, end)) + "\n      | ";
  return out + printable_text(text);
}

// Bytes of `text` that hold its first `count` code points.
std::size_t bytes_of(std::string_view text, std::uint32_t count) {
  std::size_t at = 0;
  for (; at < text.size(); ++at)
    if ((static_cast<unsigned char>(text[at]) & 0xc0) != 0x80 && count-- == 0) break;
  return at;
}

// The source line, cut around the column when it is very long, and the underline with the suggestion.
std::string excerpt(Source const& source, Problem const& p) {
  std::uint32_t const column = std::max(p.place.column, 1u) - 1;
  std::uint32_t const first = column < widest ? 0 : column - widest / 2;
  std::string_view rest = source.line(p.place.line);
  rest.remove_prefix(bytes_of(rest, first));
  std::string_view const window = rest.substr(0, bytes_of(rest, widest));
  auto const cells = printable(window);
  std::uint32_t const length = static_cast<std::uint32_t>(cells.size()), offset = std::min(column - first, length);
  std::string shown = first > 0 ? "..." : "";
  std::string const before(shown.size() + offset, ' ');
  for (std::string const& c : cells) shown += c;
  if (window.size() < rest.size()) shown += "...";
  std::uint32_t const width = std::clamp(p.width, 1u, std::max(1u, length - offset));
  return fmt::format("{:>5} | {}\n      | {}{} {}\n", p.place.line, shown, before, std::string(width, '^'),
                     printable_lines(p.suggestion));
}

std::string rendered(SceneDocument const& document, Problem const& p, std::string const& more) {
  Source const& source = document.source(p.place.file);
  std::string where = printable_text(source.name);
  if (p.place.line > 0) where += fmt::format(":{}:{}", p.place.line, p.place.column);
  std::string const head = fmt::format("{}: {}: {}{}\n", where, p.severity == Severity::error ? "error" : "warning",
                                       printable_text(p.what), more);
  if (p.place.line > 0) return head + excerpt(source, p);
  return p.suggestion.empty() ? head : head + fmt::format("      | {}\n", printable_lines(p.suggestion));
}

}  // namespace

std::string rendered_errors(SceneDocument const& document) {
  std::string out;
  auto const errors = document.problems(Severity::error);
  for (Problem const& p : errors) out += rendered(document, p, "");
  std::size_t const n = document.error_count();
  std::string const cut = n > errors.size() ? fmt::format(", {} are shown", errors.size()) : "";
  return out + fmt::format("{} error{}{}. Nothing was run.\n", n, n == 1 ? "" : "s", cut);
}

std::string rendered_warnings(SceneDocument const& document) {
  auto const warnings = document.problems(Severity::warning);
  std::map<std::string, std::size_t> count;
  for (Problem const& p : warnings) ++count[p.what];
  std::string out;
  for (Problem const& p : warnings) {
    std::size_t const n = std::exchange(count[p.what], 0);
    if (n > 0) out += rendered(document, p, n > 1 ? fmt::format(" ({} places, this is the first)", n) : "");
  }
  return out;
}

std::string warnings_as_json(Scene const& scene) {
  auto const* document = dynamic_cast<SceneDocument const*>(scene.root().document());
  auto warnings = document ? document->problems(Severity::warning) : std::vector<Problem>{};
  return warnings.empty() ? "" : problems_as_json(InputError(std::move(warnings), "", document->source_names()));
}

// The list holds errors and warnings; the text for people holds the errors alone.
void throw_errors(SceneDocument const& document) {
  if (document.healthy()) return;
  auto all = document.problems(Severity::error), warnings = document.problems(Severity::warning);
  all.insert(all.end(), warnings.begin(), warnings.end());
  throw InputError(std::move(all), rendered_errors(document), document.source_names());
}

}  // namespace straytrace::scene
