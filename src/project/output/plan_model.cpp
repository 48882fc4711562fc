#include "project/output/plan_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <optional>

#include "base/error.hpp"
#include "chain/chain.hpp"
#include "chain/registry.hpp"
#include "fit/measured/factored_response.hpp"
#include "fpaa/plan/plan_graph.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/judge_responses.hpp"
#include "numeric/quadratic_roots.hpp"
#include "project/output/circuit_model.hpp"

namespace bodesmith::project {
namespace {

using Factor = FactoredResponse::Factor;

/// From the input pin to the output.
std::vector<const fpaa::PlacedCam*> cams_in_series(const fpaa::PlanGraph& graph) {
  if (!graph.output.node) throw DesignError("the plan has no output that is wired");
  std::vector<const fpaa::PlacedCam*> out;
  for (std::optional<std::size_t> at = graph.output.node; at;) {
    const fpaa::PlanGraph::PlanNode& cam = graph.nodes[*at];
    if (cam.inputs.size() != 1)
      throw DesignError(
          fmt::format("the plan is no chain: {} takes {} inputs, expected one", cam.name, cam.inputs.size()));
    out.push_back(cam.cam);
    at = cam.inputs.front().from.node;
  }
  std::ranges::reverse(out);
  return out;
}

/// c0 + c1/z + c2/z^2 under 1/z = (2 fc - s)/(2 fc + s), times (2 fc + s)^degree; s in units of `unit`.
std::vector<Factor> bilinear_factors(const std::vector<double>& c, std::size_t degree, double two_clocks) {
  const auto at = [&](std::size_t i) { return i < c.size() ? c[i] : 0.0; };
  return FactoredResponse::factors_of(
      degree < 2 ? quadratic_roots(two_clocks * (at(0) + at(1)), at(0) - at(1), 0.0)
                 : quadratic_roots(two_clocks * two_clocks * (at(0) + at(1) + at(2)),
                                   2.0 * two_clocks * (at(0) - at(2)), at(0) - at(1) + at(2)));
}

/// One response made of the factors of all CAMs, which knows whose they are.
class CamFactors {
 public:
  CamFactors(std::vector<const fpaa::PlacedCam*> cams, double unit_rad_s)
      : cams_(std::move(cams)), unit_(unit_rad_s) {
    for (const fpaa::PlacedCam* cam : cams_) {
      const std::size_t degree = std::max(cam->z.numerators[0].size(), cam->z.denominator.size()) - 1;
      const double two_clocks = 2.0 * cam->clock_a.value / unit_;
      add(start_.zeros, zeros_, bilinear_factors(cam->z.numerators[0], degree, two_clocks));
      add(start_.poles, poles_, bilinear_factors(cam->z.denominator, degree, two_clocks));
    }
  }

  /// Fitted from the CAMs' own roots.
  FactoredResponse fitted(const ResponseSamples& samples, bool with_delay) const {
    FactoredResponse model = start_;
    model.fits_delay = with_delay;
    Complex of_both = 0.0;
    double of_model = 0.0;
    for (std::size_t i = 0; i < samples.s.size(); ++i) {
      const Complex h = model.response(samples.s[i]) / samples.deviation[i];
      of_both += std::conj(h) * samples.response[i] / samples.deviation[i];
      of_model += std::norm(h);
    }
    model.gain = of_both.real() / of_model;
    model = refine(model, samples, kIterations);
    // What is at rest in every CAM is so in all of them.
    for (const auto which : {&FactoredResponse::zeros, &FactoredResponse::poles}) {
      for (std::size_t i = 0; i < (start_.*which).size(); ++i) {
        if (!(start_.*which)[i].pair && (start_.*which)[i].frequency == 0.0)
          (model.*which)[i].frequency = 0.0;
      }
    }
    return model;
  }

