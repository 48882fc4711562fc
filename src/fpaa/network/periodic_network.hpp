#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/units.hpp"
#include "fpaa/network/clocked_network.hpp"

namespace bodesmith::fpaa {

/// The sum over q = 0 … turns - 1 of exp(j q turn) is this times exp(j turn (turns - 1)/2), for a turn within +-pi.
double size_of_turns(double turn, double turns);

/// A voltage in the periodic steady state under the input exp(j w t): alpha_i + beta_i exp(j w t) from edge[i] to
/// edge[i+1] (ticks; one edge more than pieces), a turn of exp(j w edge.back()) later the same again. In addition to that gamma_i times
/// the waveform of the node that it follows, of which each piece then takes in whole periods.
struct SineWaveform {
  const std::vector<std::int64_t>* edges = nullptr;
  std::vector<Complex> alpha, beta;
  std::optional<std::size_t> follows = {};
  std::vector<double> gamma = {};
  Complex end = 0.0;  ///< at edges.back()
  /// Of what follows late, in addition: area of a short peak where each piece begins, V s; -late_i times d/dt of what is followed,
  /// in seconds.
  std::vector<Complex> peak = {};
  std::vector<double> late = {};
  Complex end_rate = 0.0;  ///< d/dt just before edges.back()
};

/// Clocked networks one behind the other, none of which reads what depends on it: the board of a plan.
///
/// Exact periodic steady state for a sine. Between switching instants everything is algebraic
/// (clocked_network.hpp), so that with an input exp(j w t) every voltage is piecewise alpha + beta exp(j w t).
/// Over a network's own common period L (of its clocks and of all it reads) q(L) = exp(j w L) q(0), one small
/// complex solve; two passes over the instants give its waveform. The gain is
///   (1/L) int_0^L v(t) exp(-j w t) dt
/// of the last network's output: a component at another line w + 2 pi k/L likewise. The cost of a frequency grows
/// with the switching instants in L: two for each network where all share a clock. What reads a faster clock of which its own
/// intervals take in whole periods follows that waveform, which is the same but for a turn in each of them: a geometric sum.
///
/// Slow op-amps and switches follow late (ClockedNetwork), to the first order in their time constants.
///
/// The response is linear: what a network reads of clocks that have no short common period with one another is
/// superposed, each part over its own common period with the network's clocks.
///
/// Noise: what opens leaves a charge of known covariance at every instant (ChargeMap::noise), uncorrelated from
/// instant to instant. By the transposed passes, G_i the Fourier transform of the output after a unit charge at
/// instant i of the common period L of the network and all that follows it, the density at the output is
/// (1/L) sum_i G_i' K_i G_i: all foldings are in it. (Where that L has too many instants, foldings by clocks that
/// have no short common period are left out.) Noise of op-amps that have settled long before a switch moves: what they leave in the
/// charges likewise, and at the output that is read what they are while no switch moves, with what both have in common; right to
/// the first order in settling time over interval. (What another network samples of it is left out: one network has all.)
class PeriodicNetworks {
 public:
  /// What an input of a network reads.
  struct Source {
    enum class Kind { nothing, board_input, network };
    Kind kind = Kind::nothing;
    std::size_t network = 0;  ///< an earlier one
  };

  explicit PeriodicNetworks(double ticks_per_second) : ticks_per_second_(ticks_per_second) {}

  /// `sources`: one for each input. Throws DesignError where the common period has too many instants.
  std::size_t add(ClockedNetwork network, std::vector<Source> sources);
  /// The same network with other capacitors: its maps alone.
  void replace(std::size_t index, const ClockedNetwork& network);
  /// The network whose output is the board's.
  void set_output(std::size_t index) { output_ = index; }

  std::size_t size() const { return parts_.size(); }
  /// Pieces of waveforms that a frequency costs.
  std::size_t pieces() const;
  /// Instants that nodes() looks at, some 10 ns each.
  std::size_t instants() const;

