#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
#include <string>

namespace bodesmith {

/// Long work that says how far it is. What a person sees of it, show_progress() decides; a ProgressListener hears it instead.
/// Pieces of work within work, on the same thread, are shown as parts of it.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `fraction` in [0, 1]. Cheap enough for inner loops.
  void at(double fraction) { at(fraction, fraction); }
  /// What follows takes the work from `fraction` to `next`; a Progress made in it counts from the one to the other. `doing` is
  /// shown until the next call (a text that stays, such as a literal).
  void at(double fraction, double next, const char* doing = nullptr);

  /// What a display shows of it.
  struct Part {
    std::string what;
    double fraction = -1.0;  ///< below 0: not known
    double next = 0.0;
  };
  Part part() const;

 private:
  std::string what_;
  std::function<void(double)> listener_;
  bool on_display_ = false;
  std::atomic<double> fraction_{-1.0};
  std::atomic<double> next_{0.0};
  std::atomic<const char*> doing_{nullptr};
};

/// From here on a terminal at stderr shows, after half a second, a line with a bar, what the work of this thread is at, and the
/// time it may still take; nothing where stderr is no terminal, or after be_quiet(). `what`: the work as a whole.
void show_progress(const std::string& what);
/// Takes the line away for good: before anything else is written.
void hide_progress();
/// That line: "[####------]  40 %  run: tracking, 3 s left", no longer than `columns`; without a known fraction "run: tracking, 12 s".
std::string progress_line(const std::string& what, double fraction, double elapsed_s, int columns);

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

/// A time after which a long search begins nothing new and keeps the best so far; by default there is none.
class Deadline {
 public:
  Deadline() = default;
  /// So many seconds from now.
  explicit Deadline(double seconds)
      : end_(std::chrono::steady_clock::now() +
             std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                 std::chrono::duration<double>(seconds < kLongest_s ? seconds : kLongest_s))) {}

  bool passed() const { return end_ && std::chrono::steady_clock::now() >= *end_; }

 private:
  static constexpr double kLongest_s = 1e9;  ///< what the clock's counter holds

  std::optional<std::chrono::steady_clock::time_point> end_;
};

}  // namespace bodesmith
