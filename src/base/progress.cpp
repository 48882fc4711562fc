#include "base/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <csignal>
#include <memory>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/temporary.hpp"
#include "base/terminal.hpp"

namespace bodesmith {
namespace {

constexpr double kSilentS = 0.5;
constexpr auto kEvery = std::chrono::milliseconds(100);
constexpr int kBar = 24;

std::atomic<bool> line_shown{false};

void write_to_terminal(std::string_view text) {
  // Past stdio, whose buffers belong to the thread that works.
  const auto written = ::write(STDERR_FILENO, text.data(), text.size());
  static_cast<void>(written);
}

/// From a signal handler too.
void erase_progress_line() {
  if (line_shown.exchange(false)) write_to_terminal("\r\x1b[K");
}

/// One line on the terminal, drawn by a thread of its own: also while the work is in a place that says nothing.
class Display {
 public:
  explicit Display(std::string what) : what_(std::move(what)), drawing_([this] { draw(); }) {}
  ~Display() {
    {
      const std::lock_guard guard(lock_);
      over_ = true;
    }
    wake_.notify_all();
    drawing_.join();
    erase_progress_line();
  }
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

  void put(const Progress& work) {
    const std::lock_guard guard(lock_);
    works_.push_back(&work);
  }
  void take(const Progress& work) {
    const std::lock_guard guard(lock_);
    std::erase(works_, &work);
    if (works_.empty()) highest_ = -1.0;
  }

 private:
  void draw() {
    std::unique_lock guard(lock_);
    while (!wake_.wait_for(guard, kEvery, [this] { return over_; })) {
      const double elapsed = watch_.seconds();
      if (elapsed < kSilentS) continue;
      line_shown.store(true);
      write_to_terminal("\r\x1b[K" + line(elapsed));
    }
  }

  /// The outermost work's fraction, refined by the works inside; the innermost one's name.
  std::string line(double elapsed) {
    std::string what = what_;
    double fraction = -1.0;
    double from = 0.0;
    double span = 1.0;
    for (const Progress* work : works_) {
      const Progress::Part part = work->part();
      if (part.what != what_) what = what_ + ": " + part.what;
      if (part.fraction < 0.0 || span <= 0.0) continue;
      fraction = from + span * std::clamp(part.fraction, 0.0, 1.0);
      from = fraction;
      span *= std::max(0.0, part.next - part.fraction);
    }
    highest_ = std::max(highest_, fraction);
    return progress_line(what, highest_, elapsed, terminal_columns(STDERR_FILENO));
  }

  std::string what_;
  Stopwatch watch_;
  std::mutex lock_;
  std::condition_variable wake_;
  std::vector<const Progress*> works_;
  double highest_ = -1.0;  ///< a bar does not go back
  bool over_ = false;
  std::thread drawing_;
};

/// Whether this is the thread whose work the display shows; the others leave it alone.
bool& shown_here() {
  thread_local bool here = false;
  return here;
}

std::unique_ptr<Display>& the_display() {
  static std::unique_ptr<Display> display;
  return display;
}

std::string time_text(double seconds) {
  if (seconds < 100.0) return fmt::format("{:.0f} s", seconds);
  if (seconds < 6000.0) return fmt::format("{:.0f} min", seconds / 60.0);
  return fmt::format("{:.1f} h", seconds / 3600.0);
}

/// Whether the display of this thread, if there is one, shows the work from here on; take_off_display() then ends it.
bool put_on_display(const Progress& work) {
  if (shown_here()) the_display()->put(work);
  return shown_here();
}

void take_off_display(const Progress& work) {
  if (shown_here()) the_display()->take(work);
}

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

void show_progress(const std::string& what) {
  if (quiet() || !on_terminal(STDERR_FILENO)) return;
  hide_progress();
  the_display() = std::make_unique<Display>(what);
  shown_here() = true;
}

void hide_progress() {
  shown_here() = false;
  the_display().reset();
}

std::string progress_line(const std::string& what, double fraction, double elapsed_s, int columns) {
  std::string out;
  if (fraction >= 0.0) {
    const int full = static_cast<int>(fraction * kBar);
    out = fmt::format("[{:#<{}}{:-<{}}] {:3.0f} %  {}", "", full, "", kBar - full, 100.0 * fraction, what);
    // Too early a guess would be a random number.
    if (fraction > 0.02) out += fmt::format(", {} left", time_text(elapsed_s * (1.0 - fraction) / fraction));
  } else {
    out = fmt::format("{}, {}", what, time_text(elapsed_s));
  }
  // A line that wraps could not be taken back.
  const auto room = static_cast<std::size_t>(std::max(columns - 1, 1));
  if (out.size() > room) {
    std::size_t end = room;
    while (end > 0 && (static_cast<unsigned char>(out[end]) & 0xC0U) == 0x80U) --end;
    out.resize(end);
  }
  return out;
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
