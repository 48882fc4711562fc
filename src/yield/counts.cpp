#include "yield/counts.hpp"

#include <cmath>
#include <cstring>
#include <limits>

namespace bodesmith {

YieldCounts::YieldCounts(const YieldResult& shape) {
  const auto range = [&](const Histogram& h) {
    low_.push_back(h.low);
    per_bin_.push_back(kBins / (h.high - h.low));
  };
  for (size_t i = 0; i < shape.magnitude_db.size(); ++i) {
    range(shape.magnitude_db[i]);
    range(shape.phase_deg[i]);
  }
  range(shape.worst_db);
  range(shape.worst_deg);
  histograms_ = low_.size();
  counts_.assign(histograms_ * kBins, 0);
  least_.assign(histograms_, std::numeric_limits<double>::infinity());
  greatest_.assign(histograms_, -std::numeric_limits<double>::infinity());
}

void YieldCounts::merge(const YieldCounts& other) {
  for (size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
  for (size_t i = 0; i < histograms_; ++i) {
    least_[i] = std::min(least_[i], other.least_[i]);
    greatest_[i] = std::max(greatest_[i], other.greatest_[i]);
  }
  samples_ += other.samples_;
  within_ += other.within_;
}

void YieldCounts::gather(const Team& team) {
  if (team.size() == 1) return;
  std::vector<std::uint64_t> whole = {samples_, within_};
  team.add_up(whole);
  team.add_up(counts_);
  team.least(least_);
  team.greatest(greatest_);
  samples_ = whole[0];
  within_ = whole[1];
}

void YieldCounts::put_into(YieldResult& result) const {
  const auto put = [&](Histogram& h, size_t index) {
    const auto begin = counts_.begin() + static_cast<std::ptrdiff_t>(index * kBins);
    h.counts.assign(begin, begin + kBins);
    h.least = least_[index];
    h.greatest = greatest_[index];
  };
  for (size_t i = 0; i < result.magnitude_db.size(); ++i) {
    put(result.magnitude_db[i], 2 * i);
    put(result.phase_deg[i], 2 * i + 1);
  }
  put(result.worst_db, histograms_ - 2);
  put(result.worst_deg, histograms_ - 1);
  result.samples = samples_;
  result.within = within_;
}

std::string YieldCounts::bytes() const {
  std::string out;
  const auto put = [&](const void* from, size_t size) { out.append(static_cast<const char*>(from), size); };
  put(&samples_, sizeof samples_);
  put(&within_, sizeof within_);
  put(counts_.data(), counts_.size() * sizeof(std::uint64_t));
  put(least_.data(), least_.size() * sizeof(double));
  put(greatest_.data(), greatest_.size() * sizeof(double));
  return out;
}

bool YieldCounts::from_bytes(std::string_view bytes) {
  if (bytes.size() !=
      2 * sizeof samples_ + counts_.size() * sizeof(std::uint64_t) + 2 * histograms_ * sizeof(double)) {
    return false;
  }
  const auto get = [&](void* to, size_t size) {
    std::memcpy(to, bytes.data(), size);
    bytes.remove_prefix(size);
  };
  get(&samples_, sizeof samples_);
  get(&within_, sizeof within_);
  get(counts_.data(), counts_.size() * sizeof(std::uint64_t));
  get(least_.data(), least_.size() * sizeof(double));
  get(greatest_.data(), greatest_.size() * sizeof(double));
  return true;
}

YieldSensitivity yield_sensitivity(const YieldDesign& design, const YieldOptions& options) {
  YieldSensitivity out;
  std::vector<double> values;
  for (const YieldPart& part : design.parts) values.push_back(part.nominal);
  constexpr double kStep = 1e-4;
  for (size_t i = 0; i < design.parts.size(); ++i) {
    const YieldPart& part = design.parts[i];
    std::vector<double> db, deg;
    for (const Hertz f : options.grid) {
      values[i] = part.nominal * (1.0 + kStep);
      const std::complex<double> up = design.response(f, values);
      values[i] = part.nominal * (1.0 - kStep);
      const std::complex<double> ratio = up / design.response(f, values);
      const double per_percent = 0.01 / (2.0 * kStep);
      // A null of the response has no slope in dB.
      const bool finite = std::isfinite(ratio.real()) && std::isfinite(ratio.imag()) && std::abs(ratio) > 0.0;
      db.push_back(finite ? to_decibel(std::abs(ratio)) * per_percent : 0.0);
      deg.push_back(finite ? to_degrees(std::arg(ratio)) * per_percent : 0.0);
    }
    values[i] = part.nominal;
    out.db_per_percent.push_back(std::move(db));
    out.deg_per_percent.push_back(std::move(deg));
    const Spread& spread = options.spread;
    const double kelvin =
        std::max(std::abs(spread.temperature_low_c - 25.0), std::abs(spread.temperature_high_c - 25.0));
    switch (part.kind) {
      case YieldPart::Kind::resistor:
        out.limit_percent.push_back(spread.resistor_percent + spread.resistor_ppm_per_k * kelvin * 1e-4);
        break;
      case YieldPart::Kind::capacitor:
        out.limit_percent.push_back(spread.capacitor_percent + spread.capacitor_ppm_per_k * kelvin * 1e-4);
        break;
      case YieldPart::Kind::switched_capacitor:
        out.limit_percent.push_back(3.0 * spread.unit_capacitor_percent / std::sqrt(part.nominal));
        break;
    }
  }
  return out;
}

}  // namespace bodesmith
