// SPDX-License-Identifier: BSD-3-Clause
// The strict subset of YAML (docs/reference/scene.md): each rejected text stands next to the accepted one it differs
// from.
#include "unit/scene/support.hpp"

namespace straytrace::test {
namespace {

using ::testing::HasSubstr;

struct TextPair {
  char const *accepted, *rejected, *place, *what;
};

TEST(Syntax, InvalidTextsNextToAcceptedOnes) {
  std::vector<TextPair> const pairs{
      {"trace: {a: 1, b: 2}\n", "trace: {a: 1, a: 2}\n", "2:15", "key 'a' is written twice in one table"},
      {"trace: 1\nnoise: 2\n", "trace: 1\ntrace: 2\n", "3:1", "key 'trace' is written twice"},
      {"trace: {a: x5}\n", "trace: {a: &x 5}\n", "2:12", "anchors (&name) are not part"},
      {"trace: {a: [x]}\n", "trace: {a: &x [x]}\n", "2:12", "anchors (&name) are not part"},
      {"trace: {a: x, b: y}\n", "trace: {a: &x 1, b: *x}\n", "2:21", "aliases (*name) are not part"},
      {"trace: {a: foo}\n", "trace: {a: !foo 7}\n", "2:12", "tags (!name) are not part"},
      {"trace: {a: '5'}\n", "trace: {a: !!str 5}\n", "2:12", "tags (!name) are not part"},
      {"trace: {a: '5'}\n", "trace: {a: ! 5}\n", "2:12", "tags (!name) are not part"},
      {"trace: {a: {b: 1}}\n", "trace: {<<: {b: 1}}\n", "2:9", "merge keys (<<) are not part"},
      {"trace: {a: 1}\n", "trace: {[a]: 1}\n", "2:9", "a key must be plain text"},
      {"trace: {a: 1}\n", "? {a: 1}\n: 2\n", "2:3", "a key must be plain text"},
      {"trace: {a: 1}\n", "trace: {: 1}\n", "2:9", "a key is missing before ':'"},
      {"title: a\n", "title: a\n---\ntitle: b\n", "3:1", "a second document begins here"},
      {"title: a  b\n", "title: a\tb\n", "2:9", "a tab character"},
      {"trace:\n  a: 1\n", "trace:\n\ta: 1\n", "3:1", "a tab character"},
      {"title: 'a\n  b'\n", "title: a\n  b\n", "2:8", "a value without quotes continues on the next line"},
      {"trace: {a: [1, 2], b: 3}\n", "trace: {a: [1, 2\n  , 3 4\n  5], b: 3}\n", "3:5",
       "a value without quotes continues"},
      {"title: \"abc\"\n", "title: \"abc\n", "2:8", "this quote is not closed"},
      {"title: 'it''s'\n", "title: 'it''s''\n", "2:8", "this quote is not closed"},
      {"trace: {a: {b: 1}}\nnoise: {c: 2}\n", "trace: {a: {b: 1}\nnoise: {c: 2}\n", "2:8",
       "this bracket is not closed"},
      {"scene:\n  - {name: a, file: b}\n  - {name: c, file: d}\n",
       "scene:\n  - {name: a, file: b\n  - {name: c, file: d}\n", "3:5", "this bracket is not closed"},
      {"trace: {a: [1, 2]}\n", "trace: {a: [1, 2}}\n", "2:17", "brackets of different kinds do not match"},
      {"title: 'a: b'\n", "title: a: b\n", "2:9", "a second ': ' in one value"},
      {"trace:\n  a: 1\n  b: 2\n", "trace:\n  a: 1\n b: 2\n", "4:2", "the indentation does not match"},
      {"trace: {a: nil}\n", "trace: {a: }\n", "2:9", "'a' has no value"},
      {"trace: {a: nil}\n", "trace: {a: null}\n", "2:9", "'a' has no value"},
      {"trace: {a: nil}\n", "trace: {a: ~}\n", "2:9", "'a' has no value"},
      {"trace: {a: 3.2 mm}\n", "trace: {a: 3,2 mm}\n", "2:12", "'3,2 mm' has a decimal comma"},
      {"trace: {a: [0 m, 0 m, 1 m], b: 2}\n", "trace: {a: 0 m, 0 m, 1 m, b: 2}\n", "2:12",
       "'a' is a list without brackets"},
      {"trace: {a: [b]}\n", "trace: {a: [b, ~]}\n", "2:16", "an empty element in a list"},
      {"title: \xc3\xa4\n", "title: \xc3\n", "2:8", "this is not UTF-8 text"},
      {"title: \xc3\xa4\n", "title: \xc0\x80\n", "2:8", "this is not UTF-8 text"},
      {"title: a b\n", "title: a\x04 b\n", "2:9", "control character 0x04 in the text"},
      {"title: a\r\n", "title: a\rb\n", "2:9", "control character 0x0d in the text"},
      {"trace: 1\n", "tarce: 1\n", "2:1", "unknown key 'tarce' at the top of a model"},
  };
  for (TextPair const& t : pairs) {
    EXPECT_EQ(errors_of(t.accepted), "") << t.accepted;
    std::string const said = errors_of(t.rejected);
    EXPECT_THAT(said, HasSubstr(std::string("arm.yaml:") + t.place + ": error: " + t.what)) << t.rejected;
  }
}

// Before values and elements, and in values; the place of a later mistake counts code points. The width of an
// indentation counts, so there they are errors.
TEST(Syntax, NoBreakSpacesAreSpacesExceptInIndentations) {
  for (std::string const space : {"\xc2\xa0", "\xe2\x80\x89", "\xe2\x80\xaf"}) {
    Scene const scene =
        scene_of("trace:\n  a:" + space + "5" + space + "m\n  b: [1 m," + space + "2 m," + space + space + "3 m]\n");
    EXPECT_EQ(scene.table("trace").number("a", dim::length), 5);
    EXPECT_EQ(scene.table("trace")["b"].as_numbers(dim::length, 3), (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(said_by(scene), "");
    EXPECT_THAT(errors_of("trace: {a:" + space + "[x], b: &y 1}\n"), HasSubstr("2:20: error: anchors"));
    EXPECT_THAT(errors_of("trace:\n" + space + " a: 1\n  b: 2\n"),
                ::testing::AllOf(HasSubstr("3:1: error: a no-break or thin space in the indentation"),
                                 HasSubstr("\n1 error.")));
  }
}

TEST(Syntax, HeadOfTheFile) {
  auto const said = [](std::string const& text) { return errors_of(FileTexts{{"arm.yaml", text}}); };
  EXPECT_EQ(said("straytrace: 1\n"), "");
  EXPECT_EQ(said("\xef\xbb\xbfstraytrace: 1\n"), "");
  EXPECT_EQ(said("# a comment\n\n---\nstraytrace: 1\n"), "");
  EXPECT_THAT(said("title: a\n"), HasSubstr("the format version is missing"));
  EXPECT_THAT(said("title: a\nstraytrace: 1\n"), HasSubstr("2:1: error: 'straytrace' must be the first key"));
  EXPECT_THAT(said("straytrace: 2\n"),
              HasSubstr("1:13: error: format version 2 is newer than this program, which reads version 1"));
  // What another version means is unknown, so nothing else is reported; the same mistake counts in this version.
  EXPECT_THAT(said("straytrace: 2\nnose: 1\n"),
              ::testing::AllOf(HasSubstr("is newer"), HasSubstr("\n1 error. Nothing was run.")));
  EXPECT_THAT(said("straytrace: 1\nnose: 1\n"), HasSubstr("unknown key 'nose'"));
  EXPECT_THAT(said("straytrace: one\n"), HasSubstr("\"one\" is not a format version"));
  EXPECT_THAT(said("straytrace: 0\n"), HasSubstr("\"0\" is not a format version"));
  EXPECT_THAT(said("straytrace: [1]\n"), HasSubstr("is not a format version"));
  EXPECT_THAT(said(""), HasSubstr("arm.yaml: error: the file is empty"));
  EXPECT_EQ(said("straytrace-run sha256 0\n\x01\x02"),
            "arm.yaml:1:1: error: this is a run file, not a scene\n"
            "    1 | straytrace-run sha256 0\n"
            "      | ^ 'straytrace run' repeats it, 'noise' and 'paths' read it\n"
            "1 error. Nothing was run.\n");
  EXPECT_THAT(said("- a\n"), HasSubstr("a model file is a table of keys"));
  EXPECT_THAT(said("%YAML 1.2\n---\nstraytrace: 1\n"), HasSubstr("1:1: error: YAML directives are not part"));
}

// One message for the whole list, without keys of numbers elsewhere and keys with a value.
TEST(Syntax, ListsWithoutBrackets) {
  std::string const said = errors_of("trace: {a: 0 m, 0 m, -1 m, b: 2}\n");
  EXPECT_THAT(said, ::testing::AllOf(HasSubstr("write a list: [0 m, 0 m, -1 m]"), HasSubstr("\n1 error.")));
  EXPECT_THAT(said, HasSubstr(" ^^^^^^^^^^^^^^ write"));  // all of it
  EXPECT_THAT(errors_of("trace: {a: 1, 5 m: 2}\n"), ::testing::Not(HasSubstr("brackets")));
  EXPECT_THAT(errors_of("trace: {a: word, 5 m}\n"), HasSubstr("'5 m' has no value"));
  Scene const scene = scene_of("trace:\n  at: 0 m, 0 m, 1 m\n");
  scene.table("trace")["at"].as_numbers(dim::length, 3);
  EXPECT_THAT(said_by(scene), ::testing::AllOf(HasSubstr("3:7: error: 'at' is a list without brackets"),
                                               HasSubstr("write a list: [0 m, 0 m, 1 m]"), HasSubstr("\n1 error.")));
}

// "1,5 m" in a list is two elements. A compact list is an error only where it has another length with it.
TEST(Syntax, DecimalCommasInLists) {
  auto const said = [](std::string const& list) {
    Scene const scene = scene_of("trace: {at: " + list + "}\n");
    scene.table("trace")["at"].as_numbers(dim::length, 3);
    return said_by(scene);
  };
  EXPECT_THAT(said("[0 m, 1,5 m, 1 m]"), ::testing::AllOf(HasSubstr("2:19: error: '1,5 m' has a decimal comma"),
                                                          HasSubstr("write '1.5 m'"), HasSubstr("\n1 error.")));
  EXPECT_THAT(said("[0 m, -0,5 m, 1 m]"), HasSubstr("'-0,5 m' has a decimal comma"));
  EXPECT_THAT(said("[1,5 m, 1 m]"), HasSubstr("'1,5 m' has a decimal comma"));
  EXPECT_EQ(said("[0,0,5 m]"), "");
  EXPECT_EQ(said("[0 m,1 m,5 m]"), "");
  EXPECT_THAT(said("[0 m, 1, 5 m]"), HasSubstr("got \"1\" without a unit"));
  EXPECT_THAT(said("[0 m, 1 m]"), HasSubstr("'at' needs 3 values, got 2"));
}

TEST(Syntax, ColumnsCountCodePoints) {
  std::string const said = errors_of("trace: {\xc3\xa4\xc3\xb6: \"\xe2\x82\xac\", a: 1, a: 2}\n");
  EXPECT_THAT(said, HasSubstr("arm.yaml:2:24: error: key 'a' is written twice"));
}

TEST(Syntax, TypesComeFromTheReader) {
  Scene const scene = scene_of("trace: {a: no, b: 1:30, c: y, d: 010, e: 'x y', f: 1e-6}\n");
  Node const t = scene.table("trace");
  EXPECT_EQ(t.word("a"), "no");
  EXPECT_FALSE(t.flag("a", true));
  EXPECT_EQ(t.word("b"), "1:30");
  EXPECT_EQ(t.word("c"), "y");
  EXPECT_EQ(t.number("d", dim::plain), 10);
  EXPECT_EQ(t.word("e"), "x y");
  EXPECT_EQ(t.number("f", dim::plain), 1e-6);
  EXPECT_NO_THROW(scene.throw_if_problems());
}

TEST(Syntax, HostileTexts) {
  auto const repeat = [](std::string const& s, int n) {
    std::string out;
    for (int i = 0; i < n; ++i) out += s;
    return out;
  };
  EXPECT_EQ(errors_of("trace: " + repeat("[", 60) + repeat("]", 60) + "\n"), "");
  EXPECT_THAT(errors_of("trace: " + repeat("[", 70) + repeat("]", 70) + "\n"), HasSubstr("nested more than 64 deep"));
  for (char const* piece :
       {"[", "{a: ", "- ", "? ", "{? ", "[ \"a\" ", "\"", "'", "&a ", "!a ", "*a ", ": ", "|\n", "%", ", "})
    EXPECT_NE(errors_of("trace:\n  " + repeat(piece, 20001)), "") << piece;
  std::string keys = "trace: {";
  for (int i = 0; i < 20000; ++i) keys += "k" + std::to_string(i) + ": 1, ";
  EXPECT_EQ(errors_of(keys + "z: 1}\n"), "");
  std::string unknown;
  for (int i = 0; i < 20000; ++i) unknown += "k" + std::to_string(i) + ": 1\n";
  EXPECT_THAT(errors_of(unknown), HasSubstr("are shown. Nothing was run."));
  EXPECT_THAT(errors_of(FileTexts{{"arm.yaml", "straytrace: 1\n#" + std::string(17 << 20, 'x')}}),
              HasSubstr("it is larger than 16 MB"));
  EXPECT_THAT(errors_of("trace: [" + repeat("1,", 1000001) + "1]\n"), HasSubstr("more than 1000000 keys and values"));
}

}  // namespace
}  // namespace straytrace::test
