#pragma once

#include <vector>

#include "chain/block.hpp"

namespace bodesmith::chain {

// One function a file of this folder; registry.cpp lists them.
const BlockType& gain_block();
const BlockType& lowpass_block();
const BlockType& pole_zero_block();
const BlockType& fractional_lead_lag_block();
const BlockType& resonator_block();
const BlockType& delay_block();
const BlockType& saturation_block();
const BlockType& slew_limit_block();
const BlockType& dead_zone_block();
const BlockType& backlash_block();
const BlockType& polynomial_block();
const BlockType& creep_block();
const BlockType& hum_block();
const BlockType& drift_block();
const BlockType& sample_hold_block();
const BlockType& opamp_block();
const BlockType& multiplier_block();
const BlockType& voltage_controlled_gain_block();
const BlockType& comparator_block();
const BlockType& switched_capacitor_block();
const BlockType& noise_block();
/// One block type for each model of hysteresis/registry.hpp.
std::vector<const BlockType*> hysteresis_blocks();

/// Name, one-line description and parameters in the constructor; the rest in the type's own class.
class NamedBlockType : public BlockType {
 public:
  NamedBlockType(std::string name, std::string what, std::vector<ParameterSpec> specs)
      : name_(std::move(name)), what_(std::move(what)), specs_(std::move(specs)) {}
  std::string_view name() const override { return name_; }
  std::string_view what() const override { return what_; }
  const std::vector<ParameterSpec>& specs() const override { return specs_; }

 private:
  std::string name_;
  std::string what_;
  std::vector<ParameterSpec> specs_;
};

/// Shorthands for specs.
inline ParameterSpec any_number(std::string name, std::string what,
                                std::optional<double> standard = std::nullopt) {
  ParameterSpec s;
  s.name = std::move(name);
  s.what = std::move(what);
  s.standard = standard;
  return s;
}
inline ParameterSpec above_zero(std::string name, std::string what,
                                std::optional<double> standard = std::nullopt) {
  ParameterSpec s = any_number(std::move(name), std::move(what), standard);
  s.low = 0.0;
  s.low_excluded = true;
  return s;
}
inline ParameterSpec not_negative(std::string name, std::string what,
                                  std::optional<double> standard = std::nullopt) {
  ParameterSpec s = any_number(std::move(name), std::move(what), standard);
  s.low = 0.0;
  return s;
}
inline ParameterSpec list_of(ParameterSpec entry) {
  entry.shape = ParameterSpec::Shape::list;
  return entry;
}

}  // namespace bodesmith::chain
