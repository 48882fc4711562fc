// Drawn boards, soldered by other code and measured by ngspice: a short version of faults_batch.
#include <gtest/gtest.h>

#include <algorithm>

#include "boards/built.hpp"
#include "circuits.hpp"
#include "faults/circuit_board.hpp"
#include "faults/diagnosis.hpp"
#include "schematic/ngspice/ngspice.hpp"

namespace bodesmith::faults {
namespace {

Diagnosis diagnosed_board(const synthesis::Circuit& designed, const BuiltBoard& board, Random& random) {
  const std::vector<Hertz> grid = small_grid(30);
  Measurement measurement{{measured(response_of(board, grid), grid, 0.02, 0.1, true, random)}};
  const CircuitBoard as_designed(designed, measurement, Spread());
  return diagnose_board(as_designed, DiagnosisOptions());
}

bool has_the_right_one(const Diagnosis& d, const BuiltBoard& board) {
  for (std::size_t i = 0; i < d.tied; ++i) {
    for (const Fault* fault : d.suspects[i].best.faults) {
      for (const std::string& part : fault->parts) {
        const std::vector<std::string>& right = board.wrong[0];
        if (std::find(right.begin(), right.end(), part) != right.end()) return true;
      }
    }
  }
  return false;
}

TEST(BlindBoards, GoodOnesAreNotAccused) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  const synthesis::Circuit circuit = small_circuit();
  Random random(21);
  const BuiltBoard board = good_board(circuit, 1.0, 1.0, random);
  EXPECT_EQ(diagnosed_board(circuit, board, random).verdict, Verdict::nothing_wrong);
}

TEST(BlindBoards, DrawnFaultsAreFound) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed";
  const synthesis::Circuit circuit = small_circuit();
  int visible = 0;
  int right = 0;
  for (std::uint64_t seed = 101; seed < 104; ++seed) {
    Random random(seed);
    BuiltBoard board = good_board(circuit, 1.0, 1.0, random);
    spoil(board, random);
    const Diagnosis d = diagnosed_board(circuit, board, random);
    if (d.verdict == Verdict::nothing_wrong) continue;  // some faults change nothing that can be seen
    ++visible;
    const bool found = has_the_right_one(d, board);
    right += found ? 1 : 0;
    if (!found) std::printf("missed: %s\n", board.words.c_str());
  }
  EXPECT_GE(visible, 2);
  EXPECT_GE(right, visible - 1);
}

}  // namespace
}  // namespace bodesmith::faults
