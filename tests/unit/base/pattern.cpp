// SPDX-License-Identifier: BSD-3-Clause
// Regular expressions of short texts (base/text/pattern.hpp), and JSON as text.
#include "base/text/pattern.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/text/json_text.hpp"

namespace straytrace::testing::pattern {
namespace {

TEST(Pattern, GroupsWithTheirPlaces) {
  Pattern const form(R"(\s*([a-z]+)\s*(<)?\s*([0-9]+)\s*)");
  PatternMatch const m = form.match(" noise 12 ");
  ASSERT_TRUE(m);
  EXPECT_EQ(m[0], " noise 12 ");
  EXPECT_EQ(m[1], "noise");
  EXPECT_EQ(m.position(1), 1u);
  EXPECT_EQ(m[3], "12");
  EXPECT_EQ(m.position(3), 7u);
  EXPECT_FALSE(m.matched(2));
  EXPECT_EQ(m[2], "");
  EXPECT_TRUE(form.match("noise < 12").matched(2));
  EXPECT_FALSE(form.match("noise 12 x")) << "the whole text must match";
}

// Long texts would overflow the stack of std::regex.
TEST(Pattern, LongTextsDoNotMatch) {
  Pattern const any("(a|b)*");
  EXPECT_TRUE(any.match(std::string(Pattern::longest, 'a')));
  EXPECT_FALSE(any.match(std::string(Pattern::longest + 1, 'a')));
  EXPECT_FALSE(any.match(std::string(1'000'000, 'a')));
  EXPECT_EQ(any.width_at_start(std::string(1'000'000, 'a')), Pattern::longest);
}

TEST(Pattern, StartsAndReplacements) {
  Pattern const digits("[0-9]+");
  EXPECT_EQ(digits.width_at_start("123 Hz"), 3u);
  EXPECT_EQ(digits.width_at_start("h 123"), 0u);
  EXPECT_EQ(digits.width_at_start(""), 0u);
  EXPECT_EQ(Pattern("([0-9]),([0-9])").replaced("0,5..1,5", "$1.$2"), "0.5..1.5");
}

TEST(JsonText, TextAndBack) {
  nlohmann::ordered_json const ordered{{"z", 1}, {"a", {1.5, nullptr}}};
  EXPECT_EQ(json_text(ordered), R"({"z":1,"a":[1.5,null]})");
  EXPECT_EQ(json_text(ordered, 1), "{\n \"z\": 1,\n \"a\": [\n  1.5,\n  null\n ]\n}");
  EXPECT_EQ(read_ordered_json(json_text(ordered)), ordered);
  EXPECT_EQ(json_text(read_json(json_text(ordered))), R"({"a":[1.5,null],"z":1})");
  EXPECT_EQ(json_text(nlohmann::json("\xff")), "\"\xEF\xBF\xBD\"") << "not UTF-8";
  EXPECT_THROW(read_json("{"), nlohmann::json::parse_error);
}

}  // namespace
}  // namespace straytrace::testing::pattern
