#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "schematic/netlist.hpp"

namespace bodesmith::schematic {

/// The compiled form of a netlist at rest: in which order its voltages follow from one another, worked out once. Op-amps are
/// nullors, diodes ideal, capacitors open. What resistors, contacts, diodes and op-amps tie together is a block, linear while
/// its diodes stay as they are; a multiplier follows from its inputs. Tests solve all equations at once for the same voltages.
class RestOrder {
 public:
  /// `inputs`: nodes driven from outside. Throws std::logic_error when voltages depend on themselves through several blocks.
  RestOrder(const Netlist& netlist, const std::vector<std::string>& inputs);

  int node(const std::string& name) const;  ///< its place; throws std::logic_error where there is none
  const Netlist& netlist() const { return netlist_; }

 private:
  friend class RestPoint;
  static constexpr int kGround = 0;
  struct Block {
    std::vector<int> own;    ///< nodes that it settles: passive ones, then its op-amps' outputs
    std::vector<int> reads;  ///< nodes that it takes from elsewhere
    std::size_t passive = 0;
    std::vector<int> resistors, diodes, contacts, opamps;  ///< places in the netlist
    std::vector<std::uint64_t> diodes_at;                  ///< the output of each of its op-amps
    /// Of each of them, in the same order: where its ends (an op-amp's inputs) stand in `own`, or -1 - place in `reads`.
    struct Ends {
      int from = 0, to = 0;
    };
    std::vector<Ends> resistor_ends, diode_ends, contact_ends, opamp_inputs;
  };
  /// A block, or a multiplier, and the inputs that it depends on (bits).
  struct Step {
    int block = -1, multiplier = -1;
    int x = 0, y = 0, z = 0, out = 0;  ///< nodes of the multiplier
    std::uint64_t inputs = 0;
    bool switched = false;
  };
  int number(const std::string& name);
  void find_blocks();
  /// `block_at`: the block of a node or (from `nodes` on) of an op-amp.
  void make_blocks(const std::function<Block&(int)>& block_at, std::size_t nodes);
  void order();

  Netlist netlist_;
  std::map<std::string, int> names_;
  std::vector<std::uint64_t> bit_of_input_;  ///< of each node; 0: it is none
  std::vector<bool> is_driven_;              ///< by an input, a source, a multiplier or an op-amp
  std::vector<Block> blocks_;
  std::vector<std::size_t> block_of_opamp_;
  std::vector<Step> steps_;
};

/// One built copy at rest.
class RestPoint {
 public:
  /// `order` outlives it. `like`: a copy of the same order, of which is taken over how blocks of the same resistors were solved.
  RestPoint(const RestOrder& order, const Deviations& off, const RestPoint* like = nullptr);

  /// An input's voltage.
  void set(int input_node, double volts);
  /// All that follows, with the contacts of one position closed.
  void settle(int position);
  double volts(int node) const { return v_[static_cast<std::size_t>(node)]; }
  double volts(const std::string& node) const { return volts(order_->node(node)); }
  /// d V(out)/d offset of an op-amp: what its own speed is divided by.
  double noise_gain(std::size_t opamp);

 private:
  /// (own nodes; of each diode its current while it conducts, else its voltage backwards) = affine (reads, offsets).
  using Affine = Eigen::MatrixXd;
  const Affine& affine(std::size_t block, std::uint64_t conducting);
  Affine solve_block(const RestOrder::Block& block, std::uint64_t conducting) const;
  void settle_block(std::size_t block);

  const RestOrder* order_;
  std::vector<double> siemens_;  ///< of the resistors, by place in the netlist
  double contact_siemens_ = 1.0;
  Deviations off_;
  std::vector<double> v_;
  std::vector<std::uint64_t> conducting_;  ///< of each block: its diodes
  std::vector<std::map<std::pair<int, std::uint64_t>, Affine>> known_;
  Eigen::VectorXd given_, out_;  ///< room for settle_block()
  std::uint64_t changed_ = ~std::uint64_t{0};
  int position_ = -1;
};

}  // namespace bodesmith::schematic
