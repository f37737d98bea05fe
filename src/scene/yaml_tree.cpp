// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <array>
#include <optional>
#include <sstream>

#include "base/text/words.hpp"
#include "scene/parts.hpp"

namespace straytrace::scene {
namespace {

// As the parser gives it: line and column from 0, in bytes.
struct SyntaxComplaint {
  int line = 0, column = 0;
  std::string text;
};

struct Syntax {
  std::string_view complaint, what, suggestion;
};
constexpr std::array syntax{
    Syntax{"illegal flow end", "brackets of different kinds do not match", "close '[' with ']' and '{' with '}'"},
    Syntax{"illegal map value", "a second ': ' in one value", "quote text that contains ': ', or start a new line"},
    Syntax{"end of sequence not found", "the indentation does not match the list above",
           "align the keys of one entry in one column"},
    Syntax{"end of map not found", "the indentation does not match the table above",
           "align the keys of one table in one column"},
    Syntax{"bad file", "tables and lists are nested too deeply", "check the brackets"},  // the parser's own limit
};

// The innermost bracket left open in the lines before `last` (0: in the whole file). Quotes and comments are skipped
// the way YAML sees them: both begin only where a value may begin, brackets too unless one is open already.
std::optional<Place> unclosed_bracket(Source const& source, std::uint32_t file, std::uint32_t last) {
  struct Bracket {
    std::uint32_t line;
    std::size_t byte;
  };
  std::vector<Bracket> open;
  char quote = '\0';
  for (std::uint32_t number = 1; number <= source.lines.size() && (last == 0 || number < last); ++number) {
    std::string_view const line = source.line(number);
    bool starts = true;  // a value may begin here
    for (std::size_t i = 0; i < line.size(); ++i) {
      char const c = line[i];
      if (quote) {
        if (c == '\\' && quote == '"') ++i;
        if (c == quote) quote = '\0';
        continue;
      }
      if (c == '#' && (i == 0 || line[i - 1] == ' ')) break;
      if (c == ' ') continue;
      if (starts && (c == '"' || c == '\'')) quote = c;
      if ((c == '[' || c == '{') && (starts || !open.empty())) open.push_back({number, i});
      if ((c == ']' || c == '}') && !open.empty()) open.pop_back();
      starts = std::string_view("[{,:-").find(c) != std::string_view::npos;
    }
  }
  if (open.empty()) return {};
  auto const [number, byte] = open.back();
  return Place{file, number, code_points(source.line(number).substr(0, byte)) + 1};
}

// Records the cause in words of the input language: a bracket left open, a value that ran into the next line
// (`broken_lines`, found before the complaint), or else the message of the parser.
void report_syntax(SceneDocument& document, std::uint32_t file, std::vector<Problem> const& broken_lines,
                   SyntaxComplaint const& c) {
  Source const& source = document.source(file);
  std::uint32_t const number = static_cast<std::uint32_t>(std::max(0, c.line) + 1);
  bool const at_end = c.text.find("flow not found") != std::string::npos;  // its place is not where the cause is
  if (auto const open = unclosed_bracket(source, file, at_end ? 0 : number)) {
    document.add(
        {*open, "this bracket is not closed", "add ']' or '}' where it ends; look for a missing comma or quote too"});
    return;
  }
  for (Problem const& p : broken_lines) document.add(p);
  if (!broken_lines.empty()) return;
  auto const bytes = static_cast<std::size_t>(std::max(0, c.column));
  Place const place{file, number, code_points(source.line(number).substr(0, bytes)) + 1};
  auto const hit = std::ranges::find_if(syntax, [&](Syntax const& s) { return s.complaint == c.text; });
  if (hit != syntax.end())
    document.add({place, std::string(hit->what), std::string(hit->suggestion)});
  else
    document.add({place, fmt::format("this is not valid YAML ({})", c.text),
                  "check indentation, brackets, quotes and ': ' near here"});
}

// Length of the well-formed UTF-8 sequence at `at`; 0 when it is broken (overlong, surrogate, too large, cut off).
std::size_t sequence_length(std::string_view text, std::size_t at) {
  auto const byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  auto const tail = [&](std::size_t i) { return (byte(i) & 0xc0) == 0x80; };
  unsigned const b = byte(at), second = byte(at + 1);
  if (b < 0x80) return 1;
  if (b >= 0xc2 && b <= 0xdf) return tail(at + 1) ? 2 : 0;
  if (b >= 0xe0 && b <= 0xef) {
    bool const bad = (b == 0xe0 && second < 0xa0) || (b == 0xed && second > 0x9f);
    return !bad && tail(at + 1) && tail(at + 2) ? 3 : 0;
  }
  if (b >= 0xf0 && b <= 0xf4) {
    bool const bad = (b == 0xf0 && second < 0x90) || (b == 0xf4 && second > 0x8f);
    return !bad && tail(at + 1) && tail(at + 2) && tail(at + 3) ? 4 : 0;
  }
  return 0;
}

// Directives come before the first line of content.
void refuse_directives(SceneDocument& document, std::uint32_t file) {
  Source const& source = document.source(file);
  for (std::uint32_t number = 1; number <= source.lines.size(); ++number) {
    std::string_view const line = source.line(number);
    std::size_t const first = line.find_first_not_of(" \t");
    if (line.starts_with('%'))
      document.add({{file, number, 1}, "YAML directives are not part of the input language", "remove this line"});
    if (first != std::string_view::npos && line[first] != '#' && line[first] != '%') return;
  }
}

// No-break and thin spaces before a value or element are plain ones; every byte keeps its place. In the indentation,
// whose width counts, they are problems; then the text cannot be used.
bool blank_typeset_spaces(SceneDocument& document, std::uint32_t file, std::string& text) {
  bool usable = true;
  std::uint32_t line = 1, column = 1;
  char last = '\n';  // that is no space
  for (std::size_t at = 0; at < text.size(); ++column) {
    std::size_t const bytes = typeset_space(std::string_view(text).substr(at));
    if (bytes > 0 && last == '\n') {
      document.add({{file, line, column}, "a no-break or thin space in the indentation", "use plain spaces"});
      usable = false;
    }
    if (bytes > 0 && std::string_view("\n:,[{-").find(last) != std::string_view::npos)
      text.replace(at, bytes, bytes, ' ');
    else if (text[at] != ' ')
      last = text[at];
    at += std::max<std::size_t>(bytes > 0 ? bytes : sequence_length(text, at), 1);
    if (last == '\n' && text[at - 1] == '\n') ++line, column = 0;
  }
  return usable;
}

// The text to hand to the parser (byte order mark, tabs and typeset spaces blanked), or nothing when it cannot be read.
// Every reason is recorded as a problem.
std::optional<std::string> checked_text(SceneDocument& document, std::uint32_t file) {
  std::string text = document.source(file).text;
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
  if (text.starts_with("straytrace-run")) {
    document.add(
        {{file, 1, 1}, "this is a run file, not a scene", "'straytrace run' repeats it, 'noise' and 'paths' read it"});
    return {};
  }
  std::uint32_t line = 1, column = 1;
  bool tab_in_line = false, readable = true;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t const length = sequence_length(text, at);
    char const c = text[at];
    Place const here{file, line, column};
    if (length == 0) {
      document.add({here, "this is not UTF-8 text", "save the file as UTF-8"});
      return {};
    }
    if (c == '\t') {
      if (!tab_in_line) document.add({here, "a tab character", "use spaces; a tab looks different in every editor"});
      tab_in_line = true;
      text[at] = ' ';
    } else if ((static_cast<unsigned char>(c) < 0x20 && c != '\n' &&
                !(c == '\r' && at + 1 < text.size() && text[at + 1] == '\n')) ||
               c == 0x7f) {
      document.add(
          {here, fmt::format("control character {:#04x} in the text", static_cast<unsigned char>(c)), "remove it"});
      readable = false;
    }
    at += length;
    ++column;
    if (c == '\n') {
      ++line;
      column = 1;
      tab_in_line = false;
    }
  }
  refuse_directives(document, file);
  if (!readable || !blank_typeset_spaces(document, file, text)) return {};
  return text;
}

constexpr std::size_t deepest = 64, most_values = 1'000'000;  // half a kilobyte each

struct StopReading {};  // the rest of the file cannot be used; the problem is recorded

class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(SceneDocument& document, std::uint32_t file)
      : document_(document), source_(document.source(file)), file_(file) {}

