#include "fpaa/trim/trim.hpp"
#include "base/documents/json.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/seed_sections.hpp"
#include "numeric/random.hpp"
#include "texts.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

double worst_percent_of(const std::vector<Complex>& got, const std::vector<Complex>& wanted) {
  double worst = 0.0;
  for (std::size_t k = 0; k < got.size(); ++k) {
    worst = std::max(worst, 100.0 * std::abs(got[k] / wanted[k] - 1.0));
  }
  return worst;
}

/// The capacitors of one board.
std::vector<double> drawn(const DrawnBoard& board, const MismatchModel& mismatch, Random& random) {
  std::vector<double> out;
  for (const double units : board.nominal_units()) out.push_back(mismatch.drawn(units, random.normal()));
  return out;
}

MeasuredBoard measured_on(const Plan& plan, const std::vector<double>& units, const std::vector<Hertz>& grid,
                          double noise, bool with_phase, Random& random) {
  const DrawnBoard board(plan, grid);
  MeasuredBoard out;
  out.grid = grid;
  for (const Complex& h : board.response(units)) {
    out.gain.push_back(std::abs(h) * std::exp(noise * random.normal()));
    if (with_phase) out.phase_rad.push_back(std::arg(h) + noise * random.normal());
  }
  return out;
}

/// A board drawn unit by unit: what each capacitor is with any number of units.
class UnitBoard {
 public:
  /// Relative: every capacitor keeps its relative error, whatever its units.
  enum class Kind { nested, binary, relative };
  UnitBoard(std::size_t capacitors, Kind kind, double unit_percent, std::uint64_t seed)
      : kind_(kind), k_(unit_percent / 100.0) {
    Random random(seed);
    for (std::size_t c = 0; c < capacitors; ++c) {
      errors_.emplace_back();
      for (int i = 0; i < 255; ++i) errors_[c].push_back(random.normal());
    }
  }
  std::vector<double> sizes(const std::vector<double>& units, const std::vector<double>& designed) const {
    std::vector<double> out;
    for (std::size_t c = 0; c < units.size(); ++c) {
      const int n = static_cast<int>(std::lround(units[c]));
      double excess = 0.0;
      for (int i = 0; kind_ == Kind::nested && i < n; ++i) excess += errors_[c][static_cast<std::size_t>(i)];
      for (int bit = 0; kind_ == Kind::binary && bit < 8; ++bit) {
        if ((n >> bit) & 1) excess += std::sqrt(1 << bit) * errors_[c][static_cast<std::size_t>(bit)];
      }
      if (kind_ == Kind::relative && n > 0) excess = n / std::sqrt(designed[c]) * errors_[c][0];
      out.push_back(n + k_ * excess);
    }
    return out;
  }

 private:
  Kind kind_;
  double k_;
  std::vector<std::vector<double>> errors_;
};

struct BlindSetting {
  int boards = 8;
  int samples = 50;
  int points = 40;
  double noise = 3e-4;
  bool with_phase = true;
  UnitBoard::Kind kind = UnitBoard::Kind::binary;
  UnitArray array = UnitArray::binary;  ///< what the trim takes the units to be
  std::uint64_t seed = 1000;
};

/// Worst complex error over the band, percent, of the true board: as built, after one trim, after a second
/// (measured again).
struct BlindTrim {
  double before = 0.0;
  double after = 0.0;
  double again = 0.0;
};

BlindTrim blind_trim(const Plan& plan, const std::vector<Complex>& wanted, const std::vector<Hertz>& grid,
                     const BlindSetting& setting, std::uint64_t seed, int rounds) {
  TrimOptions options;
  options.array = setting.array;
  options.samples = setting.samples;
  Random random(seed);
  const DrawnBoard designed(plan, grid);
  const UnitBoard truth(designed.capacitor_count(), setting.kind, options.mismatch.unit_percent, seed + 77);
  BlindTrim out;
  Plan now = plan;
  for (int round = 0; round <= rounds; ++round) {
    const DrawnBoard board(now, grid);
    const std::vector<double> sizes = truth.sizes(board.nominal_units(), designed.nominal_units());
    (round == 0   ? out.before
     : round == 1 ? out.after
                  : out.again) = worst_percent_of(board.response(sizes), wanted);
    if (round == rounds) break;
    const MeasuredBoard measured = measured_on(now, sizes, log_grid(plan.error.band, setting.points),
                                               setting.noise, setting.with_phase, random);
    const Trim made = trim_board(now, wanted, grid, measured, options);
    // The changes that it lists are those between the two plans, each once.
    const DrawnBoard trimmed(made.plan, grid);
    std::size_t listed = 0;
    for (std::size_t c = 0; c < board.names().size(); ++c) {
      const double was = board.nominal_units()[c], is = trimmed.nominal_units()[c];
      if (was == is) continue;
      if (listed == made.changes.size()) {
        ADD_FAILURE() << board.names()[c] << " is not among the changes";
        break;
      }
      const TrimmedCapacitor& change = made.changes[listed++];
      EXPECT_EQ(change.name, board.names()[c]);
      EXPECT_EQ(change.before, was);
      EXPECT_EQ(change.after, is);
    }
    EXPECT_EQ(listed, made.changes.size());
    now = made.plan;
    if (!made.improved) continue;
    // What the plan says of itself is of the new capacitors.
    const DrawnBoard nominal(now, grid);
    EXPECT_NEAR(now.error_with_delays.max_complex_percent,
                worst_percent_of(nominal.response(nominal.nominal_units()), wanted), 1e-6);
    EXPECT_FALSE(now.total);
  }
  return out;
}

