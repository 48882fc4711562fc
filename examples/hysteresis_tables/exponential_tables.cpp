// "Modeling of piezoelectric actuator for compensation and controller design":
// Table 3 (number of operators), Table 5 (PI with and without the inverse model).
#include "bench.hpp"
#include "hysteresis/exponential_operator.hpp"

namespace {

using namespace bench;

constexpr int kSamples = 1000;  // 1 kHz at 1 Hz

double largest(const std::vector<double>& got, const std::vector<double>& wanted) {
  double out = 0.0;
  for (std::size_t i = kSamples; i < got.size(); ++i) out = std::max(out, std::abs(got[i] - wanted[i]));
  return out;
}

struct Control {
  double kp, ki;
  enum class Forward { none, direct, inverse } forward;
};

/// Eq. 6 at 10 kHz; drive and displacement in parts of 100 V and 12 um, as the printed gains mean.
std::pair<double, double> bound(const VirtualStageSettings& settings, const Control& control,
                                const Identified& inverse_model, double f, bool closed) {
  const double ts = 1e-4;
  VirtualStage stage(settings);
  const auto inverse = make_operator(inverse_model.model);
  const int n = static_cast<int>((f < 50 ? 6 : 30) / (f * ts));
  double sum = 0.0, u = 0.0, low = 0.0, high = 0.0;
  double y = stage.reset(0.0);
  inverse->reset(0.0);
  for (int i = 0; i < n; ++i) {
    const double t = i * ts;
    const double ramp = std::min(1.0, t * f / 2.0);  // eases in over two periods
    const double r = ramp * 5.0 + ramp * 4.0 * std::sin(2 * kPi * f * t);
    const double e = r - y;
    sum += e;
    double forward = 0.0;
    if (control.forward == Control::Forward::direct) forward = r / 12.0;
    if (control.forward == Control::Forward::inverse) forward = inverse->step(r, ts) / 100.0;
    u = closed ? (control.kp * e + control.ki * ts * sum) / 12.0 + forward : r / 12.0;
    y = stage.step(100.0 * u, ts);
    if (i > n / 2) {
      const double next = i + 1 < n ? 5.0 + 4.0 * std::sin(2 * kPi * f * (t + ts)) : r;
      low = std::min(low, next - y);
      high = std::max(high, next - y);
    }
  }
  return {low, high};
}

/// Section 6 and Fig. 8: what a parameter of eq. 3, 5 % larger, does to the modelling error; dL/d ln p at the full stroke next to it.
void sensitivity(const Identified& four, const TimeRecord& record) {
  const ExponentialOperators simple = ExponentialOperators::from(four.model.parameters).dominant_only();
  const auto error_with = [&](std::size_t i, bool lag, double factor) {
    ExponentialOperators one = simple;
    (lag ? one.tau : one.k)[i] *= factor;
    Identified moved = four;
    moved.model.parameters.set("k", one.k).set("tau", one.tau);
    return largest(StageModel(moved, 0.0).simulate(record.u, record.step_s), record.y);
  };
  // dominant_only(): K - k_d without lag, then the dominant operator; K alone moves the first by K/(K - k_d).
  const double total = simple.k[0] + simple.k[1], stroke = 100.0, left = std::exp(-simple.tau[1] * stroke);
  fmt::print(
      "\nSensitivity of eq. 3 (section 6): largest error {:.2f} um; with the parameter 5 % larger, and "
      "dL/d ln p at the full stroke\n",
      error_with(0, false, 1.0));
  fmt::print("{:>10}: {:6.2f} um {:8.2f} um\n", "K", error_with(0, false, 1.0 + 0.05 * total / simple.k[0]),
             total * stroke);
  // k_d alone moves both: K stays.
  ExponentialOperators both = simple;
  both.k[1] *= 1.05;
  both.k[0] -= 0.05 * simple.k[1];
  Identified moved = four;
  moved.model.parameters.set("k", both.k).set("tau", both.tau);
  fmt::print("{:>10}: {:6.2f} um {:8.2f} um (printed with the other sign)\n", "k_d",
             largest(StageModel(moved, 0.0).simulate(record.u, record.step_s), record.y),
             -simple.k[1] * left * stroke);
  fmt::print("{:>10}: {:6.2f} um {:8.2f} um\n", "tau_d", error_with(1, true, 1.05),
             simple.k[1] * simple.tau[1] * stroke * left * stroke);
}

}  // namespace

