#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fpaa/cams/cam.hpp"
#include "fpaa/device/board.hpp"
#include "fpaa/network/clocked_network.hpp"
#include "fpaa/plan/plan.hpp"

namespace bodesmith::fpaa {

/// CAMs in the time domain: every clock, phase and half cycle, loops, converters and look-up tables, any waveform.
///
/// A CAM whose switches are known is its network (clocked_network.hpp): between switching instants
///   V(t) = C q + D u(t),
/// and at each of them q becomes M q + N u just before it; what it reads is a voltage that may move. Any other CAM
/// (a converter, a comparator) is its CamStep: it reads at the end of its phase, shows the result `delay_cycles` later
/// and until the next one. Results that are due at an instant are there for converters that read then. Time is counted in half periods of the master clock; phase 1 of
/// every clock begins at 0. Analogue outputs clip at full scale.
class BoardRun {
 public:
  /// Something off the board that needs no clock.
  struct Part {
    std::string name;
    std::vector<std::string> inputs;
    std::function<double(double time_s, std::span<const double> inputs)> value;
  };

  /// Throws DesignError: an input that is nothing's name, a delay below 0, a loop without delay.
  BoardRun(const std::vector<WiredCam>& cams, std::vector<Part> parts, const Board& board);

  /// Everything up to and including this time.
  void advance_to(double time_s);
  /// On towards this time by whole periods that all clocks have in common, during which nothing is read or switched: for
  /// inputs that have hardly moved where it has been settled.
  void skip_towards(double time_s);
  /// What stands at a CAM's output, or a part's, now.
  double value(const std::string& name);
  /// CAMs whose output was beyond full scale since the last forget_clipping().
  std::vector<std::string> clipped() const;
  void forget_clipping();

 private:
  /// Ticks that come back.
  struct Edge {
    static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
    std::int64_t next = kNever, every = 0;
  };
  struct Node {
    std::string name;
    std::vector<std::size_t> sources;  ///< a cell, or cells + a part
    std::vector<double> read;          ///< of each input, at its last reading
    Edge edge;  ///< of a network both of its clock, of a step the one at which it reads
    bool clipped = false;
    // A network of one clock.
    std::optional<ClockedNetwork> network;
    std::size_t interval = 0;
    Eigen::VectorXd charges, next_charges;
    std::int64_t known_at = -1;  ///< reading at which `known` was worked out
    double known = 0.0;
    // Or a step.
    CamStep step;
    Edge shown;                  ///< when a result is there that has a delay
    std::deque<double> pending;  ///< made, not there yet: oldest first
    double visible = 0.0;
  };

  std::size_t source_of(const std::string& name, const std::string& reader) const;
  double voltage(std::size_t source, int depth = 0);
  double network_voltage(Node& node, int depth);
  double limited(Node& node, double volts) const;
  void switch_over(Node& node);
  void take_step(Node& node);
  void run_instant(std::int64_t tick);

  std::vector<Node> nodes_;
  std::vector<Part> parts_;
  struct KnownPart {
    std::int64_t at = -1;  ///< reading at which `volts` was worked out
    double volts = 0.0;
  };
  std::vector<KnownPart> known_parts_;
  std::vector<std::vector<std::size_t>> part_sources_;
  double ticks_per_second_;
  std::int64_t now_ = -1, next_ = 0;  ///< and when something happens next
  std::int64_t readings_ = 0;
};

}  // namespace bodesmith::fpaa
