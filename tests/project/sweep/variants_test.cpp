// Tables of variants: what they change, and where a slip in one is said to stand.
#include "project/sweep/variants.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/files.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::project {
namespace {

std::vector<Variant> variants_of(const std::string& text) {
  const TemporaryFolder folder;
  write_file(folder / "v.toml", "schema = \"bodesmith.variants/1\"\n" + text);
  Provenance from;
  return read_variants(folder / "v.toml", from);
}

std::string refusal(const std::string& text) {
  try {
    variants_of(text);
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find("v.toml"));
  }
  return "read";
}

ProjectSource project_of(const std::string& text) {
  return {"p.toml", parse_toml(text, "p.toml"), {}};
}

TEST(Variants, SetAndRemoveKeysOfTheProjectAndLeaveTheRest) {
  const auto variants = variants_of(
      "[[variant]]\nname = \"one\"\nset.hardware.circuit.resistors = \"E24\"\nset.fit.order = 3\n"
      "remove = [\"fit.max_error_db\"]\n");
  ASSERT_EQ(variants.size(), 1U);
  const ProjectSource changed = with_variant(
      project_of("[fit]\nmax_error_db = 0.1\n[hardware.circuit]\ncapacitors = \"E6\"\n"), variants[0]);
  const Node fit = changed.document.at("fit");
  EXPECT_FALSE(fit.has("max_error_db"));
  EXPECT_EQ(fit.at("order").integer(1, 9), 3);
  EXPECT_EQ(fit.at("order").line(), 5);
  EXPECT_NE(fit.at("order").file().find("v.toml"), std::string::npos);
  const Node circuit = changed.document.at("hardware").at("circuit");
  EXPECT_EQ(circuit.at("resistors").string(), "E24");
  EXPECT_EQ(circuit.at("capacitors").string(), "E6");
  EXPECT_EQ(variants[0].what(), "hardware.circuit.resistors = E24, fit.order = 3, fit.max_error_db removed");
}

TEST(Variants, AGridIsEveryCombination) {
  const auto variants =
      variants_of("[grid]\n\"fit.order\" = [2, 3, 4]\n\"hardware.circuit.resistors\" = [\"E12\", \"E96\"]\n");
  ASSERT_EQ(variants.size(), 6U);
  EXPECT_EQ(variants[0].name, "order=2+resistors=E12");
  EXPECT_EQ(variants[5].what(), "fit.order = 4, hardware.circuit.resistors = E96");
  EXPECT_EQ(variants[5].value_of("fit.order"), "4");
  EXPECT_EQ(variants[5].value_of("name"), "");
  // A name is a folder's: what parts folders or lists is none of it.
  EXPECT_EQ(
      variants_of("[grid]\n\"target.points\" = [\"a/b c,d\"]\n\"track.frequency_hz\" = [[1, 10]]\n")[0].name,
      "points=a_b_c_d+frequency_hz=1__10");
}

// A small file must not fill the memory: ten thousand designs, each with every key and its name.
TEST(Variants, EndlessNamesAndKeysOfAGridAreRefusedBeforeTheyMultiply) {
  std::string grid = "[grid]\n";
  for (int axis = 0; axis < 13; ++axis)
    grid += "\"" + std::string(30, static_cast<char>('a' + axis)) + "\" = [1, 2]\n";
  EXPECT_NE(refusal(grid).find("v.toml:2: 'grid' has the name 'aaa"), std::string::npos) << refusal(grid);
  const auto key_of = [](std::size_t letters) {
    return "[grid]\n\"" + std::string(letters, 'x') + ".order\" = [1, 2]\n";
  };
  EXPECT_NE(refusal(key_of(5000)).find("'grid' has a key of 5006 letters"), std::string::npos);
  EXPECT_EQ(variants_of(key_of(100)).size(), 2U);
}

TEST(Variants, NamesAreThoseOfFolders) {
  const auto is_read = [](const std::string& name) {
    return refusal("[[variant]]\nname = \"" + name + "\"\nset.fit.order = 1\n") == "read";
  };
  for (const char* name : {"a", "Z9", "a b", "a-b", "a_b", "a.b", "order=2", "a+b", "5%", "_"})
    EXPECT_TRUE(is_read(name)) << name;
  for (const char* name : {"", " a", "a ", ".a", "a/b", "a:b", "a*", "a~", "é", "a,b", "a\\\\b"})
    EXPECT_FALSE(is_read(name)) << name;
}

TEST(Variants, SlipsAreSaidWhereTheyStand) {
  EXPECT_EQ(refusal("").find("v.toml: has no design"), 0U) << refusal("");
  EXPECT_NE(refusal("[[variant]]\nname = \"../x\"\n").find("v.toml:2: 'variant[0]' has the name '../x'"),
            std::string::npos);
  EXPECT_NE(refusal("[[variant]]\nname = \"a\"\n[[variant]]\nname = \"a\"\n").find("v.toml:4: "),
            std::string::npos);
  EXPECT_NE(
      refusal("[[variant]]\nname = \"a\"\nsett.x = 1\n").find("v.toml:4: 'variant[0].sett' is not known"),
      std::string::npos)
      << refusal("[[variant]]\nname = \"a\"\nsett.x = 1\n");
  EXPECT_NE(refusal("[grid]\nfit.order = [1, 2]\n").find("keys with dots stand in quotes"),
            std::string::npos);
  EXPECT_NE(refusal("[grid]\na = []\n").find("is no list of values"), std::string::npos);
  const auto missing = variants_of("[[variant]]\nname = \"a\"\nremove = [\"fit.order\"]\n");
  EXPECT_THROW(with_variant(project_of("[fit]\nreal = true\n"), missing[0]), InputError);
  const auto through = variants_of("[[variant]]\nname = \"a\"\nset.name.x = 1\n");
  EXPECT_THROW(with_variant(project_of("name = \"n\"\n"), through[0]), InputError);
}

}  // namespace
}  // namespace bodesmith::project
