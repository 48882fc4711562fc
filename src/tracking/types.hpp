#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/units.hpp"
#include "lti/sections.hpp"
#include "signal/disturbance.hpp"
#include "tracking/compensator.hpp"
#include "tracking/reference.hpp"
#include "tracking/stage.hpp"

namespace bodesmith::tracking {

// How well a disturbance compensator (disturbance paper, Fig. 2) lets a stage follow a reference, in steady state.
//
//   x(t)                              reference, 0 ... alpha of the stroke, at the operating frequency f
//   v_0 = x,  v_k = x - C{d(v_k-1)}   the generator, one pass (the paper), two or more; or fed by its own drive:
//   v = x - C{d(v)}
//   C{d(h)}: w_a = d_a(h) while x rises, else 0;  w_d = d_d(h) while x falls, else 0;  C_a{w_a} + C_d{w_d}
//   u(t)   = D{v}                     drive path: the amplifier, ...
//   q(t)   = u + k_b(f) d_b(u)        the stage reads its drive; b the branch by the slope of u
//   y(t)   = stroke P{q}              damping compensator, resonance
//   e_rms% = 100 rms(y - stroke x) / (max y - min y)                                            (eq. 8)
//
// The amplitude gains of the table at alpha multiply both the generator's and the stage's disturbance.

/// How often the disturbance is worked out before it is subtracted. The stage adds d of its drive, so subtracting d
/// of the reference leaves something; each pass more leaves about max |d'| of that, the loop nothing.
struct GeneratorForm {
  int passes = 1;  ///< 0: self-fed

  static constexpr GeneratorForm one_pass() { return {1}; }    ///< v = x - d(x), the disturbance paper
  static constexpr GeneratorForm two_passes() { return {2}; }  ///< v = x - d(x - d(x))
  static constexpr GeneratorForm self_fed() { return {0}; }    ///< v = x - d(v), a loop round the generator
  bool is_self_fed() const { return passes == 0; }
};
/// One row of the comparison.
struct Design {
  std::string name;  ///< "constant polynomial", "E96 circuit", ...
  Compensator ascending;
  Compensator descending;
  /// Name of the design it was made from; the report then states how much was lost on the way. Empty: none.
  std::string made_from;
  GeneratorForm form = {};
};

struct Plant {
  Disturbance disturbance;
  double stroke = 1.0;  ///< displacement at x = 1 (the unit is the caller's)
  Sections drive_path;  ///< D: default the identity
  Sections stage_path;  ///< P: default the identity
  /// The generator's polynomials; absent: the plant's own, as if identified without error.
  std::optional<Disturbance> generator;
  /// A stage of another family, paths included, which answers the drive instead of the polynomials above.
  std::shared_ptr<const Stage> stage;

  const Disturbance& generated() const { return generator ? *generator : disturbance; }
  StagePaths paths() const { return {drive_path, stage_path}; }
};

struct Options {
  /// Where the compensators stand. Behind the switch: each filters its own branch's waveform, which is 0
  /// while the other branch is on (w_a, w_d above); the same filter on both branches is one filter behind the
  /// branch switch. Before the switch: each filters its branch's polynomial of x all the time, and the switch
  /// picks one of the two outputs:
  ///   c(t) = C_a{d_a(x)} while x rises, C_d{d_d(x)} while x falls.
  enum class Place { behind_switch, before_switch };
  /// What the stage's own disturbance is a function of. A real stage reads its drive, and its branch turns with
  /// the slope of the drive. Evaluated on the reference instead, as the disturbance paper's formulas have it,
  /// v = x - d(x) seems to leave nothing: that is for comparison with formulas, no stage shows it.
  enum class Argument { reference, drive };

  std::vector<Hertz> frequencies;
  Reference::Shape reference = Reference::Shape::triangle;
  Place place = Place::behind_switch;
  Argument argument = Argument::drive;
  double alpha = 1.0;                ///< amplitude of x
  bool also_on_reference = false;    ///< fill in Case::on_reference_percent
  bool time_domain = true;           ///< integrate a period in CVODE and check
  double relative_tolerance = 1e-7;  ///< CVODE
  std::size_t harmonics = 4096;      ///< of the periodic computation; a power of two
  std::size_t keep_samples = 400;    ///< samples a period of the waveforms kept in the report
};

/// One design at one frequency: eq. 8 over all that was simulated, its lag by the last repeat.
struct Case : TrackingError {
  Hertz frequency;
  std::string design;
  /// What rms_percent would be if the stage read the reference; by the harmonic computation.
  std::optional<double> on_reference_percent;
  double lost_rms_percent = 0.0;  ///< rms of c against the design it was made from, percent of stroke
  /// The same by the harmonic computation (compensators harmonic by harmonic, the rest sample by sample; clocked designs without
  /// images), where the figures above are of one period that CVODE integrated.
  struct Check {
    double rms_percent = 0.0;
    double difference_percent = 0.0;  ///< rms between both displacements, percent of range
  };
  std::optional<Check> check;
  // One repeat of the reference in steady state, keep_samples of each.
  std::vector<double> time_s;
  std::vector<double> reference;     ///< stroke x
  std::vector<double> displacement;  ///< y
};

struct Report {
  std::vector<Case> cases;  ///< designs within frequencies, in the order given

  /// Null when there is none.
  const Case* find(Hertz frequency, const std::string& design) const;
};

}  // namespace bodesmith::tracking
