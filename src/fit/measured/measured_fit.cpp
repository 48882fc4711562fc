#include "fit/measured/measured_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "fit/measured/measured_search.hpp"
#include "lti/section_making.hpp"
#include "signal/statistics.hpp"

namespace bodesmith {
namespace {

constexpr double kLeastRelative = 1e-7;

/// |deviation| squared of every inner point from the line through its neighbours, as the variance of one point.
std::vector<double> neighbour_variances(const FrequencyRecord& record) {
  std::vector<double> out;
  for (std::size_t i = 1; i + 1 < record.response.size(); ++i) {
    const double low = std::log(record.frequency[i - 1].value);
    const double high = std::log(record.frequency[i + 1].value);
    const double t = (std::log(record.frequency[i].value) - low) / (high - low);
    const Complex line = (1.0 - t) * record.response[i - 1] + t * record.response[i + 1];
    out.push_back(std::norm(record.response[i] - line) / (1.0 + (1.0 - t) * (1.0 - t) + t * t));
  }
  return out;
}

std::size_t half_window(std::size_t count) {
  return std::clamp<std::size_t>(count / 60, 5, 60);
}

/// variance = floor + share |H|^2.
struct TwoPartNoise {
  double floor = 0.0;
  double share = 0.0;
  double variance(Complex h) const { return floor + share * std::norm(h); }
};

/// By reweighted least squares of |error|^2 on 1 and |H|^2, both parts at least a trace above 0.
TwoPartNoise two_part_noise(const std::vector<Complex>& errors, const std::vector<Complex>& response) {
  const auto count = static_cast<double>(errors.size());
  double all = 0.0;
  double power = 0.0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    all += std::norm(errors[i]) / count;
    power += std::norm(response[i]) / count;
  }
  const double trace = 1e-14 * power + 1e-290;
  TwoPartNoise out{std::max(0.5 * all, trace), std::max(0.5 * all / std::max(power, 1e-290), 1e-14)};
  for (int round = 0; round < 30; ++round) {
    double s11 = 0.0, s1h = 0.0, shh = 0.0, e1 = 0.0, eh = 0.0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const double h = std::norm(response[i]);
      const double weight = 1.0 / std::pow(out.variance(response[i]), 2);
      const double e = std::norm(errors[i]);
      s11 += weight, s1h += weight * h, shh += weight * h * h, e1 += weight * e, eh += weight * e * h;
    }
    const double determinant = s11 * shh - s1h * s1h;
    if (!(determinant > 1e-12 * s11 * shh)) break;
    const double floor = (e1 * shh - eh * s1h) / determinant;
    const double share = (s11 * eh - s1h * e1) / determinant;
    // One part negative: the other takes all.
    out = floor < 0.0   ? TwoPartNoise{1e-6 * out.floor + trace, std::max(eh / shh, 1e-14)}
          : share < 0.0 ? TwoPartNoise{std::max(e1 / s11, trace), 1e-6 * out.share + 1e-14}
                        : TwoPartNoise{std::max(floor, trace), std::max(share, 1e-14)};
  }
  return out;
}

/// Standard deviations (of |error|, both components together) of the points of a measured response: how far each lies
/// from the straight line through its neighbours (in ln frequency), as a running median, never below 1e-7 of the
/// magnitude. With a coherence gamma^2 the relative deviation is at least sqrt((1 - gamma^2)/(2 gamma^2)) (J. S. Bendat,
/// A. G. Piersol, "Random Data", eq. 9.90, one average). Coarse sampling of a curved response counts as noise here;
/// noise_from_errors() corrects it once there is a model.
std::vector<double> noise_from_neighbours(const FrequencyRecord& record) {
  const std::size_t count = record.response.size();
  const std::vector<double> variances = neighbour_variances(record);
  const std::size_t half = half_window(count);
  std::vector<double> out(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t from = i > half + 1 ? i - half - 1 : 0;
    const std::size_t to = std::min(variances.size(), i + half);
    std::vector<double> window(variances.begin() + static_cast<std::ptrdiff_t>(std::min(from, to)),
                               variances.begin() + static_cast<std::ptrdiff_t>(to));
    double variance = 0.0;
    if (!window.empty()) {
      variance = median(std::move(window)) / std::log(2.0);  // |complex normal|^2 is exponential
    }
    const double magnitude = std::abs(record.response[i]);
    out[i] = std::max(std::sqrt(variance), kLeastRelative * magnitude);
    if (!record.coherence.empty()) {
      const double c = std::clamp(record.coherence[i], 1e-3, 1.0);
      out[i] = std::max(out[i], magnitude * std::sqrt((1.0 - c) / (2.0 * c)));
    }
    if (!(out[i] > 0.0)) out[i] = 1e-300;
  }
  return out;
}

