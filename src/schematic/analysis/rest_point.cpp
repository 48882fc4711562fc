#include "schematic/analysis/rest_point.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>
#include <stdexcept>

#include "base/error.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "schematic/analysis/sets.hpp"

namespace bodesmith::schematic {
namespace {

std::size_t at(int place) {
  return static_cast<std::size_t>(place);
}

/// Of an end at ground, which stands nowhere.
constexpr int kGroundPlace = std::numeric_limits<int>::min();

}  // namespace

RestOrder::RestOrder(const Netlist& netlist, const std::vector<std::string>& inputs) : netlist_(netlist) {
  number("0");
  for (const std::string& one : inputs) number(one);
  for (const Part& one : netlist_.parts) number(one.from), number(one.to);
  for (const OpAmp& one : netlist_.opamps) number(one.plus), number(one.minus), number(one.out);
  for (const Multiplier& one : netlist_.multipliers)
    number(one.x), number(one.y), number(one.z), number(one.out);
  for (const Contact& one : netlist_.contacts) number(one.from), number(one.to);
  for (const Source& one : netlist_.sources) number(one.node);
  is_driven_.assign(names_.size(), false);
  is_driven_[kGround] = true;
  bit_of_input_.assign(names_.size(), 0);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    bit_of_input_[at(node(inputs[i]))] = std::uint64_t{1} << i;
    is_driven_[at(node(inputs[i]))] = true;
  }
  for (const OpAmp& one : netlist_.opamps) is_driven_[at(node(one.out))] = true;
  for (const Multiplier& one : netlist_.multipliers) is_driven_[at(node(one.out))] = true;
  for (const Source& one : netlist_.sources) is_driven_[at(node(one.node))] = true;
  find_blocks();
  order();
}

int RestOrder::number(const std::string& name) {
  return names_.try_emplace(name, static_cast<int>(names_.size())).first->second;
}

int RestOrder::node(const std::string& name) const {
  const auto found = names_.find(name);
  if (found == names_.end()) throw std::logic_error("a netlist without a node " + name);
  return found->second;
}

void RestOrder::find_blocks() {
  // Nodes that nothing drives, tied by what conducts; an op-amp is one more element, tied to what it compares.
  const std::size_t nodes = names_.size();
  Sets sets(nodes + netlist_.opamps.size());
  const auto tie = [&](int a, int b) {
    if (!is_driven_[at(a)] && !is_driven_[at(b)]) sets.join(a, b);
  };
  for (const Part& one : netlist_.parts) {
    if (one.kind != Part::Kind::capacitor) tie(node(one.from), node(one.to));
  }
  for (const Contact& one : netlist_.contacts) tie(node(one.from), node(one.to));
  const auto element = [&](std::size_t opamp) { return static_cast<int>(nodes + opamp); };
  for (std::size_t i = 0; i < netlist_.opamps.size(); ++i) {
    for (const int input : {node(netlist_.opamps[i].plus), node(netlist_.opamps[i].minus)}) {
      if (!is_driven_[at(input)]) sets.join(input, element(i));
    }
  }
  // Op-amps that read one another's outputs in a circle are one block.
  for (bool circle = true; circle;) {
    blocks_.clear(), block_of_opamp_.clear();
    std::map<int, std::size_t> place;
    make_blocks(
        [&](int one) -> Block& {
          const auto [found, fresh] = place.try_emplace(sets.of(one), blocks_.size());
          if (fresh) blocks_.emplace_back();
          return blocks_[found->second];
        },
        nodes);
    circle = false;
    const std::size_t count = blocks_.size();
    std::vector<std::vector<bool>> reaches(count, std::vector<bool>(count, false));
    for (std::size_t i = 0; i < netlist_.opamps.size(); ++i) {
      const int out = node(netlist_.opamps[i].out);
      for (std::size_t b = 0; b < count; ++b) {
        if (std::ranges::find(blocks_[b].reads, out) != blocks_[b].reads.end())
          reaches[block_of_opamp_[i]][b] = true;
      }
    }
    for (std::size_t via = 0; via < count; ++via) {
      for (std::size_t a = 0; a < count; ++a) {
        for (std::size_t b = 0; b < count; ++b)
          reaches[a][b] = reaches[a][b] || (reaches[a][via] && reaches[via][b]);
      }
    }
    for (std::size_t a = 0; a < count; ++a) {
      for (std::size_t b = a + 1; b < count; ++b) {
        if (!reaches[a][b] || !reaches[b][a]) continue;
        sets.join(element(static_cast<std::size_t>(blocks_[a].opamps.front())),
                  element(static_cast<std::size_t>(blocks_[b].opamps.front())));
        circle = true;
      }
    }
  }
}

