#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "lti/frequency_grid.hpp"
#include "schematic/analysis/equations.hpp"
#include "schematic/netlist.hpp"

namespace bodesmith::schematic {

/// V(out)/V(in) of the whole network over a grid, so that every stage loads the one before it.
std::vector<Complex> network_response(const Netlist& netlist, const std::vector<Hertz>& grid,
                                      const Assumptions& assumptions = {});

/// The same for any values of the netlist's parts, over one grid: the linear equations are numbered and scaled once, filled and
/// solved for each set of values. Throws std::invalid_argument for parts whose stamp is no power of their value (diodes).
class ResponseOfParts {
 public:
  ResponseOfParts(const Netlist& netlist, const std::vector<Hertz>& grid,
                  const Assumptions& assumptions = {});
  /// `values`: one of each of Netlist::parts (ohm, farad). Valid until the next call.
  const std::vector<Complex>& at(std::span<const double> values);

 private:
  struct Part {
    double nominal, power, factor;
    std::vector<Stamps::Slope> slopes;  ///< at the nominal value
  };
  /// The small-signal equations M x = b at one frequency.
  struct System {
    double w;
    Eigen::MatrixXcd m;
    Eigen::VectorXcd b;

    void add(const Stamps::Slope& slope, double factor);
  };

  std::vector<Part> parts_;
  std::vector<System> others_;  ///< what is no part, a system a frequency
  int out_ = 0;
  System all_;
  std::vector<Complex> response_;
};

/// Return ratio of each of these op-amps with all others at work, -A (v+ - v-) for its own source set to 1 V and the input at rest:
/// 1 + T is what must not vanish. Every feedback is in it.
std::vector<Complex> return_ratios(const Equations& equations, const Netlist& netlist,
                                   const std::vector<std::size_t>& opamps, RadPerSecond w);

/// d ln V(out)/d ln value of every resistor and capacitor at one frequency, by the adjoint network: with M x = b and
/// M' y = e_out, d V(out) = -y' dM x, whatever the number of parts. 0 for other parts, and at a null of the response.
std::vector<Complex> log_sensitivities(const Equations& equations, std::size_t parts, RadPerSecond w);

/// Spectral density of the noise at a node in V/sqrt(Hz), all elements' sources at once by one solution of the transposed
/// system a frequency. `flicker`: with the op-amps' 1/f corner.
std::vector<double> output_noise(const Netlist& netlist, const std::vector<Hertz>& grid, bool flicker = true,
                                 const std::string& node = "out", const std::string& input = "in");
/// Root of the integral of its square over the band, by trapezoids in log frequency (the density bends slowly).
double output_noise_rms(const Netlist& netlist, Band band, bool flicker = true,
                        const std::string& node = "out", int points = 121, const std::string& input = "in");
/// |V(out)| at rest with every op-amp's offset and bias currents at the signs that add up.
double worst_output_offset(const Netlist& netlist);

}  // namespace bodesmith::schematic
