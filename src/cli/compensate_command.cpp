#include "base/error.hpp"
#include "cli/commands.hpp"

namespace bodesmith::cli {

int run_compensate(const std::vector<std::string>&) { throw InputError("compensate is not built yet"); }

}  // namespace bodesmith::cli
