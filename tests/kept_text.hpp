#pragma once

#include <gtest/gtest.h>

#include <cctype>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>

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

/// Compares line by line with tests/`name`, at six digits. Where a writer was changed on purpose: run with
/// BODESMITH_KEEP=1, look at what git says changed, and give it to the program that reads the format.
inline void expect_kept(const std::string& name, const std::string& text) {
  const std::filesystem::path path = std::filesystem::path(BODESMITH_SOURCE_DIR) / "tests" / name;
  if (std::getenv("BODESMITH_KEEP") != nullptr) write_file(path, few_digits(text));
  std::istringstream got(few_digits(text)), kept(read_file(path));
  std::string one, other;
  for (int line = 1;; ++line) {
    const bool more = static_cast<bool>(std::getline(got, one)),
               wanted = static_cast<bool>(std::getline(kept, other));
    ASSERT_EQ(more, wanted) << name << ":" << line;
    if (!more) return;
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

/// Of all files of a folder in the order of their names.
inline std::string digest_of_folder(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& one : std::filesystem::directory_iterator(folder))
    files[one.path().filename().string()] = read_file(one.path());
  std::string all;
  for (const auto& [name, text] : files) all += name + "\n" + text;
  return digest(all);
}

}  // namespace bodesmith
