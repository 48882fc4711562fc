// Every reader on every file of its corpus: what the fuzzers started from, and what they found.
#include <gtest/gtest.h>

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

/// A few hundred damaged copies of every file: cut, doubled, bytes changed.
TEST(Fuzz, DamagedFilesAreReadOrRefused) {
  std::mt19937_64 random(7);
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(random() % n); };
  for (const Reader& reader : readers()) {
    for (const auto& entry : fs::directory_iterator(corpus_of(reader))) {
      const std::string whole = bytes_of(entry.path());
      for (int i = 0; i < 40; ++i) {
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
        EXPECT_NO_THROW(run(reader, bytes)) << reader.name << ", " << entry.path();
      }
    }
  }
}

}  // namespace
}  // namespace bodesmith::fuzz
