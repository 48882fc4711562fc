#include "fpaa/cams/cam.hpp"

// One line a CAM, in the order of AnadigmDesigner2's menu. Planning asks them in this order.
namespace bodesmith::fpaa {

BODESMITH_REGISTRY(Cam, cam_registry, "CAM", filter_bilinear_cam, filter_biquad_cam, gain_inv_cam,
                   gain_half_cam, gain_hold_cam, gain_switch_cam, gain_voltage_controlled_cam, sum_diff_cam,
                   sum_inv_cam, sum_filter_cam, integrator_cam, hold_cam, multiplier_cam,
                   transfer_function_cam, comparator_cam, biquad_stage_cam)

}  // namespace bodesmith::fpaa
