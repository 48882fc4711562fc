#include "base/files.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <system_error>

#include "base/error.hpp"
#include "base/temporary.hpp"

namespace bodesmith {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLargestFile = std::size_t{1} << 31;

bool inputs_protected = false;

std::function<void(const fs::path&)>& asked_before_writing() {
  static std::function<void(const fs::path&)> ask;
  return ask;
}

std::vector<fs::path>& inputs() {
  static std::vector<fs::path> all;
  return all;
}

/// Where a link leads in the end, also when nothing stands there yet.
fs::path followed(const fs::path& path) {
  fs::path out = path;
  std::error_code ec;
  for (int links = 0; links < 40 && fs::is_symlink(out, ec); ++links) {
    const fs::path next = fs::read_symlink(out, ec);
    if (ec) return path;
    out = next.is_absolute() ? next : out.parent_path() / next;
  }
  return out;
}

bool was_read(const fs::path& target) {
  return std::ranges::any_of(inputs(), [&](const fs::path& input) {
    std::error_code ec;
    return fs::equivalent(input, target, ec) && !ec;
  });
}

/// Devices and pipes are not replaced.
bool is_special(const fs::path& target) {
  std::error_code ec;
  const fs::file_status status = fs::status(target, ec);
  return !ec && fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

/// Temporary files of this name whose process is gone.
void drop_stale(const fs::path& target) {
  const std::string start = "." + target.filename().string() + ".tmp";
  std::error_code ec;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  for (fs::directory_iterator it(folder, ec), end; !ec && it != end; it.increment(ec)) {
    const std::string name = it->path().filename().string();
    if (!name.starts_with(start) || !is_ended_process(name.substr(start.size()))) continue;
    std::error_code ignored;
    fs::remove(it->path(), ignored);
  }
}

/// Names may come from a user's file: they do not lead out of the folder that was asked for. A link that stands in it does.
bool stays_below(const fs::path& relative) {
  return relative.is_relative() && std::ranges::find(relative, fs::path("..")) == relative.end();
}

bool is_pipe(const fs::path& path) {
  std::error_code ec;
  return fs::is_fifo(path, ec);
}

/// A pipe that nobody writes into would be waited for without end. One that is written to is opened as any file.
std::FILE* open_to_read(const fs::path& path) {
  if (!is_pipe(path)) return std::fopen(path.c_str(), "rb");
  constexpr int kPatienceMs = 2000;
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return nullptr;
  pollfd waiting{descriptor, POLLIN, 0};
  char first = 0;
  ssize_t got = -1;
  // Slow writers are waited for: without any the end of the file is read at once.
  if (::poll(&waiting, 1, kPatienceMs) == 0 && (got = ::read(descriptor, &first, 1)) == 0) {
    ::close(descriptor);
    throw InputError(path.string(), 0, "is a pipe into which nobody writes, expected a file");
  }
  ::fcntl(descriptor, F_SETFL, ::fcntl(descriptor, F_GETFL) & ~O_NONBLOCK);
  std::FILE* const out = ::fdopen(descriptor, "rb");
  if (out != nullptr && got == 1) std::ungetc(static_cast<unsigned char>(first), out);
  return out;
}

/// Whether somebody reads from it: to open it would wait for that.
bool has_reader(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor >= 0) ::close(descriptor);
  return descriptor >= 0 || errno != ENXIO;
}

fs::path& last_read() {
  static fs::path path;
  return path;
}

void write_to(const fs::path& path, const std::string& content, std::string& why) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  if (out) out.write(content.data(), static_cast<std::streamsize>(content.size()));
  const bool opened = out.is_open();
  out.close();
  if (!out || !opened) why = std::strerror(errno);
}

}  // namespace

void ask_before_writing(std::function<void(const fs::path&)> ask) {
  asked_before_writing() = std::move(ask);
}

void protect_inputs() {
  inputs_protected = true;
}

void remember_input(const fs::path& path) {
  if (inputs_protected) inputs().push_back(path);
}

