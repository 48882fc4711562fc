// The MPI side of numeric/parallel_for.cpp, a module of its own: loaded only when the program was started by mpirun.
#include <mpi.h>

#include <cstddef>
#include <cstdint>

namespace {

int rank = 0;

void reduce(void* values, std::size_t count, MPI_Datatype type, MPI_Op operation) {
  // MPI counts are int: in pieces.
  constexpr std::size_t kPiece = std::size_t{1} << 24;
  for (std::size_t done = 0; done < count; done += kPiece) {
    const int piece = static_cast<int>(count - done < kPiece ? count - done : kPiece);
    void* const at = static_cast<char*>(values) + done * 8;
    if (rank == 0) {
      MPI_Reduce(MPI_IN_PLACE, at, piece, type, operation, 0, MPI_COMM_WORLD);
    } else {
      MPI_Reduce(at, nullptr, piece, type, operation, 0, MPI_COMM_WORLD);
    }
  }
}

}  // namespace

extern "C" {

void bodesmith_mpi_init(int* my_rank, int* size) {
  MPI_Init(nullptr, nullptr);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, size);
  *my_rank = rank;
}

void bodesmith_mpi_finish() {
  MPI_Finalize();
}

void bodesmith_mpi_sum(std::uint64_t* values, std::size_t count) {
  reduce(values, count, MPI_UINT64_T, MPI_SUM);
}
void bodesmith_mpi_min(double* values, std::size_t count) {
  reduce(values, count, MPI_DOUBLE, MPI_MIN);
}
void bodesmith_mpi_max(double* values, std::size_t count) {
  reduce(values, count, MPI_DOUBLE, MPI_MAX);
}
void bodesmith_mpi_broadcast(std::uint64_t* value) {
  MPI_Bcast(value, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
}

}  // extern "C"
