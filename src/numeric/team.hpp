#pragma once

#include <cstdint>
#include <memory>
#include <vector>

namespace bodesmith {

/// The processes that share one job: alone, or under `mpirun -n N`.
class Team {
 public:
  virtual ~Team() = default;
  virtual int rank() const { return 0; }
  virtual int size() const { return 1; }
  bool leads() const { return rank() == 0; }
  /// Sums, minima and maxima of all processes; the result is the leader's only.
  virtual void sum(std::vector<std::uint64_t>&) const {}
  virtual void min(std::vector<double>&) const {}
  virtual void max(std::vector<double>&) const {}
  /// The leader's value, for everyone.
  virtual std::uint64_t from_leader(std::uint64_t value) const { return value; }
};

/// Joins the MPI job when the program was started by mpirun and MPI support was built (a module beside the
/// program, loaded only then: a program started alone pays nothing for it); otherwise a team of one. Throws
/// InputError when started by mpirun without MPI support. Leaves the job when destroyed.
std::unique_ptr<Team> join_team();

}  // namespace bodesmith