  /// Component of the output at the input's own frequency, for an input of 1.
  Complex gain(RadPerSecond w) const;
  /// Of one network's op-amp: mean and largest |v| at any instant, for a sine of amplitude 1.
  struct NodeSize {
    Complex gain;
    double largest = 0.0;
  };
  /// [network][op-amp].
  std::vector<std::vector<NodeSize>> nodes(RadPerSecond w) const;
  /// The output's components at several frequencies (lines k fc +- f; below 0: the conjugate one above) for one sine.
  std::vector<Complex> components(RadPerSecond sine, std::span<const RadPerSecond> lines) const;

  /// One-sided noise density at the output, [network]: what each adds, in kT over the unit of capacitance, a hertz. Of networks made
  /// with their noise.
  std::vector<double> noise_density(RadPerSecond w) const;
  /// How many of its op-amps' longest time constants an interval between switches takes, at the least; infinite without noise of
  /// op-amps.
  double settled() const;

 private:
  /// A network, or the part of it that reads some of its sources.
  struct Node {
    ClockedNetwork clocked;
    std::vector<Source> sources;               ///< indices of nodes
    std::int64_t period = 1;                   ///< of its waveform
    std::vector<std::int64_t> edges = {};      ///< of pieces, one more than there are
    std::vector<std::uint32_t> interval = {};  ///< of each piece, index into the network's
    std::vector<bool> ends = {};               ///< whether an interval ends with the piece
    /// [input][piece]: piece of the source and how many of the source's periods later.
    std::vector<std::vector<std::uint32_t>> source_piece = {};
    std::vector<std::vector<std::uint32_t>> source_turn = {};
    std::optional<std::size_t> follows = {};  ///< SineWaveform::follows
    Eigen::MatrixXd loop = {};                ///< q over the whole period without an input

    std::size_t pieces() const { return interval.size(); }
  };
  /// Inputs of a node, one waveform each on the node's own pieces.
  struct Inputs {
    std::vector<Complex> alpha, beta, at_end;   ///< [piece * inputs + input]
    std::vector<double> gamma, late;            ///< likewise; none where nothing is followed
    std::vector<Complex> turn_at_end;           ///< exp(j w edge) of each piece's end
    std::vector<Complex> followed_at_end;       ///< what is followed, there
    Complex followed_at_start = 0.0;            ///< and just before the first piece
    std::vector<Complex> followed_rate_at_end;  ///< d/dt of it
    std::vector<Complex> peak, rate_at_end;     ///< as alpha, of slow parts: SineWaveform::peak, and d/dt
    double w = 0.0;
  };
  class NoisePass;
  class LateOutput;

  std::vector<std::vector<Source>> parts_of(std::int64_t own, const std::vector<Source>& sources) const;
  /// False where what its sources follow does not fit its own intervals.
  bool lay_pieces(Node& node) const;
  std::optional<std::size_t> followed_by(const Node& node) const;
  static void find_loop(Node& node);
  /// `in` keeps its room from node to node.
  void find_inputs(const Node& node, const std::vector<SineWaveform>& known, double w, Inputs& in) const;
  static void step(const Node& node, const Inputs& in, std::size_t piece, Eigen::VectorXcd& q,
                   Eigen::VectorXcd& next);
  /// Charges at the beginning of the period.
  static Eigen::VectorXcd start_of(const Node& node, const Inputs& in);
  /// Waveforms of these op-amps (rows of V).
  static std::vector<SineWaveform> waveforms(const Node& node, const Inputs& in,
                                             std::span<const std::size_t> opamps);
  std::vector<SineWaveform> outputs(double w) const;
  Complex mean(const SineWaveform& of, const std::vector<SineWaveform>& known, double w, double line) const;
  std::size_t instants_of(const Node& node) const;
  using AtInstant = std::function<void(Complex turn, Complex value)>;
  void for_each_instant(const SineWaveform& of, const std::vector<SineWaveform>& known, double w,
                        const AtInstant& at) const;

  double ticks_per_second_;
  bool may_follow_ = true;
  std::vector<Node> nodes_;
  std::vector<std::vector<std::size_t>> parts_;  ///< of each network: its nodes
  std::optional<std::size_t> output_;
};

}  // namespace bodesmith::fpaa
