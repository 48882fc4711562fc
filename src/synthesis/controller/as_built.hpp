#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "schematic/netlist.hpp"
#include "synthesis/controller/library.hpp"
#include "tracking/built_controller.hpp"
#include "tracking/reference.hpp"
#include "tracking/stage.hpp"

namespace bodesmith::generator {

/// One repeat of the reference in steady state, sampled uniformly from its phase 0 on.
struct SteadyState {
  tracking::Reference reference;
  Hertz operating;
  double step_s = 0.0;
  std::vector<double> r, v;
  std::vector<double> first_v;  ///< the first repeat, from rest (ngspice only, where a whole one settles)
  std::vector<double> own_s;    ///< the simulator's own instants of the repeat, or others that were asked for
  std::vector<double> own_v;    ///< v at those
  double wall_s = 0.0;          ///< of the simulation

  double period_s() const { return step_s * static_cast<double>(v.size()); }
};

struct NgspiceRun {
  const Deviations* off = nullptr;  ///< none: as realised
  double settle_repeats = 1.0;      ///< before the one that is kept; more while what is slow still settles
  int steps = 2000;                 ///< largest step: this part of an operating period
  std::size_t samples = 2048;       ///< to an operating period
  /// References of this frequency and more take tighter tolerances than SPICE's own, with which the slope detector trips up to a
  /// microsecond early or late on smooth references. Where ngspice finds no step small enough for them, the next is taken.
  Hertz tight_from{0.0};

  /// For a study of many references: from rest to the far end of the reference everything that is quick has settled, and at a
  /// four times finer step the drive differs by less than .001 % of range. What SPICE's own tolerance does at a turn takes a
  /// share of the period that grows with the frequency: .001 % at 400 Hz, .02 at 4 kHz.
  static NgspiceRun of_many() { return {.settle_repeats = 0.5, .steps = 500, .tight_from = Hertz{500.0}}; }
  /// For the one reference that stands for a run: but for full triangles as tight and fine as smooth slopes need, with as many samples
  /// as show for how long the drive is late where it jumps, at turns that are no full stroke's ends.
  static NgspiceRun of_one(const tracking::Reference& reference);
};

/// Whole repeats until what is slow, the smoothing behind the slope meter, has settled.
int repeats_to_settle(const DisturbanceCircuit& controller, double repeat_s);

/// The emitted netlist through plain `.tran` from rest, r starting at 0 V. Throws InputError as
/// ngspice::run_transient.
SteadyState run_in_ngspice(const DisturbanceCircuit& controller, const tracking::Reference& reference,
                           Hertz operating, const NgspiceRun& options = {});

/// Independent sources that make the reference from node `r` to ground, for a deck; from phase `start`, at 0 s, to `end`, in repeats.
std::string reference_sources(const tracking::Reference& reference, Hertz operating, double start,
                              double end);
/// The same of 1 V at node `rising` while it rises, else 0.
std::string rising_source(const tracking::Reference& reference, Hertz operating, double start, double end);

/// What the disturbance paper's stage makes of the drive, reading it, against r: y = v + K_b(f) d_b(v), with amplitude gains
/// y = v + K_b(f) g_b(alpha) d_b(v/alpha), alpha the reference's stroke.
tracking::TrackingError stage_error(const DisturbanceCircuit& controller, const SteadyState& run);

/// The whole netlist in time by CVODE (schematic/analysis/in_time.hpp), alongside what ngspice makes of it: from rest, as many
/// repeats of the reference as the smoothing behind the slope meter needs, at least half of one (a whole one with a peak meter); the
/// one behind them is kept. `at_s`: instants of it, from its begin, at which v is told too (SteadyState::own_v). `samples`: of it.
SteadyState run_in_cvode(const DisturbanceCircuit& controller, const tracking::Reference& reference,
                         Hertz operating, std::size_t samples, const std::vector<double>& at_s = {});

/// From the turn at the end of a repeat to the new contact: slope detector (integrated from its circuit) and
/// switch. DesignError when the slope never reaches the detector's threshold.
double switch_delay_s(const DisturbanceCircuit& controller, const tracking::Reference& reference,
                      Hertz operating);

/// The circuit for a tracking study: its netlist in ngspice, or without it by CVODE.
class CircuitController final : public tracking::BuiltController {
 public:
  explicit CircuitController(std::shared_ptr<const DisturbanceCircuit> controller,
                             std::optional<NgspiceRun> options)
      : controller_(std::move(controller)), options_(options) {}

  std::string key() const override { return options_ ? "controller_circuit" : "controller_cvode"; }
  std::string name() const override;
  int part_count() const override;
  tracking::DriveWaveform drive(const tracking::Reference& reference, Hertz operating) const override;

 private:
  std::shared_ptr<const DisturbanceCircuit> controller_;
  std::optional<NgspiceRun> options_;
};

}  // namespace bodesmith::generator