  std::shared_ptr<NodeData> root() const { return root_; }
  // Possible consequences of broken syntax are recorded only when the document is complete.
  void OnDocumentEnd() override {
    for (Problem& p : guesses_) document_.add(std::move(p));
    for (Problem& p : broken_lines_) document_.add(std::move(p));
    guesses_.clear();
    broken_lines_.clear();
  }
  // Causes that explain a complaint of the parser better than the complaint itself.
  std::vector<Problem> const& broken_lines() const { return broken_lines_; }
  bool quote_is_open() const { return quote_is_open_; }

  void OnDocumentStart(YAML::Mark const& mark) override {
    if (++documents_ == 1) return;
    problem(place(mark), "a second document begins here", "a file contains one model: remove the line '---' above");
    throw StopReading{};
  }

  void OnNull(YAML::Mark const& mark, YAML::anchor_t) override {
    count(mark);
    if (awaits_key()) {
      guess(place(mark), "a key is missing before ':'", "write 'key: value'");
      set_discarded_key();
      return;
    }
    auto node = std::make_shared<NodeData>();  // of kind none: its problem is recorded here
    node->place = place(mark);
    if (stack_.empty()) return;
    Frame& top = stack_.back();
    if (top.node->kind == Node::Kind::table) {
      if (follows_decimal_comma(top))
        refuse_decimal_comma(top);
      else if (continues_list(top))
        refuse_open_list(top);
      else if (!top.discard)
        guess(top.key_place, fmt::format("'{}' has no value", shortened(top.key)), "write a value, or remove the key",
              top.key_width);
      node->place = top.key_place;
    } else {
      guess(node->place, "an empty element in a list", "write a value, or remove it");
    }
    attach(std::move(node));
  }

