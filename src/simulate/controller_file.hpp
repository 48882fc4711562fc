#pragma once

#include <filesystem>
#include <optional>

#include "base/provenance.hpp"
#include "chain/chain.hpp"
#include "lti/sections.hpp"
#include "signal/time_record.hpp"
#include "simulate/feedback.hpp"

namespace bodesmith::simulate {

/// What stands round a plant: a controller and, if wanted, a feed-forward path (disturbance paper's hybrid
/// controllers: the inverse model in front, feedback for what it leaves).
struct LoopSetup {
  PidController controller;
  std::optional<Sections> filter;  ///< in series behind it: notches, leads, what makes a PI a fractional PID
  std::optional<chain::Chain> feedforward;  ///< u gets F{r}
  std::optional<TimeRecord> drive;          ///< or a drive worked out before (compensate), column u
  std::filesystem::path inverse;  ///< or an inverse.toml, whose reader sets `drive` for each reference
};

/// controller.toml:
///   schema = "bodesmith.controller/1"
///   type = "pid"                  # or "pi"
///   kp = 0.5
///   ki_per_s = 150.0
///   kd_s = 1e-4                   # pid only
///   derivative_corner_hz = 1e3    # pid only, default 10 kHz
///   sample_s = 1e-4               # absent: continuous
///   lower = -0.1                  # limits of the control, absent: none
///   upper = 1.1
///   filter = "notch.json"         # sections.json behind the limits; or its keys here
///   feedforward = "inverse.toml"  # the inverse that compensate writes, or a model.toml, or a CSV with time_s,u; relative to this file
/// Gains may have either sign. What `tune` writes besides these keys is passed over. Errors name file and line.
LoopSetup read_controller(const std::filesystem::path& path, Provenance& from);
/// The same from a document at hand; `feedforward` is relative to `folder`.
LoopSetup controller_from_node(const Node& node, const std::filesystem::path& folder, Provenance& from);

/// The loop for one reference. InputError when the drive is not sampled as the reference is.
LoopResult simulate_loop(const chain::Chain& plant, const LoopSetup& setup, const TimeRecord& reference,
                         const Options& options = {});

}  // namespace bodesmith::simulate
