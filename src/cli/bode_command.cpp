#include "cli/commands.hpp"
namespace bodesmith::cli {
int run_bode(const std::vector<std::string>&) { return kDone; }
}  // namespace bodesmith::cli
