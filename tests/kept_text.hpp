#pragma once

#include <gtest/gtest.h>

#include <cctype>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>

#include "base/documents/json.hpp"
#include "base/files.hpp"

namespace bodesmith {

/// The text with every decimal number at six digits: what a writer makes hangs on no last bits then.
inline std::string few_digits(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const bool begins =
        std::isdigit(static_cast<unsigned char>(text[i])) != 0 &&
        (i == 0 || (std::isalnum(static_cast<unsigned char>(text[i - 1])) == 0 && text[i - 1] != '_'));
    const std::size_t end = begins ? text.find_first_not_of("0123456789.", i) : i + 1;
    const std::string digits = text.substr(i, std::min(end, text.size()) - i);
    i += digits.size();
    if (!begins || digits.size() < 7 || digits.find('.') == std::string::npos) {
      out += digits;
      continue;
    }
    char* after = nullptr;
    const double number = std::strtod(text.c_str() + i - digits.size(), &after);
    i = static_cast<std::size_t>(after - text.c_str());
    char rounded[32];
    std::snprintf(rounded, sizeof rounded, "%.6g", number);
    out += rounded;
  }
  return out;
}

/// Compares line by line with tests/`name`, at six digits, but for the version in it. Where a writer was changed on purpose: run
/// with BODESMITH_KEEP=1, look at what git says changed, and give it to the program that reads the format.
inline void expect_kept(const std::string& name, const std::string& text) {
  const std::filesystem::path path = std::filesystem::path(BODESMITH_SOURCE_DIR) / "tests" / name;
  if (std::getenv("BODESMITH_KEEP") != nullptr && !name.starts_with("..")) write_file(path, few_digits(text));
  std::istringstream got(few_digits(text)), kept(few_digits(read_file(path)));
  std::string one, other;
  for (int line = 1;; ++line) {
    const bool more = static_cast<bool>(std::getline(got, one)),
               wanted = static_cast<bool>(std::getline(kept, other));
    ASSERT_EQ(more, wanted) << name << ":" << line;
    if (!more) return;
    if (one.starts_with("* Written by bodesmith")) continue;
    ASSERT_EQ(one, other) << name << ":" << line;
  }
}

/// FNV-1a of a picture, whose coordinates say nothing to a reader: where one was changed on purpose, look at it.
inline std::string digest(const std::string& text) {
  std::uint64_t out = 0xcbf29ce484222325U;
  for (const char c : text) out = (out ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  char hex[20];
  std::snprintf(hex, sizeof hex, "%016llx", static_cast<unsigned long long>(out));
  return hex;
}

/// A line for each key, so that what differs is named.
inline std::string line_a_key(const Json& json) {
  std::string out;
  for (const auto& [key, value] : json.items()) out += key + ": " + value.dump() + "\n";
  return out;
}

/// Every file that is to be written, with its digest at six digits, a line each.
inline std::string digests(const OutputSet& files) {
  std::string all;
  for (const auto& path : files.paths())
    all += digest(few_digits(*files.content(path))) + " " + path.string() + "\n";
  return all;
}

}  // namespace bodesmith
