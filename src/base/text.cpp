#include "base/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace bodesmith {

std::string number_text(double value) {
  char buffer[40];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
  std::string out(buffer, result.ptr);
  if (out.find_first_of(".eni") == std::string::npos) out += ".0";
  return out;
}

std::string rounded_text(double value, int digits) {
  // 13210, not 1.321e+04: up to a million people read the digits.
  const double size = std::abs(value);
  if (digits >= 1 && size >= std::pow(10.0, digits) && size < 999999.5) {
    const double unit = std::pow(10.0, std::floor(std::log10(size)) + 1 - digits);
    return fmt::format("{:.0f}", unit * std::round(value / unit));
  }
  return fmt::format("{:.{}g}", value, digits);
}

std::string engineering_text(double value, std::string_view unit, int digits) {
  static constexpr std::pair<double, const char*> kPrefixes[] = {
      {1e9, "G"}, {1e6, "M"}, {1e3, "k"}, {1.0, ""}, {1e-3, "m"}, {1e-6, "µ"}, {1e-9, "n"}, {1e-12, "p"}};
  for (const auto& [scale, prefix] : kPrefixes) {
    // A value that rounds up to the next prefix belongs there: 999.96 is 1 k, not 1000.
    if (std::abs(value) * (1.0 + 0.5 * std::pow(10.0, -digits)) >= scale) {
      return fmt::format("{} {}{}", rounded_text(value / scale, digits), prefix, unit);
    }
  }
  return fmt::format("{} {}", rounded_text(value, digits), unit);
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> out;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = text.find(separator, begin);
    out.push_back(text.substr(begin, end == std::string_view::npos ? end : end - begin));
    if (end == std::string_view::npos) return out;
    begin = end + 1;
  }
}

std::string_view trim(std::string_view text) {
  const char* blank = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(blank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blank) - begin + 1);
}

std::string folded_text(std::string_view text) {
  constexpr std::size_t kColumns = 100;
  constexpr std::size_t kWidestLabel = 20;
  std::string out;
  for (std::string_view line : split(text, '\n')) {
    std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
    const std::size_t gap = line.find("  ", indent);
    const std::size_t behind = std::min(line.find_first_not_of(' ', gap), line.size());
    indent = 2 + (behind <= kWidestLabel ? behind : indent);
    std::size_t room = kColumns;
    while (line.size() > room) {
      const std::size_t blank = line.rfind(' ', room);
      // A path longer than a line stays whole.
      if (blank == std::string_view::npos || blank < line.find_first_not_of(' ')) break;
      out.append(line.substr(0, blank)).append("\n").append(indent, ' ');
      line.remove_prefix(blank + 1);
      room = kColumns - indent;
    }
    out.append(line).append("\n");
  }
  out.pop_back();
  return out;
}

std::string join(const std::vector<std::string>& parts, std::string_view separator) {
  return fmt::format("{}", fmt::join(parts, separator));
}

bool parse_number(std::string_view text, double& value) {
  text = trim(text);
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc() && result.ptr == text.data() + text.size() && std::isfinite(value);
}

}  // namespace bodesmith