void RestOrder::make_blocks(const std::function<Block&(int)>& block_at, std::size_t nodes) {
  std::vector<bool> tied(nodes, false);
  for (const Part& one : netlist_.parts) {
    if (one.kind != Part::Kind::capacitor) tied[at(node(one.from))] = tied[at(node(one.to))] = true;
  }
  for (const Contact& one : netlist_.contacts) tied[at(node(one.from))] = tied[at(node(one.to))] = true;
  const auto element = [&](std::size_t opamp) { return static_cast<int>(nodes + opamp); };
  for (std::size_t i = 0; i < nodes; ++i) {
    if (!is_driven_[i] && tied[i]) block_at(static_cast<int>(i)).own.push_back(static_cast<int>(i));
  }
  for (Block& one : blocks_) one.passive = one.own.size();
  for (std::size_t i = 0; i < netlist_.opamps.size(); ++i) {
    Block& block = block_at(element(i));
    block.own.push_back(node(netlist_.opamps[i].out));
    block.opamps.push_back(static_cast<int>(i));
    block_of_opamp_.push_back(static_cast<std::size_t>(&block - blocks_.data()));
  }
  const auto between = [&](int from, int to, std::vector<int> Block::*list, std::size_t i) {
    if (is_driven_[at(from)] && is_driven_[at(to)]) return;
    (block_at(is_driven_[at(from)] ? to : from).*list).push_back(static_cast<int>(i));
  };
  for (std::size_t i = 0; i < netlist_.parts.size(); ++i) {
    const Part& one = netlist_.parts[i];
    if (one.kind != Part::Kind::capacitor)
      between(node(one.from), node(one.to),
              one.kind == Part::Kind::diode ? &Block::diodes : &Block::resistors, i);
  }
  for (std::size_t i = 0; i < netlist_.contacts.size(); ++i)
    between(node(netlist_.contacts[i].from), node(netlist_.contacts[i].to), &Block::contacts, i);
  for (Block& block : blocks_) {
    std::set<int> reads;
    const auto read = [&](const std::string& name) {
      const int one = node(name);
      if (one != kGround && std::ranges::find(block.own, one) == block.own.end()) reads.insert(one);
    };
    for (const std::vector<int>* list : {&block.resistors, &block.diodes}) {
      for (const int i : *list) read(netlist_.part(i).from), read(netlist_.part(i).to);
    }
    for (const int i : block.contacts) read(netlist_.contacts[at(i)].from), read(netlist_.contacts[at(i)].to);
    for (const int i : block.opamps) read(netlist_.opamps[at(i)].plus), read(netlist_.opamps[at(i)].minus);
    block.reads.assign(reads.begin(), reads.end());
    const auto place = [&](const std::string& name) {
      const int one = node(name);
      if (one == kGround) return kGroundPlace;
      const auto here = std::ranges::find(block.own, one);
      if (here != block.own.end()) return static_cast<int>(here - block.own.begin());
      return -1 - static_cast<int>(std::ranges::find(block.reads, one) - block.reads.begin());
    };
    const auto ends = [&](const std::string& from, const std::string& to) {
      return Block::Ends{place(from), place(to)};
    };
    for (const int i : block.resistors)
      block.resistor_ends.push_back(ends(netlist_.part(i).from, netlist_.part(i).to));
    constexpr std::size_t kMostDiodes = std::numeric_limits<std::uint64_t>::digits;  // a bit each
    if (block.diodes.size() > kMostDiodes)
      throw DesignError(fmt::format(
          "{} diodes act on one another, expected {} at most (of a gain curve: fewer straight pieces, by a larger tolerance or "
          "fewer frequencies in its table)",
          block.diodes.size(), kMostDiodes));
    for (const int i : block.diodes)
      block.diode_ends.push_back(ends(netlist_.part(i).from, netlist_.part(i).to));
    for (const int i : block.contacts)
      block.contact_ends.push_back(ends(netlist_.contacts[at(i)].from, netlist_.contacts[at(i)].to));
    for (const int i : block.opamps)
      block.opamp_inputs.push_back(ends(netlist_.opamps[at(i)].plus, netlist_.opamps[at(i)].minus));
    for (const int i : block.opamps) {
      block.diodes_at.push_back(0);
      for (std::size_t k = 0; k < block.diodes.size(); ++k) {
        const Part& one = netlist_.part(block.diodes[k]);
        if (const std::string& out = netlist_.opamps[at(i)].out; one.from == out || one.to == out)
          block.diodes_at.back() |= std::uint64_t{1} << k;
      }
    }
  }
}

