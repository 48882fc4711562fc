#include "fpaa/plan/error_budget.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/plan/error_reference.hpp"
#include "fpaa/plan/plan_limits.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr int kPoints = 200;         ///< of the band, for the response's errors
constexpr int kMismatchPoints = 40;  ///< of the band, for boards with other capacitors
constexpr int kNoisePoints = 60;     ///< of the band
constexpr int kNodePoints = 300;     ///< up to kOfFastest
constexpr int kNoiseCost = 10;       ///< of a noise density, in gains
constexpr std::size_t kNamedCapacitors = 8;

/// What each CAM is loaded with at DC and at half its clock.
std::vector<ErrorBudget::CamShare> cam_shares(const std::vector<const PlacedCam*>& cams) {
  std::vector<ErrorBudget::CamShare> out;
  for (const PlacedCam* cam : cams) {
    ErrorBudget::CamShare share;
    share.name = cam->name;
    share.gain = 0.0;
    for (std::size_t i = 1; i <= cam->input_count(); ++i) {
      const double dc = std::abs(cam->z.response({0.0}, cam->clock_a, i));
      const double top = std::abs(cam->z.response(Hertz{0.5 * cam->clock_a.value}.rad_s(), cam->clock_a, i));
      share.gain += std::max(dc, top);
    }
    share.settling_product_hz = (1.0 + share.gain) * cam->clock_a.value;
    out.push_back(share);
  }
  return out;
}

/// int density df by CAM over a grid, straight between its points; the board made with its noise.
std::vector<double> integrated_noise(const SwitchedBoard& board, const std::vector<Hertz>& grid) {
  std::vector<std::vector<double>> density(grid.size());
  parallel_for(grid.size(), thread_count(0),
               [&](std::size_t k) { density[k] = board.noise_density(grid[k].rad_s()); });
  std::vector<double> out(board.graph().nodes.size(), 0.0);
  for (std::size_t k = 1; k < grid.size(); ++k) {
    for (std::size_t n = 0; n < out.size(); ++n)
      out[n] += 0.5 * (density[k - 1][n] + density[k][n]) * (grid[k].value - grid[k - 1].value);
  }
  return out;
}

/// Logarithmic in the band and below, evenly spaced from there to half the fastest clock.
std::vector<Hertz> whole_noise_grid(const Plan& plan, Band band, int points) {
  const double top = 0.5 * *plan.clocks_hz().rbegin();
  const double from = std::min(1e-3 * band.from.value, 1e-6 * top);
  std::vector<Hertz> out{{0.0}};
  for (const Hertz f : log_grid({{from}, {top}}, points)) out.push_back(f);
  for (int k = 1; k < points; ++k) out.push_back({top * k / points});
  std::ranges::sort(out, {}, &Hertz::value);
  return out;
}

/// Fewer frequencies where each costs a long common period, `times` so often.
int affordable(int points, std::size_t pieces_of, int times = 1) {
  constexpr double kPieces = 4e6;  // a second or two
  const double pieces = static_cast<double>(pieces_of) * times;
  return std::clamp(static_cast<int>(kPieces / pieces), std::min(points, 20), points);
}

/// Noise in the band by CAM, for every figure that has it.
std::vector<double> band_noise_of(const SwitchedBoard& noisy, Band band) {
  return integrated_noise(noisy, log_grid(band, affordable(kNoisePoints, noisy.pieces(), kNoiseCost)));
}

/// Node gains and noise.
void add_nodes_and_noise(const Plan& plan, const SwitchedBoard& board, Band band,
                         std::vector<ErrorBudget::CamShare>& shares) {
  const SwitchedBoard noisy(plan, true);
  const int points = affordable(kNodePoints, noisy.pieces(), kNoiseCost);
  const std::vector<double> in_band = band_noise_of(noisy, band);
  const std::vector<double> whole = integrated_noise(noisy, whole_noise_grid(plan, band, points));
  for (const auto& nodes : nodes_over(
           board, log_grid({{0.1 * band.from.value}, {kOfFastest * *plan.clocks_hz().rbegin()}}, points))) {
    for (std::size_t c = 0; c < shares.size(); ++c) {
      for (const auto& node : nodes[c])
        shares[c].peak_node_gain = std::max(shares[c].peak_node_gain, node.largest);
    }
  }
  for (std::size_t c = 0; c < shares.size(); ++c) {
    shares[c].noise_kt_per_cu = whole[c];
    shares[c].noise_in_band_kt_per_cu = in_band[c];
  }
}

