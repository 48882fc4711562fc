#include "fpaa/streams/board_link.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.hpp"
#include "base/progress.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr int kXon = 0x11;
constexpr int kXoff = 0x13;

class TerminalPort : public SerialPort {
 public:
  explicit TerminalPort(const std::string& device) : device_(device) {
    file_ = ::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (file_ < 0) throw InputError(fmt::format("{}: cannot be opened: {}", device, std::strerror(errno)));
    termios line{};
    if (::tcgetattr(file_, &line) != 0) {
      ::close(file_);
      throw InputError(fmt::format("{}: is not a serial port", device));
    }
    ::cfmakeraw(&line);
    line.c_cflag |= CLOCAL | CREAD;
    line.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | PARENB);
    ::cfsetispeed(&line, B57600);
    ::cfsetospeed(&line, B57600);
    if (::tcsetattr(file_, TCSANOW, &line) != 0) {
      ::close(file_);
      throw InputError(fmt::format("{}: cannot be set to 57600 8N1: {}", device, std::strerror(errno)));
    }
    ::tcflush(file_, TCIOFLUSH);
  }
  ~TerminalPort() override { ::close(file_); }
  TerminalPort(const TerminalPort&) = delete;
  TerminalPort& operator=(const TerminalPort&) = delete;

  void write(std::string_view bytes) override {
    while (!bytes.empty()) {
      pollfd wait{file_, POLLOUT, 0};
      if (::poll(&wait, 1, kWriteTimeoutMs) <= 0) {
        throw InputError(fmt::format("{}: takes no bytes, expected a board that reads", device_));
      }
      const ssize_t count = ::write(file_, bytes.data(), bytes.size());
      if (count < 0 && (errno == EAGAIN || errno == EINTR)) continue;
      if (count <= 0) throw InputError(fmt::format("{}: writing failed: {}", device_, std::strerror(errno)));
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
  }

  std::optional<std::uint8_t> read(double seconds) override {
    const Stopwatch watch;
    while (true) {
      stop_if_interrupted();
      const double left = seconds - watch.seconds();
      if (left <= 0.0) return std::nullopt;
      pollfd wait{file_, POLLIN, 0};
      ::poll(&wait, 1, static_cast<int>(std::min(left, kReadSliceS) * 1000.0) + 1);
      std::uint8_t byte = 0;  // read() says whether there is one
      const ssize_t count = ::read(file_, &byte, 1);
      if (count == 1) {
        if (byte == kXon || byte == kXoff) continue;
        return byte;
      }
      if (count == 0 || (errno != EAGAIN && errno != EINTR)) {
        if (count < 0 && errno == EIO) return std::nullopt;  // the other end of a pseudo-terminal is closed
        throw InputError(fmt::format("{}: the line is gone", device_));
      }
    }
  }

 private:
  static constexpr int kWriteTimeoutMs = 5000;
  static constexpr double kReadSliceS = 0.2;  ///< after which a Ctrl-C is noticed
  std::string device_;
  int file_ = -1;
};

class Link {
 public:
  Link(SerialPort& port, const LinkOptions& options) : port_(port), options_(options) {}

  /// Asks until an answer comes; before each try `prepare` runs (it may send a packet).
  template <class Prepare>
  std::string ask(char command, const std::string& what, Prepare prepare) {
    std::string trouble;
    for (int attempt = 0; attempt <= options_.retries; ++attempt) {
      ++report_.tries;
      drain();
      prepare();
      port_.write(std::string{kStx, command});
      const auto answer = read_answer(trouble);
      port_.write(std::string(1, kEtx));
      if (!answer) continue;
      if (answer->find("ERR") != std::string::npos || answer->find("FAIL") != std::string::npos) {
        throw InputError(fmt::format("the board refuses {}: it answers '{}'", what, *answer));
      }
      return *answer;
    }
    throw InputError(
        fmt::format("the board does not answer {} ({}, {} tries)", what, trouble, options_.retries + 1));
  }

  LinkReport& report() { return report_; }

 private:
  /// What is still on the line from an earlier, late answer.
  void drain() {
    while (port_.read(kQuietS)) {
    }
  }

  std::optional<std::string> read_answer(std::string& trouble) {
    std::string answer;
    while (answer.size() < kMaxAnswer) {
      const auto received = port_.read(options_.timeout_s);
      if (!received) {
        trouble =
            answer.empty() ? "silence" : fmt::format("the answer stops after {} characters", answer.size());
        return std::nullopt;
      }
      const std::uint8_t byte = *received;
      if (byte == 0) {
        if (!answer.empty()) return answer;
        continue;
      }
      const bool printable = (byte >= 0x20 && byte < 0x7F) || byte == '\r' || byte == '\n' || byte == '\t';
      if (!printable) {
        trouble = fmt::format("garbage, byte {:02X}", byte);
        return std::nullopt;
      }
      answer += static_cast<char>(byte);
    }
    trouble = "an answer that does not end";
    return std::nullopt;
  }

  static constexpr std::size_t kMaxAnswer = 4096;
  static constexpr double kQuietS = 0.01;  ///< nothing more comes of a late answer after this
  SerialPort& port_;
  LinkOptions options_;
  LinkReport report_;
};

/// Chips in the answer to 'T': three characters and seven a chip; eleven characters mean none.
int chips_of(std::string_view answer) {
  constexpr std::size_t kStart = 3;
  constexpr std::size_t kOneChip = 7;
  constexpr std::size_t kNone = 11;
  if (answer.size() == kNone || answer.size() < kStart) return 0;
  return static_cast<int>((answer.size() - kStart) / kOneChip);
}

}  // namespace

std::unique_ptr<SerialPort> open_serial_port(const std::string& device) {
  return std::make_unique<TerminalPort>(device);
}

LinkReport send_packets(SerialPort& port, const std::vector<std::string>& packets, int chips_needed,
                        const LinkOptions& options) {
  Link link(port, options);
  LinkReport& report = link.report();
  report.identity = link.ask('#', "who it is ('#')", [] {});
  const std::string chips = link.ask('T', "which chips it has ('T')", [] {});
  report.chips = chips_of(chips);
  if (report.chips < chips_needed) {
    throw InputError(fmt::format("the board has {} chips (it answers '{}'), the packets need {}",
                                 report.chips, chips, chips_needed));
  }
  for (std::size_t i = 0; i < packets.size(); ++i) {
    report.status.push_back(link.ask('?', fmt::format("its status ('?') after packet {}", i + 1),
                                     [&] { port.write(packets[i]); }));
  }
  return report;
}

}  // namespace bodesmith::fpaa
