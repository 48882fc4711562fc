#pragma once

#include "fpaa/cams/placed_cam.hpp"
#include "fpaa/device/board.hpp"
#include "fpaa/search/design.hpp"

namespace bodesmith::fpaa {

/// The CAM that a stage of whole capacitors is: a low pass, high pass or pole and zero (FilterBilinear), a sum
/// (SumInv), a biquad (FilterBiquad with one input, BiquadStage with several). Without its place.
PlacedCam cam_of_stage(const DesignStage& stage, const Board& board);
Resources resources_of_stage(const DesignStage& stage);

}  // namespace bodesmith::fpaa