void RestOrder::order() {
  std::map<int, Step> known = {{kGround, {}}};  // what a node depends on
  for (std::size_t i = 0; i < bit_of_input_.size(); ++i)
    if (bit_of_input_[i] != 0) known[static_cast<int>(i)].inputs = bit_of_input_[i];
  for (const Source& one : netlist_.sources) known.try_emplace(node(one.node));
  std::vector<bool> block_done(blocks_.size(), false), multiplier_done(netlist_.multipliers.size(), false);
  // True when all of `reads` are known: `step` depends on what they depend on.
  const auto ready = [&](const std::vector<int>& reads, Step& step) {
    return std::ranges::all_of(reads, [&](int one) {
      const auto found = known.find(one);
      if (found == known.end()) return !is_driven_[at(one)] && step.multiplier < 0;
      step.inputs |= found->second.inputs;
      step.switched = step.switched || found->second.switched;
      return true;
    });
  };
  for (bool moved = true; moved;) {
    moved = false;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      Step step{.block = static_cast<int>(i), .switched = !blocks_[i].contacts.empty()};
      if (block_done[i] || !ready(blocks_[i].reads, step)) continue;
      // Not its own input's: a node that is driven twice keeps what drives it from outside.
      for (const int one : blocks_[i].own) known.try_emplace(one, step);
      block_done[i] = moved = true;
      steps_.push_back(step);
    }
    for (std::size_t i = 0; i < netlist_.multipliers.size(); ++i) {
      const Multiplier& one = netlist_.multipliers[i];
      Step step;
      step.multiplier = static_cast<int>(i);
      step.x = node(one.x), step.y = node(one.y), step.z = node(one.z), step.out = node(one.out);
      if (multiplier_done[i] || !ready({step.x, step.y, step.z}, step)) continue;
      known.try_emplace(step.out, step);
      multiplier_done[i] = moved = true;
      steps_.push_back(step);
    }
  }
  if (steps_.size() != blocks_.size() + netlist_.multipliers.size())
    throw std::logic_error("the circuit's voltages at rest do not follow from one another");
}

RestPoint::RestPoint(const RestOrder& order, const Deviations& off, const RestPoint* like)
    : order_(&order), off_(off), conducting_(order.blocks_.size()), known_(order.blocks_.size()) {
  const Netlist& netlist = order.netlist_;
  v_.assign(order.names_.size(), 0.0);
  for (std::size_t i = 0; i < netlist.sources.size(); ++i)
    v_[at(order.node(netlist.sources[i].node))] = netlist.sources[i].volts * (1.0 + off.source[i]);
  for (std::size_t i = 0; i < netlist.parts.size(); ++i)
    siemens_.push_back(
        netlist.parts[i].kind == Part::Kind::resistor ? 1.0 / off.value(netlist, static_cast<int>(i)) : 0.0);
  contact_siemens_ = off.contact(netlist.analog_switch).on_siemens();
  if (like == nullptr || like->contact_siemens_ != contact_siemens_) return;
  for (std::size_t b = 0; b < known_.size(); ++b) {
    const std::vector<int>& resistors = order.blocks_[b].resistors;
    if (std::ranges::all_of(resistors, [&](int i) { return siemens_[at(i)] == like->siemens_[at(i)]; }))
      known_[b] = like->known_[b];
  }
}

