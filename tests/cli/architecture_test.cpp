// The house rule: a room includes only headers of the rooms that CMakeLists.txt says it USES, and these stand
// above it.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "base/files.hpp"

namespace bodesmith {
namespace {
namespace fs = std::filesystem;

std::map<std::string, std::set<std::string>> allowed_rooms(std::vector<std::string>& order) {
  std::string text = read_file(fs::path(BODESMITH_SOURCE_DIR) / "CMakeLists.txt");
  std::map<std::string, std::set<std::string>> allowed;
  const std::regex call("bodesmith_room\\(([a-z_]+)([^)]*)\\)");
  for (std::sregex_iterator it(text.begin(), text.end(), call), end; it != end; ++it) {
    const std::string room = (*it)[1];
    order.push_back(room);
    const std::string arguments = (*it)[2];
    std::smatch uses;
    if (std::regex_search(arguments, uses, std::regex("USES([a-z_\\s]+)"))) {
      const std::string list = uses[1];
      const std::regex word("[a-z_]+");
      for (std::sregex_iterator w(list.begin(), list.end(), word); w != std::sregex_iterator(); ++w) {
        allowed[room].insert(w->str());
      }
    }
    allowed[room].insert(room);
  }
  return allowed;
}

TEST(Architecture, RoomsKnowOnlyTheRoomsTheyUse) {
  std::vector<std::string> order;
  const auto allowed = allowed_rooms(order);
  ASSERT_GE(order.size(), 12u);
  const std::set<std::string> rooms(order.begin(), order.end());
  const std::regex include("#include \"([a-z_]+)/[^\"]+\"");
  int seen = 0;
  for (const std::string& room : order) {
    for (const auto& entry :
         fs::recursive_directory_iterator(fs::path(BODESMITH_SOURCE_DIR) / "src" / room)) {
      if (!entry.is_regular_file()) continue;
      const std::string text = read_file(entry.path());
      for (std::sregex_iterator it(text.begin(), text.end(), include), end; it != end; ++it) {
        const std::string other = (*it)[1];
        if (rooms.count(other) == 0) continue;
        ++seen;
        EXPECT_TRUE(allowed.at(room).count(other) > 0)
            << entry.path() << " includes \"" << other << "/...\", which " << room << " does not use";
      }
    }
  }
  EXPECT_GT(seen, 50);
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