struct BlindResult {
  double before_95 = 0.0;
  double after_95 = 0.0;
  double again_95 = 0.0;
  int worse = 0;
};

BlindResult blind_boards(const Plan& plan, const BlindSetting& setting, int rounds = 1) {
  const std::vector<Hertz> grid = trim_grid(plan, {});
  const DrawnBoard designed(plan, grid);
  const std::vector<Complex> wanted = designed.response(designed.nominal_units());
  std::vector<double> before, after, again;
  BlindResult out;
  for (int b = 0; b < setting.boards; ++b) {
    const BlindTrim one =
        blind_trim(plan, wanted, grid, setting, setting.seed + static_cast<std::uint64_t>(b), rounds);
    before.push_back(one.before);
    after.push_back(one.after);
    again.push_back(one.again);
    out.worse += one.after > one.before * (1.0 + 1e-12) ? 1 : 0;
  }
  const auto p95 = [&](std::vector<double>& values) {
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(0.95 * (setting.boards - 1))];
  };
  out.before_95 = p95(before);
  out.after_95 = p95(after);
  out.again_95 = p95(again);
  std::printf("95 %% before %.4f after %.4f (%.3f) again %.4f (%.3f), worse %d\n", out.before_95,
              out.after_95, out.after_95 / out.before_95, out.again_95, out.again_95 / out.before_95,
              out.worse);
  return out;
}

TEST(Trim, BringsBoardsToAFifthAndNoneFurtherAway) {
  using Kind = UnitBoard::Kind;
  for (const Kind kind : {Kind::binary, Kind::nested, Kind::relative}) {
    const BlindResult boards = blind_boards(seed_plan(), {.boards = 5, .kind = kind});
    EXPECT_LT(boards.after_95, 0.2 * boards.before_95);
    EXPECT_EQ(boards.worse, 0);
  }
}

/// Four frequencies leave a second measurement something to tell.
TEST(Trim, MeasuredAndTrimmedAgainIsBetterStill) {
  const BlindResult boards =
      blind_boards(seed_plan(), {.boards = 5, .samples = 200, .points = 4, .seed = 700}, 2);
  EXPECT_LT(boards.again_95, boards.after_95);
  EXPECT_LT(boards.again_95, 0.3 * boards.before_95);
}

/// The same sections with the clocks searched: their capacitors are chosen for little mismatch and leave less to trim.
TEST(Trim, HelpsPlansOfSeveralClocksToo) {
  const Plan plan = plan_of(seed_sections());
  EXPECT_GT(plan.clocks_hz().size(), 1u);
  const BlindResult boards = blind_boards(plan, {.boards = 3, .noise = 1e-4, .seed = 500});
  EXPECT_LT(boards.after_95, 0.3 * boards.before_95);
  EXPECT_EQ(boards.worse, 0);
}

TEST(Trim, FewFrequenciesAndMagnitudesAloneHelpToo) {
  const BlindResult few = blind_boards(seed_plan(), {.boards = 3, .points = 5, .seed = 2000});
  EXPECT_LT(few.after_95, 0.25 * few.before_95);
  EXPECT_EQ(few.worse, 0);
  const BlindResult magnitudes = blind_boards(seed_plan(), {.boards = 3, .with_phase = false, .seed = 3000});
  EXPECT_LT(magnitudes.after_95, 0.3 * magnitudes.before_95);
  EXPECT_EQ(magnitudes.worse, 0);
}

TEST(Trim, KeepsTheCapacitorsWhereTheMeasurementSaysNothing) {
  // 5 % of noise at three frequencies, on boards that are off by less.
  const BlindResult noisy =
      blind_boards(seed_plan(), {.boards = 3, .points = 3, .noise = 0.05, .seed = 4000});
  EXPECT_EQ(noisy.worse, 0);
}

