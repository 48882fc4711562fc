// "High-speed tracking control of piezoelectric actuators using an ellipse-based hysteresis model":
// Table I (feedforward, PID, hybrid at 100 Hz) and Table II (PID and hybrid over frequency).
#include "bench.hpp"
#include "hysteresis/ellipse.hpp"

namespace {

using namespace bench;

constexpr double kSampling = 1e-4;  // 10 kHz, section III

struct Gains {
  double p, i, d;
};

struct Run {
  TrackingError error;
  double bias = 0.0;                  ///< mean of y - r, um
  double height = 0.0;                ///< of the loop y over r, um
  double height_without_delay = 0.0;  ///< of a sample and a half
};

constexpr double kCentre = 30.0;  // of the references, um

/// Largest distance of y on the way up from y on the way down at the same r, a sine of n samples a period; means over periods.
/// `late`: half samples by which r is taken later.
double loop_height(const std::vector<double>& y, std::size_t first, std::size_t n, std::size_t late = 0) {
  std::vector<double> mean(n, 0.0);
  for (std::size_t i = first; i < y.size(); ++i) mean[i % n] += y[i];
  double out = 0.0;
  for (std::size_t k = 0; k < n; ++k)
    out = std::max(out, std::abs(mean[k] - mean[(n + n / 2 + late - k) % n]));
  return out / (static_cast<double>(y.size() - first) / static_cast<double>(n));
}

/// Eq. 3 with the feedforward of eq. 6; drive in parts of 150 V, displacement in parts of 67.66 um. Neither: the drive in
/// proportion to the reference.
Run run(const VirtualStageSettings& settings, const Model* forward, const Gains* pid, double f,
        double centre = kCentre) {
  VirtualStage stage(settings);
  std::unique_ptr<Inverse> inverse;
  if (forward != nullptr) inverse = make_inverse(*forward);
  const double amplitude = 6.5;
  const double period = 1.0 / (f * kSampling);
  const int settle = std::max(20000, static_cast<int>(4 * period));
  const int n = settle + static_cast<int>(std::max(3.0, 0.2 * f) * period);
  std::vector<double> got, wanted;
  double y = stage.reset(centre / 67.66 * 150.0);
  double sum = 0.0, before = 0.0;
  for (int k = 0; k < n; ++k) {
    const double r = centre + amplitude * std::sin(2 * kPi * f * k * kSampling);
    const double e = (r - y) / 67.66;
    sum += e;
    double u = forward == nullptr && pid == nullptr ? r / 67.66 : 0.0;
    if (inverse) u += (k == 0 ? inverse->reset(r) : inverse->step(r, kSampling)) / 150.0;
    if (pid != nullptr) u += pid->p * e + pid->i * sum + pid->d * (e - before);
    before = e;
    got.push_back(y);
    wanted.push_back(r);
    y = stage.step(150.0 * u, kSampling);
  }
  const auto first = static_cast<std::size_t>(settle);
  Run out{tracking_error(got, wanted, first)};
  for (std::size_t i = first; i < got.size(); ++i)
    out.bias += (got[i] - wanted[i]) / static_cast<double>(got.size() - first);
  if (const auto samples = std::lround(period); std::abs(period - static_cast<double>(samples)) < 1e-9) {
    out.height = loop_height(got, first, static_cast<std::size_t>(samples));
    out.height_without_delay = loop_height(got, first, static_cast<std::size_t>(samples), 3);
  }
  return out;
}

}  // namespace

