#include "fpaa/error_budget.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <random>

#include "base/json.hpp"
#include "fpaa/cams/filter_bilinear.hpp"
#include "fpaa/cams/filter_biquad.hpp"
#include "fpaa/noise.hpp"
#include "numeric/random.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

constexpr int kPoints = 200;
constexpr int kMismatchPoints = 40;
constexpr int kNoisePoints = 4000;

double worst_percent(const std::vector<Complex>& got, const std::vector<Complex>& wanted) {
  double worst = 0.0;
  for (size_t k = 0; k < got.size(); ++k) worst = std::max(worst, 100.0 * std::abs(got[k] / wanted[k] - 1.0));
  return worst;
}

/// A CAM's transfer when its capacitors are these (not whole) numbers.
Complex with_capacitors(const PlacedCam& cam, const std::vector<double>& units, RadPerSecond w) {
  const auto c = [&](const char* name) {
    for (size_t i = 0; i < cam.capacitors.size(); ++i) {
      if (cam.capacitors[i].name == name) return units[i];
    }
    return 0.0;
  };
  const Complex z = std::polar(1.0, -w.value / cam.clock_a.value);  // 1/z
  const Complex d = 1.0 - z;
  if (cam.cam == "GainInv") return -c("Cin") / c("Cout");
  if (cam.cam == "FilterBilinear") {
    if (cam.option == "Low Pass") return -c("Cin") / (c("Cout") + c("Cint") * d);
    return -(c("Ca") + c("Cb") * d) / (c("Cc") + c("Cd") * d);  // high pass: no Ca
  }
  const bool high_q = cam.realised.contains("form") && cam.realised["form"] == "high Q";
  const Complex loop = c("C2") * c("C3") * z;
  const Complex below = high_q ? c("CA") * c("CB") * d * d + c("C3") * z * c("C4") * d + loop
                               : c("CA") * d * (c("CB") * d + c("C4")) + loop;
  const Complex above = c("C1") * c("C3") * z + (high_q ? c("Cp") * c("C3") * d * z : c("Cp") * c("CA") * d) +
                        c("Cpp") * c("CA") * d * d;
  return -above / below;
}

/// Bilinear images of the wanted poles and zeros by tan; biquads as they are realised.
Complex unquantised(const PlacedCam& cam, RadPerSecond w) {
  const Complex s(0.0, std::tan(0.5 * w.value / cam.clock_a.value));
  const auto corner = [&](const char* key) {
    return std::tan(M_PI * cam.requested[key].get<double>() / cam.clock_a.value);
  };
  if (cam.cam != "FilterBilinear") return cam.z.response(w, cam.clock_a);
  const std::vector<double> exact = [&] {
    std::vector<double> units;
    for (const Capacitor& c : cam.capacitors) units.push_back(c.units);
    return units;
  }();
  if (cam.option == "Pole and Zero") {
    // The gain that belongs to the wanted one: compared below with a free gain over the chain.
    return -cam.requested["dc_gain"].get<double>() * (1.0 + s / corner("zero_hz")) /
           (1.0 + s / corner("pole_hz"));
  }
  std::vector<double> units = exact;
  const double ratio = branch_ratio({cam.requested["corner_hz"].get<double>()}, cam.clock_a);
  for (size_t i = 0; i < units.size(); ++i) {
    const std::string& name = cam.capacitors[i].name;
    if (name == "Cout" || name == "Cc") units[i] = 1.0;
    if (name == "Cint" || name == "Cd") units[i] = ratio;
    if (name == "Cin") units[i] = cam.requested["gain"].get<double>();
    if (name == "Cb") units[i] = 0.5 * cam.requested["gain"].get<double>() * (1.0 + 2.0 * ratio);
  }
  return with_capacitors(cam, units, w);
}

