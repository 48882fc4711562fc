#include "numeric/team.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "base/error.hpp"

namespace bodesmith {
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