  void OnAlias(YAML::Mark const& mark, YAML::anchor_t) override {
    problem(place(mark), "aliases (*name) are not part of the input language",
            "repeat the value, or use params and parts");
    if (awaits_key()) return set_discarded_key();
    auto node = std::make_shared<NodeData>();
    node->place = place(mark);
    attach(std::move(node));
  }

  void OnScalar(YAML::Mark const& mark, std::string const& tag, YAML::anchor_t anchor,
                std::string const& value) override {
    count(mark);
    refuse_properties(mark, tag, anchor);
    auto node = std::make_shared<NodeData>();
    node->kind = Node::Kind::scalar;
    node->place = place(mark);
    node->text = value;
    locate_text(*node, rest_of_line(mark), tag == "?");
    if (awaits_key()) return set_key(std::move(*node));
    attach(std::move(node));
  }

  void OnSequenceStart(YAML::Mark const& mark, std::string const& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    begin(mark, tag, anchor, Node::Kind::list);
  }
  void OnMapStart(YAML::Mark const& mark, std::string const& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    begin(mark, tag, anchor, Node::Kind::table);
  }
  void OnSequenceEnd() override { end(); }
  void OnMapEnd() override { end(); }

 private:
  struct Frame {
    std::shared_ptr<NodeData> node;
    bool is_key = false, has_key = false, discard = false;
    std::string key{};
    Place key_place{};
    std::uint32_t key_width = 1;
    std::size_t open_list = 0, open_list_guess = 0;  // entries when a list without brackets began, and its problem
    std::string open_list_text{};
  };

  void problem(Place where, std::string what, std::string suggestion, std::uint32_t width = 1) {
    document_.add({where, std::move(what), std::move(suggestion), Severity::error, width});
  }

  void guess(Place where, std::string what, std::string suggestion, std::uint32_t width = 1) {
    guesses_.push_back({where, std::move(what), std::move(suggestion), Severity::error, width});
  }

  // Marks count bytes; a byte order mark is not counted.
  std::string_view line_of(YAML::Mark const& mark) const {
    std::string_view line = source_.line(static_cast<std::uint32_t>(mark.line + 1));
    if (mark.line == 0 && line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);
    return line;
  }
  std::string_view rest_of_line(YAML::Mark const& mark) const {
    std::string_view const line = line_of(mark);
    return line.substr(std::min(line.size(), static_cast<std::size_t>(std::max(0, mark.column))));
  }
  // Counts on from the last mark of the same line, because a line may be megabytes long.
  Place place(YAML::Mark const& mark) {
    std::string_view const line = line_of(mark);
    auto const bytes = std::min(line.size(), static_cast<std::size_t>(std::max(0, mark.column)));
    if (mark.line != counted_line_ || bytes < counted_bytes_) counted_bytes_ = 0, counted_points_ = 0;
    counted_line_ = mark.line;
    counted_points_ += code_points(line.substr(counted_bytes_, bytes - counted_bytes_));
    counted_bytes_ = bytes;
    return {file_, static_cast<std::uint32_t>(std::max(0, mark.line) + 1), counted_points_ + 1};
  }

