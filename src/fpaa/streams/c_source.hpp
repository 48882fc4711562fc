#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "fpaa/device/config_stream.hpp"

namespace bodesmith::fpaa {

/// A piece of C source: words (names and numbers), single characters, comments (without their marks).
struct CToken {
  enum class Kind { word, symbol, comment };
  Kind kind = Kind::symbol;
  std::string_view text;
  int line = 1;
};

/// Splits C source. Throws InputError for a comment or string that does not end.
std::vector<CToken> c_tokens(std::string_view text, const std::string& file);

/// A C integer literal between 0 and `max`; throws InputError otherwise.
int c_integer(const CToken& token, int max, const std::string& file);

/// Whether `NAME [ … ] = {` stands at token `at`; then moves behind the brace.
bool opens_array(const std::vector<CToken>& tokens, std::size_t& at);

/// Bytes as the lines of an array, "0xD5, …".
std::vector<std::string> c_rows(const Bytes& bytes);

}  // namespace bodesmith::fpaa
