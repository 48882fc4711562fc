#include "base/error.hpp"

namespace bodesmith {
namespace {

constexpr std::size_t kLongestMessage = 600;

/// One line of printable text, whatever a library or a file put into the message.
std::string single_line(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '\n' || c == '\r' || c == '\t') {
      out += ' ';
    } else if (code < 0x20 || code == 0x7f) {
      out += '?';
    } else {
      out += c;
    }
  }
  if (out.size() <= kLongestMessage) return out;
  // Not in the middle of a character of several bytes.
  std::size_t end = kLongestMessage;
  while (end > 0 && (static_cast<unsigned char>(out[end]) & 0xC0U) == 0x80U) --end;
  return out.substr(0, end) + " …";
}

std::string located(std::string_view file, int line, std::string_view message) {
  std::string out(file);
  if (line > 0) out += ":" + std::to_string(line);
  if (!out.empty()) out += ": ";
  return single_line(out + std::string(message));
}

}  // namespace

InputError::InputError(const std::string& message) : std::runtime_error(single_line(message)) {}

InputError::InputError(std::string_view file, int line, std::string_view message)
    : std::runtime_error(located(file, line, message)), file_(file), line_(line) {}

}  // namespace bodesmith
