#pragma once

#include <string>
#include <vector>

#include "gap/cases/case.hpp"

/// Cases measured on decks that ngspice runs: op-amps with bandwidth, slew rate and rails, capacitors, lines,
/// diodes, multipliers, switches. The model is the ideal chain; noise is added afterwards.
namespace hidden {

/// Bases: opamp_gain, opamp_sections, rlc, spring, multipliers, switched.
const std::vector<std::string>& spice_bases();
const std::vector<std::string>& spice_effects(const std::string& base);
/// white, coloured, red, parameters_off.
const std::vector<std::string>& spice_control_kinds();
/// diode (a peak holder).
const std::vector<std::string>& spice_outside_kinds();

/// Throws InputError when ngspice is not installed or fails.
Case make_spice_case(const Specification& specification);

/// A deck with nothing hidden, without noise, beside its model: what checks the decks themselves.
struct CleanDeck {
  std::string model;
  bodesmith::TimeRecord record;
};
CleanDeck make_clean_deck(const std::string& base, std::uint64_t seed, std::size_t rows);

}  // namespace hidden
