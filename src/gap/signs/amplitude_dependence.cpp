#include "gap/signs/amplitude_dependence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <iterator>
#include <numbers>
#include <span>
#include <utility>

#include "base/text.hpp"
#include "gap/search_options.hpp"
#include "gap/signs/chance.hpp"
#include "numeric/interpolated.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Changes of a gain's or a peak's logarithm that four digits round away; all larger ones are held against chance alone.
constexpr double kRounded = 1e-4;
/// A peak stands out by half of its power on both sides (ln of the gain).
constexpr double kProminent = std::numbers::ln2 / 2.0;

const FrequencyRecord* with_drive(const Experiment& experiment) {
  const auto* response = std::get_if<FrequencyExperiment>(&experiment);
  return response != nullptr && !response->record().drive_v.empty() ? &response->record() : nullptr;
}

double drive_of(const FrequencyRecord& record) {
  return median(record.drive_v);
}

/// Of the least and of the largest drive; null: no drive is known.
std::pair<const FrequencyRecord*, const FrequencyRecord*> extremes(const Experiments& experiments) {
  const FrequencyRecord* least = nullptr;
  const FrequencyRecord* largest = nullptr;
  for (const auto& e : experiments) {
    const auto* record = with_drive(e);
    if (record == nullptr) continue;
    if (least == nullptr || drive_of(*record) < drive_of(*least)) least = record;
    if (largest == nullptr || drive_of(*record) > drive_of(*largest)) largest = record;
  }
  return {least, largest};
}

/// ln |H| and phase without jumps, over ln f.
struct Logarithm {
  std::vector<double> at;
  std::vector<double> gain;
  std::vector<double> phase;

  explicit Logarithm(const FrequencyRecord& record) {
    for (std::size_t i = 0; i < record.frequency.size(); ++i) {
      at.push_back(std::log(record.frequency[i].value));
      const std::complex<double> v = std::log(record.response[i]);
      const double last = i > 0 ? phase.back() : v.imag();
      gain.push_back(v.real());
      phase.push_back(last + std::remainder(v.imag() - last, 2.0 * std::numbers::pi));
    }
  }
  bool covers(double x) const { return x >= at.front() && x <= at.back(); }
};

struct Peak {
  double at = 0.0;    ///< ln f
  double step = 0.0;  ///< of the grid there
  /// How far the peak of 1/(1 + 2 z s/w + s^2/w^2) stands below w: ln sqrt(1 - 2 z^2), z from its height over the first
  /// point of the record, 1/(2 z sqrt(1 - z^2)).
  double by_damping = 0.0;
};

double shift_by_damping(double height) {
  const double least = 1.0 / (height * height);
  return least < 1.0 ? 0.25 * std::log(1.0 - least) : 0.0;
}

/// The highest maximum that stands out, its place by the parabola through three points.
std::optional<Peak> peak_of(const Logarithm& h) {
  const std::size_t n = h.gain.size();
  const auto highest = std::max_element(h.gain.begin(), h.gain.end());
  const auto top = static_cast<std::size_t>(highest - h.gain.begin());
  if (top < 2 || top + 2 >= n) return std::nullopt;
  const double valley =
      std::max(*std::min_element(h.gain.begin(), highest), *std::min_element(highest, h.gain.end()));
  if (*highest - valley < kProminent) return std::nullopt;
  const double a = h.gain[top - 1];
  const double b = h.gain[top];
  const double c = h.gain[top + 1];
  const double bend = a - 2.0 * b + c;
  const double step = 0.5 * (h.at[top + 1] - h.at[top - 1]);
  return Peak{h.at[top] + (bend < 0.0 ? 0.5 * step * (a - c) / bend : 0.0), step,
              shift_by_damping(std::exp(b - h.gain.front()))};
}

/// By the change of the gain, point by point.
AmplitudeClass class_without_peak(std::span<const double> change) {
  const double bottom = mean(change.first(change.size() / 3));
  const double top = mean(change.last(change.size() / 3));
  if (mean(change) > 0.0) return AmplitudeClass::rising_gain;
  return top < 0.0 && kFarMore * bottom > top ? AmplitudeClass::falling_gain_at_top
                                              : AmplitudeClass::falling_gain;
}

AmplitudeClass class_of(const Logarithm& small, const Logarithm& large, const std::vector<double>& at,
                        std::span<const double> change, AmplitudeDependence& out) {
  const auto before = peak_of(small);
  const auto after = peak_of(large);
  if (!before || !after) return class_without_peak(change);
  out.peak_at_least_hz = std::exp(before->at);
  out.peak_at_largest_hz = std::exp(after->at);
  // Damping moves a peak, too.
  const double moved = after->at - before->at - (after->by_damping - before->by_damping);
  if (std::abs(moved) > std::max(kRounded, 0.5 * before->step))
    return moved < 0.0 ? AmplitudeClass::softening_stiffness : AmplitudeClass::hardening_stiffness;
  const auto peak =
      static_cast<std::size_t>(std::min_element(at.begin(), at.end(),
                                                [&](double a, double b) {
                                                  return std::abs(a - before->at) < std::abs(b - before->at);
                                                }) -
                               at.begin());
  const std::size_t from = peak > 0 ? peak - 1 : 0;
  const double there = mean(change.subspan(from, std::min(change.size(), peak + 2) - from));
  if (std::abs(there) > kFarMore * std::abs(median({change.begin(), change.end()})))
    return there < 0.0 ? AmplitudeClass::rising_damping : AmplitudeClass::falling_damping;
  return class_without_peak(change);
}

