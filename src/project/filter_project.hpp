#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "base/documents/document.hpp"
#include "base/provenance.hpp"
#include "lti/fractional_transfer.hpp"
#include "lti/sections.hpp"
#include "project/project.hpp"
#include "signal/bode_points.hpp"
#include "tolerance/yield.hpp"

namespace bodesmith::project {

/// A project.toml without a disturbance: a response to build, nothing to track. Its [target] names points, sections or a
/// fractional transfer function.
struct FilterProject {
  std::string name;

  std::string target_file;
  std::optional<BodePoints> points;
  std::optional<Sections> sections;
  std::optional<FractionalTransfer> fractional;
  Band band;  ///< in which it is judged: the points', the sections' own, or as the project says

  struct Fit {
    enum class Method { automatic, interpolate, bounded, direct } method = Method::automatic;
    std::optional<double> max_error_db;
    std::optional<int> order;
    double beta_max = 5.0;
    bool real = false;
    int relative_degree = 0;
    std::optional<Hertz> max_corner;
    std::optional<Hertz> base;
  } fit;

  Project::Approximate approximate;
  std::optional<Project::Fpaa> fpaa;
  std::optional<Project::Circuit> circuit;
  tolerance::Spread spread;
  Project::Limits limits;
  Deadline deadline;  ///< as Project::deadline

  /// Of a document that was read from `path`; reads the file that it names. Every InputError has file and line.
  static FilterProject from_document(const Node& document, const std::filesystem::path& path,
                                     Provenance& from);

  /// |target| in dB where it is known everywhere; nothing for points.
  std::optional<std::complex<double>> target_response(RadPerSecond w) const;
};

std::string_view to_string(FilterProject::Fit::Method method);

}  // namespace bodesmith::project
