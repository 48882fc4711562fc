#pragma once

#include <Eigen/Core>
#include <complex>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "part_errors/loop.hpp"
#include "part_errors/rest_point.hpp"

namespace bodesmith::part_errors {

/// Node equations of the generator and the subtraction for small signals about one point. What the slope meter and
/// the gain curve make does not move: ground for small signals.
class LoopNetwork {
 public:
  using Complex = std::complex<double>;
  LoopNetwork(const controller::AnalogController& controller, const LoopPoint& point);

  /// -v for 1 V at what reads it, the loop cut there; 0 where the generator is not fed by its drive.
  Complex generator(RadPerSecond w) const;
  /// Return ratios of op-amps() with all loops closed.
  std::vector<Complex> return_ratios(RadPerSecond w) const;
  const std::vector<std::size_t>& opamps() const { return opamps_; }
  /// Voltages of the point: r that makes v, and the slope meter's.
  double reference_v() const { return reference_v_; }
  double slope_v() const { return slope_v_; }

 private:
  struct Gain {
    std::string out, x, y, z;
    double by_x = 0.0, by_y = 0.0;
  };
  void choose_sections();
  void number_nodes();
  int node(const std::string& name, bool cut) const;
  Eigen::MatrixXcd matrix(RadPerSecond w, bool cut, std::vector<Complex>& by_input) const;
  bool in_loop(const std::string& section) const { return sections_.count(section) > 0; }
  bool reads_argument(const std::string& section) const { return generator_sections_.count(section) > 0; }

  const controller::AnalogController& controller_;
  LoopPoint point_;
  double reference_v_ = 0.0, slope_v_ = 0.0;
  std::set<std::string> sections_, generator_sections_;
  std::vector<std::size_t> opamps_;
  std::vector<Gain> gains_;
  std::map<std::string, int> nodes_;
};

}  // namespace bodesmith::part_errors
