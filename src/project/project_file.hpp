#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/provenance.hpp"
#include "base/units.hpp"
#include "lti/sections.hpp"
#include "signal/bode_points.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith::project {

/// What a person wants, from project.toml (schema bodesmith.project/1). Paths in it are relative to its
/// folder.
struct Project {
  std::string name;

  struct Target {
    BodePoints points;
    Disturbance disturbance;
    Disturbance::Branch branch = Disturbance::Branch::descending;
    Hertz base;
  } target;

  struct Fit {
    bool bounded = false;
    double beta_max = 2.0;
    bool beta_positive = false;
  } fit;

  struct Approximate {
    std::string method = "minimax";
    std::optional<int> order;
    std::optional<double> max_error_db;
  } approximate;

  /// Which of the ways to sections is built, see alternatives.hpp.
  enum class Choose { as_asked, fewest_sections, waveform } choose = Choose::as_asked;

  struct Fpaa {
    std::string board = "an231k04-quad4";
    std::optional<Hertz> clock;
  };
  std::optional<Fpaa> fpaa;  ///< absent: no board wanted

  struct Circuit {
    std::string realization = "opamp-rc";
    std::string resistors = "E96";
    std::string capacitors = "E12";
  };
  std::optional<Circuit> circuit;  ///< absent: no op-amp circuit wanted

  /// Stage of the first seed, Fig. 1(b): amplifier pole, damping compensator (eq. 20), resonance.
  struct Plant {
    double stroke_m = 0.0;
    std::optional<Hertz> amplifier_corner;
    std::optional<Hertz> resonance;
    double damping_ratio = 0.0;
    std::optional<Section> damping_compensator;
  } plant;

  struct Track {
    bool sine = false;
    std::vector<Hertz> frequency;
  } track;

  struct Limits {
    std::optional<double> fit_db;
    std::optional<double> points_db;
    std::optional<double> approximation_db;
    std::optional<double> fpaa_percent;
    std::optional<double> circuit_db;
  } limits;

  /// Reads the project and the files it names; every complaint has file and line.
  static Project read(const std::filesystem::path& path, Provenance& from);
};

}  // namespace bodesmith::project
