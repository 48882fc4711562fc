#include "gap/effect.hpp"

#include <algorithm>
#include <cmath>

#include "signal/statistics.hpp"

namespace bodesmith::gap {

double Signal::size() const {
  return std::max({std::abs(low), std::abs(high), 1e-300});
}

double Signal::slope_quantile(double q) const {
  if (sorted_slopes.empty()) return 1.0;
  return sorted_slopes[static_cast<std::size_t>(q * static_cast<double>(sorted_slopes.size() - 1))];
}

double Signal::value_quantile(double q) const {
  return quantile(values, q);
}

bool Scene::linear(std::size_t position) const {
  return model->at(position).response(RadPerSecond{1.0}).has_value();
}

bool Scene::scaling(std::size_t position) const {
  const auto& block = model->at(position);
  return block.type_name() == "gain" && block.get("offset") == 0.0;
}

std::vector<std::size_t> Scene::linear_places() const {
  std::vector<std::size_t> places;
  // The last boundary of every stretch of linear blocks (all of them stand for the same model).
  for (std::size_t i = 0; i <= model->size(); ++i) {
    if (i == model->size() || !linear(i)) places.push_back(i);
  }
  return places;
}

std::vector<std::size_t> Scene::static_places() const {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i <= model->size(); ++i) {
    if (i == model->size() || !scaling(i)) places.push_back(i);
  }
  return places;
}

namespace {

std::function<void(Model&, std::span<const double>)> setter(int id, const std::vector<Unknown>& unknowns) {
  std::vector<std::string> names;
  for (const auto& u : unknowns) names.push_back(u.name);
  return [id, names](Model& model, std::span<const double> values) {
    auto& block = model.block(id);
    for (std::size_t k = 0; k < names.size(); ++k) block.set(names[k], values[k]);
  };
}

}  // namespace

Proposal insert_block(const Scene& scene, const Effect& effect, std::size_t position, chain::Block block,
                      std::vector<Unknown> unknowns, std::vector<std::vector<double>> starts) {
  Proposal p{*scene.model, std::move(starts)};
  Term term;
  term.effect = &effect;
  term.placed = p.model.placed(position);
  const int id = p.model.insert(position, std::move(block));
  term.blocks = {id};
  for (std::size_t k = 0; k < unknowns.size(); ++k) unknowns[k].value = p.starts.front()[k];
  term.write = setter(id, unknowns);
  term.unknowns = std::move(unknowns);
  p.model.add(std::move(term));
  return p;
}

Proposal change_block(const Scene& scene, const Effect& effect, std::size_t position,
                      std::vector<Unknown> unknowns, std::vector<std::vector<double>> starts) {
  Proposal p{*scene.model, std::move(starts)};
  Term term;
  term.effect = &effect;
  term.placed = "inside block " + std::to_string(p.model.base_number(position));
  const int id = p.model.id_at(position);
  std::vector<std::pair<std::string, double>> before;
  for (std::size_t k = 0; k < unknowns.size(); ++k) {
    before.emplace_back(unknowns[k].name, p.model.at(position).get(unknowns[k].name));
    unknowns[k].value = p.starts.front()[k];
  }
  term.write = setter(id, unknowns);
  term.undo = [id, before](Model& model) {
    for (const auto& [name, value] : before) model.block(id).set(name, value);
  };
  term.unknowns = std::move(unknowns);
  p.model.add(std::move(term));
  return p;
}

Unknown linear_unknown(std::string name, double low, double high, double scale) {
  return {std::move(name), 0.0, low, high, false, scale};
}

Unknown logarithmic_unknown(std::string name, double low, double high) {
  return {std::move(name), 0.0, low, high, true, 1.0};
}

}  // namespace bodesmith::gap
