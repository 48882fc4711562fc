// UTF-16 and Latin-1 against the characters that they stand for.
#include "signal/formats/text_encoding.hpp"

#include <gtest/gtest.h>

#include <string>

namespace bodesmith::formats {
namespace {

/// UTF-16 units with a mark before them.
std::string utf16(const std::u16string& text, bool little) {
  std::string out;
  for (const char16_t unit : u"\uFEFF" + text) {
    const char low = static_cast<char>(unit & 0xFF), high = static_cast<char>(unit >> 8);
    out += little ? low : high;
    out += little ? high : low;
  }
  return out;
}

std::string plain(const char8_t* text) {
  return reinterpret_cast<const char*>(text);
}

TEST(TextEncoding, EveryLengthOfACharacterBeginsAndEndsWhereItShould) {
  const std::u16string units = u"a\x7F\x80\x7FF\x800\xFFFD\xD800\xDC00\xDBFF\xDFFF µΩ";
  const std::string wanted = plain(u8"a\x7F\u0080\u07FF\u0800\uFFFD\U00010000\U0010FFFF µΩ");
  for (const bool little : {true, false}) EXPECT_EQ(to_utf8(utf16(units, little)), wanted) << little;
  EXPECT_EQ(to_utf8(wanted), wanted);
  EXPECT_EQ(to_utf8("\xEF\xBB\xBF" + wanted), wanted);
}

TEST(TextEncoding, HalfACharacterIsNoDigit) {
  EXPECT_EQ(to_utf8(utf16(u"1,2", true) + '3'), "1,2" + plain(u8"\uFFFD"));
  EXPECT_EQ(to_utf8(utf16(u"1,2", true) + '\n'), "1,2");
}

TEST(TextEncoding, WhatIsNoUtf8IsLatin1) {
  EXPECT_EQ(to_utf8("20 \xB0"
                    "C \xB5V"),
            plain(u8"20 °C µV"));
  EXPECT_EQ(to_utf8("\xC3("), plain(u8"Ã("));  // begun, not ended
  // Overlong, a surrogate, beyond the last character: bytes of Latin-1, each two of UTF-8.
  for (const std::string odd : {"\xC0\x80", "\xE0\x80\x80", "\xED\xA0\x80", "\xF0\x80\x80\x80",
                                "\xF4\x90\x80\x80", "\xF5\x80\x80\x80"})
    EXPECT_EQ(to_utf8(odd).size(), 2 * odd.size());
  EXPECT_TRUE(begins_as_utf16(std::string("T\0i\0", 4), "Ti"));
  EXPECT_FALSE(begins_as_utf16("Ti", "Ti"));
  EXPECT_FALSE(begins_as_utf16(std::string("T\0i\1", 4), "Ti"));
}

}  // namespace
}  // namespace bodesmith::formats
