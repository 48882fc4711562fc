#include "fpaa/device/mismatch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/documents/json.hpp"
#include "numeric/random.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::fpaa {
namespace {

/// Of a real normal number 95 % lie within so many standard deviations of 0.
constexpr double kTwoSided95 = 1.959963984540054;

}  // namespace

double MismatchModel::relative_sigma(double units) const {
  return units > 0.0 ? unit_percent / 100.0 / std::sqrt(units) : 0.0;
}

double MismatchModel::drawn(double units, double x) const {
  if (!(units > 0.0)) return 0.0;
  return std::max(0.0, units * (1.0 + relative_sigma(units) * x) + systematic_units);
}

Json MismatchModel::to_json() const {
  return {{"unit_capacitor_percent", unit_percent}, {"systematic_units", systematic_units}};
}

MismatchModel MismatchModel::from_node(const Node& node, MismatchModel out) {
  out.unit_percent = node.number_or("unit_capacitor_percent", out.unit_percent);
  out.systematic_units = node.number_or("systematic_units", out.systematic_units);
  if (!(out.unit_percent >= 0.0) || !(out.unit_percent < 100.0))
    node.at("unit_capacitor_percent")
        .fail(fmt::format("is {}, expected 0 or more and less than 100", out.unit_percent));
  if (!(std::abs(out.systematic_units) < 1.0))
    node.at("systematic_units")
        .fail(fmt::format("is {}, expected more than -1 and less than 1", out.systematic_units));
  return out;
}

double error_of_95_percent(std::complex<double> offset, double sigma) {
  return std::abs(offset) + kTwoSided95 * sigma;
}

double error_of_95_percent(std::span<const std::complex<double>> errors,
                           const std::vector<std::vector<std::complex<double>>>& effects, int boards,
                           std::uint64_t seed) {
  Random random(seed);
  std::vector<std::complex<double>> of_board(errors.size());
  std::vector<double> worst(static_cast<std::size_t>(boards), 0.0);  // squared
  for (double& largest : worst) {
    std::ranges::copy(errors, of_board.begin());
    for (const auto& effect : effects) {
      const double x = random.normal();
      for (std::size_t k = 0; k < of_board.size(); ++k) of_board[k] += x * effect[k];
    }
    for (const std::complex<double>& error : of_board) largest = std::max(largest, std::norm(error));
  }
  return std::sqrt(quantile(std::move(worst), 0.95));
}

double NoiseModel::unit_noise_v() const {
  return std::sqrt(kBoltzmann * temperature_k / unit_capacitance_f);
}

double NoiseModel::microvolts(double mean_square_kt_per_cu) const {
  return 1e6 * unit_noise_v() * std::sqrt(std::max(0.0, mean_square_kt_per_cu));
}

Json NoiseModel::to_json() const {
  return {{"unit_capacitance_f", unit_capacitance_f}, {"temperature_k", temperature_k}};
}

SlowParts SlowParts::given(std::optional<double> bandwidth_hz, double opamp_gain,
                           std::optional<double> switch_ohm, double unit_capacitance_f) {
  SlowParts out;
  if (bandwidth_hz) out.opamp = schematic::OpAmpModel::one_pole({*bandwidth_hz}, opamp_gain);
  if (switch_ohm) out.switch_s = *switch_ohm * unit_capacitance_f;
  return out;
}

SlowParts SlowParts::typical(double unit_capacitance_f) {
  return given(20e6, 1e5, 1e3, unit_capacitance_f);
}

Json SlowParts::to_json() const {
  Json out = Json::object();
  if (!opamp.is_ideal) {
    out["gain_bandwidth_hz"] = opamp.gain_bandwidth.value;
    out["gain"] = opamp.dc_gain;
  }
  if (switch_s > 0.0) out["switch_s"] = switch_s;
  return out;
}

SlowParts SlowParts::from_node(const Node& node) {
  SlowParts out;
  if (node.has("gain_bandwidth_hz"))
    out.opamp = schematic::OpAmpModel::one_pole({node.at("gain_bandwidth_hz").positive()},
                                                node.at("gain").positive());
  if (node.has("switch_s")) out.switch_s = node.at("switch_s").positive();
  return out;
}

const char* to_string(UnitArray array) {
  return array == UnitArray::nested ? "nested" : "binary";
}

ExchangedUnits exchanged_units(int from, int to, UnitArray array, double unit_variance) {
  if (from == to || from <= 0 || to <= 0) return {};
  const double shared = array == UnitArray::nested ? std::min(from, to) : from & to;
  const double n = from;
  return {shared / n, unit_variance * (shared * (n - shared) / n + (to - shared))};
}

}  // namespace bodesmith::fpaa
