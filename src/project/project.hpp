#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "approximate/approximate.hpp"
#include "base/documents/document.hpp"
#include "base/progress.hpp"
#include "base/provenance.hpp"
#include "base/units.hpp"
#include "fit/direct/direct_fit.hpp"
#include "fpaa/plan/plan.hpp"
#include "lti/fractional_transfer.hpp"
#include "lti/sections.hpp"
#include "signal/bode_points.hpp"
#include "signal/disturbance.hpp"
#include "synthesis/generator/part_errors.hpp"
#include "tolerance/yield.hpp"
#include "tracking/reference.hpp"

namespace bodesmith::project {

/// The specification in project.toml (schema bodesmith.project/1): a response to build, or with a disturbance the controller
/// of a stage, which is tracked. Paths in it are relative to its folder.
struct Project {
  std::string name;

  /// One of points, sections, fractional; of a stage points, and its disturbance.
  struct Target {
    std::string file;  ///< which says it, as the project names it
    BodePoints points;
    std::optional<Sections> sections;
    std::optional<FractionalTransfer> fractional;
    Band band;   ///< in which it is judged: the points', the sections' own, or as the project says
    Hertz base;  ///< gain 1 here, of points
    Disturbance disturbance;
    Disturbance::Branch branch = Disturbance::Branch::descending;

    bool has_points() const { return !points.points.empty(); }
  } target;

  /// What points or a fractional transfer become. A stage's become a cascade by the chart of the disturbance paper.
  struct Fit {
    enum class Method { automatic, interpolate, bounded, direct } method = Method::automatic;
    std::optional<double> max_error_db;
    std::optional<int> order;
    double beta_max = 5.0;  ///< of a bounded fit
    bool beta_positive = false;
    DirectFitOptions direct;  ///< of a direct fit: real, relative_degree, max_corner
  } fit;

  ApproximationOptions approximate;

  /// Which of a stage's alternatives is built ([choose] by), see alternatives.hpp.
  enum class Choice { tracking, as_asked, fewest_sections, waveform } choice = Choice::tracking;

  std::optional<bodesmith::fpaa::PlanOptions> fpaa;  ///< board and clock; absent: no board is designed

  struct Circuit {
    std::string realisation = "opamp-rc";
    std::string resistors = "E96";
    std::string capacitors = "E12";
  };
  std::optional<Circuit> circuit;  ///< absent: no op-amp circuit is designed
  tolerance::Spread spread;        ///< of its parts, where there is no stage; otherwise `controller.errors`

  /// The whole analog controller of a stage, which goes with [hardware.circuit].
  struct Controller {
    std::optional<std::string> form;  ///< "self-fed", "two-pass", "seed"; absent: see controllers.hpp
    generator::PartErrors errors;     ///< how far its parts are off
    bool allow_unstable = false;      ///< goes on with a phase margin below 30 degrees
  } controller;

  /// What its resistors and capacitors are bought for: what is drawn, ordered, and written into decks.
  const schematic::Tolerances& tolerances() const {
    if (plant) return controller.errors;
    return spread;
  }

  /// The stage of "Modeling and Control of Piezoelectric Hysteresis: A Polynomial-Based Fractional Order
  /// Disturbance Compensation Approach", Fig. 1(b): amplifier pole, damping compensator (eq. 20), resonance.
  struct Plant {
    double stroke_m = 0.0;
    std::optional<Hertz> amplifier_corner;
    std::optional<Hertz> resonance;
    double damping_ratio = 0.0;
    std::optional<Section> damping_compensator;
    /// What the amplifier can put out, in full strokes.
    std::optional<std::array<double, 2>> drive_range;
  };
  std::optional<Plant> plant;  ///< absent: a response to build, nothing to track

  /// The references that the stage must follow. The design is chosen and stated for the first waveform at the
  /// largest amplitude; the others are followed alongside it.
  struct Track {
    std::vector<tracking::Reference::Shape> waveforms = {tracking::Reference::Shape::triangle};
    std::vector<double> amplitudes = {1.0};  ///< of the full stroke
    std::vector<Hertz> frequency;
    std::vector<double>
        measured_percent;  ///< rms errors that somebody measured, one a frequency; may be empty

    tracking::Reference::Shape waveform() const { return waveforms.front(); }
    double amplitude() const { return *std::ranges::max_element(amplitudes); }
  } track;

  struct Limits {
    std::optional<double> fit_db;
    std::optional<double> points_db;
    std::optional<double> approximation_db;
    std::optional<double> fpaa_percent;
    std::optional<double> circuit_db;         ///< parts and op-amps together
    std::optional<double> tracking_percent;   ///< as built, worst rms of all frequencies, delay removed
    std::optional<double> agreement_percent;  ///< of all engines on one built thing (EngineRow)
    std::optional<double> yield_db;           ///< 95 of 100 circuits within it, where there is no stage
  } limits;

  /// Not in the file: a time after which what the design does not need is left out, and said.
  Deadline deadline;
};

/// A project file as it was read, before anything is made of it: a sweep changes it in between.
struct ProjectSource {
  std::filesystem::path file;
  Node document;
  Provenance from;
  Deadline deadline{};  ///< of the run, see Project::deadline

  /// Throws InputError (file and line) for what is no project.
  static ProjectSource read(const std::filesystem::path& file);

  /// What the document says, and the files that it names; every InputError has file and line.
  Project project(Provenance& from) const;
};

/// The words of the project file.
std::string_view to_string(Project::Choice choice);
std::string_view to_string(Project::Fit::Method method);

}  // namespace bodesmith::project
