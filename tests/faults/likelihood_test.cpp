// The density of a measurement: what small additions and a roughly known fault do to it.
#include "faults/likelihood.hpp"

#include <gtest/gtest.h>

#include "circuits.hpp"
#include "faults/circuit_board.hpp"
#include "schematic/analysis/response.hpp"

namespace bodesmith::faults {
namespace {

constexpr double kNoise = 2e-3;

CircuitBoard measured_board(const synthesis::Circuit& circuit, const std::vector<Hertz>& grid,
                            std::uint64_t seed) {
  Measurement measurement{{seen(grid, schematic::network_response(circuit, grid), seed, true, kNoise)}};
  return CircuitBoard(circuit, measurement, Spread());
}

/// Crosstalk 60 dB below the signal moves its phase by no more than by a milliradian.
TEST(BoardLikelihood, TheNoiseIsWhatItIsSaidToBe) {
  const synthesis::Circuit circuit = small_circuit();
  const std::vector<Hertz> grid = small_grid(60);
  double misfit = 0.0;
  double rows = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const CircuitBoard board = measured_board(circuit, grid, seed);
    const Likelihood likelihood(board, board.predict({}), {kNoise, kNoise});
    misfit += likelihood.misfit();
    rows += likelihood.rows();
  }
  EXPECT_GT(misfit / rows, 0.75);
  EXPECT_LT(misfit / rows, 1.1);
}

/// A model's error of 2 % that is smooth is expected; one that jumps from point to point is not.
TEST(BoardLikelihood, TheErrorOfARoughFaultIsSmooth) {
  const synthesis::Circuit circuit = small_circuit();
  const std::vector<Hertz> grid = small_grid(60);
  const CircuitBoard board = measured_board(circuit, grid, 3);
  Prediction prediction = board.predict({});
  prediction.reference = prediction.response * std::exp(-1.0);  // everything changed by one neper
  const Noise noise{kNoise, kNoise};
  const Likelihood exact(board, prediction, noise);
  prediction.model_error = 0.02;
  const Likelihood rough(board, prediction, noise);
  Eigen::VectorXd smooth = rough.residual();
  Eigen::VectorXd jumping = rough.residual();
  for (Eigen::Index k = 0; k < smooth.size(); ++k) {
    const double at = static_cast<double>(k % 60) / 60.0;
    smooth(k) += 0.02 * std::sin(9.0 * at);
    jumping(k) += k % 2 == 0 ? 0.02 : -0.02;
  }
  EXPECT_GT(rough.log_density_of(smooth), exact.log_density_of(smooth) + 20.0);
  EXPECT_GT(rough.log_density_of(smooth), rough.log_density_of(jumping) + 100.0);
  // What needs no such error costs a rough fault little.
  EXPECT_GT(rough.log_density(), exact.log_density() - 120.0);
}

}  // namespace
}  // namespace bodesmith::faults
