#include "measured/suspects.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/text.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "signal/period.hpp"
#include "simulate/record/record_simulator.hpp"

namespace bodesmith::measured {
namespace {

/// Another part explains as well unless the record is e to this times less likely with it, what is left taken as white noise.
constexpr double kOdds = 10.0;
/// Departure at which the direction of a part is taken first: percent, or tolerances.
constexpr double kSmall = 1.0;
constexpr int kRounds = 3;

/// Times the noise, that is noise.
constexpr double kNoise = 1.2;
/// At rest and at one frequency a controller shows nine numbers (two cubics with their constants, one gain): a sum of nine squares
/// is beyond this in one good board of two thousand.
constexpr double kMostSquares = 30.0;
/// Tolerances are limits of uniform departures, of offsets three standard deviations.
const double kUniform = 1.0 / std::sqrt(3.0);
constexpr double kOffset = 1.0 / 3.0;
/// By how many tolerances a part that is wrong may be off further once the others share in the rest.
constexpr double kCorrection = 30.0;

using Vector = Eigen::VectorXd;

Vector shown_by(const chain::Chain& chain, const TimeRecord& record) {
  const std::vector<double> y = simulate::RecordSimulator(chain, record.step_s).run_once(record.u);
  return as_eigen(y);
}

/// The departure that does `times` what one of `small` does, by the entry that moves most.
double departure_of(const chain::PartChange& part, double times, double small) {
  const auto most =
      std::max_element(part.entries.begin(), part.entries.end(),
                       [](const auto& a, const auto& b) { return std::abs(a.slope) < std::abs(b.slope); });
  const double linear = times * small / (1.0 + most->bend * small);
  return linear / (1.0 - most->bend * linear);
}

bool has_parts(const chain::Block& block) {
  return block.parts != nullptr;
}

/// Gains of a stage that records identified are right to this: percent.
constexpr double kStageGain = 1.0;

/// The stage's block with one of its curves times that: its gain at the record's frequency.
chain::Block with_curve_times(chain::Block block, const chain::PolynomialList& curve, double times) {
  std::vector<double> values = block.list(curve.key);
  for (double& value : values) value *= times;
  block.set(curve.key, values);
  return block;
}

}  // namespace

bool Suspect::within_tolerance() const {
  return std::abs(departure) <= tolerance;
}

std::string Suspect::words() const {
  if (unit == "v") return part + " is " + rounded_text(1e3 * departure, 3) + " mV";
  return part + " is " + rounded_text(std::abs(departure), 2) + (departure > 0.0 ? " % above" : " % below") +
         " its value";
}

std::vector<Suspect> suspects_of(const chain::Chain& found, const chain::Chain& base, const std::string& part,
                                 double departure, const TimeRecord& record) {
  const chain::Block& good = *std::find_if(base.blocks.begin(), base.blocks.end(), has_parts);
  chain::Chain without = found;
  const auto place = std::find_if(without.blocks.begin(), without.blocks.end(), has_parts);
  chain::Block& block = *place;
  block = good;
  const Vector y = as_eigen(record.y);
  const Vector plain = shown_by(without, record);
  const Vector unexplained = y - plain;
  // n ln(rms) is minus the logarithm of the likelihood.
  const double most =
      (y - shown_by(found, record)).norm() * std::exp(kOdds / static_cast<double>(record.size()));
  std::vector<Suspect> out;
  // By how many times what is shown now explains the record, and whether that explains as well.
  const auto explained = [&] {
    const Vector direction = shown_by(without, record) - plain;
    const double times = direction.dot(unexplained) / direction.squaredNorm();
    return std::pair(times, (unexplained - times * direction).norm() <= most);
  };
  for (const chain::PartChange& one : *good.parts) {
    if (one.part == part) {
      out.insert(out.begin(), {one.part, one.unit, departure, one.tolerance});
      continue;
    }
    if (one.entries.empty()) continue;  // an op-amp
    double t = one.is_offset() ? kSmall * one.tolerance : kSmall;
    bool does = false;
    // What stands behind is bent: once more at the size that was found.
    for (int round = 0; round < kRounds && std::abs(t) <= one.most(); ++round) {
      block = good.with(one, t);
      const auto [times, as_well] = explained();
      t = departure_of(one, times, t);
      does = as_well;
    }
    if (does && std::abs(t) <= one.most()) out.push_back({one.part, one.unit, t, one.tolerance});
  }
  block = good;
  // A stage whose gain is another one does as much as a generator whose gain is.
  for (auto stage = place + 1; stage != without.blocks.end(); ++stage) {
    const chain::Block measured_before = *stage;
    for (const chain::PolynomialList& curve : measured_before.polynomials()) {
      *stage = with_curve_times(measured_before, curve, 1.0 + 0.01 * kSmall);
      if (const auto [times, as_well] = explained(); as_well)
        out.push_back({fmt::format("{}: gain of its {} curve", measured_before.part, curve.key), "percent",
                       times * kSmall, kStageGain});
    }
    *stage = measured_before;
  }
  std::stable_sort(out.begin(), out.end(), [](const Suspect& a, const Suspect& b) {
    return std::abs(a.departure) / a.tolerance < std::abs(b.departure) / b.tolerance;
  });
  return out;
}

std::optional<Separating> separating_record(const chain::Chain& base, const std::vector<Suspect>& suspects,
                                            const TimeRecord& record, double operating_hz) {
  chain::Chain chain = base;
  const auto block = std::find_if(chain.blocks.begin(), chain.blocks.end(), has_parts);
  if (block == chain.blocks.end() || !block->has("rate_frequency_hz")) return std::nullopt;
  const chain::Block good = *block;
  std::vector<double> at = good.list("rate_frequency_hz");
  for (std::size_t i = at.size(); i-- > 1;) at.push_back(std::sqrt(at[i - 1] * at[i]));
  std::optional<Separating> best;
  for (const double f : at) {
    TimeRecord other = record;
    other.step_s *= operating_hz / f;
    std::vector<Vector> shown;
    for (const Suspect& one : suspects) {
      const auto part = std::find_if(good.parts->begin(), good.parts->end(),
                                     [&](const chain::PartChange& p) { return p.part == one.part; });
      if (part == good.parts->end()) continue;  // a stage's gain there is another one
      *block = good.with(*part, one.departure);
      for (chain::Block& any : chain.blocks) {
        if (any.has("operating_hz")) any.set("operating_hz", f);
      }
      shown.push_back(shown_by(chain, other));
    }
    if (shown.size() < 2) return std::nullopt;
    Separating here{f, std::numeric_limits<double>::infinity()};
    for (std::size_t i = 0; i < shown.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k)
        here.rms =
            std::min(here.rms, (shown[i] - shown[k]).norm() / std::sqrt(static_cast<double>(record.size())));
    }
    if (!best || here.rms > best->rms) best = here;
  }
  return best;
}

