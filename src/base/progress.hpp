#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace bodesmith {

/// A line on stderr that says how far long work is and how long it may still take; where stderr is no terminal, a
/// line every 20 seconds. Silent for the first half second.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `fraction` in [0, 1]. Cheap enough for inner loops (it looks at the clock only).
  void at(double fraction);

 private:
  std::string what_;
  std::function<void(double)> listener_;
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_;
};

/// While it lives, the outermost Progress of this thread tells `listener` its fraction instead of stderr: for programs that
/// show progress themselves. The listener is called from any thread.
class ProgressListener {
 public:
  explicit ProgressListener(std::function<void(double)> listener);
  ~ProgressListener();
  ProgressListener(const ProgressListener&) = delete;
  ProgressListener& operator=(const ProgressListener&) = delete;

 private:
  std::function<void(double)> before_;
};

/// From the first call on, Ctrl-C sets a flag instead of ending the program. A second Ctrl-C ends it, and so do
/// ten seconds in which nothing looked at the flag: no loop, however deep, makes the user wait longer.
void catch_interrupts();
/// For work that keeps what it has when it is stopped and takes longer to write it down (10 s when never called).
void allow_to_stop(unsigned seconds);
/// Whether the user asked to stop. Long loops look here and return what they have.
bool interrupted();
/// The same wish from a program that hears of Ctrl-C in its own way; and its end, before the next piece of work.
void ask_to_stop();
void forget_interruption();
/// Throws Interrupted when interrupted(): for places where there is nothing partial to return.
void stop_if_interrupted();

/// Wall seconds since construction.
class Stopwatch {
 public:
  Stopwatch() : start_(std::chrono::steady_clock::now()) {}
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_;
};

}  // namespace bodesmith
