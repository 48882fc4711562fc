#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>

#include "base/provenance.hpp"
#include "tolerance/counts.hpp"

namespace bodesmith::tolerance {

double Histogram::quantile(double p) const {
  const std::uint64_t total = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  if (total == 0) return 0.0;
  if (p <= 0.0) return min;
  if (p >= 1.0) return max;
  const double target = p * static_cast<double>(total);
  const double width = (high - low) / static_cast<double>(counts.size());
  double before = 0.0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double here = static_cast<double>(counts[i]);
    if (before + here >= target && here > 0.0) {
      return std::clamp(low + width * (static_cast<double>(i) + (target - before) / here), min, max);
    }
    before += here;
  }
  return max;
}

Counts::Counts(const Result& shape) {
  const auto range = [&](const Histogram& h) {
    low_.push_back(h.low);
    per_bin_.push_back(kBins / (h.high - h.low));
  };
  for (std::size_t i = 0; i < shape.magnitude_db.size(); ++i) {
    range(shape.magnitude_db[i]);
    range(shape.phase_deg[i]);
  }
  range(shape.worst_db);
  range(shape.worst_deg);
  range(shape.worst_percent);
  histograms_ = low_.size();
  counts_.assign(histograms_ * kBins, 0);
  min_.assign(histograms_, std::numeric_limits<double>::infinity());
  max_.assign(histograms_, -std::numeric_limits<double>::infinity());
}

void Counts::merge(const Counts& other) {
  for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
  for (std::size_t i = 0; i < histograms_; ++i) {
    min_[i] = std::min(min_[i], other.min_[i]);
    max_[i] = std::max(max_[i], other.max_[i]);
  }
  samples_ += other.samples_;
  within_ += other.within_;
}

void Counts::gather(const Team& team) {
  if (team.size() == 1) return;
  std::vector<std::uint64_t> whole = {samples_, within_};
  team.sum(whole);
  team.sum(counts_);
  team.min(min_);
  team.max(max_);
  samples_ = whole[0];
  within_ = whole[1];
}

void Counts::put_into(Result& result) const {
  const auto put = [&](Histogram& h, std::size_t index) {
    const auto begin = counts_.begin() + static_cast<std::ptrdiff_t>(index * kBins);
    h.counts.assign(begin, begin + kBins);
    h.min = min_[index];
    h.max = max_[index];
  };
  for (std::size_t i = 0; i < result.magnitude_db.size(); ++i) {
    put(result.magnitude_db[i], 2 * i);
    put(result.phase_deg[i], 2 * i + 1);
  }
  put(result.worst_db, histograms_ - 3);
  put(result.worst_deg, histograms_ - 2);
  put(result.worst_percent, histograms_ - 1);
  result.samples = samples_;
  result.within = within_;
}

std::string Counts::bytes() const {
  std::string out;
  const auto put = [&](const void* from, std::size_t size) {
    out.append(static_cast<const char*>(from), size);
  };
  put(&samples_, sizeof samples_);
  put(&within_, sizeof within_);
  put(counts_.data(), counts_.size() * sizeof(std::uint64_t));
  put(min_.data(), min_.size() * sizeof(double));
  put(max_.data(), max_.size() * sizeof(double));
  return out + sha256_hex(out);
}

bool Counts::from_bytes(std::string_view bytes) {
  const std::size_t body =
      2 * sizeof samples_ + counts_.size() * sizeof(std::uint64_t) + 2 * histograms_ * sizeof(double);
  if (bytes.size() < body || bytes.substr(body) != sha256_hex(bytes.substr(0, body))) return false;
  const auto get = [&](void* to, std::size_t size) {
    std::memcpy(to, bytes.data(), size);
    bytes.remove_prefix(size);
  };
  get(&samples_, sizeof samples_);
  get(&within_, sizeof within_);
  get(counts_.data(), counts_.size() * sizeof(std::uint64_t));
  get(min_.data(), min_.size() * sizeof(double));
  get(max_.data(), max_.size() * sizeof(double));
  return true;
}

}  // namespace bodesmith::tolerance
