#include "gap/model/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace bodesmith::gap {

namespace {

/// Relative spread of the free parameters' values in a base model: right to a quarter (docs/gap.md, 1).
constexpr double kGivenSpread = 0.25;

}  // namespace

Model::Model(const chain::Chain& base) : start_(base.start) {
  int number = 0;
  for (const auto& block : base.blocks) {
    slots_.push_back({next_id_, ++number, block, block});
    for (std::size_t k = 0; k < block.parameters().size(); ++k) {
      const auto& p = block.parameters()[k];
      if (!p.free) continue;
      Unknown u;
      u.name = fmt::format("block {} {}", number, p.name());
      u.value = p.value;
      u.low = p.min();
      u.high = p.max();
      u.parameter = p.key();
      u.unit = p.unit();
      u.logarithmic = p.min() >= 0.0 && p.value > 0.0;
      u.scale = p.value != 0.0 ? std::abs(p.value) : 1e-3;
      // A free parameter's value in the file is a guess, but not any guess: it decides where the records do
      // not (a sine cannot tell gain, frequency and damping of a resonator apart).
      u.given = p.value;
      u.given_spread = u.logarithmic ? kGivenSpread : kGivenSpread * std::abs(p.value);
      free_.push_back({next_id_, k, u});
    }
    ++next_id_;
  }
}

void Model::set_signal_size(double size) {
  for (auto& f : free_) {
    const bool is_signal = f.unknown.unit == "y" || f.unknown.unit == "u";
    if (is_signal && f.unknown.value == 0.0 && size > 0.0) f.unknown.scale = kGivenSpread * size;
  }
}

std::size_t Model::position_of(int id) const {
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (slots_[i].id == id) return i;
  }
  throw std::logic_error("gap::Model: no block with this id");
}

int Model::insert(std::size_t position, chain::Block block) {
  slots_.insert(slots_.begin() + static_cast<std::ptrdiff_t>(position), Slot{next_id_, 0, block, block});
  return next_id_++;
}

std::string Model::placed(std::size_t position) const {
  for (std::size_t i = position; i < slots_.size(); ++i) {
    if (slots_[i].base_number > 0) return fmt::format("before block {}", slots_[i].base_number);
  }
  int last = 0;
  for (const auto& slot : slots_) last = std::max(last, slot.base_number);
  return last == 0 ? "at the input" : fmt::format("after block {}", last);
}

void Model::add(Term term) {
  terms_.push_back(std::move(term));
  set_values(values());
}

void Model::remove(std::size_t term) {
  const Term gone = terms_[term];
  terms_.erase(terms_.begin() + static_cast<std::ptrdiff_t>(term));
  const auto has = [](const Term& t, int id) {
    return std::find(t.blocks.begin(), t.blocks.end(), id) != t.blocks.end();
  };
  std::erase_if(slots_, [&](const Slot& slot) {
    return has(gone, slot.id) &&
           std::none_of(terms_.begin(), terms_.end(), [&](const Term& t) { return has(t, slot.id); });
  });
  for (Slot& slot : slots_) slot.block = slot.given;
  set_values(values());
}

void Model::move_term(std::size_t from, std::size_t to) {
  Term term = std::move(terms_[from]);
  terms_.erase(terms_.begin() + static_cast<std::ptrdiff_t>(from));
  terms_.insert(terms_.begin() + static_cast<std::ptrdiff_t>(to), std::move(term));
}

std::vector<int> Model::line_blocks() const {
  std::vector<int> all;
  for (const auto& slot : slots_) {
    if (slot.base_number == 0 && slot.block.type().name() == "hum") all.push_back(slot.id);
  }
  return all;
}

std::size_t Model::end() const {
  const auto lines = line_blocks();
  std::size_t end = size();
  while (end > 0 && std::find(lines.begin(), lines.end(), slots_[end - 1].id) != lines.end()) --end;
  return end;
}

bool Model::opamps_are_known() const {
  return std::any_of(slots_.begin(), slots_.end(), [](const Slot& slot) {
    const auto& parts = slot.block.parts;
    return parts &&
           std::any_of(parts->begin(), parts->end(), [](const auto& p) { return !p.noise_gain.empty(); });
  });
}

std::size_t Model::first_unknown_of(std::size_t term) const {
  std::size_t at = free_.size();
  for (std::size_t k = 0; k < term; ++k) at += terms_[k].unknowns.size();
  return at;
}

std::vector<Unknown> Model::unknowns() const {
  std::vector<Unknown> all;
  for (const auto& f : free_) all.push_back(f.unknown);
  for (const auto& t : terms_) all.insert(all.end(), t.unknowns.begin(), t.unknowns.end());
  return all;
}

std::vector<double> Model::values() const {
  std::vector<double> all;
  for (const auto& u : unknowns()) all.push_back(u.value);
  return all;
}

void Model::set_values(std::span<const double> values) {
  std::size_t at = 0;
  for (auto& f : free_) {
    f.unknown.value = values[at];
    block(f.id).parameters()[f.parameter].value = values[at++];
  }
  for (auto& t : terms_) {
    for (auto& u : t.unknowns) u.value = values[at++];
  }
  // A term may rewrite what a free parameter set (an effect inside a block starts from the block's own
  // values), and some read what the others wrote.
  for (const bool readers : {false, true}) {
    at = free_.size();
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      const std::size_t count = terms_[k].unknowns.size();
      const auto write = terms_[k].write;
      if (terms_[k].reads_base_blocks == readers) write(*this, values.subspan(at, count));
      at += count;
    }
  }
}

chain::Chain Model::chain() const {
  chain::Chain c;
  c.start = start_;
  for (const auto& slot : slots_) c.blocks.push_back(slot.block);
  return c;
}

chain::Chain Model::linear_part(std::size_t position) const {
  chain::Chain c;
  for (const std::size_t last = end(); position < last; ++position) {
    if (is_linear(position)) c.blocks.push_back(at(position));
  }
  return c;
}

std::string Model::validation_error() const {
  for (const auto& slot : slots_) {
    if (const auto error = slot.block.validate()) return error->text();
  }
  return {};
}

}  // namespace bodesmith::gap
