#include "reader.hpp"

#include <unistd.h>

#include <cmath>
#include <fstream>
#include <stdexcept>

#include "base/documents/json.hpp"
#include "base/error.hpp"

namespace bodesmith::fuzz {
namespace {

namespace fs = std::filesystem;

/// Made for the first file, gone at the end.
class ProcessFolder {
 public:
  ProcessFolder() : path_(fs::temp_directory_path() / ("bodesmith-fuzz-" + std::to_string(::getpid()))) {
    fs::create_directories(path_);
  }
  ~ProcessFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

std::vector<Reader>& readers() {
  static std::vector<Reader> all;
  return all;
}

bool run(const Reader& reader, std::string_view bytes) {
  try {
    reader.read(bytes);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

fs::path as_file(std::string_view bytes, const std::string& name) {
  static const ProcessFolder folder;
  fs::path out = folder.path() / name;
  // A file system may write one that is cut and filled again through to the disk: a new one it does not.
  fs::remove(out);
  std::ofstream(out, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return out;
}

void require_finite(double value) {
  if (!std::isfinite(value)) throw std::logic_error("a reader let through what is not finite");
}

void require_finite(const Json& written) {
  if (written.is_number_float()) require_finite(written.get<double>());
  if (!written.is_structured()) return;
  for (const Json& value : written) require_finite(value);
}

}  // namespace bodesmith::fuzz