/// The same from a model's errors: variance = (a + b |H|^2) c, a and b by least squares, c slowly varying.
std::vector<double> noise_from_errors(const std::vector<Complex>& errors,
                                      const std::vector<Complex>& response) {
  const std::size_t count = errors.size();
  const TwoPartNoise parts = two_part_noise(errors, response);
  const std::size_t half = std::clamp<std::size_t>(count / 12, 20, 400);
  std::vector<double> out(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t from = i > half ? i - half : 0;
    const std::size_t to = std::min(count, i + half + 1);
    // Summed anew: magnitudes of many decades would leave nothing of a running sum.
    double mean = 0.0;
    for (std::size_t j = from; j < to; ++j) mean += std::norm(errors[j]) / parts.variance(response[j]);
    mean /= static_cast<double>(to - from);
    out[i] = std::max(std::sqrt(mean * parts.variance(response[i])), kLeastRelative * std::abs(response[i]));
    if (!(out[i] > 0.0)) out[i] = 1e-300;
  }
  return out;
}

constexpr std::size_t kLeastPoints = 8;
constexpr std::size_t kFold = 5;         ///< one point in five is held out
constexpr double kStandardErrors = 2.0;  ///< an order within this of the best is as good
constexpr int kPatience = 4;             ///< orders without gain after which none larger is tried

/// The record in normalised units: s over the highest frequency, response over its typical size.
struct NormalisedRecord {
  ResponseSamples samples;
  RadPerSecond unit;
  double size = 1.0;
};

NormalisedRecord normalised(const FrequencyRecord& record) {
  NormalisedRecord out;
  out.unit = record.frequency.back().rad_s();
  double sum = 0.0;
  std::size_t count = 0;
  for (const Complex& h : record.response) {
    if (std::abs(h) > 0.0) sum += std::log(std::abs(h)), ++count;
  }
  if (count == 0) throw InputError(record.file + ": the response is 0 at every frequency");
  out.size = std::exp(sum / static_cast<double>(count));
  out.samples.deviation = noise_from_neighbours(record);
  for (std::size_t i = 0; i < record.response.size(); ++i) {
    out.samples.s.emplace_back(0.0, record.frequency[i].rad_s().value / out.unit.value);
    out.samples.response.push_back(record.response[i] / out.size);
    out.samples.deviation[i] /= out.size;
  }
  return out;
}

/// Evenly chosen, at most so many: enough to tell orders apart; the model is refined on all of them.
ResponseSamples thinned(const ResponseSamples& all, std::size_t most) {
  const std::size_t step = (all.s.size() + most - 1) / most;
  if (step <= 1) return all;
  ResponseSamples out;
  for (std::size_t i = 0; i < all.s.size(); i += step) {
    out.s.push_back(all.s[i]);
    out.response.push_back(all.response[i]);
    out.deviation.push_back(all.deviation[i]);
  }
  return out;
}

struct Split {
  ResponseSamples kept;
  ResponseSamples held_out;
};

Split split(const ResponseSamples& all) {
  Split out;
  for (std::size_t i = 0; i < all.s.size(); ++i) {
    ResponseSamples& to = i % kFold == kFold / 2 ? out.held_out : out.kept;
    to.s.push_back(all.s[i]);
    to.response.push_back(all.response[i]);
    to.deviation.push_back(all.deviation[i]);
  }
  return out;
}

std::vector<double> losses(const FactoredResponse& model, const ResponseSamples& samples) {
  std::vector<double> out;
  for (std::size_t i = 0; i < samples.s.size(); ++i) {
    // A single wild point decides nothing.
    out.push_back(std::min(
        std::norm((model.response(samples.s[i]) - samples.response[i]) / samples.deviation[i]), 1e12));
  }
  return out;
}

