#include "fpaa/streams/c_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "base/error.hpp"
#include "base/text.hpp"

namespace bodesmith::fpaa {

std::vector<CToken> c_tokens(std::string_view text, const std::string& file) {
  std::vector<CToken> out;
  int line = 1;
  std::size_t at = 0;
  const auto is_word = [](char c) { return is_letter_or_digit(c) || c == '_'; };
  while (at < text.size()) {
    const char c = text[at];
    if (c == '\n') {
      ++line;
      ++at;
    } else if (is_blank(c)) {
      ++at;
    } else if (c == '/' && at + 1 < text.size() && text[at + 1] == '*') {
      const std::size_t end = text.find("*/", at + 2);
      if (end == std::string_view::npos)
        throw InputError(file, line, "the comment does not end, expected */");
      const std::string_view body = text.substr(at + 2, end - at - 2);
      out.push_back({CToken::Kind::comment, trim(body), line});
      for (const char b : body) line += b == '\n' ? 1 : 0;
      at = end + 2;
    } else if (c == '/' && at + 1 < text.size() && text[at + 1] == '/') {
      const std::size_t end = std::min(text.find('\n', at), text.size());
      out.push_back({CToken::Kind::comment, trim(text.substr(at + 2, end - at - 2)), line});
      at = end;
    } else if (c == '"' || c == '\'') {
      std::size_t end = at + 1;
      while (end < text.size() && text[end] != c && text[end] != '\n') end += text[end] == '\\' ? 2U : 1U;
      if (end >= text.size() || text[end] != c) throw InputError(file, line, "the string does not end");
      at = end + 1;
    } else if (is_word(c)) {
      std::size_t end = at;
      while (end < text.size() && is_word(text[end])) ++end;
      out.push_back({CToken::Kind::word, text.substr(at, end - at), line});
      at = end;
    } else {
      out.push_back({CToken::Kind::symbol, text.substr(at, 1), line});
      ++at;
    }
  }
  return out;
}

int c_integer(const CToken& token, int max, const std::string& file) {
  std::string_view digits = token.text;
  int base = 10;
  if (digits.size() > 2 && digits[0] == '0' && (digits[1] == 'x' || digits[1] == 'X')) {
    base = 16;
    digits.remove_prefix(2);
  }
  int value = -1;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value, base);
  if (token.kind != CToken::Kind::word || code != std::errc{} || end != digits.data() + digits.size() ||
      value < 0 || value > max) {
    throw InputError(file, token.line, fmt::format("'{}' is not a number from 0 to {}", token.text, max));
  }
  return value;
}

bool opens_array(const std::vector<CToken>& tokens, std::size_t& at) {
  if (tokens[at].kind != CToken::Kind::word || at + 1 >= tokens.size() || tokens[at + 1].text != "[")
    return false;
  std::size_t k = at + 1;
  while (k < tokens.size() && tokens[k].text != "]") ++k;
  if (k + 2 >= tokens.size() || tokens[k + 1].text != "=" || tokens[k + 2].text != "{") return false;
  at = k + 3;
  return true;
}

std::vector<std::string> c_rows(const Bytes& bytes) {
  constexpr std::size_t kBytesARow = 8;
  std::vector<std::string> rows;
  for (std::size_t i = 0; i < bytes.size(); i += kBytesARow) {
    std::string row;
    for (std::size_t k = i; k < std::min(bytes.size(), i + kBytesARow); ++k)
      row += fmt::format("0x{:02X}{}", bytes[k], k + 1 < bytes.size() ? ", " : "");
    rows.emplace_back(trim(row));
  }
  return rows;
}

}  // namespace bodesmith::fpaa