std::string read_file(const fs::path& path) {
  std::error_code ec;
  if (fs::is_directory(path, ec)) throw InputError(path.string(), 0, "is a folder, expected a file");
  const auto fail = [&](const char* what) {
    throw InputError(path.string(), 0, std::string(what) + ": " + std::strerror(errno));
  };
  {
    static std::mutex mutex;  // what several ngspice runs wrote is read at once
    const std::lock_guard<std::mutex> lock(mutex);
    last_read() = path;
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> in(open_to_read(path), &std::fclose);
  if (in == nullptr) fail("cannot be read");
  std::string text;
  if (const auto size = fs::file_size(path, ec); !ec && size <= kLargestFile) text.reserve(size);
  std::vector<char> buffer(1 << 16);
  while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), in.get())) {
    text.append(buffer.data(), got);
    if (text.size() > kLargestFile) throw InputError(path.string(), 0, "is larger than 2 GiB, expected less");
  }
  if (std::ferror(in.get()) != 0) fail("cannot be read to its end");
  return text;
}

const fs::path& last_file_read() {
  return last_read();
}

void claim_folder(const fs::path& folder) {
  static std::map<fs::path, int> claimed;  // open to the end of the process
  std::error_code ec;
  fs::create_directories(folder, ec);
  const fs::path name = fs::weakly_canonical(folder, ec);
  if (ec || claimed.count(name) > 0) return;
  const int descriptor = ::open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;  // what is written there says why not
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(descriptor);
    throw InputError(folder.string(), 0, "is being written by another run, expected another folder");
  }
  claimed[name] = descriptor;
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

const std::string* OutputSet::content(const fs::path& relative) const {
  const auto found = std::ranges::find(files_, relative, &File::path);
  return found == files_.end() ? nullptr : &found->content;
}

void OutputSet::commit() {
  struct Staged {
    fs::path temporary;  ///< empty: written to the target itself
    fs::path target;
    const std::string* content;
  };
  std::vector<Staged> staged;
  const auto drop_all = [&staged] {
    std::error_code ignored;
    for (const Staged& s : staged) {
      if (s.temporary.empty()) continue;
      fs::remove(s.temporary, ignored);
      forget_temporary(s.temporary);
    }
  };
  if (const auto& ask = asked_before_writing()) {
    for (const File& file : files_) ask(folder_ / file.path);
  }
  if (inputs_protected && !folder_.empty()) claim_folder(folder_);
  const std::string suffix = ".tmp" + std::to_string(::getpid());
  std::set<fs::path> seen;
  for (const File& file : files_) {
    const fs::path named = folder_ / file.path;
    const auto fail = [&](const std::string& why) {
      drop_all();
      throw InputError(named.string(), 0, "cannot be written: " + why);
    };
    if (!folder_.empty() && !stays_below(file.path)) fail("it is not in the folder of the outputs");
    std::error_code ec;
    if (named.has_parent_path()) {
      fs::create_directories(named.parent_path(), ec);
      if (ec) fail(ec.message());
    }
    const fs::path target = followed(named);
    if (fs::is_directory(target, ec)) fail("it is a folder");
    if (is_pipe(target) && !has_reader(target)) fail("nobody reads from this pipe");
    if (is_special(target)) {
      staged.push_back({{}, target, &file.content});
      continue;
    }
    if (!seen.insert(target.lexically_normal()).second) fail("two outputs have this name");
    if (was_read(target)) fail("it is an input, expected another name");
    drop_stale(target);
    const fs::path temporary = target.parent_path() / ("." + target.filename().string() + suffix);
    staged.push_back({temporary, target, &file.content});
    std::string why;
    {
      const EndingHeld until_written;
      remember_temporary(temporary);
      write_to(temporary, file.content, why);
    }
    if (!why.empty()) fail(why);
  }
  // What can still fail, first.
  std::stable_partition(staged.begin(), staged.end(), [](const Staged& s) { return s.temporary.empty(); });
  for (const Staged& s : staged) {
    std::error_code ec;
    std::string why;
    if (s.temporary.empty()) {
      write_to(s.target, *s.content, why);
    } else {
      fs::rename(s.temporary, s.target, ec);
      if (ec) why = ec.message();
    }
    if (!why.empty()) {
      drop_all();
      throw InputError(s.target.string(), 0, "cannot be written: " + why);
    }
    if (!s.temporary.empty()) forget_temporary(s.temporary);
  }
}

void write_file(const fs::path& path, std::string content) {
  OutputSet set;
  set.add(path, std::move(content));
  set.commit();
}

}  // namespace bodesmith
