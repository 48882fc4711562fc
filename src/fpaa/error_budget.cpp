#include "fpaa/error_budget.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>

#include "base/json.hpp"
#include "fpaa/cams/cam.hpp"
#include "numeric/random.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

constexpr int kPoints = 200;         ///< of the band, for the response's errors
constexpr int kMismatchPoints = 40;  ///< of the band, for each draw
constexpr int kNoisePoints = 4000;   ///< from 0 to half the clock

double worst_percent(const std::vector<Complex>& got, const std::vector<Complex>& wanted) {
  double worst = 0.0;
  for (std::size_t k = 0; k < got.size(); ++k)
    worst = std::max(worst, 100.0 * std::abs(got[k] / wanted[k] - 1.0));
  return worst;
}

/// One draw: every capacitor off by `sigma` times a normal number. The worst complex change over the grid.
double drawn_change_percent(const std::vector<const PlacedCam*>& cams, const std::vector<Hertz>& grid,
                            double sigma, std::mt19937_64& random) {
  const auto normal = [&] {
    const double log_u = std::log(open_unit_interval(random()));
    return box_muller(log_u, open_unit_interval(random()));
  };
  std::vector<Complex> ratio(grid.size(), 1.0);
  for (const PlacedCam* cam : cams) {
    CapacitorUnits units(cam->capacitors);
    for (double& c : units.values()) c *= 1.0 + sigma * normal();
    const DeltaTransfer drawn = cam->cam->transfer(*cam, units);
    for (std::size_t k = 0; k < grid.size(); ++k) {
      const RadPerSecond w = grid[k].rad_s();
      ratio[k] *= drawn.response(w, cam->clock_a) / cam->z.response(w, cam->clock_a);
    }
  }
  double worst = 0.0;
  for (const Complex& r : ratio) worst = std::max(worst, 100.0 * std::abs(r - 1.0));
  return worst;
}

ErrorBudget::Mismatch mismatch_of(const Plan& plan, const BudgetOptions& options) {
  ErrorBudget::Mismatch out;
  out.sigma_percent = options.mismatch_sigma_percent;
  out.draws = options.draws;
  out.seed = options.seed;
  if (options.draws <= 0) return out;
  const std::vector<Hertz> grid = log_grid(plan.error.band, kMismatchPoints);
  const auto cams = plan.cams();
  std::mt19937_64 random(options.seed);
  // Two capacitors make a ratio.
  const double sigma = options.mismatch_sigma_percent / 100.0 / std::sqrt(2.0);
  std::vector<double> worst;
  for (int draw = 0; draw < options.draws; ++draw) {
    worst.push_back(drawn_change_percent(cams, grid, sigma, random));
  }
  std::sort(worst.begin(), worst.end());
  out.median_percent = worst[worst.size() / 2];
  out.p95_percent = worst[static_cast<std::size_t>(0.95 * static_cast<double>(worst.size() - 1))];
  out.max_percent = worst.back();
  return out;
}

/// What each CAM is loaded with at DC and at half its clock.
std::vector<ErrorBudget::CamShare> cam_shares(const std::vector<const PlacedCam*>& cams) {
  std::vector<ErrorBudget::CamShare> out;
  for (const PlacedCam* cam : cams) {
    ErrorBudget::CamShare share;
    share.name = cam->name;
    const double dc = std::abs(cam->z.response({0.0}, cam->clock_a));
    const double top = std::abs(cam->z.response(Hertz{0.5 * cam->clock_a.value}.rad_s(), cam->clock_a));
    share.gain = std::max(dc, top);
    share.settling_product_hz = (1.0 + share.gain) * cam->clock_a.value;
    out.push_back(share);
  }
  return out;
}

