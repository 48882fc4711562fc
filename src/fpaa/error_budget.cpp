#include "fpaa/error_budget.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>

#include "base/json.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/error_reference.hpp"
#include "fpaa/multirate_response.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

constexpr int kPoints = 200;         ///< of the band, for the response's errors
constexpr int kMismatchPoints = 40;  ///< of the band, for each draw
constexpr int kNoisePoints = 1500;   ///< from 0 to half the clock
constexpr std::size_t kNamedCapacitors = 8;

double worst_percent(const std::vector<Complex>& got, const std::vector<Complex>& wanted) {
  double worst = 0.0;
  for (std::size_t k = 0; k < got.size(); ++k)
    worst = std::max(worst, 100.0 * std::abs(got[k] / wanted[k] - 1.0));
  return worst;
}

/// What each CAM is loaded with at DC and at half its clock.
std::vector<ErrorBudget::CamShare> cam_shares(const std::vector<const PlacedCam*>& cams) {
  std::vector<ErrorBudget::CamShare> out;
  for (const PlacedCam* cam : cams) {
    ErrorBudget::CamShare share;
    share.name = cam->name;
    share.gain = 0.0;
    for (std::size_t i = 1; i <= cam->input_count(); ++i) {
      const ZTransfer z = cam->z_from(i);
      const double dc = std::abs(z.response({0.0}, cam->clock_a));
      const double top = std::abs(z.response(Hertz{0.5 * cam->clock_a.value}.rad_s(), cam->clock_a));
      share.gain += std::max(dc, top);
    }
    share.settling_product_hz = (1.0 + share.gain) * cam->clock_a.value;
    out.push_back(share);
  }
  return out;
}

/// Mid-points of 0 ... fc/2.
std::vector<Hertz> noise_grid(double clock) {
  std::vector<Hertz> out;
  for (int k = 0; k < kNoisePoints; ++k) out.push_back({0.5 * clock * (k + 0.5) / kNoisePoints});
  return out;
}

/// The mean square at a CAM's output in kT/C_u that falls to each point of the grid, all points together
/// that of the whole band.
std::vector<double> own_noise(const PlacedCam& cam, const std::vector<Hertz>& grid) {
  std::vector<double> out(grid.size(), 0.0);
  for (const NoiseCharge& charge : cam.cam->noise_charges(cam)) {
    for (std::size_t k = 0; k < grid.size(); ++k) {
      out[k] += 2.0 * charge.units * std::norm(charge.to_output.response(grid[k].rad_s(), cam.clock_a)) /
                static_cast<double>(grid.size());
    }
  }
  return out;
}

/// Everything of a board over 0 ... fc/2 of one clock.
struct NoiseView {
  std::vector<Hertz> grid;
  std::vector<std::vector<Complex>> nodes;   ///< from the input pin
  std::vector<std::vector<Complex>> onward;  ///< to the output pin, its hold left out
};

NoiseView noise_view(const Plan& plan, double clock) {
  NoiseView out;
  out.grid = noise_grid(clock);
  const DrawnBoard board(plan, out.grid);
  const auto transfers = board.transfers(board.nominal_units());
  out.nodes = board.nodes(transfers);
  out.onward = board.onward(transfers);
  if (!board.graph().output || !board.graph().output->node) return out;
  const std::vector<Complex> hold = out.onward[*board.graph().output->node];
  for (auto& node : out.onward) {
    for (std::size_t k = 0; k < hold.size(); ++k) node[k] /= hold[k];
  }
  return out;
}

/// What a slower CAM reads of a faster one's noise folds into its band whole: the part that comes on top of
/// the line itself, as a white sum at the reader.
double folded_share(const PlanGraph& graph, std::size_t source, std::size_t node) {
  const auto& reader = graph.nodes[node];
  for (const PlanGraph::Input& input : reader.inputs) {
    if (input.from.node && *input.from.node == source && reader.period > graph.nodes[source].period) {
      return static_cast<double>(reader.period) / static_cast<double>(graph.nodes[source].period) - 1.0;
    }
  }
  return 0.0;
}

/// A CAM's own noise and what folds of it.
double folds_of(const PlanGraph& graph, std::size_t source) {
  double out = 1.0;
  for (std::size_t n = 0; n < graph.nodes.size(); ++n) out += folded_share(graph, source, n);
  return out;
}

