#include "signal/formats/text_encoding.hpp"

#include <algorithm>
#include <cstdint>

namespace bodesmith::formats {
namespace {

void append_utf8(std::string& out, std::uint32_t c) {
  const auto add = [&out](std::uint32_t byte) { out += static_cast<char>(static_cast<unsigned char>(byte)); };
  if (c < 0x80) {
    add(c);
  } else if (c < 0x800) {
    add(0xC0 | (c >> 6));
    add(0x80 | (c & 0x3F));
  } else if (c < 0x10000) {
    add(0xE0 | (c >> 12));
    add(0x80 | ((c >> 6) & 0x3F));
    add(0x80 | (c & 0x3F));
  } else {
    add(0xF0 | (c >> 18));
    add(0x80 | ((c >> 12) & 0x3F));
    add(0x80 | ((c >> 6) & 0x3F));
    add(0x80 | (c & 0x3F));
  }
}

std::string from_utf16(std::string_view bytes, bool little) {
  const auto unit = [&](std::size_t i) {
    const auto a = static_cast<unsigned char>(bytes[i]);
    const auto b = static_cast<unsigned char>(bytes[i + 1]);
    return static_cast<std::uint32_t>(little ? a | (b << 8) : b | (a << 8));
  };
  std::string out;
  out.reserve(bytes.size() / 2);
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    std::uint32_t c = unit(i);
    if (c >= 0xD800 && c < 0xDC00 && i + 3 < bytes.size()) {
      const std::uint32_t low = unit(i + 2);
      if (low >= 0xDC00 && low < 0xE000) {
        c = 0x10000 + ((c - 0xD800) << 10) + (low - 0xDC00);
        i += 2;
      }
    }
    append_utf8(out, c);
  }
  // A byte left over is half a character that was cut, and no digit of the number before it. Half an end of line is none.
  const char last = bytes.size() % 2 != 0 ? bytes.back() : '\n';
  if (last != '\n' && last != '\r') append_utf8(out, 0xFFFD);
  return out;
}

bool is_utf8(std::string_view bytes) {
  for (std::size_t i = 0; i < bytes.size();) {
    const auto lead = static_cast<unsigned char>(bytes[i]);
    const std::size_t more = lead < 0x80                   ? 0
                             : lead >= 0xC2 && lead < 0xE0 ? 1
                             : lead >= 0xE0 && lead < 0xF0 ? 2
                             : lead >= 0xF0 && lead < 0xF5 ? 3
                                                           : 4;
    if (more == 4 || more >= bytes.size() - i) return false;
    for (std::size_t k = 1; k <= more; ++k) {
      if ((static_cast<unsigned char>(bytes[i + k]) & 0xC0U) != 0x80U) return false;
    }
    // Overlong forms, surrogates, beyond the last character.
    const auto second = more > 1 ? static_cast<unsigned char>(bytes[i + 1]) : 0x80U;
    if ((lead == 0xE0 && second < 0xA0) || (lead == 0xED && second > 0x9F) ||
        (lead == 0xF0 && second < 0x90) || (lead == 0xF4 && second > 0x8F))
      return false;
    i += more + 1;
  }
  return true;
}

}  // namespace

namespace {

std::string any_to_utf8(std::string_view bytes) {
  if (bytes.substr(0, 3) == "\xEF\xBB\xBF") return std::string(bytes.substr(3));
  if (bytes.substr(0, 2) == "\xFF\xFE") return from_utf16(bytes.substr(2), true);
  if (bytes.substr(0, 2) == "\xFE\xFF") return from_utf16(bytes.substr(2), false);
  // Text of Latin letters in UTF-16 without a mark: every second byte of the beginning is 0.
  if (bytes.size() >= 8 && bytes[0] != 0 && bytes[1] == 0 && bytes[2] != 0 && bytes[3] == 0 &&
      bytes[5] == 0 && bytes[7] == 0)
    return from_utf16(bytes, true);
  if (is_utf8(bytes) || bytes.find('\0') != std::string_view::npos) return std::string(bytes);
  std::string out;
  out.reserve(bytes.size());
  for (const char c : bytes) append_utf8(out, static_cast<unsigned char>(c));
  return out;
}

}  // namespace

std::string to_utf8(std::string_view bytes) {
  std::string out = any_to_utf8(bytes);
  // Lines of old Macintoshes and of some instruments.
  if (out.find('\n') == std::string::npos && out.find('\0') == std::string::npos)
    std::replace(out.begin(), out.end(), '\r', '\n');
  return out;
}

bool begins_as_utf16(std::string_view bytes, std::string_view word) {
  if (bytes.size() < 2 * word.size()) return false;
  for (std::size_t i = 0; i < word.size(); ++i) {
    if (bytes[2 * i] != word[i] || bytes[2 * i + 1] != 0) return false;
  }
  return true;
}

}  // namespace bodesmith::formats
