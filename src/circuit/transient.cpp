#include "circuit/transient.hpp"

#include <algorithm>
#include <cmath>

#include "base/whole_number.hpp"
#include "circuit/stages/stage_form.hpp"

namespace bodesmith::circuit {
namespace {

struct StageState {
  int order = 0;
  double b0 = 0, b1 = 0, a0 = 0, a1 = 0;  ///< of the strictly proper rest, monic denominator
  double direct = 0.0;
};

StageState canonical(const Biquad& h) {
  StageState out;
  if (h.a2 != 0.0) {
    out.order = 2;
    out.a0 = h.a0 / h.a2;
    out.a1 = h.a1 / h.a2;
    out.direct = h.b2 / h.a2;
    out.b0 = h.b0 / h.a2 - out.direct * out.a0;
    out.b1 = h.b1 / h.a2 - out.direct * out.a1;
  } else if (h.a1 != 0.0) {
    out.order = 1;
    out.a0 = h.a0 / h.a1;
    out.direct = h.b1 / h.a1;
    out.b0 = h.b0 / h.a1 - out.direct * out.a0;
  } else {
    out.direct = h.b0 / h.a0;
  }
  return out;
}

class Cascade {
 public:
  explicit Cascade(const Circuit& circuit) {
    for (const Stage& stage : circuit.stages) {
      const std::vector<Biquad> factors =
          stage.form ? std::vector<Biquad>{stage.form->aim(circuit.realised_values(stage))} : stage.realised;
      for (const Biquad& h : factors) {
        stages_.push_back(canonical(h));
        states_ += stages_.back().order;
        for (const auto& pole : h.section().poles) fastest_ = std::max(fastest_, std::abs(pole));
      }
    }
  }
  int states() const { return states_; }
  double fastest() const { return fastest_; }

  /// Derivatives into `dx`; the output voltage.
  double step(double u, const std::vector<double>& x, std::vector<double>& dx) const {
    size_t at = 0;
    for (const StageState& s : stages_) {
      double y = s.direct * u;
      if (s.order == 1) {
        dx[at] = u - s.a0 * x[at];
        y += s.b0 * x[at];
      } else if (s.order == 2) {
        dx[at] = x[at + 1];
        dx[at + 1] = u - s.a0 * x[at] - s.a1 * x[at + 1];
        y += s.b0 * x[at] + s.b1 * x[at + 1];
      }
      at += static_cast<size_t>(s.order);
      u = y;
    }
    return u;
  }

 private:
  std::vector<StageState> stages_;
  int states_ = 0;
  double fastest_ = 0.0;
};

}  // namespace

std::vector<double> simulate_stages(const Circuit& circuit, const std::function<double(double)>& input,
                                    double step_s, int count) {
  const Cascade cascade(circuit);
  const size_t n = static_cast<size_t>(cascade.states());
  const int inner = whole_number(std::ceil(step_s * cascade.fastest() / 0.1), 1);
  const double h = step_s / inner;
  std::vector<double> x(n, 0.0), k1(n), k2(n), k3(n), k4(n), at(n), out;
  const auto move = [&](const std::vector<double>& k, double by) {
    for (size_t i = 0; i < n; ++i) at[i] = x[i] + by * k[i];
  };
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < inner; ++j) {
      const double t = step_s * i + h * j;
      const double y = cascade.step(input(t), x, k1);
      if (j == 0) out.push_back(y);
      move(k1, 0.5 * h);
      cascade.step(input(t + 0.5 * h), at, k2);
      move(k2, 0.5 * h);
      cascade.step(input(t + 0.5 * h), at, k3);
      move(k3, h);
      cascade.step(input(t + h), at, k4);
      for (size_t s = 0; s < n; ++s) x[s] += h / 6.0 * (k1[s] + 2.0 * (k2[s] + k3[s]) + k4[s]);
    }
  }
  return out;
}

}  // namespace bodesmith::circuit
