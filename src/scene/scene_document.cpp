// SPDX-License-Identifier: BSD-3-Clause
#include "scene/scene_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

#include "base/files/read_write.hpp"
#include "io/delimited_text.hpp"
#include "io/observatory_data.hpp"
#include "scene/model_tree.hpp"
#include "scene/parts.hpp"
#include "scene/scope.hpp"

namespace straytrace::scene {
namespace {

constexpr std::size_t most_problems = 1000;  // kept; more are only counted

std::vector<std::size_t> line_starts(std::string_view text) {
  std::vector<std::size_t> starts{0};
  for (std::size_t at = text.find('\n'); at != std::string_view::npos; at = text.find('\n', at + 1))
    starts.push_back(at + 1);
  return starts;
}

bool is_absolute(std::string_view name) {
  bool const drive = name.size() > 1 && name[1] == ':';
  return name.starts_with('/') || name.starts_with('\\') || name.starts_with('~') || drive;
}

// The samples of a record of the observatories, relative to the folder of the scene; empty and a problem without them.
std::optional<std::string> observatory_file(Node const& named_by, ObservatoryRequest asked,
                                            std::filesystem::path const& folder, std::size_t size_limit) {
  std::string const written = asked.source;
  if (!asked.source.starts_with("nds2://")) asked.source = (folder / asked.source).string();
  ObservatoryData found = observatory_record(asked);
  if (found.why.empty() && found.bytes.size() > size_limit) {
    found.why = fmt::format("the samples take more than {} MB, which a scene holds at most", size_limit >> 20);
    found.remedy = "choose a shorter span, or reduce the rate first with straytrace signal convert";
  }
  if (!found.why.empty()) {
    named_by.problem(fmt::format("'{}': {}", shortened(written), found.why), found.remedy);
    return {};
  }
  for (TextLine const& line : text_lines(found.warnings, Comments::kept))
    named_by.warning(std::string(line.text.substr(line.text.find(": ") + 2)), "see docs/reference/signal.md");
  return std::move(found.bytes);
}

void refuse_library_name(Node const& named_by, std::string const& name) {
  std::vector<std::string> names;
  for (EmbeddedFile const& file : embedded_files())
    if (is_library(file.name)) names.emplace_back(file.name);
  named_by.problem(
      fmt::format("no file '{}', neither next to the main file nor in the library of the program", shortened(name)),
      did_you_mean(name, names, "'straytrace library' lists its files"));
}

bool contains_word(std::string_view text, std::string_view word) {
  auto const in_word = [&](std::size_t i) {
    return i < text.size() && (std::isalnum(static_cast<unsigned char>(text[i])) || text[i] == '_');
  };
  for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1))
    if (!(at > 0 && in_word(at - 1)) && !in_word(at + word.size())) return true;
  return false;
}

}  // namespace

std::string_view Source::line(std::uint32_t number) const {
  if (number == 0 || number > lines.size()) return {};
  std::size_t const begin = lines[number - 1];
  std::size_t const end = number < lines.size() ? lines[number] - 1 : text.size();
  std::string_view out = std::string_view(text).substr(begin, end - begin);
  if (out.ends_with('\r')) out.remove_suffix(1);
  return out;
}

SceneDocument::SceneDocument(std::filesystem::path folder, FileTexts const* texts,
                             std::vector<std::string> const& overrides)
    : folder_(std::move(folder)), texts_(texts), overrides_(overrides) {
  for (std::string& o : overrides_)
    for (char& c : o)
      if (static_cast<unsigned char>(c) < 0x20) c = '?';
}

// The parameter in the entry that the expression with the problem contains.
NodeData::Entry const* SceneDocument::blamed_parameter(Problem const& p) const {
  if (!blame->entry->find("use")) return nullptr;
  std::string_view const line = sources_[p.place.file].line(p.place.line);
  std::string_view const expression = line.substr(std::min<std::size_t>(p.place.column - 1, line.size()), p.width);
  for (NodeData::Entry const& e : blame->entry->entries)
    if (!is_entry_key(e.key) && e.value->kind == Node::Kind::scalar && contains_word(expression, e.key)) return &e;
  return nullptr;
}