/// Node gains and noise: mid-point sums over 0 ... fc/2, one pass for all CAMs.
void add_nodes_and_noise(const std::vector<const PlacedCam*>& cams, Band band,
                         std::vector<ErrorBudget::CamShare>& shares) {
  const double clock = cams[0]->clock_a.value;
  std::vector<std::vector<NoiseCharge>> charges;
  for (const PlacedCam* cam : cams) charges.push_back(cam->cam->noise_charges(*cam));
  std::vector<Complex> h(cams.size());
  for (int k = 0; k < kNoisePoints; ++k) {
    const Hertz f{0.5 * clock * (k + 0.5) / kNoisePoints};
    const RadPerSecond w = f.rad_s();
    Complex node = 1.0;
    for (std::size_t c = 0; c < cams.size(); ++c) {
      h[c] = cams[c]->z.response(w, cams[c]->clock_a);
      node *= h[c];
      shares[c].peak_node_gain = std::max(shares[c].peak_node_gain, std::abs(node));
    }
    Complex rest = 1.0;
    for (std::size_t c = cams.size(); c-- > 0;) {
      double density = 0.0;
      for (const NoiseCharge& charge : charges[c]) {
        density += 2.0 * charge.units * std::norm(charge.to_output.response(w, cams[c]->clock_a));
      }
      density *= std::norm(rest) / kNoisePoints;
      shares[c].noise_kt_per_cu += density;
      if (f >= band.from && f <= band.to) shares[c].noise_in_band_kt_per_cu += density;
      rest *= h[c];
    }
  }
}

/// Warping, quantisation and holds over the band, each by itself.
void add_response_errors(const Plan& plan, const Sections& sections, ErrorBudget& out) {
  const auto cams = plan.cams();
  std::vector<Complex> wanted, ideal, got, holds;
  for (const Hertz f : log_grid(plan.error.band, kPoints)) {
    const RadPerSecond w = f.rad_s();
    wanted.push_back(sections.response(w));
    Complex h = 1.0;
    for (const PlacedCam* cam : cams) h *= cam->cam->unquantised(*cam, w);
    ideal.push_back(h);
    got.push_back(plan_response(plan, w, false));
    holds.push_back(plan_response(plan, w, true) / got.back());
    out.hold_phase_deg = std::max(out.hold_phase_deg, std::abs(to_degrees(std::arg(holds.back()))));
  }
  out.warping_percent = worst_percent(ideal, wanted);
  out.quantisation_percent = worst_percent(got, ideal);
  out.together_percent = worst_percent(got, wanted);
  out.hold_percent = worst_percent(holds, std::vector<Complex>(holds.size(), 1.0));
}

}  // namespace

ErrorBudget error_budget(const Plan& plan, const Sections& sections, const BudgetOptions& options) {
  ErrorBudget out;
  const auto cams = plan.cams();
  add_response_errors(plan, sections, out);
  out.mismatch = mismatch_of(plan, options);
  const double clock = cams.back()->clock_a.value;
  const double top = plan.error.band.to.value;
  out.image = {clock - top};
  out.image_db = to_decibel(top / (clock - top));
  out.settling_limit_hz = board_by_name(plan.board).settling_product.value;
  out.cams = cam_shares(cams);
  add_nodes_and_noise(cams, plan.error.band, out.cams);
  for (const ErrorBudget::CamShare& share : out.cams) {
    out.noise_kt_per_cu += share.noise_kt_per_cu;
    out.noise_in_band_kt_per_cu += share.noise_in_band_kt_per_cu;
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
  out["mismatch"] = {{"sigma_percent", mismatch.sigma_percent},
                     {"draws", mismatch.draws},
                     {"seed", mismatch.seed},
                     {"median_percent", mismatch.median_percent},
                     {"p95_percent", mismatch.p95_percent},
                     {"max_percent", mismatch.max_percent}};
  out["image"] = {{"frequency_hz", image.value}, {"magnitude_db", image_db}};
  out["settling_limit_hz"] = settling_limit_hz;
  out["noise_kt_per_cu"] = noise_kt_per_cu;
  out["noise_in_band_kt_per_cu"] = noise_in_band_kt_per_cu;
  out["cams"] = Json::array();
  for (const CamShare& cam : cams) {
    out["cams"].push_back({{"name", cam.name},
                           {"gain", cam.gain},
                           {"settling_product_hz", cam.settling_product_hz},
                           {"peak_node_gain", cam.peak_node_gain},
                           {"noise_kt_per_cu", cam.noise_kt_per_cu},
                           {"noise_in_band_kt_per_cu", cam.noise_in_band_kt_per_cu}});
  }
  return out;
}

}  // namespace bodesmith::fpaa
