#include "fpaa/cams/integrator.hpp"

#include "fpaa/cams/cam_type.hpp"

namespace bodesmith::fpaa {

const CamType& integrator_type() {
  static const CamType type = [] {
    CamType t;
    t.name = "Integrator";
    t.options = {"Inverting", "Non-inverting"};
    t.parameters = {"integration_constant_per_s"};
    t.resources = Resources{.opamps = 1, .capacitors = 2, .comparators = 0, .sars = 0, .lookup_tables = 0};
    t.transfer =
        "inverting -(Cin/Cint)/(1 - 1/z), non-inverting (Cin/Cint) z^-1/(1 - 1/z); constant fc Cin/Cint";
    t.transfer_ground = Ground::derived;
    t.limits = "constant fc/255 to 255 fc";
    return t;
  }();
  return type;
}

}  // namespace bodesmith::fpaa
