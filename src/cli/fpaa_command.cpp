#include "base/error.hpp"
#include "cli/commands.hpp"

namespace bodesmith::cli {

int run_fpaa(const std::vector<std::string>&) { throw InputError("fpaa is not built yet"); }

}  // namespace bodesmith::cli
