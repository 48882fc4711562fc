// What keeps the code and its texts in one style: headers stay light, files are named once, one spelling, one vocabulary.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "base/files.hpp"
#include "base/text.hpp"
#include "texts.hpp"

namespace bodesmith {
namespace {
namespace fs = std::filesystem;

const fs::path kRoot = BODESMITH_SOURCE_DIR;

std::vector<fs::path> files_below(const fs::path& folder, const std::set<std::string>& endings) {
  std::vector<fs::path> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && endings.count(entry.path().extension().string()) > 0)
      out.push_back(entry.path());
  }
  return out;
}

TEST(Style, HeadersDoNotIncludeTheWholeOfJson) {
  const char* const heavy = "#include [<\"](nlohmann/json\\.hpp|base/json\\.hpp)[>\"]";
  for (const fs::path& file : files_below(kRoot / "src", {".hpp"})) {
    if (file == kRoot / "src/base/documents/json.hpp") continue;
    EXPECT_FALSE(has_match(read_file(file), heavy))
        << file << " includes all of JSON, expected base/documents/json_fwd.hpp";
  }
}

TEST(Style, FilesDoNotRepeatTheNameOfTheirFolder) {
  for (const fs::path& file : files_below(kRoot / "src", {".hpp", ".cpp"})) {
    const std::string room = fs::relative(file, kRoot / "src").begin()->string();
    EXPECT_NE(file.filename().string().rfind(room + "_", 0), 0u) << file;
  }
}

TEST(Style, EverySubcommandHasAFileOfItsOwn) {
  const std::string table = read_file(kRoot / "src/cli/commands.cpp");
  const auto entries = matches(table, "COMMAND\\(([a-z]+), \"");
  for (const auto& entry : entries)
    EXPECT_TRUE(fs::exists(kRoot / "src/cli/commands" / (entry[1] + "_command.cpp"))) << entry[1];
  EXPECT_GE(entries.size(), 12u);
}

/// A way of writing that is not used here, and what is used in its place.
struct Rule {
  std::string stem;  // lower-case letters that every match holds: few lines have to be searched by expression
  std::string pattern;
  std::string instead;
};

const std::vector<Rule>& rules() {
  static const std::vector<Rule> all = {
      {"realiz", "realiz", "realis… (only the option and key `realization` are spelt so)"},
      {"behavior", "behavior", "behaviour"},
      {"miz", "(minimi|maximi|optimi)z", "…is…"},
      {"riz", "(lineari|colori|summari)z", "…is…"},
      {"liz", "normaliz", "…is…"},
      {"niz", "(recogni|organi)z", "…is…"},
      {"tiz", "discretiz", "…is…"},
      {"dear", "\\bdear(er|est)?\\b", "expensive"},
      {"hangs on", "hangs on", "depends on"},
      {"whole", "whole[ _]way", "run_project"},
      {"tell_tale", "\\btell_tale\\b", "symptom"},
      {"complaint", "\\bcomplaint", "validation error"},
      {" seed", "(first|second|third|fourth|fifth) seed",
       "the paper's title, or its short name in docs/papers.md"},
  };
  return all;
}

/// Names of the contract and of outside APIs (Google Benchmark, Zrna, Eigen, CMake) that keep their spelling.
std::string without_exceptions(const std::string& line) {
  static const char* const exceptions =
      "--realization|\"realization\"|`realization`|\\{\\{realization\\}\\}|^realization = |[.>]realization\\b|"
      "std::string realization\\b|DoNotOptimize|NonLinearOptimization|CMAKE_OPTIMIZE_DEPENDENCIES|lm\\.minimize|\\.realized\\b|^linearize v\\(";
  return replaced(line, exceptions, "");
}

void check_style(const fs::path& file) {
  int number = 0;
  const std::string text = read_file(file);
  for (const std::string_view part : split(text, '\n')) {
    ++number;
    const std::string small = lower_case(part);
    for (const Rule& rule : rules()) {
      if (small.find(rule.stem) == std::string::npos) continue;
      EXPECT_FALSE(has_match(lower_case(without_exceptions(std::string(part))), rule.pattern))
          << file.string() << ":" << number << ": " << part << "\n  expected " << rule.instead;
    }
  }
}

TEST(Style, OneSpellingAndOneVocabulary) {
  const std::set<std::string> endings = {".cpp", ".hpp", ".md",  ".toml", ".txt", ".html",
                                         ".py",  ".c",   ".cir", ".sub",  ".svg", ".sh"};
  for (const char* folder : {"src", "docs", "templates", "examples", "bench"}) {
    for (const fs::path& file : files_below(kRoot / folder, endings)) check_style(file);
  }
  for (const char* file : {"README.md", "CONTRIBUTING.md", "CHANGELOG.md", "KNOWNBUGS.md", "CMakeLists.txt"})
    check_style(kRoot / file);
}

TEST(Style, RoundedNumbersBecomeWholeOnesInOneWay) {
  // What std::lround and a cast do with a number that the type cannot hold is undefined.
  const char* const unchecked =
      R"(\bl?lround\(|static_cast<(int|long|long long|unsigned|std::size_t|std::u?int\d+_t|Eigen::Index)>\((std::)?(floor|ceil|round|trunc)\()";
  for (const fs::path& file : files_below(kRoot / "src", {".cpp", ".hpp"})) {
    if (file == kRoot / "src/base/whole_number.hpp") continue;
    EXPECT_FALSE(has_match(read_file(file), unchecked))
        << file << ", expected nearest_whole() or whole_number()";
  }
}

TEST(Style, LettersAndNumbersDoNotDependOnTheLocale) {
  // A host of the library (Python) may set one: a Turkish tolower('I') is 'I', a German strtod("1.5") is 1.
  const char* const by_locale =
      R"(<cctype>|\b(is(alnum|alpha|digit|space|upper|lower|punct)|to(upper|lower))\(|\bstrto[df]\(|\bsto[df]\(|\bato[f]\()";
  for (const char* folder : {"src", "python/src"}) {
    for (const fs::path& file : files_below(kRoot / folder, {".cpp", ".hpp"})) {
      EXPECT_FALSE(has_match(read_file(file), by_locale))
          << file << ", expected base/text.hpp or parse_number()";
    }
  }
}

TEST(Style, NothingNamesAMachine) {
  const char* const machine = "/(work|home|root|tmp)/[a-z_]+/(build|src|main)\\b";
  for (const char* folder : {"src", "tests", "docs", "templates", "examples", "bench", "cmake", ".ci"}) {
    for (const fs::path& file :
         files_below(kRoot / folder, {".cpp", ".hpp", ".md", ".toml", ".py", ".sh", ".cmake", ".txt", ""})) {
      EXPECT_FALSE(has_match(read_file(file), machine)) << file;
    }
  }
}

}  // namespace
}  // namespace bodesmith
