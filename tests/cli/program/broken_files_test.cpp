// Broken files of every kind that is read: truncated anywhere, bytes changed, lines lost or doubled, values
// replaced. A reader may accept what still makes sense; whatever it refuses must be one line that begins with
// the file's name.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "chain/model_file.hpp"
#include "fpaa/plan/plan.hpp"
#include "lti/cascade.hpp"
#include "lti/sections.hpp"
#include "project/project.hpp"
#include "run_program.hpp"
#include "signal/bode_points.hpp"
#include "signal/disturbance.hpp"
#include "signal/time_record.hpp"
#include "temporary_folder.hpp"

namespace bodesmith {
namespace {
namespace fs = std::filesystem;

struct Kind {
  std::string file;
  std::string good;
  std::function<void(const fs::path&, Provenance&)> read;
};

std::vector<Kind> kinds() {
  const fs::path example = fs::path(BODESMITH_SOURCE_DIR) / "examples/nanopositioner";
  std::string record = "time_s,u,y\n";
  for (int i = 0; i < 12; ++i) record += number_text(i * 0.5) + ",1.5,-2\n";
  return {
      {"points.csv", read_file(example / "gains.csv"),
       [](const fs::path& p, Provenance& f) { BodePoints::read_csv(p, f); }},
      {"record.csv", record, [](const fs::path& p, Provenance& f) { TimeRecord::read_csv(p, f, true); }},
      {"response.csv", "frequency_hz,magnitude_db,phase_deg,coherence\n1,0,0,1\n2,-3,-45,0.9\n4,-6,-60,0.5\n",
       [](const fs::path& p, Provenance& f) { FrequencyRecord::read_csv(p, f); }},
      {"cascade.json",
       R"({"schema": "bodesmith.cascade/1", "gain": 1.0,
 "terms": [{"lambda_s": 0.1, "x": 0.5, "beta": -0.25},
           {"lambda_s": 0.01, "x": 0.2, "beta": 1.5}],
 "fit": {"points": [{"frequency_hz": 1, "wanted_db": 0, "got_db": 0}], "rms_db": 0, "max_db": 0, "condition_number": 3}})",
       [](const fs::path& p, Provenance& f) { Cascade::read(p, f); }},
      {"sections.json",
       R"({"schema": "bodesmith.sections/1", "gain": 2.0,
 "sections": [{"gain": 1.0, "zeros_rad_s": [[-1.0, 0.0]], "poles_rad_s": [[-2.0, 0.0]]},
              {"gain": 0.5, "zeros_rad_s": [], "poles_rad_s": [[-2.0, 3.0], [-2.0, -3.0]]}],
 "error": {"band_hz": [1, 100], "max_magnitude_db": 0.1, "max_phase_deg": 0.2, "everywhere_max_magnitude_db": 0.1}})",
       [](const fs::path& p, Provenance& f) { Sections::read(p, f); }},
      {"disturbance.json", read_file(example / "disturbance.json"),
       [](const fs::path& p, Provenance& f) { Disturbance::read(p, f); }},
      {"model.toml",
       "schema = \"bodesmith.model/1\"\n\n[[block]]\ntype = \"gain\"\ngain = 6.92\noffset = 0.0\nfree = "
       "[\"gain\"]\n"
       "[[block]]\ntype = \"resonator\"\ngain = 1.0\nnatural_frequency_hz = 120.0\ndamping_ratio = 0.05\n"
       "[[block]]\ntype = \"polynomial\"\ncoefficients = [0.0, 1.0, 0.1]\n",
       [](const fs::path& p, Provenance& f) { chain::read_model(p, f); }},
  };
}

