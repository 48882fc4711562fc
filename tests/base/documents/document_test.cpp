#include "base/documents/document.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "base/error.hpp"

namespace bodesmith {
namespace {

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Document, EveryJsonValueKnowsItsLine) {
  const Node node =
      parse_json("{\n \"a\": 1,\n \"b\": [\n  2,\n  3\n ],\n \"c\": {\"d\": \"x\"}\n}\n", "f.json");
  EXPECT_EQ(node.at("a").line(), 2);
  EXPECT_EQ(node.at("b").line(), 3);
  EXPECT_EQ(node.at("b")[0].line(), 4);
  EXPECT_EQ(node.at("b")[1].line(), 5);
  EXPECT_EQ(node.at("c").at("d").line(), 7);
  EXPECT_EQ(node.at("c").at("d").string(), "x");
}

TEST(Document, ComplaintsNameFileLineAndPlace) {
  const Node node = parse_json("{\"terms\": [\n {\"beta\": \"x\"}\n]}", "cascade.json");
  EXPECT_EQ(error_of([&] { node.at("terms")[0].at("beta").number(); }),
            "cascade.json:2: 'terms[0].beta' is a string, expected a number");
  EXPECT_EQ(error_of([&] { node.at("terms")[0].at("x"); }), "cascade.json:2: 'terms[0].x' is missing");
}

TEST(Document, BrokenJsonNamesTheLine) {
  EXPECT_THAT(
      error_of([] { parse_json("{\n\"a\": 1,\n\"b\" 2}", "x.json"); }).find("x.json:3: not valid JSON"), 0u);
  EXPECT_THAT(error_of([] { parse_json("", "x.json"); }).find("x.json:1: not valid JSON"), 0u);
  EXPECT_THAT(error_of([] { parse_json("{\"a\":1,\n\"a\":2}", "x.json"); }), "x.json:2: 'a' is given twice");
  EXPECT_NE(error_of([] { parse_json(std::string(5000, '['), "x.json"); }).find("deep"), std::string::npos);
  EXPECT_NE(error_of([] { parse_json("{\"a\": 1e999}", "x.json"); }), "no error");
}

// Dots of a key nest; those of texts and comments do not.
TEST(Document, KeysOfVeryManyDotsAreRefusedAndTextsWithThemAreNot) {
  std::string dots;
  for (int i = 0; i < 300; ++i) dots += "a.";
  EXPECT_NE(error_of([&] { parse_toml("x = 1\n" + dots + "b = 1\n", "x.toml"); }).find("x.toml:2"),
            std::string::npos);
  const std::vector<std::string> texts = {"x = \"" + dots + "\"\n",
                                          "x = '" + dots + "'\n",
                                          "x = \"\"\"\n" + dots + "\n" + dots + "\"\"\"\n",
                                          "x = '''" + dots + "\n'''\n",
                                          "# " + dots + "\nx = 1\n",
                                          "x = \"q\\\"" + dots + "\"\n"};
  for (const std::string& text : texts)
    EXPECT_EQ(error_of([&] { parse_toml(text + "[t]\ny = 2\n", "x.toml"); }), "no error")
        << text.substr(0, 12);
}

TEST(Document, OtherEncodingsAreToldByName) {
  const auto answer = [](std::string_view bytes) -> std::string {
    try {
      (void)parse_json(bytes, "a.json");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  using namespace std::string_view_literals;
  EXPECT_EQ(answer("\xFF\xFE{\0}\0"sv), "a.json: is UTF-16, expected UTF-8");
  EXPECT_EQ(answer("{\0}\0"sv), "a.json: is UTF-16, expected UTF-8");
  EXPECT_EQ(answer("\xFF\xFE\0\0{\0\0\0"sv), "a.json: is UTF-32, expected UTF-8");
  EXPECT_THROW((void)parse_toml("\xFE\xFF\0a"sv, "a.toml"), InputError);
  EXPECT_EQ(answer("\xEF\xBB\xBF{}"sv), "");
}

TEST(Document, TomlKeepsLinesAndOrder) {
  const Node node =
      parse_toml("schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"gain\"\ngain = 2\n", "m.toml");
  node.expect_schema("model");
  EXPECT_EQ(node.at("block")[0].at("gain").number(), 2.0);
  EXPECT_EQ(node.at("block")[0].at("gain").line(), 4);
  EXPECT_EQ(error_of([&] { node.expect_schema("cascade"); }),
            "m.toml:1: 'schema' is \"bodesmith.model/1\", expected \"bodesmith.cascade/1\"");
  EXPECT_EQ(error_of([&] { node.at("block")[0].allow_only({"type"}); }),
            "m.toml:4: 'block[0].gain' is not known here, expected one of: type");
  EXPECT_EQ(error_of([] { parse_toml("a = \n", "m.toml"); }).find("m.toml:1: not valid TOML"), 0u);
  EXPECT_EQ(error_of([] { parse_toml("a = nan\n", "m.toml").at("a").number(); }),
            "m.toml:1: 'a' is not finite, expected a finite number");
}

TEST(Document, WhatAValueMayBe) {
  const Node node = parse_toml(
      "n = 3\nhalf = 2.5\nword = \"sine\"\nyes = true\nlist = [1, 2.5, -4]\n[table]\na = 1\nb = 2\n",
      "t.toml");
  EXPECT_EQ(node.size(), 6u);
  EXPECT_EQ(node.at("table").size(), 2u);
  EXPECT_EQ(node.at("list").size(), 3u);
  EXPECT_EQ(node.at("list").numbers(), (std::vector<double>{1.0, 2.5, -4.0}));
  EXPECT_EQ(node.at("list").items()[2].place(), "list[2]");
  EXPECT_EQ(node.at("table").members()[1].first, "b");
  EXPECT_EQ(node.at("n").integer(3, 3), 3);
  EXPECT_EQ(node.at("word").one_of({"cubic", "sine"}), "sine");
  EXPECT_TRUE(node.boolean_or("yes", false));
  EXPECT_TRUE(node.boolean_or("no", true));
  EXPECT_EQ(node.number_or("half", 0.0), 2.5);
  EXPECT_EQ(node.number_or("third", 0.25), 0.25);
  EXPECT_EQ(node.string_or("word", ""), "sine");
  EXPECT_EQ(node.string_or("words", "none"), "none");
  const auto said = [&](auto read) -> std::string {
    try {
      read();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(said([&] { node.at("n").integer(4, 9); }),
            "t.toml:1: \'n\' is 3, expected a whole number from 4 to 9");
  EXPECT_EQ(said([&] { node.at("n").integer(0, 2); }),
            "t.toml:1: \'n\' is 3, expected a whole number from 0 to 2");
  EXPECT_EQ(said([&] { node.at("half").integer(0, 9); }),
            "t.toml:2: \'half\' is 2.5, expected a whole number from 0 to 9");
  EXPECT_EQ(said([&] { node.at("list")[2].non_negative(); }),
            "t.toml:5: \'list[2]\' is -4, expected a number of at least 0");
  EXPECT_EQ(said([&] { node.at("list")[2].positive(); }),
            "t.toml:5: \'list[2]\' is -4, expected a number above 0");
  EXPECT_EQ(said([&] { (void)node.at("list")[3]; }), "t.toml:5: \'list\' has 3 items, expected at least 4");
  EXPECT_NE(said([&] {
              node.at("word").one_of({"cubic", "sines"});
            }).find("did you mean 'sines'"),
            std::string::npos);
  EXPECT_NE(said([&] {
              node.at("table").allow_only({"a", "c"});
            }).find("t.toml:8: 'table.b' is not known here"),
            std::string::npos);
}

/// Only what the key names changes, in tables that are made where they are missing; the old document stays as it was.
TEST(Document, AChangedCopyIsTheSameElsewhere) {
  const Node node = parse_toml("a = 1\n[t]\nb = 2\nc = 3\n", "t.toml");
  const Node value = parse_toml("\n\nx = 7\n", "other.toml").at("x");
  const Node changed = node.with("t.b", value).with("new.deep.one", value);
  EXPECT_EQ(changed.at("t").at("b").number(), 7.0);
  EXPECT_EQ(changed.at("t").at("c").number(), 3.0);
  EXPECT_EQ(changed.at("t").size(), 2u);
  EXPECT_EQ(changed.at("a").number(), 1.0);
  EXPECT_EQ(changed.at("new").at("deep").at("one").number(), 7.0);
  EXPECT_EQ(changed.at("new").line(), 3);
  EXPECT_EQ(changed.at("new").file(), "other.toml");
  EXPECT_EQ(node.at("t").at("b").number(), 2.0);
  EXPECT_FALSE(node.has("new"));
  const Node less = changed.without("t.c", value);
  EXPECT_FALSE(less.at("t").has("c"));
  EXPECT_TRUE(less.at("t").has("b"));
  for (const char* key : {"a.b", "", "t..x"}) EXPECT_THROW(node.with(key, value), InputError) << key;
  for (const char* key : {"none", "t.none", "none.x"})
    EXPECT_THROW(node.without(key, value), InputError) << key;
}

TEST(Document, TextsHaveOneLine) {
  EXPECT_EQ(error_of([] { parse_json("{\"name\": \"a\\n.control\"}", "p.json").at("name").string(); }),
            "p.json:1: 'name' holds a line break or another control character, expected one line of text");
  EXPECT_EQ(parse_json("{\"name\": \"µF, 10 %\"}", "p.json").at("name").string(), "µF, 10 %");
}

TEST(Document, WhatStandsBelowAFractionLineHasAnInverse) {
  EXPECT_EQ(parse_json("{\"f_hz\": 3e-308}", "p.json").at("f_hz").positive(), 3e-308);
  EXPECT_EQ(error_of([] { parse_json("{\"f_hz\": 1e-320}", "p.json").at("f_hz").positive(); }),
            "p.json:1: 'f_hz' is 9.99989e-321, expected a number above 2.3e-308");
}

}  // namespace
}  // namespace bodesmith
