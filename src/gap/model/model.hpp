#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "chain/chain.hpp"

namespace bodesmith::gap {

class Effect;
class Model;

/// A number that a fit may change.
struct Unknown {
  std::string name = {};  ///< key with its unit
  double value = 0.0;
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool logarithmic = false;  ///< searched as ln(value); value, low > 0
  double scale = 1.0;        ///< size of a typical change (linear ones)
  /// What is known beforehand, as one more observation: the value given, right to `given_spread` (of
  /// ln(value) when logarithmic). 0: nothing is.
  double given = 0.0;
  double given_spread = 0.0;
  /// Steps in which the value is tried around the place where a fit ends, for what moves edges across samples
  /// (a clock, a switch): the sum of squares is then hilly on that scale. 0: it is smooth.
  double hop = 0.0;
  std::string parameter =
      {};                 ///< key of the block's parameter that it is; empty: it is none of a block's own
  std::string unit = {};  ///< of that parameter ("Hz", "s", "y/s", ...); empty: none

  bool moves_edges() const { return hop > 0.0; }
  /// How far a value is off what was given, in its spread.
  double deviations(double at) const {
    return (logarithmic ? std::log(at / given) : at - given) / given_spread;
  }
  bool at_bound() const { return value <= low || value >= high; }
};

/// A named effect put into the chain: blocks of its own, or a change inside a block of the base model.
struct Term {
  const Effect* effect = nullptr;
  /// "before block 2", "after block 3", "inside block 1" (blocks of the base model, from 1).
  std::string placed;
  /// Name of the part that it accuses ("Rd3"), or for which the block that it changes stands ("amplifier"); empty: none.
  std::string part = {};
  std::vector<Unknown> unknowns;
  /// Ids of the blocks it brought, or shares with other terms: they stay as long as one of them does.
  std::vector<int> blocks;
  /// Turns the unknowns' values into block parameters.
  std::function<void(Model&, std::span<const double>)> write;
  /// Of its name, place and form beforehand (evidence/score.hpp).
  double log_prior = 0.0;
  /// What it writes depends on base blocks, which other terms may change: it is written after those.
  bool reads_base_blocks = false;
};

/// The base chain together with the terms found so far, and one vector of everything a fit may change: the
/// base model's free parameters first, then each term's unknowns. Blocks carry ids, so that terms find theirs
/// whatever is inserted elsewhere. A value: copies are independent.
class Model {
 public:
  Model() = default;
  explicit Model(const chain::Chain& base);

  std::size_t size() const { return slots_.size(); }
  const chain::Block& at(std::size_t position) const { return slots_[position].block; }
  int id_at(std::size_t position) const { return slots_[position].id; }
  bool is_base(std::size_t position) const { return slots_[position].base_number > 0; }
  /// Number (from 1) of the base model's block there; 0 for a block of a term.
  int base_number(std::size_t position) const { return slots_[position].base_number; }
  std::size_t position_of(int id) const;
  chain::Block& block(int id) { return slots_[position_of(id)].block; }

  void set_start(chain::Start start) { start_ = start; }
  /// Free parameters that are 0 and have the unit of a signal (offsets) say nothing of their size: they are right to a quarter of this.
  void set_signal_size(double size);
  /// Inserts before `position` (size(): at the end); returns the new block's id.
  int insert(std::size_t position, chain::Block block);
  /// "before block 2" in the base model's numbers.
  std::string placed(std::size_t position) const;

  const std::vector<Term>& terms() const { return terms_; }
  /// Hum that terms brought, its size and phase each record's own (lines.hpp); it stands at the end.
  std::vector<int> line_blocks() const;
  /// Where a block behind the whole chain goes: in front of the lines.
  std::size_t end() const;
  /// A block has op-amps whose noise gain is known (chain::PartChange): it is a circuit's model.
  bool opamps_are_known() const;
  void add(Term term);
  /// Its blocks go, but those that other terms share; base blocks are as they were given, and all values written anew.
  void remove(std::size_t term);
  void move_term(std::size_t from, std::size_t to);
  void set_effect_of_last(const Effect& effect) { terms_.back().effect = &effect; }
  void set_log_prior(std::size_t term, double value) { terms_[term].log_prior = value; }
  /// Place of a term's first unknown among the model's.
  std::size_t first_unknown_of(std::size_t term) const;

  std::vector<Unknown> unknowns() const;
  std::vector<double> values() const;
  std::size_t free_count() const { return free_.size(); }
  void set_values(std::span<const double> values);

  chain::Chain chain() const;
  /// The block there is linear and time-invariant.
  bool is_linear(std::size_t position) const { return at(position).response(RadPerSecond{1.0}).has_value(); }
  /// Linear blocks alone, from `position` on, but lines: a curve or a memory passes small things on much as they are.
  chain::Chain linear_part(std::size_t position) const;
  /// Empty when every block is within its bounds.
  std::string validation_error() const;

 private:
  struct Slot {
    int id;
    int base_number;
    chain::Block block;
    chain::Block given;  ///< as it came
  };
  struct Free {
    int id;
    std::size_t parameter;
    Unknown unknown;
  };
  std::optional<chain::Start> start_;  ///< as the base model says
  std::vector<Slot> slots_;
  std::vector<Free> free_;
  std::vector<Term> terms_;
  int next_id_ = 0;
};

}  // namespace bodesmith::gap
