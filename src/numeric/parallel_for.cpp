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

thread_local int allowance = 1;

}  // namespace

int allowed_threads() {
  return allowance;
}

ThreadAllowance::ThreadAllowance(int threads) : before_(allowance) {
  allowance = threads;
}
ThreadAllowance::~ThreadAllowance() {
  allowance = before_;
}

void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex guard;
  const auto loop = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (...) {
        const std::lock_guard lock(guard);
        if (!failure) failure = std::current_exception();
        next = count;
      }
    }
  };
  std::vector<std::thread> helpers;
  const std::size_t team = std::min(count, static_cast<std::size_t>(std::max(threads, 1)));
  try {
    for (std::size_t t = 1; t < team; ++t) helpers.emplace_back(loop);
  } catch (const std::system_error&) {
    // No more threads are to be had: those that there are do the work.
  }
  {
    const ThreadAllowance busy(helpers.empty() ? allowance : 1);
    loop();
  }
  for (auto& h : helpers) h.join();
  if (failure) std::rethrow_exception(failure);
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