  /// Its blocks. Each CAM has the gain of its own capacitors, at rest or at its poles' frequency; the last one what the fit adds to it.
  std::vector<chain::Block> blocks(const FactoredResponse& model) const {
    std::vector<Section> sections;
    double left = model.gain;
    for (std::size_t i = 0; i < cams_.size(); ++i) {
      Section one{1.0, roots(model.zeros, zeros_, i), roots(model.poles, poles_, i)};
      left *= std::pow(unit_, static_cast<double>(one.poles.size()) - static_cast<double>(one.zeros.size()));
      const bool at_rest = std::abs(cams_[i]->z.dc_gain()) > 1e-9 && !integrates(one);
      const RadPerSecond w{at_rest || one.poles.empty() ? 0.0 : std::abs(one.poles.front())};
      const Complex ratio = cams_[i]->z.response(w, cams_[i]->clock_a) / one.response(Complex(0.0, w.value));
      one.gain = std::copysign(std::abs(ratio), ratio.real());
      left /= one.gain;
      sections.push_back(std::move(one));
    }
    std::vector<chain::Block> out;
    for (std::size_t i = 0; i < cams_.size(); ++i) {
      if (i + 1 == cams_.size()) sections[i].gain *= left;
      std::ranges::move(stage_blocks(sections[i], cams_[i]->name), std::back_inserter(out));
    }
    if (model.delay > 0.0) {
      out.push_back(chain::make_block("delay").set("delay_s", model.delay / unit_));
      out.back().part = "delay";
    }
    return out;
  }

 private:
  static constexpr int kIterations = 200;

  static void add(std::vector<Factor>& to, std::vector<std::size_t>& ends, std::vector<Factor> factors) {
    to.insert(to.end(), factors.begin(), factors.end());
    ends.push_back(to.size());
  }
  std::vector<Complex> roots(const std::vector<Factor>& factors, const std::vector<std::size_t>& ends,
                             std::size_t cam) const {
    std::vector<Complex> out;
    for (std::size_t i = cam == 0 ? 0 : ends[cam - 1]; i < ends[cam]; ++i) {
      for (const Complex& root : factors[i].roots()) out.push_back(unit_ * root);
    }
    return out;
  }

  std::vector<const fpaa::PlacedCam*> cams_;
  double unit_;
  FactoredResponse start_;
  std::vector<std::size_t> zeros_, poles_;  ///< behind each CAM's own
};

}  // namespace

PlanModel plan_model(const fpaa::Plan& plan) {
  const fpaa::SwitchedBoard board(plan);
  const Band stated = plan.error_with_delays.band;
  const Band fitted{Hertz{0.1 * stated.from.value},
                    std::max(stated.to, Hertz{0.25 * *plan.clocks_hz().begin()})};
  const double unit = std::sqrt(stated.from.rad_s().value * stated.to.rad_s().value);
  ResponseSamples samples;
  double largest = 0.0;
  for (const Hertz f : log_grid(fitted, 200)) {
    samples.s.emplace_back(0.0, f.rad_s().value / unit);
    samples.response.push_back(board.gain(f.rad_s()));
    largest = std::max(largest, std::abs(samples.response.back()));
  }
  for (const Complex& h : samples.response)
    samples.deviation.push_back(std::max(std::abs(h), kJudgedFloor * largest));
  const CamFactors cams(cams_in_series(board.graph()), unit);
  const auto made = [&](bool with_delay) {
    PlanModel one{cams.blocks(cams.fitted(samples, with_delay)), stated};
    chain::Chain model;
    model.blocks = one.blocks;
    one.worst_percent = judge_responses(at_each([&](RadPerSecond w) { return *model.response(w); }),
                                        at_each([&](RadPerSecond w) { return board.gain(w); }), stated)
                            .max_complex_percent;
    return one;
  };
  PlanModel out = made(false);
  if (out.worst_percent <= plan.error_with_delays.max_complex_percent) return out;
  PlanModel late = made(true);
  return late.worst_percent < out.worst_percent ? late : out;
}

}  // namespace bodesmith::project
