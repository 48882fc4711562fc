#include "fpaa/device/config_stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "base/error.hpp"

namespace bodesmith::fpaa {
namespace {

using ::testing::HasSubstr;

ConfigStream random_stream(std::mt19937& random) {
  ConfigStream s;
  s.primary = random() % 2 == 0;
  s.leading_zeros = static_cast<int>(random() % 6);
  s.address1 = 1 + static_cast<int>(random() % 0x60);
  s.control = static_cast<int>(random() % 256);
  s.trailing_zeros = static_cast<int>(random() % 3);
  const int blocks = static_cast<int>(random() % 5);
  for (int b = 0; b < blocks; ++b) {
    ConfigBlock block;
    block.bank = static_cast<int>(random() % 24);
    block.byte = static_cast<int>(random() % 32);
    const std::size_t count = random() % 7 == 0 ? 256 : 1 + random() % 40;
    for (std::size_t i = 0; i < count; ++i) block.data.push_back(static_cast<std::uint8_t>(random()));
    s.blocks.push_back(block);
  }
  return s;
}

std::string complaint(const Bytes& bytes) {
  try {
    decode(bytes, "x.ahf");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ConfigStream, RoundTripsByteForByteThroughEveryForm) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 500; ++trial) {
    const ConfigStream stream = random_stream(random);
    const Bytes bytes = encode(stream);
    const ConfigStream back = decode(bytes, "x");
    EXPECT_EQ(encode(back), bytes);
    EXPECT_EQ(back.blocks, stream.blocks);
    EXPECT_EQ(from_ahf(to_ahf(bytes), "x"), bytes);
    const auto packets = from_packets(to_packet(bytes, stream.primary) + to_packet(bytes, false), "x");
    ASSERT_EQ(packets.size(), 2u);
    EXPECT_EQ(packets[0].bytes, bytes);
    EXPECT_EQ(packets[0].primary, stream.primary);
    EXPECT_FALSE(packets[1].primary);
  }
}

TEST(ConfigStream, MatchesTheBytesOfTheVendorsForm) {
  // Facts: update = D5, Address1, control, blocks; block = 80|40|byte, bank, count, data, 2A.
  ConfigStream s;
  s.address1 = 2;
  s.control = 0x81;
  s.blocks = {{0, 7, {0xFA}}, {3, 4, {1, 2, 3}}};
  const Bytes wanted = {0xD5, 0x02, 0x81, 0xC7, 0x00, 0x01, 0xFA, 0x2A,
                        0x84, 0x03, 0x03, 0x01, 0x02, 0x03, 0x2A};
  EXPECT_EQ(encode(s), wanted);
  EXPECT_EQ(to_packet({0xD5, 0x0A}, false), std::string("\x02") + "10004D50A\x03");
}

TEST(ConfigStream, RefusesWithTheByteOffset) {
  const Bytes good = {0xD5, 0x02, 0x81, 0x84, 0x03, 0x03, 0x01, 0x02, 0x03, 0x2A};
  EXPECT_EQ(complaint(good), "");
  Bytes bad = good;
  bad[0] = 0xD4;
  EXPECT_THAT(complaint(bad), HasSubstr("x.ahf: byte 0: is D4"));
  bad = good;
  bad[9] = 0x2B;
  EXPECT_THAT(complaint(bad), HasSubstr("byte 9"));
  bad = good;
  bad[3] = 0xA4;
  EXPECT_THAT(complaint(bad), HasSubstr("CRC16"));
  bad = good;
  bad[3] = 0xC4;  // says that another block follows
  EXPECT_THAT(complaint(bad), HasSubstr("byte 10: the stream ends"));
  bad = good;
  bad.push_back(0x11);
  EXPECT_THAT(complaint(bad), HasSubstr("byte 10: is 11"));
  EXPECT_THAT(complaint({0xD5, 0xB7, 0x21}), HasSubstr("byte 2"));
  EXPECT_THAT(complaint({}), HasSubstr("byte 0: the stream ends"));
}

TEST(ConfigStream, BrokenInputNeverPassesUnnoticedOrCrashes) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 3000; ++trial) {
    Bytes bytes = encode(random_stream(random));
    const std::size_t cut = random() % (bytes.size() + 1);
    if (random() % 2 == 0) bytes.resize(cut);
    for (int k = 0; k < 2 && !bytes.empty(); ++k)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    try {
      EXPECT_EQ(encode(decode(bytes, "x")), bytes);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("x: byte "));
    }
    const std::string text(bytes.begin(), bytes.end());
    for (const auto read : {+[](const std::string& t) { from_ahf(t, "x"); },
                            +[](const std::string& t) { from_packets(t, "x"); }}) {
      try {
        read(text);
      } catch (const InputError&) {
      }
    }
  }
}

}  // namespace
}  // namespace bodesmith::fpaa