Problem SceneDocument::where_the_user_can_act(Problem p) const {
  if (!blame || (p.place.file != blame->hidden && !is_library(sources_[p.place.file].name))) return p;
  if (NodeData::Entry const* parameter = p.place.line > 0 ? blamed_parameter(p) : nullptr) {
    p.suggestion = fmt::format("change it: {}", p.what);
    p.what = fmt::format("'{}' does not suit the part '{}'", parameter->key, blame->entry->find("use")->value->text);
    p.place = parameter->value->place;
    p.width = parameter->value->width;
  } else {
    p.what = fmt::format("'{}': {}", blame->name, p.what);
    p.suggestion = fmt::format("change the parameters of the part ({}:{}:{}: {})", sources_[p.place.file].name,
                               p.place.line, p.place.column, p.suggestion);
    p.place = blame->place;
    p.width = blame->width;
  }
  return p;
}

void SceneDocument::add(Problem p) {
  if (p.place.line > 0 && is_binary(sources_[p.place.file].text)) {
    Severity const severity = p.severity;
    p = binary_problem(sources_[p.place.file].text, p.place.file);
    p.severity = severity;
  }
  p = where_the_user_can_act(std::move(p));
  if (!seen_.emplace(p.place.file, p.place.line, p.place.column, p.what).second) return;
  if (p.severity == Severity::error) ++errors_;
  if (problems_.size() < most_problems) problems_.push_back(std::move(p));
  if (seen_.size() > 100 * most_problems) seen_.clear();  // hostile input must not fill the memory
}

void SceneDocument::withdraw(Problem p) {
  p = where_the_user_can_act(std::move(p));
  auto const key = [](Problem const& q) { return std::tuple(q.place.file, q.place.line, q.place.column, q.what); };
  errors_ -= std::erase_if(problems_, [&](Problem const& q) { return key(q) == key(p); });
}

std::optional<Value> SceneDocument::evaluate(NodeData const& node, Scope const* scope) {
  return evaluate(node, {[scope](std::string_view name) { return find_parameter(scope, name); },
                         [scope] { return parameter_names(scope); }});
}

std::optional<Value> SceneDocument::evaluate(NodeData const& node, ParameterLookup const& lookup) {
  try {
    return evaluate_expression(node.text, lookup);
  } catch (ExpressionProblem const& p) {
    Problem problem{node.place, p.what, p.suggestion, Severity::error, node.width};
    if (node.inset >= 0 && p.end > p.begin) {
      std::string_view const text = node.text;
      problem.place.column += static_cast<std::uint32_t>(node.inset) + code_points(text.substr(0, p.begin));
      problem.width = std::max(1u, code_points(text.substr(p.begin, p.end - p.begin)));
    }
    add(std::move(problem));
    return {};
  }
}

std::optional<std::string> SceneDocument::origin(std::string_view expression, Scope const* scope) const {
  std::optional<std::string> found;
  std::set<std::string_view> hidden;  // by those of the same name further inside
  for (; scope; scope = scope->outer.get())
    for (auto const& [name, value] : scope->own) {
      if (!contains_word(expression, name) || !hidden.insert(name).second) continue;
      if (auto const hit = scope->origins.find(name); hit != scope->origins.end()) return hit->second;
      found = "";
    }
  return found;
}

std::uint32_t SceneDocument::add_source(std::string name, std::string text, bool stored) {
  Source s{std::move(name), std::move(text), stored};
  s.lines = line_starts(s.text);
  if (stored) files_[s.name] = s.text;
  sources_.push_back(std::move(s));
  return static_cast<std::uint32_t>(sources_.size() - 1);
}

