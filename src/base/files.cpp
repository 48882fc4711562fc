#include "base/files.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>

#include "base/error.hpp"

namespace bodesmith {
namespace fs = std::filesystem;

std::string read_file(const fs::path& path) {
  std::error_code ec;
  if (fs::is_directory(path, ec)) throw InputError(path.string(), 0, "is a folder, expected a file");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path.string(), 0, std::string("cannot be read: ") + std::strerror(errno));
  std::ostringstream text;
  text << in.rdbuf();
  if (in.bad()) throw InputError(path.string(), 0, "cannot be read to its end");
  return std::move(text).str();
}

void OutputSet::add(const fs::path& relative, std::string content) {
  files_.push_back({relative, std::move(content)});
}

void OutputSet::include(const fs::path& below, const OutputSet& other) {
  for (const File& file : other.files_) files_.push_back({below / file.path, file.content});
}

std::vector<fs::path> OutputSet::paths() const {
  std::vector<fs::path> out;
  for (const File& file : files_) out.push_back(file.path);
  return out;
}

void OutputSet::commit() {
  struct Staged {
    fs::path temporary;
    fs::path target;
  };
  std::vector<Staged> staged;
  const auto drop_all = [&staged] {
    std::error_code ignored;
    for (const Staged& s : staged) fs::remove(s.temporary, ignored);
  };
  const std::string suffix = ".tmp" + std::to_string(::getpid());
  for (const File& file : files_) {
    const fs::path target = folder_ / file.path;
    const auto fail = [&](const std::string& why) {
      drop_all();
      throw InputError(target.string(), 0, "cannot be written: " + why);
    };
    std::error_code ec;
    if (target.has_parent_path()) {
      fs::create_directories(target.parent_path(), ec);
      if (ec) fail(ec.message());
    }
    if (fs::is_directory(target, ec)) fail("it is a folder");
    const fs::path temporary = target.parent_path() / ("." + target.filename().string() + suffix);
    staged.push_back({temporary, target});
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    if (!out) fail(std::strerror(errno));
    out.write(file.content.data(), static_cast<std::streamsize>(file.content.size()));
    out.close();
    if (!out) fail(std::strerror(errno));
  }
  for (const Staged& s : staged) {
    std::error_code ec;
    fs::rename(s.temporary, s.target, ec);
    if (ec) {
      drop_all();
      throw InputError(s.target.string(), 0, "cannot be written: " + ec.message());
    }
  }
}

void write_file(const fs::path& path, std::string content) {
  OutputSet set;
  set.add(path, std::move(content));
  set.commit();
}

}  // namespace bodesmith
