#include "base/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "base/temporary.hpp"

namespace bodesmith {
namespace {

std::atomic<bool> stop_wanted{false};

std::function<void(double)>& thread_listener() {
  thread_local std::function<void(double)> listener;
  return listener;
}

constexpr int kInterruptedStatus = 130;
std::atomic<unsigned> seconds_to_stop{10};

void on_interrupt(int) {
  if (stop_wanted.exchange(true)) end_at_once(kInterruptedStatus);
  ::alarm(seconds_to_stop.load());
}

/// Nobody looked at the flag.
void on_patience_ended(int) {
  constexpr std::string_view kText = "bodesmith: interrupted\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kText.data(), kText.size());
  end_at_once(kInterruptedStatus);
}

}  // namespace

Progress::Progress(std::string what)
    : what_(std::move(what)),
      listener_(std::exchange(thread_listener(), {})),
      terminal_(::isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()),
      last_(start_) {}

Progress::~Progress() {
  if (listener_) thread_listener() = std::move(listener_);
  if (shown_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::at(double fraction) {
  if (listener_) {
    listener_(fraction);
    return;
  }
  const auto now = std::chrono::steady_clock::now();
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  if (!terminal_) {
    // A log gets a line now and then, so that nobody takes long work for a standstill.
    constexpr double kLogEveryS = 20.0;
    if (std::chrono::duration<double>(now - last_).count() < kLogEveryS) return;
    last_ = now;
    fmt::print(stderr, "bodesmith: {}: {:.0f} %\n", what_, 100.0 * fraction);
    return;
  }
  if (elapsed < 0.5 || std::chrono::duration<double>(now - last_).count() < 0.1) return;
  last_ = now;
  shown_ = true;
  fmt::print(stderr, "\r\x1b[K{}: {:.0f} %", what_, 100.0 * fraction);
  if (fraction > 0.01) fmt::print(stderr, ", {:.0f} s left", elapsed * (1.0 - fraction) / fraction);
  std::fflush(stderr);
}

ProgressListener::ProgressListener(std::function<void(double)> listener)
    : before_(std::exchange(thread_listener(), std::move(listener))) {}

ProgressListener::~ProgressListener() {
  thread_listener() = std::move(before_);
}

void catch_interrupts() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGALRM, on_patience_ended);
}
void allow_to_stop(unsigned seconds) {
  seconds_to_stop.store(seconds);
}
bool interrupted() {
  return stop_wanted.load(std::memory_order_relaxed);
}
void ask_to_stop() {
  stop_wanted.store(true);
}
void forget_interruption() {
  stop_wanted.store(false);
}
void stop_if_interrupted() {
  if (interrupted()) throw Interrupted();
}

}  // namespace bodesmith