TEST(Trim, FindsTheNoiseOfTheMeasurement) {
  Random random(7);
  const Plan& plan = seed_plan();
  const DrawnBoard board(plan, log_grid(plan.error.band, 60));
  const std::vector<double> truth = drawn(board, {}, random);
  const MeasuredBoard measured = measured_on(plan, truth, board.grid(), 1e-3, true, random);
  const BoardEstimate estimate = estimate_board(plan, measured, {});
  EXPECT_NEAR(estimate.noise / 1e-3, 1.0, 0.25);
  // The estimate is nearer than the plan where it matters: the response.
  std::vector<double> units = board.nominal_units();
  for (std::size_t c = 0; c < units.size(); ++c) units[c] *= std::exp(estimate.error[c]);
  const auto real = board.response(truth);
  EXPECT_LT(worst_percent_of(board.response(units), real),
            0.5 * worst_percent_of(board.response(board.nominal_units()), real));
}

TEST(Trim, RefusesAMeasurementOfAnotherBoard) {
  Random random(1);
  const DrawnBoard board(seed_plan(), log_grid(seed_plan().error.band, 10));
  MeasuredBoard measured = measured_on(seed_plan(), board.nominal_units(), board.grid(), 0.0, true, random);
  for (double& gain : measured.gain) gain *= 3.0;
  EXPECT_THROW(estimate_board(seed_plan(), measured, {}), DesignError);
}

/// The estimate is where prior and measurement balance, x/sigma^2 = S' (y - S x)/s^2, and its root is one of (1/sigma^2 + S' S/s^2)^-1.
TEST(Trim, TheEstimateBalancesPriorAndMeasurement) {
  Random random(17);
  const Plan& plan = seed_plan();
  const MismatchModel mismatch{0.2, 0.0};
  const DrawnBoard board(plan, log_grid(plan.error.band, 7));
  for (const bool with_phase : {true, false}) {
    MeasuredBoard measured =
        measured_on(plan, drawn(board, mismatch, random), board.grid(), 1e-3, with_phase, random);
    measured.deviation = 1e-3;
    const BoardEstimate got = estimate_board(plan, measured, mismatch);
    EXPECT_EQ(got.noise, 1e-3);
    const std::vector<double>& nominal = board.nominal_units();
    std::vector<double> units = nominal;
    for (std::size_t c = 0; c < units.size(); ++c) units[c] *= std::exp(got.error[c]);
    const std::vector<Complex> h = board.response(units);
    const auto slopes = board.sensitivities(units);
    for (std::size_t c = 0; c < units.size(); ++c) {
      const double prior = std::pow(mismatch.relative_sigma(nominal[c]), -2.0);
      double pull = 0.0;
      for (std::size_t k = 0; k < h.size(); ++k) {
        pull += slopes[c][k].real() * std::log(measured.gain[k] / std::abs(h[k])) * 1e6;
        if (with_phase)
          pull += slopes[c][k].imag() * std::arg(std::polar(1.0, measured.phase_rad[k]) / h[k]) * 1e6;
      }
      EXPECT_NEAR(got.error[c] * prior, pull, 1e-3 * std::sqrt(prior)) << board.names()[c];
      for (std::size_t d = 0; d < units.size(); ++d) {
        double unity = 0.0;  // row c of (1/sigma^2 + S' S/s^2) P, column d
        for (std::size_t e = 0; e < units.size(); ++e) {
          double covariance = 0.0;
          for (std::size_t i = 0; i < got.root[e].size(); ++i) covariance += got.root[e][i] * got.root[d][i];
          double precision = e == c ? prior : 0.0;
          for (std::size_t k = 0; k < h.size(); ++k)
            precision += 1e6 * (slopes[c][k].real() * slopes[e][k].real() +
                                (with_phase ? slopes[c][k].imag() * slopes[e][k].imag() : 0.0));
          unity += precision * covariance;
        }
        EXPECT_NEAR(unity, c == d ? 1.0 : 0.0, 1e-2) << c << " " << d;
      }
    }
  }
}

TEST(Trim, SaysWhatItChanges) {
  Trim trim;
  trim.improved = true;
  trim.array = UnitArray::nested;
  trim.before = {1.5, 2.5};
  trim.after = {0.25, 0.5};
  trim.estimate.noise = 0.25;
  trim.changes = {{"chip1.A.Cin", 7, 9}};
  EXPECT_EQ(trim.to_json(), parsed(R"({"improved": true, "unit_array": "nested",
      "before": {"median_percent": 1.5, "p95_percent": 2.5}, "after": {"median_percent": 0.25, "p95_percent": 0.5},
      "measurement_deviation_percent": 25, "changes": [{"capacitor": "chip1.A.Cin", "before": 7, "after": 9}]})"));
}

}  // namespace
}  // namespace bodesmith::fpaa
