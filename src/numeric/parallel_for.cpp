#include "numeric/parallel_for.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <mutex>
#include <system_error>
#include <thread>

#include "base/error.hpp"

namespace bodesmith {
namespace {

/// Of the innermost work around that shares its threads.
thread_local FreeThreads* shared = nullptr;

bool take(FreeThreads& threads) {
  int free = threads.free;
  while (free > 0) {
    if (threads.free.compare_exchange_weak(free, free - 1)) return true;
  }
  return false;
}

/// One loop's work and who is at it.
class Loop {
 public:
  Loop(std::size_t count, int threads, FreeThreads& from, const std::function<void(std::size_t)>& work)
      : count_(count),
        most_helpers_(std::min(count, static_cast<std::size_t>(std::max(threads, 1))) - 1),
        from_(from),
        work_(work) {}

  void run() {
    work_on();
    ++from_.free;  // while it waits
    for (std::thread helper = next_helper(); helper.joinable(); helper = next_helper()) helper.join();
    --from_.free;
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void work_on() {
    for (std::size_t i = next_++; i < count_; i = next_++) {
      if (i + 1 < count_) call_helpers();
      try {
        work_(i);
      } catch (...) {
        const std::lock_guard lock(guard_);
        if (!failure_) failure_ = std::current_exception();
        next_ = count_;
      }
    }
  }

  void call_helpers() {
    if (from_.free <= 0) return;
    const std::lock_guard lock(guard_);
    while (helpers_.size() < most_helpers_ && take(from_)) {
      try {
        helpers_.emplace_back([this] {
          shared = &from_;
          work_on();
          ++from_.free;
        });
      } catch (const std::system_error&) {
        // No more threads are to be had: those that there are do the work.
        ++from_.free;
        return;
      }
    }
  }

  /// One that was called and is not waited for yet; those at work may still call others.
  std::thread next_helper() {
    const std::lock_guard lock(guard_);
    return awaited_ < helpers_.size() ? std::move(helpers_[awaited_++]) : std::thread();
  }

  const std::size_t count_, most_helpers_;
  FreeThreads& from_;
  const std::function<void(std::size_t)>& work_;
  std::atomic<std::size_t> next_{0};
  std::mutex guard_;
  std::vector<std::thread> helpers_;
  std::size_t awaited_ = 0;
  std::exception_ptr failure_;
};

}  // namespace

int allowed_threads() {
  return shared != nullptr ? shared->all : 1;
}

ThreadAllowance::ThreadAllowance(int threads) : threads_(threads), before_(shared) {
  shared = &threads_;
}
ThreadAllowance::~ThreadAllowance() {
  shared = before_;
}

void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& work) {
  if (count == 0) return;
  if (shared != nullptr) {
    Loop(count, threads, *shared, work).run();
  } else {
    const ThreadAllowance allowance(threads);
    Loop(count, threads, *shared, work).run();
  }
}

int thread_count(int wanted) {
  return wanted > 0 ? wanted : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

namespace {

bool started_by_mpirun() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"}) {
    if (std::getenv(name) != nullptr) return true;
  }
  return false;
}

/// What the module (src/mpi/module.cpp) exports.
class MpiTeam final : public Team {
 public:
  explicit MpiTeam(void* library) : library_(library) {
    get(init_, "bodesmith_mpi_init");
    get(finish_, "bodesmith_mpi_finish");
    get(sum_, "bodesmith_mpi_sum");
    get(min_, "bodesmith_mpi_min");
    get(max_, "bodesmith_mpi_max");
    get(broadcast_, "bodesmith_mpi_broadcast");
    init_(&rank_, &size_);
  }
  ~MpiTeam() override { finish_(); }
  MpiTeam(const MpiTeam&) = delete;
  MpiTeam& operator=(const MpiTeam&) = delete;

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  void sum(std::vector<std::uint64_t>& values) const override { sum_(values.data(), values.size()); }
  void min(std::vector<double>& values) const override { min_(values.data(), values.size()); }
  void max(std::vector<double>& values) const override { max_(values.data(), values.size()); }
  std::uint64_t from_leader(std::uint64_t value) const override {
    broadcast_(&value);
    return value;
  }

 private:
  template <class F>
  void get(F*& function, const char* name) {
    function = reinterpret_cast<F*>(::dlsym(library_, name));
    if (function == nullptr)
      throw InputError(fmt::format("the MPI module lacks {}, expected one of this version", name));
  }

  void* library_;
  int rank_ = 0;
  int size_ = 1;
  void (*init_)(int*, int*) = nullptr;
  void (*finish_)() = nullptr;
  void (*sum_)(std::uint64_t*, std::size_t) = nullptr;
  void (*min_)(double*, std::size_t) = nullptr;
  void (*max_)(double*, std::size_t) = nullptr;
  void (*broadcast_)(std::uint64_t*) = nullptr;
};

}  // namespace

std::unique_ptr<Team> join_team() {
  if (!started_by_mpirun()) return std::make_unique<Team>();
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path here = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const fs::path& folder : {here, here.parent_path() / "lib" / "bodesmith"}) {
    const fs::path file = folder / "bodesmith_mpi.so";
    if (!fs::exists(file, ignored)) continue;
    if (void* library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_GLOBAL))
      return std::make_unique<MpiTeam>(library);
    throw InputError(fmt::format("{}: {}", file.string(), ::dlerror()));
  }
  throw InputError(
      "started by mpirun, but built without MPI; expected an MPI library when bodesmith was configured");
}

}  // namespace bodesmith