int main() {
  VirtualStageSettings settings = VirtualStageSettings::stack_actuator();
  // Records as Fig. 2 has them: sines about 75 V, several amplitudes and frequencies.
  std::vector<TimeRecord> records;
  for (const double f : {1.0, 10.0, 50.0, 100.0, 200.0, 300.0}) {
    for (const double a : {6.0, 12.0, 18.0, 24.0}) {
      const int n = static_cast<int>(std::lround(std::max(1.0 / (f * kSampling), 30.0)));
      records.push_back(measure(
          settings, wave(n, 5.2, [&](double c) { return 70.0 + a * std::sin(2 * kPi * c); }), 1.0 / (f * n)));
    }
  }
  IdentifyOptions options;
  options.size = 4;
  options.skip_s = 0.0;
  const Identified found = model_type_registry().get("ellipse").identify(records, options);
  const Ellipse model = Ellipse::from(found.model.parameters);
  fmt::print("Ellipse model: {}\n", found.method);
  for (const double f : {1.0, 100.0, 300.0}) {
    const Ellipse::Coefficients p = model.inverse_coefficients(6.5, f, kSampling);
    fmt::print("  at {:>3} Hz: phase {:6.2f} deg, p1' {:.4f} p2' {:.4f} p3' {:.3f}\n", f,
               model.at(14.0, f).phase_rad * 180 / kPi, p.p1, p.p2, p.p3);
  }
  const Gains pid{0.05, 0.65, 0.0};
  fmt::print(
      "\nTable I, 100 Hz, percent of the displacement range: largest (MTE), rms (RMSTE)\n{:<24} | {:>14} | "
      "{:>14}\n",
      "", "paper", "ours");
  const auto row = [](const char* name, const char* paper_max, const char* paper_rms,
                      const TrackingError& e) {
    fmt::print("{:<24} | {:>6} {:>6}  | {:6.2f} {:6.2f}\n", name, paper_max, paper_rms, e.max_percent,
               e.rms_percent);
  };
  const Run open = run(settings, &found.model, nullptr, 100.0);
  // Where the records' own middle is: what a drive about 70 V makes.
  const double own = model.at(14.0, 100.0).y_0;
  const Run centred = run(settings, &found.model, nullptr, 100.0, own);
  row("feedforward", "7.16", "5.33", open.error);
  row("  about the records' own", "", "", centred.error);
  row("PID", "8.2", "5.53", run(settings, nullptr, &pid, 100.0).error);
  row("hybrid", "0.7", "0.34", run(settings, &found.model, &pid, 100.0).error);
  fmt::print(
      "\nBias of the feedforward: {:.2f} um about {:.1f} um, {:.2f} um about {:.2f} um, the middle of the records.\n"
      "p3' says where a small loop lies from where those of the records lay, by the slope of the small loop; the\n"
      "stage's own middle moves by the slope of the great one.\n",
      open.bias, kCentre, centred.bias, own);
  const Run linear = run(settings, nullptr, nullptr, 100.0, own);
  fmt::print(
      "Loop height: {:.3f} um driven in proportion, {:.3f} um by the feedforward, {:.0f} % less (paper 88 %); most of it is\n"
      "the delay of a sample and a half, of computing and of the difference quotient: {:.3f} um without, {:.0f} % less\n",
      linear.height, centred.height, 100.0 * (1.0 - centred.height / linear.height),
      centred.height_without_delay, 100.0 * (1.0 - centred.height_without_delay / linear.height));
  constexpr double kConverterV = 20.0 / 65536.0, kVoltsPerMicrometre = 0.148;
  fmt::print("Eq. 4: {:.3f} mV, {:.2f} nm (paper 0.305 mV, 2.07 nm)\n", 1e3 * kConverterV,
             1e3 * kConverterV / kVoltsPerMicrometre);
  fmt::print("\nTable II, percent of the displacement range: MTE, RMSTE\n{:>6} {:<8} | {:>14} | {:>14}\n",
             "Hz", "", "paper", "ours");
  const struct {
    double f, pm, pr, hm, hr;
  } rows[] = {{1, .18, .06, .14, .03},
              {10, .79, .5, .16, .04},
              {50, 3.76, 2.6, .41, .17},
              {300, 41.17, 28.19, 3.22, 1.68}};
  for (const auto& at : rows) {
    const TrackingError a = run(settings, nullptr, &pid, at.f).error;
    const TrackingError b = run(settings, &found.model, &pid, at.f).error;
    fmt::print("{:>6} {:<8} | {:>6} {:>6}  | {:6.2f} {:6.2f}\n", at.f, "PID", at.pm, at.pr, a.max_percent,
               a.rms_percent);
    fmt::print("{:>6} {:<8} | {:>6} {:>6}  | {:6.2f} {:6.2f}\n", "", "hybrid", at.hm, at.hr, b.max_percent,
               b.rms_percent);
  }
  fmt::print(
      "\nShape: alone neither is good at 100 Hz, together they are; the PID's error grows with the frequency "
      "and the hybrid's slower.\n"
      "PID gains are chosen so that the plain PID is the paper's (it prints none). At 1 Hz both end in the "
      "sensor's noise.\n");
  return 0;
}
