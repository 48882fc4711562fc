#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "gap/model/model.hpp"
#include "gap/scene.hpp"

namespace bodesmith::gap {

/// Values of a term's unknowns to start a fit from, each set as long as the term has unknowns.
using Starts = std::vector<std::vector<double>>;

/// A candidate: the model with the term as its last one, whose effect is set behind all proposals (Effect::propose), and values of the term's unknowns to start
/// from.
struct Proposal {
  Model model;
  Starts starts;

  const Term& term() const { return model.terms().back(); }
};

/// Turns the values of a term's unknowns into its block's parameters.
using BlockWriter = std::function<void(chain::Block&, std::span<const double>)>;
/// For effects that are one block of their own. Without a writer each unknown's name is the block's parameter, whose unit it gets. Without
/// starts the unknowns (linear ones) begin a tenth of a typical change off what the block has.
Proposal insert_block(const Scene& scene, std::size_t position, chain::Block block,
                      std::vector<Unknown> unknowns, Starts starts = {}, BlockWriter write = {});
/// For effects inside a base block. Writer and starts as of insert_block.
Proposal change_block(const Scene& scene, std::size_t position, std::vector<Unknown> unknowns,
                      Starts starts = {}, BlockWriter write = {});
/// For effects that are a part of a base block (Block::parts) off its value, by percent or volts.
Proposal change_part(const Scene& scene, std::size_t position, std::size_t which);
/// For all others: `model` is the scene's with the term's blocks in it, `term` knows how to write its
/// unknowns; their values become those of the first start.
Proposal propose_term(Model model, Term term, Starts starts);

/// "inside block 2", for a term that changes the base block at `position`.
std::string inside_block(const Model& model, std::size_t position);

Unknown linear_unknown(std::string name, double low, double high, double scale);
Unknown logarithmic_unknown(std::string name, double low, double high);

/// The base model's blocks whose parameter `key` is at 0 and not refitted anyhow: where an effect may set it.
std::vector<std::size_t> places_of_unused(const Scene& scene, std::string_view key);
/// Whether one of the model's unknowns is a block's parameter `key`.
bool is_refitted(const Model& model, std::string_view key);

}  // namespace bodesmith::gap