std::optional<GoodParts> good_parts_explain(const chain::Chain& chain, const TimeRecord& record,
                                            double noise_rms, const std::string& wrong) {
  // A record that begins in motion: what the chain does at its start is not the record's. Of several periods all but the first count.
  const std::size_t period = find_period(record.u);
  const std::size_t counted = 2 * period > record.size() ? record.size() : record.size() - period;
  const auto left_beside = [&](const chain::Chain& with) -> Vector {
    return (as_eigen(record.y) - shown_by(with, record)).tail(eigen_index(counted)) / noise_rms;
  };
  Vector left = left_beside(chain);
  const double most = kNoise * kNoise * static_cast<double>(left.size());
  const bool nothing_left = left.squaredNorm() <= most;
  chain::Chain off = chain;
  const auto block = std::find_if(off.blocks.begin(), off.blocks.end(), has_parts);
  if (block == off.blocks.end())
    return nothing_left ? std::optional(GoodParts{0.0, left.squaredNorm()}) : std::nullopt;
  const chain::Block good = *block;
  const auto count = eigen_index(good.parts->size());
  const auto part = [&](Eigen::Index k) -> const chain::PartChange& {
    return (*good.parts)[static_cast<std::size_t>(k)];
  };
  Eigen::MatrixXd directions(left.size(), count);
  Vector deviations(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double good_part = part(k).tolerance * (part(k).is_offset() ? kOffset : kUniform);
    deviations[k] = part(k).part == wrong ? kCorrection * part(k).tolerance : good_part;
    *block = good.with(part(k), deviations[k]);
    directions.col(k) = left - left_beside(off);
  }
  Eigen::MatrixXd normal = gram(directions);
  normal.diagonal().array() += 1.0;
  // What parts do is bent: the rest is what they leave together, not what their directions do.
  Vector departures = Vector::Zero(count);
  for (int round = 0; round < kRounds; ++round) {
    departures += solve_ldlt(normal, transpose_times(directions, left) - departures);
    // Far beyond what is asked a controller may have no answer at all.
    if (departures.squaredNorm() > 2.0 * kMostSquares) return std::nullopt;
    *block = good;
    for (Eigen::Index k = 0; k < count; ++k) *block = block->with(part(k), departures[k] * deviations[k]);
    left = left_beside(off);
  }
  GoodParts out{0.0, left.squaredNorm() + departures.squaredNorm()};
  if (!nothing_left && !(left.squaredNorm() <= most && departures.squaredNorm() <= kMostSquares))
    return std::nullopt;
  for (Eigen::Index k = 0; k < count && !nothing_left; ++k) {
    if (part(k).part == wrong) out.further = departures[k] * deviations[k];
  }
  return out;
}

bool good_parts_do_as_much(const chain::Chain& chain, const chain::Chain& other, const TimeRecord& record,
                           double noise_rms) {
  const auto parts = good_parts_explain(chain, record, noise_rms);
  if (!parts) return false;
  const auto otherwise = good_parts_explain(other, record, noise_rms);
  return !otherwise || parts->squares <= otherwise->squares + 2.0 * kOdds;
}

}  // namespace bodesmith::measured