/// Trapezoids over the band, up to half the CAM's clock.
double noise_in_band(const PlacedCam& cam, const std::vector<Hertz>& grid,
                     const std::vector<Complex>& onward) {
  const double nyquist = 0.5 * cam.clock_a.value;
  std::vector<double> per_hz = own_noise(cam, grid);
  for (std::size_t k = 0; k < grid.size(); ++k) {
    per_hz[k] *= std::norm(onward[k]) * static_cast<double>(grid.size()) / nyquist;
  }
  double out = 0.0;
  for (std::size_t k = 0; k + 1 < grid.size(); ++k) {
    const double width = std::min(grid[k + 1].value, nyquist) - std::min(grid[k].value, nyquist);
    out += 0.5 * (per_hz[k] + per_hz[k + 1]) * width;
  }
  return out;
}

/// Node gains and noise: mid-point sums over 0 ... fc/2 of each CAM's clock.
void add_nodes_and_noise(const Plan& plan, Band band, std::vector<ErrorBudget::CamShare>& shares) {
  const DrawnBoard board(plan, log_grid(band, kPoints));
  const PlanGraph& graph = board.graph();
  const auto onward = board.onward(board.transfers(board.nominal_units()));
  std::map<double, NoiseView> views;
  for (std::size_t c = 0; c < shares.size(); ++c) {
    const PlacedCam& cam = *graph.nodes[c].cam;
    const auto [at, fresh] = views.try_emplace(cam.clock_a.value);
    if (fresh) at->second = noise_view(plan, cam.clock_a.value);
    const NoiseView& view = at->second;
    const std::vector<double> own = own_noise(cam, view.grid);
    const double folds = folds_of(graph, c);
    for (std::size_t k = 0; k < view.grid.size(); ++k) {
      shares[c].peak_node_gain = std::max(shares[c].peak_node_gain, std::abs(view.nodes[c][k]));
      shares[c].noise_kt_per_cu += own[k] * folds * std::norm(view.onward[c][k]);
    }
    shares[c].noise_in_band_kt_per_cu = folds * noise_in_band(cam, board.grid(), onward[c]);
  }
}

/// Each CAM's own transfer with op-amps that do not settle whole, and the plan with all of them.
void add_settling(const Plan& plan, const OpAmpModel& opamp, ErrorBudget& out) {
  constexpr double kIdeal = 1e3;  // clocks: settled to exp(-1000 pi beta)
  const DrawnBoard board(plan, log_grid(plan.error.band, kMismatchPoints));
  const auto ideal = board.transfers(board.nominal_units());
  auto slow = ideal;
  for (std::size_t n = 0; n < slow.size(); ++n) {
    const PlacedCam& cam = *board.graph().nodes[n].cam;
    const auto stage = cam.cam->switches(cam);
    if (!stage) continue;
    const ChargeBalance settled(*stage, {{kIdeal * cam.clock_a.value}, 1e12}, cam.clock_a);
    const ChargeBalance got(*stage, opamp, cam.clock_a);
    for (std::size_t i = 0; i < slow[n].size(); ++i) {
      for (std::size_t k = 0; k < board.grid().size(); ++k) {
        const RadPerSecond w = board.grid()[k].rad_s();
        const int input = static_cast<int>(i) + 1;
        const Complex ratio = got.response(w, input) / settled.response(w, input);
        if (!std::isfinite(std::abs(ratio))) continue;
        slow[n][i][k] *= ratio;
        out.cams[n].settling_percent = std::max(out.cams[n].settling_percent, 100.0 * std::abs(ratio - 1.0));
      }
    }
  }
  out.opamp = opamp;
  out.settling_percent = worst_percent(board.response(slow), board.response(ideal));
}

/// One path of CAMs with one input each, each of which says what was requested of it.
bool is_one_path(const Plan& plan) {
  const auto cams = plan.cams();
  return plan.wires.size() + 1 >= cams.size() &&
         std::all_of(cams.begin(), cams.end(), [&](const PlacedCam* cam) {
           return cam->input_count() == 1 && !cam->requested.entries().empty() &&
                  cam->clock_a.value == cams[0]->clock_a.value;
         });
}