struct ClassWords {
  const char* name;
  std::vector<std::string> suspects;
  const char* what_happens;  ///< with the peak's two frequencies
};
/// In the order of AmplitudeClass.
const ClassWords& words_of(AmplitudeClass kind) {
  static const std::array<ClassWords, 7> all = {{
      {"softening_stiffness",
       {"cubic_stiffness", "quadratic_stiffness", "hysteresis"},
       "the peak moves down from {} to {} Hz: a stiffness that softens"},
      {"hardening_stiffness",
       {"cubic_stiffness", "backlash"},
       "the peak moves up from {} to {} Hz: a stiffness that hardens"},
      {"rising_damping",
       {"drag", "saturation"},
       "the peak falls: damping that grows with speed, or a limit that the peak alone reaches"},
      {"falling_damping",
       {"hysteresis", "dead_zone", "backlash"},
       "the peak rises: damping that falls, as that of dry friction"},
      {"rising_gain", {"hysteresis", "dead_zone", "backlash"}, "the gain rises: hysteresis, or a dead zone"},
      {"falling_gain", {"saturation", "cubic_nonlinearity"}, "the gain falls: saturation"},
      {"falling_gain_at_top",
       {"slew_limit"},
       "the gain falls at high frequencies alone: a limited rate of change"},
  }};
  return all.at(static_cast<std::size_t>(kind));
}

}  // namespace

std::string to_string(AmplitudeClass kind) {
  return words_of(kind).name;
}

std::vector<std::string> suspects_of(AmplitudeClass kind) {
  return words_of(kind).suspects;
}

std::optional<AmplitudeDependence> amplitude_dependence(const Experiments& experiments) {
  const auto [least, largest] = extremes(experiments);
  if (least == nullptr || !(drive_of(*largest) > drive_of(*least))) return std::nullopt;
  const Logarithm small(*least);
  const Logarithm large(*largest);
  std::vector<double> at;
  std::vector<double> gain;
  std::vector<std::complex<double>> change;
  for (std::size_t i = 0; i < small.at.size(); ++i) {
    if (!large.covers(small.at[i])) continue;
    at.push_back(small.at[i]);
    gain.push_back(interpolated(large.at, large.gain, at.back()) - small.gain[i]);
    change.emplace_back(gain.back(),
                        std::remainder(interpolated(large.at, large.phase, at.back()) - small.phase[i],
                                       2.0 * std::numbers::pi));
  }
  double energy = 0.0;
  double together = 0.0;
  for (std::size_t i = 0; i < change.size(); ++i) {
    energy += std::norm(change[i]);
    if (i > 0) together += (change[i] * std::conj(change[i - 1])).real();
  }
  const auto n = static_cast<double>(change.size());
  AmplitudeDependence out;
  out.least_drive_v = drive_of(*least);
  out.largest_drive_v = drive_of(*largest);
  out.change = std::sqrt(std::max(0.0, together) / n);
  out.times_noise = out.change / std::sqrt(std::max(0.0, energy - together) / n);
  // Of independent errors the sum of the products of neighbours has the deviation energy/sqrt(2n).
  out.strength = together / (kDeviations * energy / std::sqrt(2.0 * n));
  if (!(out.strength > 1.0) || out.change < kRounded) return std::nullopt;
  out.kind = class_of(small, large, at, gain, out);
  return out;
}

Experiments of_least_drive(const Experiments& experiments) {
  const auto [least, largest] = extremes(experiments);
  if (least == nullptr) return experiments;
  // Nearer to the least drive than to the largest one.
  const double most = std::sqrt(drive_of(*least) * drive_of(*largest));
  Experiments out;
  std::copy_if(experiments.begin(), experiments.end(), std::back_inserter(out), [&](const Experiment& e) {
    const auto* record = with_drive(e);
    return record != nullptr && drive_of(*record) <= most;
  });
  return out;
}

std::string to_text(const AmplitudeDependence& d) {
  return fmt::format(
      "The response depends on the drive ({} V against {} V): {}. No linear effect does that; they were looked for at the "
      "least drive alone. Time records at these amplitudes would tell which it is ({}).",
      rounded_text(d.largest_drive_v), rounded_text(d.least_drive_v),
      fmt::format(fmt::runtime(words_of(d.kind).what_happens), rounded_text(d.peak_at_least_hz.value_or(0.0)),
                  rounded_text(d.peak_at_largest_hz.value_or(0.0))),
      join(suspects_of(d.kind), ", "));
}

}  // namespace bodesmith::gap
