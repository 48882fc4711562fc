#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "fpaa/device/config_stream.hpp"

namespace bodesmith::fpaa {

/// The board behind a pseudo-terminal. `habit` decides how it answers.
class FakeBoard {
 public:
  struct Habit {
    int chips = 4;
    int silent_first = 0;   ///< questions that go unanswered
    int garbage_first = 0;  ///< questions answered with noise
    bool refuses = false;   ///< status answers ERR
    bool half_answers = false;
  };

  explicit FakeBoard(const Habit& habit) : habit_(habit) {
    master_ = ::posix_openpt(O_RDWR | O_NOCTTY);
    if (master_ < 0) throw std::runtime_error("there is no pseudo-terminal to be had (/dev/ptmx, /dev/pts)");
    ::grantpt(master_);
    ::unlockpt(master_);
    name_ = ::ptsname(master_);
    // Kept open so that the line survives the client's closing, and raw from the start.
    slave_ = ::open(name_.c_str(), O_RDWR | O_NOCTTY);
    termios line{};
    ::tcgetattr(slave_, &line);
    ::cfmakeraw(&line);
    ::tcsetattr(slave_, TCSANOW, &line);
    thread_ = std::thread([this] { run(); });
  }
  ~FakeBoard() {
    stop_ = true;
    thread_.join();
    ::close(slave_);
    ::close(master_);
  }
  const std::string& name() const { return name_; }
  /// Packets as they came in; call after the client is done.
  std::vector<Packet> packets() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    thread_ = std::thread([] {});
    return packets_;
  }

 private:
  int next() {
    while (!stop_) {
      pollfd wait{master_, POLLIN, 0};
      if (::poll(&wait, 1, 20) <= 0) continue;
      unsigned char byte = 0;
      if (::read(master_, &byte, 1) == 1) return byte;
    }
    return -1;
  }
  void say(std::string text) {
    if (silent_ < habit_.silent_first) {
      ++silent_;
      return;
    }
    if (noisy_ < habit_.garbage_first) {
      ++noisy_;
      text = "\xFF\x80\x01";
    }
    if (habit_.half_answers) text = text.substr(0, 3);
    if (!habit_.half_answers) text.push_back('\0');
    EXPECT_EQ(::write(master_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  void run() {
    while (!stop_) {
      if (next() != 0x02) continue;  // ETX and strays
      const int command = next();
      if (command == '#') say("AN231K04-QUAD4 v2");
      if (command == 'T') {
        std::string list = "N=" + std::to_string(habit_.chips);
        for (int i = 0; i < habit_.chips; ++i) list += "B720010";
        say(habit_.chips == 0 ? "NO DEVICES!" : list);
      }
      if (command == '?') say(habit_.refuses ? "ERR 3" : "OK");
      if (command == '0' || command == '1') {
        std::string text = "\x02";
        text += static_cast<char>(command);
        int byte = 0;
        while ((byte = next()) != 0x03 && byte >= 0) text += static_cast<char>(byte);
        text += '\x03';
        packets_.push_back(from_packets(text, "line").at(0));
      }
    }
  }

  Habit habit_;
  int master_ = -1;
  int slave_ = -1;
  std::string name_;
  std::atomic<bool> stop_{false};
  int silent_ = 0;
  int noisy_ = 0;
  std::vector<Packet> packets_;
  std::thread thread_;
};

}  // namespace bodesmith::fpaa