/// Mean of a - b in units of its standard error.
double excess(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  const double lead = mean(a) - mean(b);
  double square = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) square += std::pow(a[i] - b[i] - lead, 2);
  const double error = std::sqrt(square / (n * (n - 1.0)));
  return error > 0.0 ? lead / error : (lead > 0.0 ? 1e9 : 0.0);
}

int most_poles(std::size_t points) {
  return static_cast<int>(std::clamp<std::size_t>((points - 3) / 3, 1, 60));
}

/// What the held-out points say of every order.
struct OrderChoice {
  std::vector<MeasuredFit::Order> orders;
  int order = 1;
  FactoredResponse model;
};

OrderChoice choose_order(const ResponseSamples& all, const MeasuredFitOptions& options) {
  constexpr std::size_t kEnoughPoints = 4000;
  const Split points = split(thinned(all, kEnoughPoints));
  MeasuredSearch search(points.kept, options.delay);
  Progress progress("fit");
  const int top = std::min(options.max_order, most_poles(points.kept.s.size()));
  std::vector<std::vector<double>> loss;
  std::size_t best = 0;
  for (int order = 1; order <= top; ++order) {
    stop_if_interrupted();
    loss.push_back(losses(search.of_order(order), points.held_out));
    if (mean(loss.back()) < mean(loss[best])) best = loss.size() - 1;
    progress.at(static_cast<double>(order) / top);
    if (static_cast<int>(loss.size() - 1 - best) >= kPatience && mean(loss[best]) < 30.0) break;
  }
  OrderChoice out;
  for (std::size_t i = 0; i < loss.size(); ++i) {
    out.orders.push_back({static_cast<int>(i) + 1, mean(loss[i]), excess(loss[i], loss[best])});
  }
  // Points with noise leave about 1. Far less: the noise is the least that is assumed, of a file that has none, and
  // further poles would follow its rounding.
  constexpr double kNothingLeft = 0.01;
  const auto chosen = std::ranges::find_if(out.orders, [&](const MeasuredFit::Order& order) {
    if (order.held_out <= kNothingLeft) return true;
    return order.against_best <= kStandardErrors && order.held_out <= 1.5 * mean(loss[best]);
  });
  out.order = chosen->order;
  out.model = search.of_order(out.order);
  return out;
}

/// An order that was asked for: from evenly spread poles; where these do not reach the noise, grown pair by pair too.
FactoredResponse of_given_order(const ResponseSamples& all, int order, bool delay) {
  FactoredResponse best = MeasuredSearch(all, delay).of_order(order);
  if (best.cost <= 1.3 * static_cast<double>(all.s.size())) return best;
  MeasuredSearch grown(all, delay);
  for (int n = order % 2 == 0 ? 2 : 1; n < order; n += 2) {
    stop_if_interrupted();
    (void)grown.of_order(n);
  }
  const FactoredResponse& other = grown.of_order(order);
  return other.cost < best.cost ? other : best;
}

/// Rewrites the deviations by the model's own errors and refines it with them.
FactoredResponse with_own_noise(FactoredResponse model, ResponseSamples& samples) {
  for (int round = 0; round < 2; ++round) {
    std::vector<Complex> errors;
    for (std::size_t i = 0; i < samples.s.size(); ++i) {
      errors.push_back(model.response(samples.s[i]) - samples.response[i]);
    }
    samples.deviation = noise_from_errors(errors, samples.response);
    model = refine(model, samples, 60);
  }
  return model;
}

/// Leaves out what the data do not ask for (Schwarz's criterion): a delay, then zeros above the band.
FactoredResponse pruned(FactoredResponse model, const ResponseSamples& samples) {
  const double price = 2.0 * std::log(2.0 * static_cast<double>(samples.s.size()));
  const auto take = [&](const FactoredResponse& simpler) {
    if (simpler.cost > model.cost + price) return false;
    model = simpler;
    return true;
  };
  if (model.fits_delay) {
    FactoredResponse simpler = model;
    simpler.fits_delay = false;
    simpler.delay = 0.0;
    take(refine(simpler, samples, 80));
  }
  return without_far_zeros(std::move(model), samples);
}

MeasuredFit::Root physical(const FactoredResponse::Factor& f, RadPerSecond unit) {
  const double hz = unit.hz().value;
  return {f.pair, Hertz{f.frequency * hz}, Hertz{f.frequency_deviation * hz}, f.damping, f.damping_deviation};
}

