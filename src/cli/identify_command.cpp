#include "base/error.hpp"
#include "cli/commands.hpp"

namespace bodesmith::cli {

int run_identify(const std::vector<std::string>&) { throw InputError("identify is not built yet"); }

}  // namespace bodesmith::cli
