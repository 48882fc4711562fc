#pragma once

#include <vector>

#include "synthesis/generator/layout.hpp"
#include "synthesis/parts/netlist_maker.hpp"

/// The steps of make_layout(), for its own files only.
namespace bodesmith::generator {

constexpr int kMostPowers = 7;
constexpr std::size_t kMostBranches = 64;
/// Greatest |voltage| aimed at, as a share of full scale: room for what E-series resistors round.
constexpr double kRoom = 0.97;

/// Node voltage of x^k at x = 1: U^(1-k).
double level(const MultiplierModel& m, int power);
std::string power_text(int power);
/// "a" and "d" for two branches, "" for one, "1_", "2_", … for more: between the kind and the number of a
/// part.
std::string branch_letter(std::size_t branch, std::size_t count);

/// Throws DesignError when a multiplier would have to leave its output range.
void check_outputs(const Layout& layout);

/// The groups in the order of the netlist.
void arrange(Layout& layout);
/// Of what is not in the signal path.
const synthesis::Series& capacitors();

/// Powers, sums, chains, output amplifier and slope detector for this group size.
Layout build(const Input& input, const Options& options, int group);
/// Control voltages and voltage-controlled gains.
void add_amplitude(Layout& layout, const Input& input, const Options& options);
void add_nodes(Layout& layout);
/// Every group size from 1 to the degree; marks the one to build.
std::vector<Candidate> compare_schemes(const Input& input, const Options& options);

}  // namespace bodesmith::generator
