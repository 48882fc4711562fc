#include "gap/proposal.hpp"

#include <algorithm>
#include <utility>

namespace bodesmith::gap {
namespace {

/// Writes the unknowns' values into a block: by `write`, or each as the parameter of its name.
std::function<void(Model&, std::span<const double>)> writer(int id, const std::vector<Unknown>& unknowns,
                                                            BlockWriter write) {
  if (write) return [id, write](Model& m, std::span<const double> v) { write(m.block(id), v); };
  std::vector<std::string> names;
  for (const auto& u : unknowns) names.push_back(u.name);
  return [id, names](Model& model, std::span<const double> values) {
    auto& block = model.block(id);
    for (std::size_t k = 0; k < names.size(); ++k) block.set(names[k], values[k]);
  };
}

const chain::Parameter* find_parameter(const chain::Block& block, std::string_view name) {
  const auto& all = block.parameters();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const chain::Parameter& p) { return p.name() == name; });
  return found == all.end() ? nullptr : &*found;
}

/// What the block's parameters tell of the unknowns: keys and units, and starts where there are none.
void add_parameters(std::vector<Unknown>& unknowns, Starts& starts, const chain::Block& block) {
  std::vector<double> start;
  for (auto& u : unknowns) {
    const auto* parameter = find_parameter(block, u.name);
    start.push_back((parameter != nullptr ? parameter->value : 0.0) + 0.1 * u.scale);
    if (parameter == nullptr) continue;
    u.parameter = parameter->key();
    u.unit = parameter->unit();
  }
  if (starts.empty()) starts.push_back(std::move(start));
}

/// The term with its unknowns, which block `id` of the model has.
Proposal propose_in_block(Model model, int id, Term term, std::vector<Unknown> unknowns, Starts starts,
                          BlockWriter write) {
  add_parameters(unknowns, starts, model.block(id));
  term.write = writer(id, unknowns, std::move(write));
  term.unknowns = std::move(unknowns);
  return propose_term(std::move(model), std::move(term), std::move(starts));
}

}  // namespace

Proposal insert_block(const Scene& scene, std::size_t position, chain::Block block,
                      std::vector<Unknown> unknowns, Starts starts, BlockWriter write) {
  Model model = *scene.model;
  Term term;
  term.placed = model.placed(position);
  const int id = model.insert(position, std::move(block));
  term.blocks = {id};
  return propose_in_block(std::move(model), id, std::move(term), std::move(unknowns), std::move(starts),
                          std::move(write));
}

Proposal change_block(const Scene& scene, std::size_t position, std::vector<Unknown> unknowns, Starts starts,
                      BlockWriter write) {
  Term term;
  term.placed = inside_block(*scene.model, position);
  term.part = scene.model->at(position).part;
  return propose_in_block(*scene.model, scene.model->id_at(position), std::move(term), std::move(unknowns),
                          std::move(starts), std::move(write));
}

Proposal change_part(const Scene& scene, std::size_t position, std::size_t which) {
  const chain::Block good = scene.model->at(position);
  const chain::PartChange part = (*good.parts)[which];
  const double most = part.most();
  const double start = part.is_offset() ? part.tolerance : 2.0;
  const int id = scene.model->id_at(position);
  Term term;
  term.placed = part.part + " " + inside_block(*scene.model, position);
  term.part = part.part;
  term.unknowns = {linear_unknown(part.is_offset() ? "off_v" : "off_percent", -most, most, start)};
  term.write = [id, good, part](Model& m, std::span<const double> v) { m.block(id) = good.with(part, v[0]); };
  return propose_term(*scene.model, std::move(term), {{start}});
}

Proposal propose_term(Model model, Term term, Starts starts) {
  for (std::size_t k = 0; k < term.unknowns.size(); ++k) term.unknowns[k].value = starts.front()[k];
  model.add(std::move(term));
  return {std::move(model), std::move(starts)};
}

std::string inside_block(const Model& model, std::size_t position) {
  return "inside block " + std::to_string(model.base_number(position));
}

Unknown linear_unknown(std::string name, double low, double high, double scale) {
  return {.name = std::move(name), .low = low, .high = high, .scale = scale};
}

Unknown logarithmic_unknown(std::string name, double low, double high) {
  return {.name = std::move(name), .low = low, .high = high, .logarithmic = true};
}

std::vector<std::size_t> places_of_unused(const Scene& scene, std::string_view key) {
  std::vector<std::size_t> places;
  for (std::size_t at : scene.base_places()) {
    const auto* parameter = find_parameter(scene.model->at(at), key);
    if (parameter != nullptr && !parameter->free && parameter->value == 0.0) places.push_back(at);
  }
  return places;
}

bool is_refitted(const Model& model, std::string_view key) {
  const auto unknowns = model.unknowns();
  return std::any_of(unknowns.begin(), unknowns.end(), [&](const Unknown& u) { return u.parameter == key; });
}

}  // namespace bodesmith::gap
