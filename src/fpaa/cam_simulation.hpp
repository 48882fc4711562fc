#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fpaa/board.hpp"
#include "fpaa/cams/cam_step.hpp"
#include "fpaa/placed_cam.hpp"

namespace bodesmith::fpaa {

/// CAMs of any kind run event by event: every clock, phase, hold and half cycle, converters and look-up
/// tables, loops.
///
/// Time is counted in half periods of the master clock from t = 0. A CAM of phase 1 has its edges at 0, T, 2T
/// …, one of phase 2 half a period later (T: of its ClockA). An edge reads the inputs, except that an input
/// marked late was read half a period before; the output appears `delay_cycles` after the edge and stays
/// until the next one does. At a common instant outputs that were due appear first, then the edges come in
/// the order in which CAMs read one another, then the late inputs are read. (A switched capacitor reads at
/// the end of its phase: everything outside the board is seen half a period later than said here, always the
/// same time.) Analogue outputs clip at the board's full scale.
class CamSimulation {
 public:
  struct Cell {
    PlacedCam cam;
    std::vector<std::string> inputs;  ///< names of cells or of parts outside
    std::vector<bool> late;           ///< inputs read half a cycle before the edge; empty: none
  };
  /// Something beside the board that needs no clock.
  struct Part {
    std::string name;
    std::vector<std::string> inputs;
    std::function<double(double time_s, std::span<const double> inputs)> value;
  };

  /// Throws DesignError: an input that is nothing's name, a delay below 0, a loop without delay.
  CamSimulation(const std::vector<Cell>& cells, std::vector<Part> parts, const Board& board);

  /// Everything up to and including this time.
  void advance_to(double time_s);
  /// What stands at a CAM's output, or a part's, now.
  double value(const std::string& name) const;
  /// CAMs whose output was beyond full scale since the last forget_clipping().
  std::vector<std::string> clipped() const;
  void forget_clipping();

 private:
  struct Node {
    std::string name;
    std::unique_ptr<CamStep> step;
    std::vector<std::size_t> sources;  ///< a cell, or cells + a part
    std::vector<double> read;
    std::vector<std::size_t> late;  ///< indices of inputs
    std::int64_t period = 1, offset = 0, delay = 0;
    std::deque<double> pending;  ///< made, not there yet: oldest first
    double visible = 0.0;
    bool clipped = false;
  };
  /// What happens every `period` ticks.
  struct Beat {
    std::int64_t period = 1;
    std::int64_t next = 0;
    std::vector<std::size_t> appear;  ///< nodes whose output appears
    std::vector<std::size_t> edges;   ///< in order
    std::vector<std::size_t> latch;   ///< nodes whose late inputs are read
  };

  std::size_t source_of(const std::string& name, const std::string& reader) const;
  void add_beats(std::size_t node);
  Beat& beat(std::int64_t period, std::int64_t offset);
  void find_order();
  void add_reads(std::size_t source, std::vector<std::size_t>& cells) const;
  double read(std::size_t source) const;
  void edge(std::size_t node);
  static void appear(Node& node, std::int64_t tick);
  void run_beats(std::int64_t tick);

  std::vector<Node> nodes_;
  std::vector<Part> parts_;
  std::vector<std::vector<std::size_t>> part_sources_;
  std::vector<std::size_t> rank_;  ///< of each node in the order of edges
  std::vector<Beat> beats_;
  double ticks_per_second_;
  double full_scale_v_;
  std::int64_t now_ = 0;
};

}  // namespace bodesmith::fpaa
