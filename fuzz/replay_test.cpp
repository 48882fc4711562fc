// Every reader on every file of its corpus: what the fuzzers started from, and what they found.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <random>

#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

fs::path corpus_of(const Reader& reader) {
  return fs::path(BODESMITH_SOURCE_DIR) / "fuzz" / "corpus" / reader.name;
}

TEST(Fuzz, EveryReaderHasACorpusOfWhichItAcceptsSome) {
  EXPECT_GE(readers().size(), 15U);
  for (const Reader& reader : readers()) {
    std::size_t files = 0, accepted = 0;
    for (const auto& entry : fs::directory_iterator(corpus_of(reader))) {
      ++files;
      if (run(reader, bytes_of(entry.path()))) ++accepted;
    }
    EXPECT_GE(files, 1U) << reader.name;
    EXPECT_GE(accepted, 1U) << reader.name;
  }
}

/// Damaged copies of every file: cut, doubled, bytes changed. For campaigns without clang, BODESMITH_FUZZ_COPIES says how
/// many of each (40 else) and BODESMITH_FUZZ_SEED which; these then also tell what took more than a second.
TEST(Fuzz, DamagedFilesAreReadOrRefused) {
  const char* const asked = std::getenv("BODESMITH_FUZZ_COPIES");
  const char* const seed = std::getenv("BODESMITH_FUZZ_SEED");
  const int copies = asked == nullptr ? 40 : std::atoi(asked);
  std::mt19937_64 random(seed == nullptr ? 7U : static_cast<std::uint64_t>(std::atoll(seed)));
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(random() % n); };
  for (const Reader& reader : readers()) {
    for (const auto& entry : fs::directory_iterator(corpus_of(reader))) {
      const std::string whole = bytes_of(entry.path());
      for (int i = 0; i < copies; ++i) {
        std::string bytes = whole;
        switch (i % 4) {
          case 0:
            bytes.resize(below(bytes.size() + 1));
            break;
          case 1:
            for (int k = 0; k < 3 && !bytes.empty(); ++k)
              bytes[below(bytes.size())] = static_cast<char>(random() & 0xFF);
            break;
          case 2:
            bytes.insert(below(bytes.size() + 1), bytes.substr(below(bytes.size() + 1), 40));
            break;
          default:
            for (int k = 0; k < 4 && !bytes.empty(); ++k)
              bytes[below(bytes.size())] = "0123456789-+.eE,;\"[]{}\n#"[below(24)];
        }
        const std::clock_t begin = std::clock();
        EXPECT_NO_THROW(run(reader, bytes)) << reader.name << ", " << entry.path() << ", copy " << i;
        const auto took = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
        if (asked != nullptr && took > 1.0)
          ADD_FAILURE() << reader.name << ", " << entry.path() << ", copy " << i << ": " << took << " s";
      }
    }
  }
}

}  // namespace
}  // namespace bodesmith::fuzz