  void refuse_properties(YAML::Mark const& mark, std::string const& tag, YAML::anchor_t anchor) {
    if (anchor != 0)
      problem(place(mark), "anchors (&name) are not part of the input language",
              "remove it; use params and parts for repeated content");
    bool const tagged = (tag != "?" && tag != "!" && !tag.empty()) || rest_of_line(mark).starts_with('!');
    if (tagged)
      problem(place(mark), "tags (!name) are not part of the input language",
              "remove it; the type of a value follows from its key");
  }

  // Finds how much of the line the text takes; plain text that is not found literally was broken over lines.
  void locate_text(NodeData& node, std::string_view rest, bool plain) {
    std::string const quote(1, rest.empty() ? ' ' : rest.front());
    bool const quoted = quote == "\"" || quote == "'";
    if (rest.starts_with(node.text) && !quoted) {
      node.inset = 0;
      node.width = std::max(1u, code_points(node.text));
    } else if (quoted && rest.substr(1).starts_with(node.text + quote)) {
      node.inset = 1;
      node.width = code_points(node.text) + 2;
    } else if (quoted) {
      if (!quote_closes(node.place.line, rest, quote[0])) {
        quote_is_open_ = true;
        problem(node.place, "this quote is not closed", fmt::format("add {} where the text ends", quote));
      }
    } else if (plain && !rest.starts_with('&') && !rest.starts_with('!')) {
      node.kind = Node::Kind::none;
      broken_lines_.push_back({node.place, "a value without quotes continues on the next line",
                               "put quotes around it, or close the bracket, quote or line before", Severity::error,
                               code_points(rest)});
    }
  }

  // The parser takes the end of the file for a closing quote; this looks for a real one. `rest` begins with the quote.
  bool quote_closes(std::uint32_t line, std::string_view rest, char quote) const {
    for (std::string_view part = rest.substr(1);; part = source_.line(++line)) {
      for (std::size_t i = 0; i < part.size(); ++i) {
        if (part[i] == '\\' && quote == '"')
          ++i;
        else if (part[i] == quote && quote == '\'' && i + 1 < part.size() && part[i + 1] == quote)
          ++i;
        else if (part[i] == quote)
          return true;
      }
      if (line >= source_.lines.size()) return false;
    }
  }

  bool awaits_key() const {
    return !stack_.empty() && stack_.back().node->kind == Node::Kind::table && !stack_.back().has_key;
  }

  void set_discarded_key() {
    stack_.back().has_key = true;
    stack_.back().discard = true;
  }

  void set_key(NodeData scalar) {
    Frame& top = stack_.back();
    top.has_key = true;
    top.key = std::move(scalar.text);
    top.key_place = scalar.place;
    top.key_width = scalar.width;
    top.discard = top.key == "<<";
    if (top.discard)
      problem(top.key_place, "merge keys (<<) are not part of the input language",
              "write the keys out, or use params and parts", 2);
    if (NodeData::Entry const* first = top.node->find(top.key)) {
      top.discard = true;
      problem(top.key_place, fmt::format("key '{}' is written twice in one table", shortened(top.key)),
              fmt::format("remove one of them; the first is in line {}", first->place.line), top.key_width);
    }
  }

  // "{position: 3,2 mm}" is a table with the keys 'position' and '2 mm'.
  static bool follows_decimal_comma(Frame const& top) {
    if (top.node->entries.empty() || top.key.find_first_of("0123456789") != 0) return false;
    NodeData const& before = *top.node->entries.back().value;
    return before.kind == Node::Kind::scalar && straytrace::is_number(before.text) &&
           before.place.line == top.key_place.line && before.place.column + before.width + 1 == top.key_place.column;
  }

  void refuse_decimal_comma(Frame& top) {
    NodeData& before = *top.node->entries.back().value;
    problem(before.place, fmt::format("'{}' has a decimal comma", shortened(before.text + "," + top.key)),
            fmt::format("write '{}'", shortened(before.text + "." + top.key)), before.width + 1 + top.key_width);
    before.kind = Node::Kind::none;
    top.discard = true;
  }

