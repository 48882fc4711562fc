#pragma once

#include <gtest/gtest.h>

#include <filesystem>

#include "run_program.hpp"

namespace bodesmith {

/// One run of the main example for all tests of this process.
struct MainExample {
  ProgramResult result;
  std::filesystem::path folder;  ///< what it wrote
};
inline const MainExample& main_example() {
  static const TemporaryFolder folder;
  static const MainExample made = [] {
    MainExample out{{}, folder / "out"};
    out.result = run_bodesmith("run " BODESMITH_SOURCE_DIR "/examples/nanopositioner/project.toml -o " +
                               out.folder.string());
    EXPECT_EQ(out.result.status, 0) << out.result.err << out.result.out;
    return out;
  }();
  return made;
}

}  // namespace bodesmith
