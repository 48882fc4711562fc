#include <algorithm>
#include <set>

#include "faults/diagnosis.hpp"
#include "numeric/index.hpp"

namespace bodesmith::faults {
namespace {

/// Relative change of the response, above what counts as nothing, that no tolerance and no noise hides.
constexpr double kSeen = 0.05;
constexpr int kSizesTried = 5;

bool shows(const Board& board, const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
  for (Eigen::Index k = 0; k < a.size(); ++k) {
    if (std::abs(a(k) - b(k)) > kSeen * (std::abs(b(k)) + board.floors()[std_index(k)])) return true;
  }
  return false;
}

/// The parts of which some wrong value changes what a board with `there` shows.
std::set<std::string> parts_seen(const Board& board, const std::vector<Fault>& faults, const Effect& there) {
  const std::unique_ptr<ChangedBoard> changed = board.changed_by(there);
  const Eigen::VectorXcd before = changed->response({});
  std::set<std::string> out;
  for (const Fault& fault : faults) {
    // Of a single part that can be exchanged: a place is no part, and an op-amp is seen through its stage's parts. Values
    // alone: an op-amp without feedback would shine through a dead stage as no real one does.
    if (fault.parts.size() != 1 || fault.replaces.empty() || !fault.has_size() ||
        out.contains(fault.parts[0]))
      continue;
    for (const double t : comb(fault, kSizesTried)) {
      if (!shows(board, changed->response(fault.effect(t)), before)) continue;
      out.insert(fault.parts[0]);
      break;
    }
  }
  return out;
}

}  // namespace

std::vector<std::string> hidden_behind(const Board& board, const std::vector<Fault>& faults,
                                       std::span<const Suspect> rivals) {
  std::set<std::string> hidden = parts_seen(board, faults, {});
  for (const Suspect& rival : rivals) {
    if (hidden.empty()) break;
    for (const std::string& part : parts_seen(board, faults, rival.best.effect())) hidden.erase(part);
    for (const Fault* fault : rival.best.faults) {
      for (const std::string& part : fault->parts) hidden.erase(part);
    }
  }
  return {hidden.begin(), hidden.end()};
}

}  // namespace bodesmith::faults