Sections physical_sections(const FactoredResponse& model, const NormalisedRecord& record) {
  std::vector<Complex> poles = model.pole_roots();
  std::vector<Complex> zeros = model.zero_roots();
  for (Complex& p : poles) p *= record.unit.value;
  for (Complex& z : zeros) z *= record.unit.value;
  const double gain =
      model.gain * record.size *
      std::pow(record.unit.value, static_cast<double>(poles.size()) - static_cast<double>(zeros.size()));
  Sections out = make_sections(gain, std::move(zeros), std::move(poles));
  out.delay_s = model.delay / record.unit.value;
  return out;
}

void state_errors(const FrequencyRecord& record, const NormalisedRecord& normal, MeasuredFit& out) {
  double db = 0.0;
  double relative = 0.0;
  std::vector<double> noise;
  for (std::size_t i = 0; i < record.response.size(); ++i) {
    const Complex wanted = record.response[i];
    if (wanted == Complex(0.0)) continue;
    const Complex ratio = out.sections.response(record.frequency[i].rad_s()) / wanted;
    db += std::pow(to_decibel(std::abs(ratio)), 2);
    out.max_db = std::max(out.max_db, std::abs(to_decibel(std::abs(ratio))));
    relative += std::norm(ratio - 1.0);
    noise.push_back(100.0 * normal.samples.deviation[i] * normal.size / std::abs(wanted));
  }
  const auto count = static_cast<double>(noise.size());
  out.rms_db = std::sqrt(db / count);
  out.rms_percent = 100.0 * std::sqrt(relative / count);
  out.noise_percent = median(std::move(noise));
}

void warn(const FactoredResponse& model, MeasuredFit& out) {
  if (!model.converged)
    out.warnings.emplace_back("the refinement was still improving when its iterations were over");
  for (const MeasuredFit::Root& pole : out.poles) {
    const double spread = pole.frequency_deviation.value / std::abs(pole.frequency.value);
    if (spread > 0.5) {
      out.warnings.push_back(fmt::format("the pole at {} is hardly determined ({} % of its frequency)",
                                         engineering_text(pole.frequency.value, "Hz"),
                                         std::isfinite(spread) ? rounded_text(100.0 * spread, 2) : "any"));
    }
  }
}

void check_record(const FrequencyRecord& record, const MeasuredFitOptions& options) {
  const std::size_t count = record.response.size();
  if (count < kLeastPoints) {
    throw InputError(fmt::format("{}: {} points, expected at least {} to fit a model to them", record.file,
                                 count, kLeastPoints));
  }
  if (options.order && *options.order > most_poles(count)) {
    throw InputError(
        fmt::format("{}: order {} has more unknowns than {} points determine, expected at most {}",
                    record.file, *options.order, count, most_poles(count)));
  }
}

}  // namespace

MeasuredFit fit_measured(const FrequencyRecord& record, const MeasuredFitOptions& options) {
  check_record(record, options);
  NormalisedRecord normal = normalised(record);
  MeasuredFit out;
  FactoredResponse model;
  if (options.order) {
    model = of_given_order(normal.samples, *options.order, options.delay);
  } else {
    OrderChoice choice = choose_order(normal.samples, options);
    out.orders = std::move(choice.orders);
    model = refine(choice.model, normal.samples, 60);
  }
  model = pruned(with_own_noise(std::move(model), normal.samples), normal.samples);
  model = with_zeros_at_rest(std::move(model), normal.samples);

  out.order = model.pole_count();
  out.sections = physical_sections(model, normal);
  out.delay_s = out.sections.delay_s;
  out.delay_deviation_s = model.fits_delay ? model.delay_deviation / normal.unit.value : 0.0;
  out.gain_deviation_percent = 100.0 * model.gain_deviation / std::abs(model.gain);
  for (const auto& f : model.poles) out.poles.push_back(physical(f, normal.unit));
  for (const auto& f : model.zeros) out.zeros.push_back(physical(f, normal.unit));
  out.rms_noise = std::sqrt(model.cost / static_cast<double>(record.response.size()));
  out.converged = model.converged;
  state_errors(record, normal, out);
  warn(model, out);
  return out;
}

}  // namespace bodesmith
