#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bodesmith {

/// The bytes of a file. Throws InputError (naming the path) when it cannot be read or is a folder.
std::string read_file(const std::filesystem::path& path);

/// Files that are written together, whole or not at all: nothing touches the disk before commit(), every file
/// goes to a temporary name beside its target first, and only when all of them stand are they renamed.
class OutputSet {
 public:
  /// Files are named relative to `folder`, which commit() makes; an empty folder means paths as they are.
  explicit OutputSet(std::filesystem::path folder = {}) : folder_(std::move(folder)) {}

  void add(const std::filesystem::path& relative, std::string content);
  /// Every file of another set, below a folder of this one.
  void include(const std::filesystem::path& below, const OutputSet& other);
  /// Throws InputError when a file cannot be written; targets that existed are then untouched.
  void commit();

  const std::filesystem::path& folder() const { return folder_; }
  /// Paths added so far (relative to the folder), in order.
  std::vector<std::filesystem::path> paths() const;

 private:
  struct File {
    std::filesystem::path path;
    std::string content;
  };
  std::filesystem::path folder_;
  std::vector<File> files_;
};

/// OutputSet of one.
void write_file(const std::filesystem::path& path, std::string content);

}  // namespace bodesmith