/// Warping, quantisation and holds over the band, each by itself.
void add_response_errors(const Plan& plan, const Sections& sections, ErrorBudget& out) {
  const auto cams = plan.cams();
  const bool one_path = is_one_path(plan);
  const MultirateResponse response(plan);
  std::vector<Complex> wanted, ideal, got, holds;
  for (const Hertz f : log_grid(plan.error.band, kPoints)) {
    const RadPerSecond w = f.rad_s();
    // Nothing is relative to a response of 0.
    if (beside_a_zero(sections, w)) continue;
    wanted.push_back(sections.response(w));
    Complex h = 1.0;
    for (const PlacedCam* cam : cams) h *= cam->cam->unquantised(*cam, w);
    got.push_back(response.without_delays(w));
    ideal.push_back(one_path ? h : got.back());
    holds.push_back(response.as_it_runs(w) / got.back());
    out.hold_phase_deg = std::max(out.hold_phase_deg, std::abs(to_degrees(std::arg(holds.back()))));
  }
  out.warping_percent = one_path ? worst_percent(ideal, wanted) : 0.0;
  out.quantisation_percent = one_path ? worst_percent(got, ideal) : worst_percent(got, wanted);
  out.together_percent = worst_percent(got, wanted);
  out.hold_percent = worst_percent(holds, std::vector<Complex>(holds.size(), 1.0));
}

}  // namespace

double noise_in_band_kt_per_cu(const Plan& plan, Band band) {
  constexpr int kSearchPoints = 60;
  const DrawnBoard board(plan, log_grid(band, kSearchPoints));
  const PlanGraph& graph = board.graph();
  const auto onward = board.onward(board.transfers(board.nominal_units()));
  double out = 0.0;
  for (std::size_t c = 0; c < graph.nodes.size(); ++c) {
    out += folds_of(graph, c) * noise_in_band(*graph.nodes[c].cam, board.grid(), onward[c]);
  }
  return out;
}

ErrorBudget error_budget(const Plan& plan, const Sections& sections, const BudgetOptions& options) {
  ErrorBudget out;
  const auto cams = plan.cams();
  add_response_errors(plan, sections, out);
  out.mismatch_model = options.assumptions.mismatch;
  out.noise_model = options.assumptions.noise;
  out.seed = options.seed;
  std::vector<Hertz> drawn_at;
  for (const Hertz f : log_grid(plan.error.band, kMismatchPoints)) {
    if (!beside_a_zero(sections, f.rad_s())) drawn_at.push_back(f);
  }
  out.mismatch = mismatch_spread(DrawnBoard(plan, drawn_at), out.mismatch_model, options.draws, options.seed);
  const double clock = cams.back()->clock_a.value;
  const double top = plan.error.band.to.value;
  out.image = {clock - top};
  out.image_db = to_decibel(top / (clock - top));
  out.settling_limit_hz = board_by_name(plan.board).settling_product.value;
  out.cams = cam_shares(cams);
  add_nodes_and_noise(plan, plan.error.band, out.cams);
  add_settling(plan, options.opamp, out);
  for (const ErrorBudget::CamShare& share : out.cams) {
    out.noise_kt_per_cu += share.noise_kt_per_cu;
    out.noise_in_band_kt_per_cu += share.noise_in_band_kt_per_cu;
  }
  return out;
}

Json MismatchSpread::to_json() const {
  Json out{{"draws", draws},
           {"median_percent", median_percent},
           {"p95_percent", p95_percent},
           {"max_percent", max_percent},
           {"p95_db", p95_db},
           {"capacitors", Json::array()}};
  for (const Share& share : shares) {
    if (out["capacitors"].size() == kNamedCapacitors) break;
    out["capacitors"].push_back({{"capacitor", share.capacitor}, {"share", share.share}});
  }
  return out;
}

Json ErrorBudget::to_json() const {
  Json out;
  out["warping_percent"] = warping_percent;
  out["quantisation_percent"] = quantisation_percent;
  out["together_percent"] = together_percent;
  out["hold_percent"] = hold_percent;
  out["hold_phase_deg"] = hold_phase_deg;
  out["mismatch"] = mismatch_model.to_json();
  out["mismatch"]["seed"] = seed;
  out["mismatch"].update(mismatch.to_json());
  out["image"] = {{"frequency_hz", image.value}, {"magnitude_db", image_db}};
  out["settling_limit_hz"] = settling_limit_hz;
  out["settling"] = {{"opamp_gain_bandwidth_hz", opamp.gain_bandwidth.value},
                     {"opamp_gain", opamp.gain},
                     {"error_percent", settling_percent}};
  out["noise_kt_per_cu"] = noise_kt_per_cu;
  out["noise_in_band_kt_per_cu"] = noise_in_band_kt_per_cu;
  out["noise_in_band_uv"] = noise_model.microvolts(noise_in_band_kt_per_cu);
  out["noise_uv"] = noise_model.microvolts(noise_kt_per_cu);
  out["noise"] = noise_model.to_json();
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
