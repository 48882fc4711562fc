#include "numeric/termination.hpp"

namespace bodesmith {

std::string_view to_string(Termination termination) {
  switch (termination) {
    case Termination::gradient:
      return "gradient";
    case Termination::step:
      return "step";
    case Termination::cost:
      return "cost";
    case Termination::max_iterations:
      return "max_iterations";
    case Termination::stopped:
      return "stopped";
    case Termination::not_runnable:
      return "not_runnable";
  }
  return "";
}

}  // namespace bodesmith