void add_settling(const Plan& plan, ErrorBudget& out) {
  const auto cams = plan.cams();
  for (std::size_t n = 0; n < cams.size(); ++n) {
    const auto stage = cams[n]->cam->switches(*cams[n]);
    if (!stage) continue;
    const Unsettled left = unsettled(*stage, out.late.parts, cams[n]->clock_a);
    out.cams[n].settling_percent = 100.0 * (left.moving + left.by_gain);
    out.settling_percent += out.cams[n].settling_percent;
  }
}

/// The plan with other capacitors: over the band and near sharp roots.
DrawnBoard drawn_board(const SwitchedBoard& switched, const Sections& sections, Band band) {
  std::vector<Hertz> grid = log_grid(band, affordable(kMismatchPoints, switched.pieces(),
                                                      2 * static_cast<int>(switched.nominal_units().size())));
  const std::vector<Hertz> sharp = about_sharp_roots(sections, band);
  grid.insert(grid.end(), sharp.begin(), sharp.end());
  return {switched, std::move(grid)};
}

}  // namespace

PlanTotal plan_total(const Plan& plan, const SwitchedBoard& switched, const Sections& sections,
                     const BoardAssumptions& assumptions) {
  PlanTotal out;
  out.at_input_v = plan.max_input_v;
  out.designed_percent = plan.error_with_delays.max_complex_percent;
  const Band band = plan.error_with_delays.band;
  const DrawnBoard board = drawn_board(switched, sections, band);
  const std::vector<Hertz>& grid = board.grid();
  // To the first order about the capacitors that boards have on average.
  std::vector<double> average = board.nominal_units();
  for (double& units : average) units = assumptions.mismatch.drawn(units, 0.0);
  const std::vector<Complex> designed = board.response(board.nominal_units());
  std::vector<Complex> error = board.response(average);
  std::vector<Complex> change = error;
  std::vector<std::vector<Complex>> effects = board.slopes(average);
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const double size = error_reference(sections, grid[k].rad_s());
    error[k] = (error[k] - sections.response(grid[k].rad_s())) / size;
    change[k] = (change[k] - designed[k]) / size;
    for (std::size_t c = 0; c < average.size(); ++c) {
      const double units = board.nominal_units()[c];
      if (units > 0.0)
        effects[c][k] *= assumptions.mismatch.relative_sigma(units) * units / average[c] / size;
    }
  }
  const double worst = 100.0 * error_of_95_percent(error, effects, kDrawnBoards, assumptions.seed);
  out.mismatch_p95_percent = 100.0 * error_of_95_percent(change, effects, kDrawnBoards, assumptions.seed);
  double asked = 1.0;  // the largest of the input itself and the response that was asked for
  for (const Hertz f : log_grid(band, kPoints))
    asked = std::max(asked, std::abs(sections.response(f.rad_s())));
  if (out.at_input_v > 0.0) out.from_bound_db = to_decibel(out.at_input_v * asked / kFullScaleV);
  double noise = 0.0;  // mean square at the pin, kT/C_u
  for (const double share : band_noise_of(SwitchedBoard(plan, true), band)) noise += share;
  const double rms_v = 1e-6 * assumptions.noise.microvolts(noise);
  double largest = 0.0;
  for (const Complex h : designed) largest = std::max(largest, std::abs(h));
  const double sine_rms_v = out.at_input_v * largest / std::numbers::sqrt2;
  out.noise_percent = sine_rms_v > 0.0 ? 100.0 * rms_v / sine_rms_v : 0.0;
  out.p95_percent = std::hypot(std::max(worst, out.designed_percent), out.noise_percent);
  return out;
}

LateFigure late_figure(const Plan& plan, const Sections& sections) {
  LateFigure out{plan.slow, plan.error_with_delays.max_complex_percent, plan.error_with_delays.worst};
  if (plan.slow.opamp.is_ideal) out.parts.opamp = SlowParts::typical().opamp;
  if (!plan.slow.is_at_once()) return out;
  out = {SlowParts::typical()};
  Plan late = plan;
  late.slow = out.parts;
  const SwitchedBoard board(late);
  for (const Hertz f : log_grid(plan.error.band, affordable(kPoints, board.pieces()))) {
    const RadPerSecond w = f.rad_s();
    const double percent =
        100.0 * std::abs(board.gain(w) - sections.response(w)) / error_reference(sections, w);
    if (percent > out.percent) out.percent = percent, out.worst = f;
  }
  return out;
}

