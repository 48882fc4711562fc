#include "base/memory_file.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <stdexcept>

#include "base/files.hpp"

namespace bodesmith {

MemoryFile::MemoryFile(std::string_view bytes) : descriptor_(::memfd_create("bodesmith", MFD_CLOEXEC)) {
  if (descriptor_ < 0) throw std::runtime_error("the system gives no file in memory");
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written <= 0) {
      ::close(descriptor_);
      throw std::runtime_error("a file in memory cannot be written");
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

MemoryFile::~MemoryFile() {
  ::close(descriptor_);
}

std::filesystem::path MemoryFile::path() const {
  return "/proc/self/fd/" + std::to_string(descriptor_);
}

std::string MemoryFile::bytes() const {
  return read_file(path());
}

}  // namespace bodesmith
