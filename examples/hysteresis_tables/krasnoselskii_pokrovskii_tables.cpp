// "Rate Dependent Krasnoselskii-Pokrovskii Modeling and Inverse Compensation Control of Piezoceramic Actuated Stages":
// rate-dependent KP against classic KP. Table 1 (modelling), Table 2 (sines), Table 3 (triangles).
#include "bench.hpp"
#include "hysteresis/krasnoselskii_pokrovskii.hpp"

namespace {

using namespace bench;

constexpr int kSamples = 1000;

TimeRecord sine_record(const VirtualStageSettings& settings, double f) {
  return measure(
      settings, wave(kSamples, 4.0, [](double c) { return 60.0 * std::sin(2 * kPi * c + 1.5 * kPi) + 60.0; }),
      1.0 / (kSamples * f));
}

/// Drive by the inverse, run the stage, error against the reference over the last two periods.
TrackingError track(const VirtualStageSettings& settings, Inverse& inverse, const std::vector<double>& r,
                    double step_s) {
  std::vector<double> drive;
  for (std::size_t i = 0; i < r.size(); ++i)
    drive.push_back(i == 0 ? inverse.reset(r[0]) : inverse.step(r[i], step_s));
  const TimeRecord got = measure(settings, drive, step_s);
  return tracking_error(got.y, r, r.size() / 2);
}

}  // namespace

