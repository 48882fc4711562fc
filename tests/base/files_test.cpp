#include "base/files.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <thread>
#include <vector>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/provenance.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "temporary_folder.hpp"
#include "texts.hpp"

namespace bodesmith {
namespace {
namespace fs = std::filesystem;

TEST(Files, NothingIsWrittenWhenOneFileCannotBe) {
  const TemporaryFolder folder;
  write_file(folder / "kept.txt", "old");
  fs::create_directory(folder / "blocked");
  OutputSet set(folder.path());
  set.add("kept.txt", "new");
  set.add("blocked", "a folder stands here");
  EXPECT_THROW(set.commit(), InputError);
  EXPECT_EQ(read_file(folder / "kept.txt"), "old");
  int entries = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder.path())) ++entries;
  EXPECT_EQ(entries, 2) << "a temporary file was left behind";
}

// As `run` does with what ngspice wrote at several frequencies.
TEST(Files, SeveralThreadsReadAtOnce) {
  const TemporaryFolder folder;
  std::vector<std::filesystem::path> names;
  for (const char* name :
       {"one", "a folder of a long name/another of a longer one/two", "a folder of a long name/three"}) {
    names.push_back(folder / name);
    write_file(names.back(), name);
  }
  std::vector<std::thread> readers;
  std::atomic<int> wrong = 0;
  for (const auto& name : names) {
    readers.emplace_back([&wrong, &name] {
      const std::string known = read_file(name);
      for (int i = 0; i < 12000; ++i) wrong += read_file(name) == known ? 0 : 1;
    });
  }
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_NE(std::find(names.begin(), names.end(), last_file_read()), names.end());
}

TEST(Files, CommitMakesTheFolder) {
  const TemporaryFolder folder;
  OutputSet set(folder / "a/b");
  set.add("c/d.txt", "x");
  EXPECT_FALSE(fs::exists(folder / "a"));
  set.commit();
  EXPECT_EQ(read_file(folder / "a/b/c/d.txt"), "x");
}

TEST(Files, NothingIsWrittenOutsideOfTheFolder) {
  const TemporaryFolder folder;
  for (const std::string& name : {std::string("../out.txt"), std::string("a/../../out.txt"),
                                  std::string("a/../out.txt"), (folder / "out.txt").string()}) {
    OutputSet inner;
    inner.add(name, "x");
    OutputSet direct(folder / "asked"), included(folder / "asked");
    direct.add("first.txt", "x");
    direct.add(name, "x");
    included.include("below", inner);
    EXPECT_THROW(direct.commit(), InputError) << name;
    EXPECT_THROW(included.commit(), InputError) << name;
    EXPECT_FALSE(fs::exists(folder / "asked/first.txt"));
  }
  EXPECT_FALSE(fs::exists(folder / "out.txt"));
  EXPECT_FALSE(fs::exists(folder / "asked/out.txt"));
}

TEST(Files, OneNameIsOneOutput) {
  const TemporaryFolder folder;
  OutputSet set(folder.path());
  set.add("a.txt", "1");
  set.add("./a.txt", "2");
  EXPECT_THROW(set.commit(), InputError);
  EXPECT_FALSE(fs::exists(folder / "a.txt"));
}

TEST(Files, LinksAreFollowedAndDevicesStay) {
  const TemporaryFolder folder;
  write_file(folder / "real.txt", "old");
  fs::create_symlink("real.txt", folder / "link.txt");
  write_file(folder / "link.txt", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link.txt"));
  EXPECT_EQ(read_file(folder / "real.txt"), "new");
  fs::create_symlink("/dev/null", folder / "null");
  write_file(folder / "null", "gone");
  EXPECT_TRUE(fs::is_character_file(folder / "null"));
  EXPECT_THROW(write_file("/dev/full", "no room"), InputError);
}

TEST(Files, WhatAKilledRunLeftGoes) {
  const TemporaryFolder folder;
  // No process has this number: the kernel's largest is 2^22.
  write_file(folder / ".out.csv.tmp99999999", "half");
  write_file(folder / ".other.csv.tmp99999999", "another output's");
  write_file(folder / "out.csv", "whole");
  EXPECT_FALSE(fs::exists(folder / ".out.csv.tmp99999999"));
  EXPECT_TRUE(fs::exists(folder / ".other.csv.tmp99999999"));
}

TEST(Errors, AreOnePrintableLineOfBoundedLength) {
  const std::string what = InputError("a\nb\x1b[31m" + std::string(5000, 'x')).what();
  EXPECT_EQ(what.substr(0, 9), "a b?[31mx");
  EXPECT_LT(what.size(), 700u);
}

TEST(Json, WhatIsNotFiniteIsRefused) {
  Json json;
  json["list"] = {1.0, INFINITY};
  EXPECT_THROW(to_text(json), InputError);
}

TEST(Provenance, Sha256MatchesTheStandardsExample) {
  // FIPS 180-2, appendix B.1.
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Text, NumbersReadBackExactly) {
  for (const double value : {0.1, 1.0, -2.5e-300, 1e22, 12345.678901234567, 5e-324}) {
    double back = 0.0;
    EXPECT_TRUE(parse_number(number_text(value), back));
    EXPECT_EQ(back, value);
  }
  double ignored = 0.0;
  for (const char* text : {"", "1.2.3", "0x10", "nan", "inf", "1e999", "1,5", "4k7"}) {
    EXPECT_FALSE(parse_number(text, ignored)) << text;
  }
  for (const double value : {std::nan(""), HUGE_VAL, -HUGE_VAL}) EXPECT_THROW(number_text(value), InputError);
}

TEST(Text, EngineersPrefixes) {
  EXPECT_EQ(engineering_text(20500.0, "Ω"), "20.5 kΩ");
  EXPECT_EQ(engineering_text(1e-8, "F"), "10 nF");
  EXPECT_EQ(engineering_text(999.96, "Ω"), "1 kΩ");
  EXPECT_EQ(engineering_text(6.54e-7, "s", 2), "650 ns");
  EXPECT_EQ(engineering_text(0.0, "V"), "0 V");
  EXPECT_EQ(engineering_text(-4.7e-6, "F"), "-4.7 µF");
}

TEST(JsonText, RefusesNumbersThatAreNotFinite) {
  EXPECT_THROW(to_text(Json{{"a", NAN}}), InputError);
  EXPECT_EQ(to_text(Json{{"a", {1.0, 2.5}}}), "{\n  \"a\": [1.0, 2.5]\n}\n");
  // Nested, empty, longer than a line: what was read is what was written.
  Json deep = {{"a", {{"b", {1.5, "x, \"y\"", nullptr}}, {"c", Json::array()}}}, {"d", Json::object()}};
  for (int i = 0; i < 40; ++i)
    deep["e"].push_back({{"number", 0.125 * i}, {"list", {i, i + 1, {{"f", true}}}}}), deep["g"].push_back(i);
  EXPECT_EQ(parsed(to_text(deep)), deep);
}

TEST(TextTemplate, EmbedsTheBytesOfTheFile) {
  EXPECT_EQ(render_template("self_test.txt", {{"name", "R<1"}, {"raw", 2.5}}), "R<1 & 2.5\n");
  EXPECT_THROW(render_template("no such", {}), std::logic_error);
}

}  // namespace
}  // namespace bodesmith