std::string unsettled_text(const Plan& plan) {
  constexpr double kLeast = 2e-4;  // of what ngspice and the figures agree to
  double most = kLeast;
  const PlacedCam* worst = nullptr;
  for (const PlacedCam* cam : plan.cams()) {
    const auto stage = cam->cam->switches(*cam);
    const double left = stage ? unsettled(*stage, plan.slow, cam->clock_a).moving : 0.0;
    if (left > most) most = left, worst = cam;
  }
  if (worst == nullptr) return "";
  return fmt::format(
      "With the given op-amps and switches {} (clock {}) is still {} % of a step away from its end when a phase is over. The figures "
      "take it as settled: they hold for faster parts or slower clocks.",
      worst->name, engineering_text(worst->clock_a.value, "Hz", 4), rounded_text(100.0 * most, 3));
}

std::string late_text(const Plan& plan, const LateFigure& late) {
  const double stated = plan.error_with_delays.max_complex_percent;
  if (const std::string unsettled = unsettled_text(plan); !unsettled.empty()) return unsettled + "\n";
  if (!plan.slow.is_at_once() || late.percent - stated < std::max(0.02, 0.02 * stated)) return "";
  return fmt::format(
      "op-amps of {} and switches of 1 kohm (not published, not in it) would make it {} % at {}\n",
      engineering_text(late.parts.opamp.gain_bandwidth.value, "Hz"), rounded_text(late.percent, 3),
      engineering_text(late.worst.value, "Hz", 4));
}

ErrorBudget error_budget(const Plan& plan, const Sections& sections, const BoardAssumptions& assumptions) {
  ErrorBudget out;
  const auto cams = plan.cams();
  const SwitchedBoard board(plan);
  out.assumptions = assumptions;
  out.capacitors = drawn_board(board, sections, plan.error.band).variance_shares(assumptions.mismatch);
  out.settling_limit_hz = board_by_name(plan.board).settling_product.value;
  out.cams = cam_shares(cams);
  add_nodes_and_noise(plan, board, plan.error.band, out.cams);
  out.late = late_figure(plan, sections);
  add_settling(plan, out);
  for (const ErrorBudget::CamShare& share : out.cams) {
    out.noise_kt_per_cu += share.noise_kt_per_cu;
    out.noise_in_band_kt_per_cu += share.noise_in_band_kt_per_cu;
  }
  return out;
}

Json ErrorBudget::to_json() const {
  Json out;
  Json& mismatch = out["mismatch"];
  mismatch["seed"] = assumptions.seed;
  mismatch["draws"] = kDrawnBoards;
  for (std::size_t i = 0; i < std::min(kNamedCapacitors, capacitors.size()); ++i)
    mismatch["capacitors"].push_back(
        {{"capacitor", capacitors[i].capacitor}, {"share", capacitors[i].share}});
  out["settling_limit_hz"] = settling_limit_hz;
  out["settling"] = {{"opamp_gain_bandwidth_hz", late.parts.opamp.gain_bandwidth.value},
                     {"opamp_gain", late.parts.opamp.dc_gain},
                     {"late_percent", late.percent},
                     {"error_percent", settling_percent}};
  out["noise_kt_per_cu"] = noise_kt_per_cu;
  out["noise_in_band_kt_per_cu"] = noise_in_band_kt_per_cu;
  out["noise_in_band_uv"] = assumptions.noise.microvolts(noise_in_band_kt_per_cu);
  out["noise_uv"] = assumptions.noise.microvolts(noise_kt_per_cu);
  out["noise"] = assumptions.noise.to_json();
  out["cams"] = Json::array();
  for (const CamShare& cam : cams) {
    out["cams"].push_back({{"name", cam.name},
                           {"gain", cam.gain},
                           {"settling_product_hz", cam.settling_product_hz},
                           {"settling_percent", cam.settling_percent},
                           {"peak_node_gain", cam.peak_node_gain},
                           {"noise_kt_per_cu", cam.noise_kt_per_cu},
                           {"noise_in_band_kt_per_cu", cam.noise_in_band_kt_per_cu}});
  }
  return out;
}

}  // namespace bodesmith::fpaa
