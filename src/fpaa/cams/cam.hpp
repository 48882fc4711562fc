#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/registry.hpp"
#include "fpaa/cams/placed_cam.hpp"
#include "fpaa/cams/switches.hpp"

namespace bodesmith::fpaa {

struct FilterStage;

// A CAM goes through two types: what it is (Cam, one object each, in the registry) and what it is made of (PlacedCam:
// capacitors, clock, place). Everything that is particular to one CAM stands in cams/<cam>.cpp; what is said there was "seen" in
// public vendor-generated code, is "derived" from it, or is "assumed": a standard circuit that fits (plans that use it say so).

/// One parameter of a CAM's dialog.
struct CamParameter {
  std::string_view key;    ///< in CamValues, ends in its unit
  std::string_view words;  ///< in AnadigmDesigner2's dialogs and report
  bool frequency = false;  ///< shown in kHz
};

/// What the library knows of one CAM apart from what it computes.
struct CamFacts {
  std::string_view name;                      ///< as AnadigmDesigner2 writes it
  std::vector<CamParameter> parameters = {};  ///< those with words of their own
  std::optional<Resources> resources = {};    ///< of the plainest option; absent: not publicly known
  double delay_cycles = 0.0;                  ///< of its latest input
  bool half_cycle_output = false;  ///< valid only during one phase: needs a Hold before a bypass output
  bool takes_half_cycle_anywhere = false;  ///< may read a half-cycle output of another chip or clock
  int clock_b_ratio = 0;                   ///< ClockB = ratio * ClockA; 0: no ClockB
};

/// How the Zrna client places a CAM.
struct ZrnaModule {
  std::string class_name;  ///< "FilterPoleZero"
  std::string arguments;   ///< of its constructor
  struct Attribute {
    std::string_view key;   ///< of the realised value; a frequency is given in kHz
    std::string_view name;  ///< "pole_frequency"
  };
  std::vector<Attribute> attributes;  ///< in the order in which they are set
};

/// A CAM whose insides are not switched capacitors alone (a converter, a comparator) at work: the output, in volts, that an edge of its
/// clock makes of the inputs (input 1 first), before any delay. All it remembers starts at 0. Logic is 0 or 1.
using CamStep = std::function<double(std::span<const double> inputs)>;

/// One CAM of the library. The defaults are those of a CAM that plans do not use.
class Cam {
 public:
  explicit Cam(CamFacts facts) : facts_(std::move(facts)) {}
  virtual ~Cam() = default;
  Cam(const Cam&) = delete;
  Cam& operator=(const Cam&) = delete;

  std::string_view name() const { return facts_.name; }
  const CamFacts& facts() const { return facts_; }
  /// Null for a key whose words are not known.
  const CamParameter* parameter(std::string_view key) const;
  /// With so many inputs; nothing where it is not publicly known.
  virtual std::optional<Resources> resources(std::size_t) const { return facts_.resources; }

  // In a plan.
  /// What is not publicly known and is assumed when a plan uses it; empty: nothing.
  virtual std::string assumption() const { return {}; }

  /// Makes `out` (whose clock is there) this CAM with the stage's capacitors; false where it makes other stages.
  virtual bool place(const FilterStage&, PlacedCam&) const { return false; }

  // A placed CAM. Only CAMs that are used in plans are asked.
  /// H of these capacitors; `cam` says option, form and how many inputs. (`cam.z` as it stands, whatever the capacitors, where it is not
  /// known which of them makes what.)
  virtual ZTransfer transfer(const PlacedCam& cam, const CapacitorUnits&) const { return cam.z; }
  /// A CAM of other parts than switched capacitors at work; empty for the others, which are their switches.
  virtual CamStep step(const PlacedCam&) const { return {}; }
  /// The capacitors as the vendor's component table of this CAM lists them.
  virtual std::vector<Capacitor> vendor_capacitors(const PlacedCam& cam, std::span<const std::string>) const {
    return cam.capacitors;
  }
  /// Its switched-capacitor circuit with these capacitors, for responses, primary streams and ngspice; nothing where that is not
  /// publicly known, or is not made of switched capacitors alone.
  virtual std::optional<StageSwitches> switches(const PlacedCam&, const CapacitorUnits&) const {
    return std::nullopt;
  }
  /// The same with the capacitors that the plan says.
  std::optional<StageSwitches> switches(const PlacedCam& cam) const {
    return switches(cam, CapacitorUnits(cam.capacitors));
  }
  /// Nothing when the Zrna client has no such module.
  virtual std::optional<ZrnaModule> zrna_module(const PlacedCam&) const { return std::nullopt; }
  /// One line for the board's picture.
  virtual std::string picture_text(const PlacedCam&) const { return {}; }
  /// Whether AnadigmDesigner2 can place this CAM with these capacitors; otherwise it is made by stream only.
  virtual bool in_vendor_menu(const PlacedCam&) const { return true; }
  /// Drawn and counted as a gain stage, not as a filter.
  virtual bool is_gain() const { return false; }

 private:
  CamFacts facts_;
};

/// Every CAM, in the order of AnadigmDesigner2's menu (cams/registry.cpp).
Registry<Cam>& cam_registry();
// Those that others place by name.
const Cam& comparator_cam();
const Cam& gain_hold_cam();
const Cam& gain_switch_cam();
const Cam& hold_cam();
const Cam& multiplier_cam();
const Cam& sum_diff_cam();
const Cam& transfer_function_cam();

}  // namespace bodesmith::fpaa
