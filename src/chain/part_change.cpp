#include "chain/part_change.hpp"

namespace bodesmith::chain {
namespace {

/// Departures of opposite signs that move a parameter to one side by more than this share of the rest: no bilinear form.
constexpr double kOneSided = 0.5;

}  // namespace

void PartChange::add(std::string parameter, double departure, double above, double below) {
  Entry out{std::move(parameter), (above - below) / (2.0 * departure), 0.0};
  if (out.slope == 0.0) return;
  if (std::abs(above + below) < kOneSided * std::abs(above - below)) {
    out.slope = 2.0 / (departure * (1.0 / above - 1.0 / below));
    out.bend = 0.5 * out.slope * (1.0 / above + 1.0 / below);
  }
  entries.push_back(std::move(out));
}

}  // namespace bodesmith::chain
