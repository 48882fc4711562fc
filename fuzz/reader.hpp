#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/documents/json_fwd.hpp"

namespace bodesmith::fuzz {

/// A reader under test: it may refuse any bytes with an InputError, and must do nothing else wrong with them.
struct Reader {
  const char* name;
  void (*read)(std::string_view bytes);
};

/// Every reader of this program, by name.
std::vector<Reader>& readers();

/// `const Registered csv{"csv", read_csv};` in a file of its own adds one.
struct Registered {
  Registered(const char* name, void (*read)(std::string_view)) { readers().push_back({name, read}); }
};

/// Runs one reader; false when it refused the bytes.
bool run(const Reader& reader, std::string_view bytes);

/// The bytes as a file of that name, in a folder of this process.
std::filesystem::path as_file(std::string_view bytes, const std::string& name);

/// std::logic_error unless finite: no reader may let anything else through.
void require_finite(double value);
/// The same of every number in a document that would be written.
void require_finite(const Json& written);

}  // namespace bodesmith::fuzz
