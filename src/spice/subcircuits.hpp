#pragma once

#include <string>
#include <vector>

namespace bodesmith::spice {

/// A subcircuit as found in a library text: its name and pins.
struct Subcircuit {
  std::string name;
  std::vector<std::string> pins;
  int line = 0;
};
/// Every top-level .subckt of a library. Throws InputError with file and line when one is not ended.
std::vector<Subcircuit> list_subcircuits(const std::string& text, const std::string& file);

/// The name of the one with two pins (`in out`): `wanted`, or when that is empty "compensator" when there is
/// one, otherwise the last. Throws InputError when there is none.
std::string pick_subcircuit(const std::vector<Subcircuit>& all, const std::string& wanted,
                            const std::string& file);

}  // namespace bodesmith::spice
