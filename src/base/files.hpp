#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace bodesmith {

/// The bytes of a file. Throws InputError (naming the path) when it cannot be read to its end, is a folder, is larger
/// than 2 GiB, or is a pipe into which nobody writes for some seconds.
std::string read_file(const std::filesystem::path& path);
/// The file that read_file() was given last, for what can be said of the memory that ran out over it.
const std::filesystem::path& last_file_read();

/// From here on this process alone writes into the folder, which it makes: InputError while another one does. Where the
/// file system has no such locks there is none.
void claim_folder(const std::filesystem::path& folder);

/// From here on OutputSet refuses to write over what remember_input() has named: for programs that end after one
/// command.
void protect_inputs();
void remember_input(const std::filesystem::path& path);

/// Asked before commit() writes anything, with every file it would write: what refuses throws. Empty: nobody.
void ask_before_writing(std::function<void(const std::filesystem::path&)> ask);

/// Files that are written together, whole or not at all: nothing touches the disk before commit(), every file
/// goes to a temporary name next to its target first, and only when all of them stand are they renamed. A link is
/// followed; what is no ordinary file (a device, a pipe) is written to as it is, before the others. Temporary files go when the program
/// is ended by a signal, and those that a killed run left go at the next commit to the same name.
class OutputSet {
 public:
  /// Files are named relative to `folder`, which commit() makes; an empty folder means paths as they are.
  explicit OutputSet(std::filesystem::path folder = {}) : folder_(std::move(folder)) {}

  void add(const std::filesystem::path& relative, std::string content);
  /// Every file of another set, below a folder of this one.
  void include(const std::filesystem::path& below, const OutputSet& other);
  /// Claims the folder (in programs that end after one command). Throws InputError when a file cannot be written, was read as an input, is named twice, or would stand outside of the
  /// folder (absolute, ".."); targets that existed are then untouched.
  void commit();

  /// Paths added so far (relative to the folder), in order.
  std::vector<std::filesystem::path> paths() const;
  /// What commit() writes under one of them; null when there is none.
  const std::string* content(const std::filesystem::path& relative) const;

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