int main() {
  VirtualStageSettings settings = VirtualStageSettings::pusher();
  const double step_s = 1.0 / kSamples;
  // Every record begins with one full triangle that is not counted: the stage's first rise is no branch of
  // its loops.
  const auto record = [&](double periods, const std::function<double(double)>& shape, double dt) {
    const auto f = [&](double c) { return c < 1.0 ? 100.0 * triangle(c) : shape(c - 1.0); };
    return measure(settings, wave(kSamples, periods + 1.0, f), dt);
  };
  const TimeRecord train = record(
      4.0, [](double c) { return 100.0 * triangle(c); }, step_s);
  const TimeRecord tests[] = {
      train,
      record(
          8.0, [](double c) { return 50.0 * std::exp(-0.25 * c) * (1.0 - std::cos(2 * kPi * c)); }, step_s),
      record(
          8.0, [](double c) { return 50.0 * std::exp(-0.25 * (8.0 - c)) * (1.0 - std::cos(2 * kPi * c)); },
          step_s),
      record(
          8.0, [](double c) { return 50.0 - 50.0 * std::exp(-0.25 * c) * std::cos(2 * kPi * c); }, step_s),
      record(
          6.0, [](double c) { return 50.0 - 35.0 * std::cos(2 * kPi * c) - 15.0 * std::cos(6 * kPi * c); },
          0.1 * step_s),
  };
  fmt::print(
      "Table 3, largest modelling error in um: triangle, decaying, growing, decaying about the middle, "
      "second-order reversals\n{:>10} | {:>30} | {:>30}\n",
      "operators", "paper", "ours");
  const double paper[7][5] = {{.44, .53, .60, .58, .40}, {.29, .38, .38, .38, .35}, {.26, .37, .38, .37, .35},
                              {.27, .37, .38, .38, .34}, {.28, .38, .38, .38, .36}, {.28, .38, .37, .37, .35},
                              {.29, .39, .39, .38, .37}};
  StageModel four;
  Identified of_four;
  for (int row = 0; row < 8; ++row) {
    IdentifyOptions options;
    options.size = row == 7 ? 2 : row == 6 ? 4 : 3 + row;
    options.skip_s = 1.0;
    Identified found = model_type_registry().get("exponential_operator").identify({&train, 1}, options);
    if (options.size == 4) four = StageModel(found, 0.0);
    if (row == 1) of_four = found;
    if (row == 6) {
      const ExponentialOperators simple = ExponentialOperators::from(found.model.parameters).dominant_only();
      found.model.parameters.set("k", simple.k).set("tau", simple.tau);
    }
    std::string a, b;
    for (int i = 0; i < 5; ++i) {
      a += row < 7 ? fmt::format("{:6.2f}", paper[row][i]) : std::string();
      b += fmt::format("{:6.2f}",
                       largest(StageModel(found, 0.0).simulate(tests[i].u, tests[i].step_s), tests[i].y));
    }
    fmt::print("{:>10} | {:>30} | {:>30}\n",
               row == 7   ? "2 refitted"
               : row == 6 ? "dominant"
                          : std::to_string(3 + row),
               a, b);
  }

  sensitivity(of_four, train);

  // Eq. 4, 5: the inverse by the same form, on the exchanged record, dominant operator only.
  const TimeRecord turned = exchanged(train);
  const Identified inverse = model_type_registry().get("exponential_operator").identify({&turned, 1}, {});
  fmt::print("\nInverse by operators of the same form (eq. 4): rms {:.2f} % of the drive's range\n\n",
             error_figures(StageModel(inverse, 0.0), {&turned, 1}).rms_percent);
  fmt::print(
      "Table 5, tracking 5 + 4 sin um, smallest and largest error in um\n{:<24} | {:>16} {:>16} | {:>18} "
      "{:>18}\n",
      "", "paper 100 Hz", "paper 10 Hz", "ours 100 Hz", "ours 10 Hz");
  const struct {
    const char* name;
    Control control;
    bool closed;
    const char* at_100;
    const char* at_10;
  } rows[] = {
      {"PI with inverse model",
       {0.5, 2500, Control::Forward::inverse},
       true,
       "-0.1 to 0.15",
       "-0.01 to 0.05"},
      {"PI with direct forward", {0.5, 2500, Control::Forward::direct}, true, "+-0.4", "+-0.1"},
      {"traditional PI", {0.75, 1875, Control::Forward::none}, true, "+-2.5", "-0.1 to 0.2"},
      {"open loop", {0, 0, Control::Forward::none}, false, "-", "-1 to 0.5"},
  };
  for (const auto& row : rows) {
    const auto fast = bound(settings, row.control, inverse, 100.0, row.closed);
    const auto slow = bound(settings, row.control, inverse, 10.0, row.closed);
    fmt::print("{:<24} | {:>16} {:>16} | {:>18} {:>18}\n", row.name, row.at_100, row.at_10,
               fmt::format("{:.2f} to {:.2f}", fast.first, fast.second),
               fmt::format("{:.2f} to {:.2f}", slow.first, slow.second));
  }
  fmt::print(
      "\nShape: from three or four operators on nothing is gained, as in the paper. Striking out all but the "
      "dominant operator\n"
      "costs here what it does not cost there: our four fit best together, so two are better fitted anew "
      "than left over (last\n"
      "row). What remains is the stage's asymmetry, which no number of operators can follow (their loops are "
      "centrally\n"
      "symmetric). The order of the controllers is the paper's; the printed gains act here on parts of 100 V "
      "and 12 um.\n");
  return 0;
}
