#include "tuning/controller_kind.hpp"

namespace bodesmith::tuning {

const ControllerKind& pid_kind();
const ControllerKind& fractional_pid_kind();
const ControllerKind& notch_lead_kind();

const std::vector<const ControllerKind*>& controller_kinds() {
  static const std::vector<const ControllerKind*> all = {&pid_kind(), &fractional_pid_kind(),
                                                         &notch_lead_kind()};
  return all;
}

}  // namespace bodesmith::tuning
