#include "fpaa/streams/board_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "fpaa/fake_board.hpp"

namespace bodesmith::fpaa {
namespace {

using ::testing::HasSubstr;

const Bytes kUpdate = {0xD5, 0x01, 0x81, 0x84, 0x03, 0x01, 0xFF, 0x2A, 0x00};

LinkReport send(FakeBoard& board, int chips, const LinkOptions& options = {.timeout_s = 0.3, .retries = 3}) {
  const auto port = open_serial_port(board.name());
  return send_packets(*port, {to_packet(kUpdate, false), to_packet(kUpdate, true)}, chips, options);
}

TEST(BoardLink, SendsToABoardThatBehaves) {
  FakeBoard board({});
  const LinkReport report = send(board, 4);
  EXPECT_EQ(report.identity, "AN231K04-QUAD4 v2");
  EXPECT_EQ(report.chips, 4);
  EXPECT_EQ(report.status, (std::vector<std::string>{"OK", "OK"}));
  const auto packets = board.packets();
  ASSERT_EQ(packets.size(), 2u);
  EXPECT_EQ(packets[0].bytes, kUpdate);
  EXPECT_FALSE(packets[0].primary);
  EXPECT_TRUE(packets[1].primary);
}

TEST(BoardLink, AsksAgainAfterSilenceAndGarbage) {
  FakeBoard board({.silent_first = 2, .garbage_first = 1});
  const LinkReport report = send(board, 1);
  EXPECT_EQ(report.status.size(), 2u);
  EXPECT_EQ(report.tries, 4 + 3);
}

TEST(BoardLink, GivesUpOnSilence) {
  FakeBoard board({.silent_first = 1000});
  try {
    send(board, 1, {.timeout_s = 0.1, .retries = 1});
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("silence, 2 tries"));
  }
  EXPECT_TRUE(board.packets().empty()) << "nothing may be sent to a board that does not say who it is";
}

TEST(BoardLink, GivesUpOnGarbageAndHalfAnswers) {
  FakeBoard noisy({.garbage_first = 1000});
  EXPECT_THROW(send(noisy, 1, {.timeout_s = 0.1, .retries = 1}), InputError);
  FakeBoard half({.half_answers = true});
  EXPECT_THROW(send(half, 1, {.timeout_s = 0.1, .retries = 1}), InputError);
}

TEST(BoardLink, ReportsARefusalAndMissingChips) {
  FakeBoard refusing({.refuses = true});
  try {
    send(refusing, 1);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("ERR 3"));
    EXPECT_THAT(error.what(), HasSubstr("packet 1"));
  }
  FakeBoard small({.chips = 1});
  EXPECT_THROW(send(small, 2), InputError);
  FakeBoard none({.chips = 0});
  EXPECT_THROW(send(none, 1), InputError);
}

TEST(BoardLink, WhatIsNotASerialPortIsRefused) {
  EXPECT_THROW(open_serial_port("/dev/null"), InputError);
  EXPECT_THROW(open_serial_port("/nowhere/at/all"), InputError);
}

}  // namespace
}  // namespace bodesmith::fpaa
