#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace bodesmith {

/// A file without a place on the disk, for libraries that read or write files by name only. It goes with the object.
class MemoryFile {
 public:
  /// Throws std::runtime_error when the system gives none.
  explicit MemoryFile(std::string_view bytes = {});
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::filesystem::path path() const;
  std::string bytes() const;

 private:
  int descriptor_;
};

}  // namespace bodesmith