std::uint32_t SceneDocument::command_line() {
  if (!command_line_) {
    std::string text;
    for (std::string const& o : overrides_) text += fmt::format("-p {}\n", o);
    command_line_ = add_source(std::string(command_line_name), std::move(text), false);
  }
  return *command_line_;
}

std::optional<std::string> SceneDocument::read(std::string const& name, std::size_t size_limit, std::string& why) {
  if (texts_) {
    auto const hit = texts_->find(name);
    if (hit == texts_->end())
      why = "the stored model does not contain it";
    else if (hit->second.size() > size_limit)
      why = fmt::format("it is larger than {} MB", size_limit >> 20);
    else
      return hit->second;
    return {};
  }
  std::filesystem::path const path = folder_ / name;
  if (auto text = unsaved_text(path)) return text;
  FileBytes file = bytes_of_file(path, size_limit);
  why = std::move(file.why);
  if (!why.empty()) return {};
  return std::move(file.bytes);
}

std::uint32_t SceneDocument::open_main(std::string const& name) {
  std::string why;
  auto text = read(name, model_file_limit, why);
  if (!text) {
    std::string const head = texts_ ? "" : head_of_file(folder_ / name, 15);
    if (head == "straytrace-run ") why = "it is a run file, not a scene";
    std::string const remedy = head == "straytrace-run "
                                   ? "name the scene file; straytrace paths, noise and report read run files"
                                   : remedy_for_unreadable(folder_ / name);
    throw InputError(
        {{{}, "cannot read this file: " + why, remedy}},
        fmt::format("{}: error: cannot read this file: {}\n      | {}\n1 error. Nothing was run.\n", name, why, remedy),
        {name});
  }
  return add_source(name, std::move(*text), true);
}

std::string SceneDocument::name_from(Node const& named_by, std::string const& written) const {
  Source const& from = sources_.at(named_by.place().file);
  auto const base = from.stored ? std::filesystem::path(from.name).parent_path() : std::filesystem::path();
  return (base / written).lexically_normal().generic_string();
}

std::optional<std::uint32_t> SceneDocument::known_source(std::string const& name) const {
  for (std::uint32_t i = 0; i < sources_.size(); ++i)
    if (sources_[i].stored && sources_[i].name == name) return i;
  return {};
}

std::optional<std::uint32_t> SceneDocument::open(Node const& named_by, std::string const& written,
                                                 std::size_t size_limit) {
  bool const control =
      std::any_of(written.begin(), written.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; });
  if (written.empty() || control) {
    named_by.problem("this is not a file name", "write a name relative to this file, for example 'data/steel.csv'");
    return {};
  }
  auto const record = request_of_name(written);
  if (is_absolute(written) && !record) {
    named_by.problem(fmt::format("'{}' is an absolute path, which is not valid on other machines", shortened(written)),
                     "write a name relative to this file, for example 'data/steel.csv'");
    return {};
  }
  bool const remote = record && record->source.starts_with("nds2://");
  std::string const name = remote ? written : name_from(named_by, written);
  if (auto const known = known_source(name)) return known;
  std::string why;
  if (record && !texts_) {
    auto samples = observatory_file(named_by, *request_of_name(name), folder_, size_limit);
    return samples ? std::optional(add_source(name, std::move(*samples), true)) : std::nullopt;
  }
  auto text = read(name, size_limit, why);
  if (!text)
    if (auto const file = open_library(name, written)) return file;
  if (!text) {
    if (is_library(name) && !texts_) {
      refuse_library_name(named_by, name);
      return {};
    }
    std::string const near = texts_ ? "" : nearest_file(folder_ / name);
    std::string const meant = near.empty()
                                  ? ""
                                  : fmt::format("did you mean '{}'? ",
                                                (std::filesystem::path(written).parent_path() / near).generic_string());
    named_by.problem(
        fmt::format("cannot read file '{}': {}", shortened(written), why),
        fmt::format("{}names are relative to the file that contains them; '{}' was searched next to the main file",
                    meant, shortened(name)));
    return {};
  }
  return add_source(name, std::move(*text), true);
}

