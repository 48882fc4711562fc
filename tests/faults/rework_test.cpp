// What mends a board and where to measure next, against a search of everything.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "circuits.hpp"
#include "faults/circuit_board.hpp"
#include "faults/diagnosis.hpp"
#include "schematic/analysis/response.hpp"

namespace bodesmith::faults {
namespace {

struct Made {
  synthesis::Circuit circuit = small_circuit();
  std::vector<Hertz> grid = small_grid(12);
  std::unique_ptr<CircuitBoard> board;
  std::vector<Fault> faults;

  Made() {
    Measurement measurement;
    measurement.channels.push_back(seen(grid, schematic::network_response(circuit, grid), 1));
    board = std::make_unique<CircuitBoard>(circuit, measurement, Spread());
    faults = board->faults();
  }
  /// A part of another value as the only fault.
  Suspect wrong(std::size_t part, double factor, double probability = 0.5) const {
    const double sign = factor > 1.0 ? 1.0 : -1.0;
    for (const Fault& fault : faults) {
      const double t = std::log(std::abs(std::log(factor)));
      if (fault.kind->name() != "value_off" || fault.parts[0] != circuit.parts[part].name) continue;
      if ((fault.size(t).value > circuit.parts[part].realised) != (sign > 0.0)) continue;
      Suspect out;
      out.site = fault.site;
      out.probability = probability;
      out.best.faults = {&fault};
      out.best.sizes = {t};
      return out;
    }
    return {};
  }
  double error_percent(const Effect& effect) const {
    const Eigen::VectorXcd got = board->response(effect), good = board->response({});
    double worst = 0.0;
    for (Eigen::Index k = 0; k < got.size(); ++k)
      worst = std::max(worst, 100.0 * std::abs(got(k) / good(k) - 1.0));
    return worst;
  }
};

/// A resistor that is too large has the missing conductance soldered across, a capacitor that is too small what it lacks.
TEST(Rework, OnePartAcrossMendsWhicheverIsWrong) {
  const Made made;
  std::size_t mended = 0;
  for (std::size_t part = 0; part < made.circuit.parts.size(); ++part) {
    const bool resistor = made.circuit.parts[part].kind == schematic::Part::Kind::resistor;
    for (const double by : {1.03, 2.0, 6.0}) {
      const auto off = [&](double more) { return resistor ? by * more : 1.0 / (by * more); };
      const std::vector<Suspect> rivals = {made.wrong(part, off(1.0)), made.wrong(part, off(1.002))};
      ASSERT_EQ(rivals[0].best.faults.size(), 1u);
      const std::vector<Rework> found = rework_for(*made.board, rivals);
      ASSERT_EQ(found.size(), 2u) << made.circuit.parts[part].name << " " << by;
      ASSERT_TRUE(found[0].across.has_value());
      EXPECT_EQ(found[0].parts, 1u);
      // Whatever else could be soldered there leaves as much.
      double least = 1e300;
      for (int i = 0; i <= 1400; ++i) {
        const Effect added =
            made.board->in_parallel(found[0].across->part, std::exp(-7.0 + 14.0 * i / 1400.0));
        double worst = 0.0;
        for (const Suspect& rival : rivals)
          worst = std::max(worst, made.error_percent(joined(rival.best.effect(), added)));
        least = std::min(least, worst);
      }
      EXPECT_LE(found[0].error_percent, least + 0.05);
      const double nominal = made.board->soldered_parts()[found[0].across->part].nominal;
      const Effect added = made.board->in_parallel(found[0].across->part, found[0].across->value / nominal);
      double left = 0.0;
      for (const Suspect& rival : rivals)
        left = std::max(left, made.error_percent(joined(rival.best.effect(), added)));
      EXPECT_NEAR(found[0].error_percent, left, 1e-9);
      if (found[0].across->part == part && by == 2.0) {
        EXPECT_NEAR(found[0].across->value / nominal, resistor ? 2.0 : 0.5, 0.02);
        ++mended;
      }
      EXPECT_FALSE(found[1].across.has_value());
      EXPECT_EQ(found[1].parts, 1u);
    }
  }
  EXPECT_GT(mended, made.circuit.parts.size() / 2);
  // Nothing to add where one is accused alone; where both ways are open, all that are accused are exchanged.
  EXPECT_EQ(rework_for(*made.board, std::vector{made.wrong(0, 2.0)}).size(), 1u);
  EXPECT_TRUE(rework_for(*made.board, {}).empty());
  const std::vector<Rework> two =
      rework_for(*made.board, std::vector{made.wrong(0, 3.0), made.wrong(1, 0.3)});
  EXPECT_EQ(two.back().parts, 2u);
}

/// Every pair of rivals at every node, by the formulas written out here.
TEST(Rework, TheNextProbeIsWhereTheRivalsDifferMost) {
  const Made made;
  const std::vector<Suspect> rivals = {made.wrong(0, 2.0, 0.5), made.wrong(2, 0.5, 0.3),
                                       made.wrong(4, 1.5, 0.2)};
  const auto probe = next_probe(*made.board, rivals);
  ASSERT_TRUE(probe.has_value());
  double most = 0.0;
  std::string best;
  for (const std::string& node : made.board->probe_nodes()) {
    double told = 0.0, largest = 0.0, at_hz = 0.0, db = 0.0, deg = 0.0;
    std::vector<std::string> apart;
    for (std::size_t i = 0; i < rivals.size(); ++i) {
      for (std::size_t j = i + 1; j < rivals.size(); ++j) {
        const Eigen::VectorXcd a = made.board->at_node(node, rivals[i].best.effect()),
                               b = made.board->at_node(node, rivals[j].best.effect());
        double size = 0.0;
        for (Eigen::Index k = 0; k < a.size(); ++k) {
          if (std::abs(a(k)) < 3e-3 && std::abs(b(k)) < 3e-3) continue;
          const std::complex<double> ratio = std::log((a(k) + 3e-4) / (b(k) + 3e-4));
          size = std::max(size, std::abs(ratio));
          if (std::abs(ratio) > largest) {
            largest = std::abs(ratio);
            at_hz = made.grid[static_cast<std::size_t>(k)].value;
            db = std::abs(ratio.real()) * 20.0 / std::log(10.0);
            deg = std::abs(ratio.imag()) * 180.0 / M_PI;
          }
        }
        told += rivals[i].probability * rivals[j].probability * std::min(size / 0.012, 10.0);
        if (size > 0.036) apart.push_back(rivals[i].site + " from " + rivals[j].site);
      }
    }
    if (told > most) {
      most = told;
      best = node;
    }
    if (node != probe->node) continue;
    EXPECT_NEAR(probe->at.value, at_hz, 1e-9);
    EXPECT_NEAR(probe->db, db, 1e-9);
    EXPECT_NEAR(probe->deg, deg, 1e-9);
    EXPECT_NEAR(probe->factor, largest / 0.012, 1e-9);
    EXPECT_EQ(probe->tells_apart, apart);
  }
  EXPECT_EQ(probe->node, best);
  // The same board twice is told apart nowhere.
  EXPECT_FALSE(next_probe(*made.board, std::vector{made.wrong(0, 2.0), made.wrong(0, 2.0)}).has_value());
}

}  // namespace
}  // namespace bodesmith::faults
