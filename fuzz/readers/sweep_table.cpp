#include "reader.hpp"
#include "simulate/sweep.hpp"

namespace bodesmith::fuzz {
namespace {

/// What `simulate … --resume` takes up.
void read_sweep_bytes(std::string_view bytes) {
  for (const auto& row : simulate::read_sweep_csv(as_file(bytes, "sweep.csv"), "key"))
    require_finite(row.rms_percent);
}
const Registered sweep_reader{"sweep_table", read_sweep_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
