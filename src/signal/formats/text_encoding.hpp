#pragma once

#include <string>
#include <string_view>

namespace bodesmith::formats {

/// UTF-16 with a byte order mark, or little-endian without one (as LTspice writes), becomes UTF-8; a UTF-8 mark goes;
/// what is no UTF-8 and holds no 0 is taken as Latin-1 (a degree sign of one byte would break every JSON output).
std::string to_utf8(std::string_view bytes);

/// Two bytes a character, the second of them 0 (Latin letters): how LTspice's binary files begin.
bool begins_as_utf16(std::string_view bytes, std::string_view word);

/// What a command wants of a file: a plain table without a header can be either.
enum class Content { any, response, record };

}  // namespace bodesmith::formats
