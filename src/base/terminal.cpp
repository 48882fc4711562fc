#include "base/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdlib>

namespace bodesmith {
namespace {

std::atomic<bool> quiet_wanted{false};

const char* escape_of(Tone tone) {
  constexpr std::array kWords = {"\x1b[1;31m", "\x1b[33m", "\x1b[32m", "\x1b[1m", "\x1b[2m"};
  return kWords.at(static_cast<std::size_t>(tone));
}

std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string_view() : std::string_view(value);
}

}  // namespace

bool on_terminal(int file_descriptor) {
  return ::isatty(file_descriptor) != 0;
}

bool colours_wanted(int file_descriptor) {
  return environment("NO_COLOR").empty() && environment("TERM") != "dumb" && on_terminal(file_descriptor);
}

std::string coloured(std::string_view text, Tone tone, int file_descriptor) {
  if (!colours_wanted(file_descriptor)) return std::string(text);
  return escape_of(tone) + std::string(text) + "\x1b[0m";
}

int terminal_columns(int file_descriptor) {
  winsize size{};
  if (::ioctl(file_descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 80;
}

void be_quiet() {
  quiet_wanted.store(true);
}
bool quiet() {
  return quiet_wanted.load(std::memory_order_relaxed);
}

}  // namespace bodesmith