int main() {
  const VirtualStageSettings settings = VirtualStageSettings::piezoceramic();
  const double frequencies[] = {1, 10, 20, 50, 100};
  std::vector<TimeRecord> records;
  for (const double f : frequencies) records.push_back(sine_record(settings, f));

  IdentifyOptions options;
  options.size = 60;
  const Identified classic =
      model_type_registry().get("krasnoselskii_pokrovskii").identify({records.data(), 1}, options);
  const Identified rated = model_type_registry().get("krasnoselskii_pokrovskii").identify(records, options);
  IdentifyOptions swarm;
  swarm.method = "paper";
  const Identified by_swarm =
      model_type_registry().get("krasnoselskii_pokrovskii").identify({records.data(), 1}, swarm);
  const double a1 = rated.model.parameters.number("a1");
  const double a2 = rated.model.parameters.number("a2");
  fmt::print(
      "Rate function found: a1 = {:.4f}, a2 = {:.3e} s/V   (paper: 0.96 and \"2.5e7\", see the README)\n", a1,
      a2);
  fmt::print(
      "Densities at 1 Hz: convex solve {:.3f} % in {:.2f} s, swarm with cuckoo (55 kernels) {:.3f} % in "
      "{:.2f} s\n\n",
      error_figures(StageModel(classic, 0.0), {records.data(), 1}).rms_percent, classic.compute_s,
      error_figures(StageModel(by_swarm, 0.0), {records.data(), 1}).rms_percent, by_swarm.compute_s);

  fmt::print("Table 1, modelling error, RMSE um (RE %)\n{:>6} | {:>22} {:>22} | {:>22} {:>22}\n", "Hz",
             "paper KP", "paper RDKP", "ours KP", "ours RDKP");
  const double paper1[5][4] = {{.1482, .42, .2761, .80},
                               {.5997, 1.72, .5452, 1.57},
                               {.8345, 2.39, .7219, 2.08},
                               {1.3916, 3.89, 1.0543, 3.04},
                               {2.4464, 7.01, 1.6341, 4.69}};
  for (int i = 0; i < 5; ++i) {
    const TimeRecord& record = records[static_cast<std::size_t>(i)];
    const ErrorFigures kp = error_figures(StageModel(classic, 0.0), {&record, 1});
    const ErrorFigures rd = error_figures(StageModel(rated, 0.0), {&record, 1});
    fmt::print("{:>6} | {:>13.4f} ({:5.2f}) {:>13.4f} ({:5.2f}) | {:>13.4f} ({:5.2f}) {:>13.4f} ({:5.2f})\n",
               frequencies[i], paper1[i][0], paper1[i][1], paper1[i][2], paper1[i][3], kp.rms, kp.rms_percent,
               rd.rms, rd.rms_percent);
  }
  const TimeRecord damped = measure(
      settings,
      wave(kSamples, 12.0,
           [](double c) { return 60.0 + 60.0 * std::exp(-0.15 * c) * std::sin(2 * kPi * c + 1.5 * kPi); }),
      1.0 / (kSamples * 50.0));
  const ErrorFigures kp = error_figures(StageModel(classic, 0.0), {&damped, 1});
  const ErrorFigures rd = error_figures(StageModel(rated, 0.0), {&damped, 1});
  fmt::print(
      "Fig. 11, decaying amplitude (50 Hz here): paper KP 1.0076 (5.57), RDKP 0.7065 (3.83); ours KP {:.4f} "
      "({:.2f}), RDKP {:.4f} ({:.2f})\n\n",
      kp.rms, kp.rms_percent, rd.rms, rd.rms_percent);

  const auto tracking = [&](const char* title, const double(&paper)[5][4],
                            const std::function<double(double)>& shape) {
    fmt::print("{}\n{:>6} | {:>16} {:>16} | {:>16} {:>16} {:>20}\n", title, "Hz", "paper KP", "paper RDKP",
               "ours KP", "ours RDKP", "KP, recursive 0.01");
    for (int i = 0; i < 5; ++i) {
      const double step_s = 1.0 / (kSamples * frequencies[i]);
      const std::vector<double> r = wave(kSamples, 4.0, shape);
      const auto exact_kp = make_inverse(classic.model);
      const auto exact_rd = make_inverse(rated.model);
      RecursiveInverse recursive(make_operator(classic.model), 0.01, 0.0, 120.0);
      const TrackingError one = track(settings, *exact_kp, r, step_s);
      const TrackingError two = track(settings, *exact_rd, r, step_s);
      const TrackingError three = track(settings, recursive, r, step_s);
      fmt::print(
          "{:>6} | {:>8.4f} ({:4.2f}) {:>8.4f} ({:4.2f}) | {:>8.4f} ({:5.2f}) {:>8.4f} ({:5.2f}) {:>12.4f} "
          "({:5.2f})\n",
          frequencies[i], paper[i][0], paper[i][1], paper[i][2], paper[i][3], one.rms, one.rms_percent,
          two.rms, two.rms_percent, three.rms, three.rms_percent);
    }
    fmt::print("\n");
  };
  const double paper2[5][4] = {{.3435, 1.12, .3649, 1.18},
                               {.4626, 1.52, .4028, 1.30},
                               {.5734, 1.89, .4726, 1.54},
                               {.7379, 2.44, .5810, 1.90},
                               {.9416, 3.08, .7657, 2.51}};
  tracking("Table 2, tracking sines, RMSE um (RE %)", paper2,
           [](double c) { return 16.0 + 9.0 * std::sin(2 * kPi * c + 1.5 * kPi); });
  const double paper3[5][4] = {{.6325, 2.77, .5853, 1.18},
                               {1.0625, 4.81, .8862, 3.96},
                               {1.1145, 5.06, .7378, 3.29},
                               {1.3261, 6.03, 1.0875, 4.87},
                               {1.4649, 6.75, .9181, 4.07}};
  tracking("Table 3, tracking triangles, RMSE um (RE %)", paper3,
           [](double c) { return 3.0 + 24.0 * triangle(c); });
  fmt::print(
      "Shape: KP alone is best at the rate it was identified at and worsens with frequency; the rate "
      "function helps more the\n"
      "faster the drive, and costs at 1 Hz: a1 is a plain gain, also there. The recursive inverse ends where "
      "the exact one does\n"
      "(classic KP: the two columns agree); with the rate function it would run away at these sampling "
      "times, since\n"
      "a2 H > dt dH/du, so the rated inverse takes its slope from the reference. Sizes differ where the "
      "virtual stage's lag,\n"
      "resonance and fractional law are not the paper's stage: psi scales the output, it cannot delay it.\n");
  return 0;
}