  static bool begins_number(std::string_view text) {
    if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
    return text.find_first_of("0123456789") == 0;
  }

  // "{at: 0 m, 0 m, 1 m}" is a table with the keys 'at', '0 m' and '1 m'.
  static bool continues_list(Frame const& top) {
    if (top.node->entries.empty() || !begins_number(top.key)) return false;
    NodeData const& before = *top.node->entries.back().value;
    bool const first = before.kind == Node::Kind::scalar && begins_number(before.text);
    return (first || top.open_list == top.node->entries.size()) && before.place.line == top.key_place.line;
  }

  void refuse_open_list(Frame& top) {
    NodeData& before = *top.node->entries.back().value;
    if (top.open_list != top.node->entries.size()) {
      top.open_list = top.node->entries.size();
      top.open_list_guess = guesses_.size();
      top.open_list_text = before.text;
      guess(before.place, fmt::format("'{}' is a list without brackets", shortened(before.label)), "", before.width);
      before.kind = Node::Kind::none;
    }
    Problem& p = guesses_[top.open_list_guess];
    bool const adjacent = p.place.column + p.width + 1 == top.key_place.column;
    top.open_list_text += (adjacent ? "," : ", ") + top.key;
    p.suggestion = fmt::format("write a list: [{}]", shortened(top.open_list_text));
    p.width = top.key_place.column + top.key_width - p.place.column;
    top.discard = true;
  }

  void attach(std::shared_ptr<NodeData> node) {
    if (stack_.empty()) {
      root_ = std::move(node);
      return;
    }
    Frame& top = stack_.back();
    if (top.node->kind == Node::Kind::list) {
      node->label = top.node->label;
      top.node->elements.push_back(std::move(node));
      return;
    }
    node->label = top.key;
    if (!top.discard) top.node->add({top.key, top.key_place, top.key_width, std::move(node)});
    top.has_key = top.discard = false;
  }

  void count(YAML::Mark const& mark) {
    if (++values_ <= most_values) return;
    problem(place(mark), fmt::format("the file has more than {} keys and values", most_values),
            "use 'repeat', or put measured data into separate files");
    throw StopReading{};
  }

  void begin(YAML::Mark const& mark, std::string const& tag, YAML::anchor_t anchor, Node::Kind kind) {
    count(mark);
    if (stack_.size() >= deepest) {
      problem(place(mark), fmt::format("tables and lists are nested more than {} deep", deepest), "check the brackets");
      throw StopReading{};
    }
    refuse_properties(mark, tag, anchor);
    auto node = std::make_shared<NodeData>();
    node->kind = kind;
    node->place = place(mark);
    bool const is_key = awaits_key();
    if (is_key)
      guess(node->place, "a key must be plain text", "write 'key: value'");
    else
      attach(node);
    stack_.push_back({std::move(node), is_key});
  }

  void end() {
    bool const is_key = stack_.back().is_key;
    stack_.pop_back();
    if (is_key) set_discarded_key();
  }

  SceneDocument& document_;
  Source const& source_;
  std::uint32_t file_;
  std::shared_ptr<NodeData> root_;
  std::vector<Frame> stack_;
  int documents_ = 0, counted_line_ = -1;
  std::size_t counted_bytes_ = 0, values_ = 0;
  std::uint32_t counted_points_ = 0;
  bool quote_is_open_ = false;
  std::vector<Problem> guesses_, broken_lines_;
};

}  // namespace

std::shared_ptr<NodeData> read_yaml(SceneDocument& document, std::uint32_t file) {
  auto const text = checked_text(document, file);
  if (!text) return nullptr;
  TreeBuilder builder(document, file);
  try {
    std::istringstream stream(*text);
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (StopReading const&) {
    return nullptr;
  } catch (YAML::ParserException const& e) {
    if (!builder.quote_is_open())
      report_syntax(document, file, builder.broken_lines(), {e.mark.line, e.mark.column, e.msg});
    return nullptr;
  }
  auto const root = builder.root();
  if (root && root->kind == Node::Kind::table) return root;
  document.add({{file, root ? root->place.line : 0, root ? root->place.column : 0},
                root ? "a model file is a table of keys" : "the file is empty",
                "begin with 'straytrace: 1'"});
  return nullptr;
}

}  // namespace straytrace::scene
