// Which files a file may name, and where outputs may stand (docs/limits.md, "Files that name files").
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>

#include "run_program.hpp"

namespace bodesmith {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOneSection =
    R"({"schema":"bodesmith.sections/1","gain":1,"sections":[{"gain":1e4,"zeros_rad_s":[],)"
    R"("poles_rad_s":[[-1e4,0]]}]})";
constexpr const char* kLagModel =
    "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"lowpass\"\ncorner_hz = 40.0\n";

std::string filter_project(const std::string& sections, const std::string& name = "x") {
  return fmt::format(
      "schema = \"bodesmith.project/1\"\nname = \"{}\"\n[target]\nsections = \"{}\"\n[hardware.circuit]\n",
      name, sections);
}

std::set<fs::path> files_below(const fs::path& folder) {
  std::set<fs::path> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) out.insert(fs::relative(entry.path(), folder));
  return out;
}

TEST(Paths, NamesAreRelativeToTheFileThatHoldsThem) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "elsewhere");
  write_file(folder / "deep/s.json", kOneSection);
  write_file(folder / "deep/mine/p.toml", filter_project("../s.json"));
  write_file(folder / "deep/mine/absolute.toml", filter_project((folder / "deep/s.json").string()));
  write_file(folder / "deep/mine/none.toml", filter_project("s.json"));
  const auto run = [&](const std::string& arguments) {
    return run_shell("cd " + (folder / "elsewhere").string() + " && " + BODESMITH_PROGRAM + " " + arguments);
  };
  for (const char* project : {"p.toml", "absolute.toml"}) {
    const ProgramResult result = run(fmt::format("run ../deep/mine/{} -o out", project));
    EXPECT_EQ(result.status, 0) << result.err;
  }
  // Not relative to where the program was started.
  write_file(folder / "elsewhere/s.json", kOneSection);
  const ProgramResult none = run("run ../deep/mine/none.toml -o out");
  EXPECT_EQ(none.status, 2);
  EXPECT_NE(none.err.find("none.toml:4: 'target.sections' names ../deep/mine/s.json"), std::string::npos)
      << none.err;
  // A controller's and an inverse's model stand beside them.
  write_file(folder / "deep/m.toml", kLagModel);
  write_file(
      folder / "deep/c.toml",
      "schema = \"bodesmith.controller/1\"\ntype = \"pi\"\nki_per_s = 10.0\nfeedforward = \"i/inverse.toml\"\n");
  write_file(folder / "deep/i/inverse.toml", "schema = \"bodesmith.inverse/1\"\nmodel = \"../m.toml\"\n");
  const ProgramResult loop =
      run("simulate ../deep/m.toml --controller ../deep/c.toml --reference sine --duration-s 1 -o y.csv");
  EXPECT_EQ(loop.status, 0) << loop.err;
}

TEST(Paths, VariantsNameFilesNextToTheProjectAndFoldersInTheOutput) {
  const TemporaryFolder folder;
  write_file(folder / "p/s.json", kOneSection);
  write_file(folder / "p/other/s.json", kOneSection);
  write_file(folder / "p/p.toml", filter_project("s.json"));
  const auto sweep = [&](const std::string& variants) {
    write_file(folder / "v/v.toml", "schema = \"bodesmith.variants/1\"\n" + variants);
    return run_bodesmith(
        fmt::format("run {0}/p/p.toml --sweep {0}/v/v.toml -o {0}/out", folder.path().string()));
  };
  const std::set<fs::path> before = files_below(folder.path());
  for (const char* name : {"../x", "..", ".", "a/b", "/tmp/x", "", ".hidden"}) {
    const ProgramResult result = sweep(fmt::format("[[variant]]\nname = \"{}\"\n", name));
    EXPECT_EQ(result.status, 2) << name;
    EXPECT_NE(result.err.find("v.toml:2: "), std::string::npos) << name << result.err;
    EXPECT_FALSE(fs::exists(folder / "out"));
  }
  const ProgramResult good = sweep("[grid]\n\"target.sections\" = [\"s.json\", \"../p/other/s.json\"]\n");
  EXPECT_EQ(good.status, 0) << good.err;
  EXPECT_TRUE(fs::exists(folder / "out/sections=.._p_other_s.json/variant.json"));
  for (const fs::path& file : files_below(folder.path()))
    EXPECT_TRUE(before.count(file) > 0 || *file.begin() == "out" || *file.begin() == "v") << file;
}

TEST(Paths, ANameInAProjectIsNoPath) {
  const TemporaryFolder folder;
  write_file(folder / "s.json", kOneSection);
  const std::set<fs::path> before = files_below(folder.path());
  for (const char* name : {"../../x", "/tmp/x", ".include s.json", "*ng_script"}) {
    write_file(folder / "p.toml", filter_project("s.json", name));
    const ProgramResult result =
        run_bodesmith(fmt::format("run {0}/p.toml -o {0}/a/b/out", folder.path().string()));
    EXPECT_EQ(result.status, 0) << name << result.err;
    const std::string deck = read_file(folder / "a/b/out/spice/ac.cir");
    EXPECT_EQ(std::string(".*").find(deck.front()), std::string::npos) << deck.substr(0, 60);
  }
  for (const fs::path& file : files_below(folder.path()))
    EXPECT_TRUE(before.count(file) > 0 || file == "p.toml" || file.string().starts_with("a/b/out/")) << file;
}

TEST(Paths, ANetlistIncludesNothingOutsideOfItsFolder) {
  const TemporaryFolder folder;
  write_file(folder / "secret.txt", "nobody should read this\n");
  for (const char* line : {".include ../secret.txt", ".lib /etc/passwd typ", ".inc ~/secret.txt"}) {
    for (const char* file : {"deck/x.cir", "deck/x.sub"}) {
      write_file(folder / file, fmt::format("t\n{}\nV1 in 0 AC 1\nR1 in out 1k\nR2 out 0 1k\n"
                                            ".subckt a in out\nR1 in out 1\n.ends\n",
                                            line));
      const ProgramResult result = run_bodesmith("bode " + (folder / file).string() +
                                                 " --from-hz 1 --to-hz 10 -o " + (folder / "b.csv").string());
      EXPECT_EQ(result.status, 2) << line;
      EXPECT_NE(result.err.find(fs::path(file).filename().string() + ":2: includes "), std::string::npos)
          << result.err;
      EXPECT_EQ(result.err.find("nobody"), std::string::npos) << result.err;
      EXPECT_FALSE(fs::exists(folder / "b.csv"));
    }
  }
}

}  // namespace
}  // namespace bodesmith
