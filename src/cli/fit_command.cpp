#include "base/error.hpp"
#include "cli/commands.hpp"

namespace bodesmith::cli {

int run_fit(const std::vector<std::string>&) { throw InputError("fit is not built yet"); }

}  // namespace bodesmith::cli
