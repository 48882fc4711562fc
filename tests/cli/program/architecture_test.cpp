// The house rule: a room includes only headers of the rooms that CMakeLists.txt says it USES, and these stand
// above it.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "texts.hpp"

#include "base/files.hpp"

namespace bodesmith {
namespace {
namespace fs = std::filesystem;

std::map<std::string, std::set<std::string>> allowed_rooms(std::vector<std::string>& order) {
  std::string text = read_file(fs::path(BODESMITH_SOURCE_DIR) / "CMakeLists.txt");
  std::map<std::string, std::set<std::string>> allowed;
  for (const auto& call : matches(text, "bodesmith_room\\(([a-z_]+)([^)]*)\\)")) {
    const std::string& room = call[1];
    order.push_back(room);
    for (const auto& uses : matches(call[2], "USES([a-z_\\s]+)"))
      for (const auto& word : matches(uses[1], "[a-z_]+")) allowed[room].insert(word[0]);
    allowed[room].insert(room);
  }
  return allowed;
}

TEST(Architecture, RoomsKnowOnlyTheRoomsTheyUse) {
  std::vector<std::string> order;
  const auto allowed = allowed_rooms(order);
  ASSERT_GE(order.size(), 12u);
  const std::set<std::string> rooms(order.begin(), order.end());
  int seen = 0;
  for (const std::string& room : order) {
    for (const auto& entry :
         fs::recursive_directory_iterator(fs::path(BODESMITH_SOURCE_DIR) / "src" / room)) {
      if (!entry.is_regular_file()) continue;
      const std::string text = read_file(entry.path());
      for (const auto& include : matches(text, "#include \"([a-z_]+)/[^\"]+\"")) {
        const std::string& other = include[1];
        if (rooms.count(other) == 0) continue;
        ++seen;
        EXPECT_TRUE(allowed.at(room).count(other) > 0)
            << entry.path() << " includes \"" << other << "/...\", which " << room << " does not use";
      }
    }
  }
  EXPECT_GT(seen, 50);
}

/// Of every file of src/ (a header and its source are one) the files of its own room that it includes.
std::map<std::string, std::set<std::string>> file_graph() {
  const fs::path root = fs::path(BODESMITH_SOURCE_DIR) / "src";
  std::map<std::string, std::set<std::string>> out;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".cpp" && extension != ".hpp") continue;
    const std::string unit = fs::relative(entry.path(), root).replace_extension().string();
    const std::string room = unit.substr(0, unit.find('/') + 1);
    const std::string text = read_file(entry.path());
    for (const auto& include : matches(text, "#include \"([a-z0-9_/]+)\\.hpp\"")) {
      const std::string& other = include[1];
      if (other != unit && other.starts_with(room)) out[unit].insert(other);
    }
  }
  return out;
}

/// What a file reaches by its includes, itself only if it stands in a circle.
std::set<std::string> reached_from(const std::string& unit,
                                   const std::map<std::string, std::set<std::string>>& graph) {
  std::set<std::string> out;
  std::vector<std::string> open = {unit};
  while (!open.empty()) {
    const auto at = graph.find(open.back());
    open.pop_back();
    if (at == graph.end()) continue;
    for (const std::string& next : at->second)
      if (out.insert(next).second) open.push_back(next);
  }
  return out;
}

TEST(Architecture, NoFileOfARoomIncludesItselfByWayOfOthers) {
  const auto graph = file_graph();
  ASSERT_GT(graph.size(), 300u);
  for (const auto& [unit, includes] : graph)
    EXPECT_EQ(reached_from(unit, graph).count(unit), 0u)
        << unit << " includes itself by way of other files of its room";
}

TEST(Architecture, OptionsAreSpeltInCliAlone) {
  // A library's message names what is meant; how a command spells it is the command's business.
  const fs::path root = fs::path(BODESMITH_SOURCE_DIR) / "src";
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    const fs::path path = fs::relative(entry.path(), root);
    if (!entry.is_regular_file() || *path.begin() == "cli" || path == "main.cpp") continue;
    const std::string text = read_file(entry.path());
    for (const auto& option : matches(text, "\"[^\"\n]*--[a-z][a-z-]+")) {
      const std::string& found = option[0];
      // ngspice's own option, and a decrement after a text.
      EXPECT_TRUE(found == "\"--version" || found.find(") --") != std::string::npos) << path << ": " << found;
    }
  }
}

/// tests/P_test.cpp is of src/P, or of a helper tests/P.hpp; what is a law of a whole folder stands in it under the folder's own
/// name, what is one of the whole program in cli/program/.
TEST(Architecture, TestsMirrorTheSources) {
  const fs::path root(BODESMITH_SOURCE_DIR);
  int seen = 0;
  for (const auto& entry : fs::recursive_directory_iterator(root / "tests")) {
    const std::string path = fs::relative(entry.path(), root / "tests").string();
    if (!path.ends_with("_test.cpp") || path.starts_with("cli/program/")) continue;
    ++seen;
    const fs::path unit = path.substr(0, path.size() - std::string("_test.cpp").size());
    const bool is_of_a_file = fs::exists(root / "src" / (unit.string() + ".cpp")) ||
                              fs::exists(root / "src" / (unit.string() + ".hpp"));
    const bool is_of_a_helper = fs::exists(root / "tests" / (unit.string() + ".hpp"));
    const bool is_of_a_folder =
        unit.filename() == unit.parent_path().filename() && fs::exists(root / "src" / unit.parent_path());
    EXPECT_TRUE(is_of_a_file || is_of_a_helper || is_of_a_folder) << path << " is of nothing under src/";
  }
  EXPECT_GT(seen, 200);
}

TEST(Architecture, NamesOfTestsAreInOneStyle) {
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(BODESMITH_SOURCE_DIR) / "tests")) {
    if (!entry.path().string().ends_with("_test.cpp")) continue;
    const std::string text = read_file(entry.path());
    for (const auto& test : matches(text, R"(\nTEST(?:_[FP])?\(\s*(\w+),\s*(\w+)\))")) {
      const std::string &suite = test[1], &name = test[2];
      EXPECT_TRUE(has_match(suite + " " + name, "^[A-Z][A-Za-z0-9]* [A-Z][A-Za-z0-9]*$") &&
                  name.find("Beside") == std::string::npos)
          << entry.path() << ": " << suite << "." << name << ", expected UpperCamelCase";
    }
  }
}

TEST(Architecture, EveryHeaderIsGuardedAndEverySourceHasNoMachinePath) {
  for (const char* folder : {"src", "tests", "templates", "examples", "cmake"}) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(BODESMITH_SOURCE_DIR) / folder)) {
      if (!entry.is_regular_file()) continue;
      const std::string text = read_file(entry.path());
      if (entry.path().extension() == ".hpp") {
        EXPECT_NE(text.find("#pragma once"), std::string::npos) << entry.path();
      }
      EXPECT_EQ(text.find(std::string("/wor") + "k/main"), std::string::npos) << entry.path();
    }
  }
}

}  // namespace
}  // namespace bodesmith
