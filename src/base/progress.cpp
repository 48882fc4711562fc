#include "base/progress.hpp"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "base/progress_display.hpp"
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
  if (stop_wanted.exchange(true)) {
    erase_progress_line();
    end_at_once(kInterruptedStatus);
  }
  ::alarm(seconds_to_stop.load());
}

/// Nobody looked at the flag.
void on_patience_ended(int) {
  erase_progress_line();
  constexpr std::string_view kText = "bodesmith: interrupted\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kText.data(), kText.size());
  end_at_once(kInterruptedStatus);
}

}  // namespace

Progress::Progress(std::string what)
    : what_(std::move(what)),
      listener_(std::exchange(thread_listener(), {})),
      on_display_(put_on_display(*this)) {}

Progress::~Progress() {
  if (listener_) thread_listener() = std::move(listener_);
  if (on_display_) take_off_display(*this);
}

void Progress::at(double fraction, double next, const char* doing) {
  if (listener_) {
    listener_(fraction);
    return;
  }
  next_.store(next, std::memory_order_relaxed);
  doing_.store(doing, std::memory_order_relaxed);
  fraction_.store(fraction, std::memory_order_relaxed);
}

Progress::Part Progress::part() const {
  const char* doing = doing_.load(std::memory_order_relaxed);
  return {doing == nullptr ? what_ : std::string(doing), fraction_.load(std::memory_order_relaxed),
          next_.load(std::memory_order_relaxed)};
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