ErrorBudget::Mismatch mismatch(const Plan& plan, const BudgetOptions& options) {
  ErrorBudget::Mismatch out;
  out.sigma_percent = options.mismatch_sigma_percent;
  out.draws = options.draws;
  out.seed = options.seed;
  if (options.draws <= 0) return out;
  const std::vector<Hertz> grid = log_grid(plan.error.band, kMismatchPoints);
  const auto cams = plan.cams();
  std::mt19937_64 random(options.seed);
  const auto normal = [&] {
    const double log_u = std::log(open_unit_interval(random()));
    return box_muller(log_u, open_unit_interval(random()));
  };
  const double sigma = options.mismatch_sigma_percent / 100.0 / std::sqrt(2.0);
  std::vector<double> worst;
  for (int draw = 0; draw < options.draws; ++draw) {
    std::vector<Complex> ratio(grid.size(), 1.0);
    for (const PlacedCam* cam : cams) {
      std::vector<double> units;
      for (const Capacitor& c : cam->capacitors) units.push_back(c.units * (1.0 + sigma * normal()));
      for (size_t k = 0; k < grid.size(); ++k) {
        const RadPerSecond w = grid[k].rad_s();
        ratio[k] *= with_capacitors(*cam, units, w) / cam->z.response(w, cam->clock_a);
      }
    }
    double most = 0.0;
    for (const Complex& r : ratio) most = std::max(most, 100.0 * std::abs(r - 1.0));
    worst.push_back(most);
  }
  std::sort(worst.begin(), worst.end());
  out.median_percent = worst[worst.size() / 2];
  out.p95_percent = worst[static_cast<size_t>(0.95 * static_cast<double>(worst.size() - 1))];
  out.max_percent = worst.back();
  return out;
}

void add_cams(const Plan& plan, ErrorBudget& out) {
  const auto cams = plan.cams();
  const double clock = cams[0]->clock_a.value;
  for (const PlacedCam* cam : cams) {
    ErrorBudget::Cam item;
    item.name = cam->name;
    const double dc = std::abs(cam->z.response({0.0}, cam->clock_a));
    const double top = std::abs(cam->z.response(Hertz{0.5 * cam->clock_a.value}.rad_s(), cam->clock_a));
    item.gain = std::max(dc, top);
    item.settling_product_hz = (1.0 + item.gain) * cam->clock_a.value;
    out.cams.push_back(item);
  }
  // Node gains and noise: mid-point sums over 0 ... fc/2, one pass for all CAMs.
  for (int k = 0; k < kNoisePoints; ++k) {
    const Hertz f{0.5 * clock * (k + 0.5) / kNoisePoints};
    const RadPerSecond w = f.rad_s();
    std::vector<Complex> h;
    for (const PlacedCam* cam : cams) h.push_back(cam->z.response(w, cam->clock_a));
    Complex node = 1.0;
    for (size_t c = 0; c < h.size(); ++c) {
      node *= h[c];
      out.cams[c].peak_node_gain = std::max(out.cams[c].peak_node_gain, std::abs(node));
    }
    Complex rest = 1.0;
    for (size_t c = h.size(); c-- > 0;) {
      double density = 0.0;
      for (const NoiseCharge& charge : noise_charges(*cams[c])) {
        density += 2.0 * charge.units * std::norm(charge.to_output.response(w, cams[c]->clock_a));
      }
      density *= std::norm(rest) / kNoisePoints;
      out.cams[c].noise_kt_per_cu += density;
      if (f >= plan.error.band.from && f <= plan.error.band.to)
        out.cams[c].noise_in_band_kt_per_cu += density;
      rest *= h[c];
    }
  }
  for (const ErrorBudget::Cam& cam : out.cams) {
    out.noise_kt_per_cu += cam.noise_kt_per_cu;
    out.noise_in_band_kt_per_cu += cam.noise_in_band_kt_per_cu;
  }
}

}  // namespace

ErrorBudget error_budget(const Plan& plan, const Sections& sections, const BudgetOptions& options) {
  ErrorBudget out;
  const auto cams = plan.cams();
  std::vector<Complex> wanted, ideal, got, holds, ones;
  for (const Hertz f : log_grid(plan.error.band, kPoints)) {
    const RadPerSecond w = f.rad_s();
    wanted.push_back(sections.response(w));
    Complex h = 1.0;
    for (const PlacedCam* cam : cams) h *= unquantised(*cam, w);
    ideal.push_back(h);
    got.push_back(plan_response(plan, w, false));
    holds.push_back(plan_response(plan, w, true) / got.back());
    ones.push_back(1.0);
    out.hold_phase_deg = std::max(out.hold_phase_deg, std::abs(to_degrees(std::arg(holds.back()))));
  }
  out.warping_percent = worst_percent(ideal, wanted);
  out.quantisation_percent = worst_percent(got, ideal);
  out.together_percent = worst_percent(got, wanted);
  out.hold_percent = worst_percent(holds, ones);
  out.mismatch = mismatch(plan, options);
  const double clock = cams.back()->clock_a.value;
  const double top = plan.error.band.to.value;
  out.image = {clock - top};
  out.image_db = to_decibel(top / (clock - top));
  out.settling_limit_hz = board_by_name(plan.board).settling_product.value;
  add_cams(plan, out);
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
  for (const Cam& cam : cams) {
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