// The file of the built-in library, where the user has none of that name. Files of the library name one another by
// their path in it; a stored model never mixes with the library of another version.
std::optional<std::uint32_t> SceneDocument::open_library(std::string const& name, std::string const& written) {
  std::string const shipped =
      is_library(name) ? name : std::filesystem::path(written).lexically_normal().generic_string();
  if (!is_library(shipped)) return {};
  if (auto const known = known_source(shipped)) return known;
  if (texts_) {
    auto const hit = texts_->find(shipped);
    if (hit == texts_->end()) return {};
    return add_source(shipped, hit->second, true);
  }
  std::string_view const text = embedded_file(shipped);
  if (text.empty()) return {};
  return add_source(shipped, std::string(text), true);
}

std::string SceneDocument::data_file(Node const& from, std::string const& name) {
  auto const file = open(from, name, data_file_limit);
  return file ? sources_[*file].text : std::string();
}

std::optional<std::string> SceneDocument::optional_file(Node const& from, std::string const& written) {
  if (written.empty() || is_absolute(written)) return {};
  std::string const name = name_from(from, written);
  if (auto const known = known_source(name)) return sources_[*known].text;
  std::string why;
  auto text = read(name, data_file_limit, why);
  if (text) add_source(name, *text, true);
  return text;
}

std::optional<std::string> SceneDocument::derived_file(Node const& from, std::string const& written,
                                                       std::function<std::optional<std::string>()> const& make) {
  std::string const name = name_from(from, written);
  if (auto const known = known_source(name)) return sources_[*known].text;
  auto const kept = texts_ ? texts_->find(name) : FileTexts::const_iterator();
  std::optional<std::string> text = texts_ && kept != texts_->end() ? kept->second : make();
  if (text) add_source(name, *text, true);
  return text;
}

Place SceneDocument::place_in_file(Node const& from, std::string const& name, std::uint32_t line,
                                   std::uint32_t column) {
  auto const file = open(from, name, data_file_limit);
  return file ? Place{*file, line, column} : from.place();
}

std::vector<std::string> SceneDocument::source_names() const {
  std::vector<std::string> names;
  for (Source const& s : sources_) names.push_back(s.name);
  return names;
}

std::vector<Problem> SceneDocument::problems(Severity severity) const {
  std::vector<Problem> out;
  std::copy_if(problems_.begin(), problems_.end(), std::back_inserter(out),
               [&](Problem const& p) { return p.severity == severity; });
  auto const key = [](Problem const& p) { return std::tuple(p.place.file, p.place.line, p.place.column); };
  std::stable_sort(out.begin(), out.end(), [&](Problem const& a, Problem const& b) { return key(a) < key(b); });
  return out;
}

namespace {

struct UnsavedText {
  std::string name, text;  // as given
  bool read = false;
};
std::map<std::filesystem::path, UnsavedText> texts;
std::mutex guard;  // of `texts`

std::filesystem::path key(std::filesystem::path const& file) {
  return std::filesystem::absolute(file).lexically_normal();
}

}  // namespace

void set_unsaved(std::filesystem::path const& file, std::string text) {
  std::lock_guard const alone(guard);
  texts[key(file)] = {file.string(), std::move(text)};
}

void forget_unsaved(std::filesystem::path const& file) {
  std::lock_guard const alone(guard);
  texts.erase(key(file));
}

std::optional<std::string> unsaved_text(std::filesystem::path const& file) {
  std::lock_guard const alone(guard);
  if (texts.empty()) return {};
  auto const hit = texts.find(key(file));
  if (hit == texts.end()) return {};
  hit->second.read = true;
  return hit->second.text;
}

std::vector<std::string> unread_unsaved() {
  std::lock_guard const alone(guard);
  std::vector<std::string> names;
  for (auto const& [file, unsaved] : texts)
    if (!unsaved.read) names.push_back(unsaved.name);
  return names;
}

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
