#include "base/error.hpp"

namespace bodesmith {
namespace {

/// One line, whatever a library put into its message.
std::string single_line(std::string_view text) {
  std::string out(text);
  for (char& c : out) {
    if (c == '\n' || c == '\r' || c == '\t') c = ' ';
  }
  return out;
}

std::string located(std::string_view file, int line, std::string_view message) {
  std::string out(file);
  if (line > 0) out += ":" + std::to_string(line);
  if (!out.empty()) out += ": ";
  return out + single_line(message);
}

}  // namespace

InputError::InputError(std::string_view file, int line, std::string_view message)
    : std::runtime_error(located(file, line, message)) {}

}  // namespace bodesmith
