#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>

#include "base/error.hpp"
#include "base/files.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "schematic/ngspice/ngspice_process.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::ngspice {
namespace {
namespace fs = std::filesystem;

/// Number of a process that has ended.
pid_t ended_process() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  return child;
}

TEST(WorkFolder, FoldersOfKilledRunsGoAndOthersStay) {
  const TemporaryFolder folder;
  const auto make = [&](const std::string& name, int minutes) {
    write_file(folder / name / "deck.cir", "x");
    fs::last_write_time(folder / name, fs::file_time_type::clock::now() - std::chrono::minutes(minutes));
  };
  const std::string gone = std::to_string(ended_process());
  make("bodesmith-spice-" + gone + "-abcdef", 5);
  make("bodesmith-spice-" + gone + "-fresh1", 0);
  make("bodesmith-spice-" + std::to_string(::getpid()) + "-mine12", 5);
  make("bodesmith-spice-notes", 5);
  drop_stale_work_folders(folder.path());
  EXPECT_FALSE(fs::exists(folder / ("bodesmith-spice-" + gone + "-abcdef")));
  EXPECT_TRUE(fs::exists(folder / ("bodesmith-spice-" + gone + "-fresh1")));
  EXPECT_TRUE(fs::exists(folder / ("bodesmith-spice-" + std::to_string(::getpid()) + "-mine12")));
  EXPECT_TRUE(fs::exists(folder / "bodesmith-spice-notes"));
}

TEST(WorkFolder, IsGoneWithItsFilesAndNeedsAPlaceForTemporaryFiles) {
  fs::path was;
  {
    const WorkFolder work;
    was = work.path();
    write_file(was / "deck.cir", "x");
  }
  EXPECT_FALSE(fs::exists(was));
  const char* before = std::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  ::setenv("TMPDIR", "/nowhere/at/all", 1);
  EXPECT_THROW(WorkFolder(), InputError);
  before == nullptr ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", kept.c_str(), 1);
}

TEST(Transient, IsStraightBetweenItsInstantsWhereverItIsAskedNext) {
  const Transient run{{0.0, 1.0, 3.0, 4.0}, {{0.0, 2.0, 6.0, -2.0}, {1.0, 1.0, 5.0, 5.0}}};
  std::size_t place = 1;
  for (const auto& [t, first, second] : {std::array{-1.0, 0.0, 1.0},
                                         {0.0, 0.0, 1.0},
                                         {0.5, 1.0, 1.0},
                                         {1.0, 2.0, 1.0},
                                         {2.0, 4.0, 3.0},
                                         {3.5, 2.0, 5.0},
                                         {9.0, -2.0, 5.0},
                                         {0.25, 0.5, 1.0},
                                         {2.5, 5.0, 4.0}}) {
    EXPECT_DOUBLE_EQ(run.at(0, t, place), first) << t;
    EXPECT_DOUBLE_EQ(run.at(1, t, place), second) << t;
  }
}

}  // namespace
}  // namespace bodesmith::ngspice
