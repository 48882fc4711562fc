// What a program leaves behind when a signal ends it: nothing.
#include "base/temporary.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "base/files.hpp"
#include "base/progress.hpp"
#include "temporary_folder.hpp"

namespace bodesmith {
namespace {
namespace fs = std::filesystem;

/// Runs `work` in a process of its own; its exit status.
int status_of(const std::function<void()>& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    work();
    ::_exit(99);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

TEST(Temporary, AnEndTakesFilesFoldersAndChildrenWithIt) {
  const TemporaryFolder folder;
  int pipe_ends[2];
  ASSERT_EQ(::pipe(pipe_ends), 0);
  const int status = status_of([&] {
    catch_endings();
    fs::create_directories(folder / "work");
    write_file(folder / "work/deck.cir", "x");
    write_file(folder / "kept.txt", "x");
    remember_temporary(folder / "work");
    remember_temporary(folder / "work/deck.cir");
    remember_temporary(folder / "kept.txt");
    forget_temporary(folder / "kept.txt");
    // Under this name kept.txt was written: forgotten, whoever has it now.
    std::ofstream(folder / (".kept.txt.tmp" + std::to_string(::getpid()))) << "x";
    const pid_t child = ::fork();
    if (child == 0) {
      for (;;) ::pause();
    }
    remember_child(child);
    [[maybe_unused]] const auto sent = ::write(pipe_ends[1], &child, sizeof child);
    std::raise(SIGTERM);
  });
  EXPECT_EQ(status, 128 + SIGTERM);
  EXPECT_FALSE(fs::exists(folder / "work"));
  EXPECT_TRUE(fs::exists(folder / "kept.txt"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 2);
  // The grandchild holds the other end of this pipe until it is gone.
  pid_t grandchild = 0;
  ASSERT_EQ(::read(pipe_ends[0], &grandchild, sizeof grandchild), static_cast<ssize_t>(sizeof grandchild));
  EXPECT_FALSE(is_running(grandchild));
  ::close(pipe_ends[1]);
  char none = 0;
  EXPECT_EQ(::read(pipe_ends[0], &none, 1), 0) << "process " << grandchild << " lives on";
  ::close(pipe_ends[0]);
}

TEST(Temporary, AnEndWaitsForWhatAnotherThreadIsMaking) {
  const TemporaryFolder folder;
  const int status = status_of([&] {
    catch_endings();
    std::atomic<bool> making{false};
    std::thread other([&] {
      const EndingHeld until_made;
      remember_temporary(folder / "a.tmp");
      making = true;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      std::ofstream(folder / "a.tmp") << "x";
    });
    while (!making) std::this_thread::yield();
    std::raise(SIGTERM);
    other.join();
  });
  EXPECT_EQ(status, 128 + SIGTERM);
  EXPECT_FALSE(fs::exists(folder / "a.tmp"));
}

TEST(Temporary, WorkThatNeverLooksIsEndedAllTheSame) {
  const TemporaryFolder folder;
  const int status = status_of([&] {
    catch_interrupts();
    allow_to_stop(1);
    write_file(folder / "a.tmp", "x");
    remember_temporary(folder / "a.tmp");
    std::raise(SIGINT);
    for (;;) ::pause();
  });
  EXPECT_EQ(status, 130);
  EXPECT_FALSE(fs::exists(folder / "a.tmp"));
}

TEST(Temporary, TheSecondInterruptEndsAtOnce) {
  const int status = status_of([] {
    catch_interrupts();
    std::raise(SIGINT);
    if (!interrupted()) ::_exit(1);
    std::raise(SIGINT);
  });
  EXPECT_EQ(status, 130);
}

}  // namespace
}  // namespace bodesmith