std::string mutate(const std::string& good, std::mt19937& random) {
  static const std::vector<std::string> kValues = {
      "nan", "inf",  "-1",   "0",     "1e999",  "\"x\"",    "[]",
      "{}",  "null", "true", "",      "1e-320", "\xFF\xFE", "]",
      "}",   ",",    "\"",   "# x\n", "\r",     "=",        "9999999999999999999999"};
  const auto below = [&random](size_t n) { return static_cast<size_t>(random() % std::max<size_t>(n, 1)); };
  std::string text = good;
  switch (below(6)) {
    case 0:
      return text.substr(0, below(text.size()));
    case 1:
      text[below(text.size())] = static_cast<char>(random() & 0xFF);
      return text;
    case 2: {  // a token replaced
      const size_t begin = below(text.size());
      const size_t end = std::min(text.size(), begin + 1 + below(8));
      return text.substr(0, begin) + kValues[below(kValues.size())] + text.substr(end);
    }
    case 3: {  // a number replaced
      std::vector<size_t> digits;
      for (size_t i = 0; i < text.size(); ++i) {
        if (std::isdigit(static_cast<unsigned char>(text[i])) != 0) digits.push_back(i);
      }
      const size_t begin = digits[below(digits.size())];
      size_t end = begin;
      while (end < text.size() &&
             (std::isalnum(static_cast<unsigned char>(text[end])) != 0 || text[end] == '.'))
        ++end;
      return text.substr(0, begin) + kValues[below(kValues.size())] + text.substr(end);
    }
    default: {  // a line lost or doubled
      std::vector<std::string> lines;
      for (const std::string_view line : split(text, '\n')) lines.emplace_back(line);
      const size_t i = below(lines.size());
      if (below(2) == 0) {
        lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(i));
      } else {
        lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(i), lines[i]);
      }
      return join(lines, "\n");
    }
  }
}

TEST(BrokenFiles, EveryReaderNamesTheFileAndSaysOneLine) {
  const TemporaryFolder folder;
  for (const Kind& kind : kinds()) {
    const fs::path path = folder / kind.file;
    Provenance ignored;
    write_file(path, kind.good);
    ASSERT_NO_THROW(kind.read(path, ignored)) << kind.file;
    std::mt19937 random(7);
    int refused = 0;
    for (int i = 0; i < 600; ++i) {
      const std::string text = mutate(kind.good, random);
      write_file(path, text);
      try {
        kind.read(path, ignored);
      } catch (const InputError& error) {
        ++refused;
        const std::string what = error.what();
        EXPECT_EQ(what.rfind(path.string(), 0), 0u) << what << "\n--- from ---\n" << text;
        EXPECT_EQ(what.find('\n'), std::string::npos) << what;
        EXPECT_LT(what.size(), 600u) << what;
      } catch (const std::exception& error) {
        ADD_FAILURE() << kind.file << ": not an InputError: " << error.what() << "\n--- from ---\n" << text;
      }
    }
    EXPECT_GT(refused, 150) << kind.file;
  }
}

TEST(BrokenFiles, EmptyFilesFoldersAndMissingFiles) {
  const TemporaryFolder folder;
  for (const Kind& kind : kinds()) {
    Provenance ignored;
    write_file(folder / kind.file, "");
    EXPECT_THROW(kind.read(folder / kind.file, ignored), InputError) << kind.file;
    EXPECT_THROW(kind.read(folder / ("no_" + kind.file), ignored), InputError) << kind.file;
    EXPECT_THROW(kind.read(folder.path(), ignored), InputError) << kind.file;
  }
}

TEST(BrokenFiles, TheProgramSaysOneLineAndKeepsWhatWasThere) {
  const TemporaryFolder folder;
  write_file(folder / "bad.json", "{\"schema\": \"bodesmith.sections/1\",\n \"gain\": 0, \"sections\": []}");
  write_file(folder / "bad.csv", "frequency_hz,gain\n1,1\n10,x\n");
  write_file(folder / "kept", "kept");
  const std::string out = " -o " + (folder / "kept").string();
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"fit " + (folder / "bad.csv").string() + out, "bad.csv:3: "},
      {"bode " + (folder / "bad.json").string() + out, "bad.json:2: "},
      {"approximate " + (folder / "bad.json").string() + out, "bad.json:1: "},
      {"bode nowhere.json" + out, "nowhere.json: "},
      {"fit " + (folder / "bad.csv").string(), "-o is missing"},
      {"fit", "missing"},
      {"bode --no-such-option x", "no-such-option"},
      {"frobnicate", "'frobnicate' is not a subcommand"},
      {"bode " + (folder / "bad.csv").string() + " --count 0" + out, "bad.csv:3"},
  };
  for (const auto& [arguments, expected] : cases) {
    const ProgramResult result = run_bodesmith(arguments);
    EXPECT_EQ(result.status, 2) << arguments << "\n" << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(result.err.rfind("bodesmith: ", 0), 0u) << result.err;
    EXPECT_NE(result.err.find(expected), std::string::npos) << arguments << "\n" << result.err;
    EXPECT_EQ(read_file(folder / "kept"), "kept") << arguments;
  }
}

}  // namespace
}  // namespace bodesmith
