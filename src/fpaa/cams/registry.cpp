#include "fpaa/cams/cam.hpp"

// One line a CAM, in the order of AnadigmDesigner2's menu. Planning asks them in this order.
#define BODESMITH_CAMS(ENTRY)        \
  ENTRY(filter_bilinear_cam)         \
  ENTRY(filter_biquad_cam)           \
  ENTRY(gain_inv_cam)                \
  ENTRY(gain_half_cam)               \
  ENTRY(gain_hold_cam)               \
  ENTRY(gain_switch_cam)             \
  ENTRY(gain_voltage_controlled_cam) \
  ENTRY(sum_diff_cam)                \
  ENTRY(sum_inv_cam)                 \
  ENTRY(sum_filter_cam)              \
  ENTRY(integrator_cam)              \
  ENTRY(hold_cam)                    \
  ENTRY(multiplier_cam)              \
  ENTRY(transfer_function_cam)       \
  ENTRY(comparator_cam)              \
  ENTRY(biquad_stage_cam)

namespace bodesmith::fpaa {

#define BODESMITH_DECLARE_CAM(entry) const Cam& entry();
BODESMITH_CAMS(BODESMITH_DECLARE_CAM)
#undef BODESMITH_DECLARE_CAM

#define BODESMITH_LIST_CAM(entry) &entry(),
Registry<Cam>& cam_registry() {
  static Registry<Cam> registry("CAM", {BODESMITH_CAMS(BODESMITH_LIST_CAM)});
  return registry;
}
#undef BODESMITH_LIST_CAM
#undef BODESMITH_CAMS

}  // namespace bodesmith::fpaa
