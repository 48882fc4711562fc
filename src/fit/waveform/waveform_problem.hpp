#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/units.hpp"
#include "fit/direct/root_model.hpp"
#include "fit/waveform/waveform_error.hpp"
#include "numeric/linear_algebra/matrix_products.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith {

/// Harmonics in the search (waveform_error's figures have 400).
inline constexpr Eigen::Index kSearchHarmonics = 48;

/// The error of one operating frequency as a linear function of G at its harmonics 0 ... kSearchHarmonics:
///   e = B G - d,  |e|^2 = mean square error of the waveform.
/// B is real-linear: rows for real and imaginary parts.
class WaveformErrorMap {
 public:
  WaveformErrorMap(const Disturbance& disturbance, DrivenPath path);

  /// Rate gains of the two branches at one frequency.
  struct BranchGains {
    double ascending = 1.0;
    double descending = 1.0;
  };

  Eigen::Index rows() const;
  /// e for G(k f) and its derivatives by whatever G's are (null: none).
  void apply(const Eigen::VectorXcd& g, const Eigen::MatrixXcd* g_slope, const BranchGains& gains,
             Eigen::VectorXd& e, Eigen::MatrixXd* slope) const;
  /// B, for the unknowns (Re G_0, Re G_1, Im G_1, ...).
  Eigen::MatrixXd matrix() const;

 private:
  void apply_whole(const Eigen::VectorXcd& g, const Eigen::MatrixXcd* g_slope, const BranchGains& gains,
                   Eigen::VectorXd& e, Eigen::MatrixXd* slope) const;
  void apply_half(const Eigen::VectorXcd& g, const Eigen::MatrixXcd* g_slope, double gain, Eigen::VectorXd& e,
                  Eigen::MatrixXd* slope) const;

  DrivenPath path_;
  Eigen::VectorXcd coefficient_;  ///< of the waveform, harmonics 0 ...
  Eigen::VectorXcd ascending_;    ///< each branch's share of it, for the whole path
  Eigen::VectorXcd descending_;
  Eigen::MatrixXd window_;  ///< B of a path in which one half of the period counts
  FixedMatrix by_window_;   ///< the same, to multiply by
};

/// The errors of all operating frequencies as functions of the roots of G.
class WaveformProblem {
 public:
  WaveformProblem(const Disturbance& disturbance, const std::vector<Hertz>& operating, DrivenPath path);

  std::size_t count() const { return operating_.size(); }
  const std::vector<Hertz>& operating() const { return operating_; }
  const WaveformErrorMap& map() const { return map_; }
  const WaveformErrorMap::BranchGains& gains(std::size_t i) const { return gains_[i]; }

  /// Error vector of one frequency and (unless null) its derivatives.
  void error(const RootModel& model, const Eigen::VectorXd& theta, std::size_t i, Eigen::VectorXd& e,
             Eigen::MatrixXd* slope) const;
  /// All of them, weighted evenly: |e|^2 = mean of the mean square errors.
  void errors(const RootModel& model, const Eigen::VectorXd& theta, Eigen::VectorXd& e,
              Eigen::MatrixXd* slope) const;
  /// The largest mean square error.
  double worst_square(const RootModel& model, const Eigen::VectorXd& theta) const;

 private:
  WaveformErrorMap map_;
  std::vector<Hertz> operating_;
  std::vector<WaveformErrorMap::BranchGains> gains_;
  std::vector<std::vector<RadPerSecond>> harmonics_;  ///< of each operating frequency, from 0 on
};

/// The operating frequencies, rising; those of the rate table when none are given. Throws InputError when there are
/// none.
std::vector<Hertz> checked_operating(const Disturbance& disturbance, std::vector<Hertz> operating);

/// What no linear filter, causal or not, of any order beats, percent of range. Every harmonic of every operating
/// frequency is one physical frequency, and harmonics that coincide share one value of G: a small least squares problem.
/// For the worst frequency the largest weighted bound over the frequencies' weights is taken (each one is valid).
double waveform_lower_bound(const Disturbance& disturbance, const std::vector<Hertz>& operating,
                            DrivenPath path, bool worst);

}  // namespace bodesmith