RestPoint::Affine RestPoint::solve_block(const RestOrder::Block& block, std::uint64_t conducting) const {
  const Netlist& netlist = order_->netlist_;
  const auto size = [](std::size_t n) { return static_cast<Eigen::Index>(n); };
  const Eigen::Index own = size(block.own.size()), passive = size(block.passive),
                     reads = size(block.reads.size()), opamps = size(block.opamps.size()),
                     diodes = size(block.diodes.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(own + diodes, own + diodes),
                  b = Eigen::MatrixXd::Zero(own + diodes, reads + opamps);
  const auto add = [&](Eigen::Index row, int place, double factor) {
    if (place == kGroundPlace) return;
    if (place >= 0) {
      a(row, place) += factor;
    } else {
      b(row, -1 - place) -= factor;
    }
  };
  const auto has_row = [&](int place) { return place >= 0 && place < passive; };
  const auto conducts = [&](const RestOrder::Block::Ends& ends, double siemens) {
    const auto& [p, q] = ends;
    if (has_row(p)) add(p, p, siemens), add(p, q, -siemens);
    if (has_row(q)) add(q, q, siemens), add(q, p, -siemens);
  };
  for (std::size_t i = 0; i < block.resistors.size(); ++i)
    conducts(block.resistor_ends[i], siemens_[at(block.resistors[i])]);
  for (std::size_t i = 0; i < block.contacts.size(); ++i) {
    const bool closed = netlist.contacts[at(block.contacts[i])].position == position_;
    conducts(block.contact_ends[i], closed ? contact_siemens_ : netlist.analog_switch.off_siemens);
  }
  for (Eigen::Index i = 0; i < opamps; ++i) {
    const auto& [plus, minus] = block.opamp_inputs[static_cast<std::size_t>(i)];
    add(passive + i, plus, 1.0);
    add(passive + i, minus, -1.0);
    b(passive + i, reads + i) = -1.0;
  }
  for (Eigen::Index k = 0; k < diodes; ++k) {
    const auto& [anode, cathode] = block.diode_ends[static_cast<std::size_t>(k)];
    if (has_row(anode)) a(anode, own + k) += 1.0;
    if (has_row(cathode)) a(cathode, own + k) -= 1.0;
    if ((conducting >> k & 1) != 0) {
      add(own + k, anode, 1.0);
      add(own + k, cathode, -1.0);
    } else {
      a(own + k, own + k) = 1.0;
    }
  }
  Affine out = solve_lu_columns(a, b);
  for (Eigen::Index k = 0; k < diodes; ++k) {
    if ((conducting >> k & 1) != 0) continue;
    const auto& [anode, cathode] = block.diode_ends[static_cast<std::size_t>(k)];
    out.row(own + k).setZero();
    for (const auto& [place, factor] : {std::pair{cathode, 1.0}, {anode, -1.0}}) {
      if (place == kGroundPlace) continue;
      if (place >= 0) {
        out.row(own + k) += factor * out.row(place);
      } else {
        out(own + k, -1 - place) += factor;
      }
    }
  }
  return out;
}

const RestPoint::Affine& RestPoint::affine(std::size_t block, std::uint64_t conducting) {
  const RestOrder::Block& one = order_->blocks_[block];
  const auto [found, fresh] = known_[block].try_emplace({one.contacts.empty() ? 0 : position_, conducting});
  if (fresh) found->second = solve_block(one, conducting);
  return found->second;
}

void RestPoint::settle_block(std::size_t b) {
  const RestOrder::Block& block = order_->blocks_[b];
  given_.resize(static_cast<Eigen::Index>(block.reads.size() + block.opamps.size()));
  Eigen::Index k = 0;
  for (const int one : block.reads) given_(k++) = v_[at(one)];
  for (const int one : block.opamps) given_(k++) = off_.offset(one);
  const auto own = static_cast<Eigen::Index>(block.own.size());
  constexpr double kZero = 1e-13;  // V and A: neither is told from rounding
  const std::size_t most = 4 * block.diodes.size() + 2;
  std::uint64_t on = 0, off = 0;
  for (std::size_t tries = 0; tries < most; ++tries) {
    out_.noalias() = affine(b, conducting_[b]) * given_;
    if (!out_.allFinite()) {
      // An op-amp without feedback: where none of its diodes conducts, those that did not before do.
      for (const std::uint64_t its : block.diodes_at) {
        if ((conducting_[b] & its) == 0) conducting_[b] |= (its & off) == 0 ? its & ~(its - 1) : its & ~off;
      }
      continue;
    }
    on = off = 0;
    for (std::size_t d = 0; d < block.diodes.size(); ++d) {
      const std::uint64_t bit = std::uint64_t{1} << d;
      if (out_(own + static_cast<Eigen::Index>(d)) < -kZero) ((conducting_[b] & bit) != 0 ? off : on) |= bit;
    }
    if ((on | off) == 0) {
      for (Eigen::Index i = 0; i < own; ++i) {
        const int node = block.own[static_cast<std::size_t>(i)];
        if (order_->bit_of_input_[at(node)] == 0) v_[at(node)] = out_(i);
      }
      return;
    }
    conducting_[b] ^= on | off;
  }
  throw std::logic_error("the diodes of a circuit find no state of rest");
}

void RestPoint::set(int input_node, double volts) {
  double& now = v_[at(input_node)];
  if (now == volts) return;
  now = volts;
  changed_ |= order_->bit_of_input_[at(input_node)];
}

void RestPoint::settle(int position) {
  const bool moved = position != position_;
  const bool first = changed_ == ~std::uint64_t{0};
  position_ = position;
  for (const RestOrder::Step& step : order_->steps_) {
    if (!first && (step.inputs & changed_) == 0 && !(moved && step.switched)) continue;
    if (step.block >= 0) {
      settle_block(at(step.block));
      continue;
    }
    if (order_->bit_of_input_[at(step.out)] != 0) continue;
    const MultiplierDeviation& off = off_.multiplier[at(step.multiplier)];
    v_[at(step.out)] = off.product(order_->netlist_.multiplier.scale_v, volts(step.x), volts(step.y)) +
                       volts(step.z) + off.w;
  }
  changed_ = 0;
}

double RestPoint::noise_gain(std::size_t opamp) {
  const std::size_t b = order_->block_of_opamp_[opamp];
  const RestOrder::Block& block = order_->blocks_[b];
  const auto place = std::ranges::find(block.opamps, static_cast<int>(opamp)) - block.opamps.begin();
  return affine(b, conducting_[b])(static_cast<Eigen::Index>(block.passive) + place,
                                   static_cast<Eigen::Index>(block.reads.size()) + place);
}

}  // namespace bodesmith::schematic
