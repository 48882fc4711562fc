#include "lti/section_making.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace bodesmith {
namespace {

constexpr std::size_t kMaxPairs = 8;      // (subsets of poles) x (subsets of zeros): C(16, 8) states
constexpr std::size_t kMaxSections = 14;  // subsets of sections

double log_size(Complex root) {
  return std::log(std::max(std::abs(root), 1e-300));
}

/// One pole or a conjugate pair.
struct Group {
  std::vector<Complex> roots;
  double log_frequency = 0.0;
};

std::vector<Group> group(std::vector<Complex> roots) {
  std::vector<Group> out;
  for (const Complex& root : roots) {
    if (root.imag() > 0.0) out.push_back({{root, std::conj(root)}, log_size(root)});
    if (root.imag() == 0.0) out.push_back({{root}, log_size(root)});
  }
  std::ranges::stable_sort(out, {}, &Group::log_frequency);
  return out;
}

void normalise(Section& section, double& gain) {
  section.gain = 1.0;
  double size = std::abs(section.dc_gain());
  if (std::isinf(size)) size = 1.0;  // an integrator has no level to go by
  if (!(size > 0.0)) size = std::abs(section.response(RadPerSecond{std::abs(section.poles.front())}));
  section.gain = 1.0 / size;
  gain *= size;
}

std::vector<double> log_curve(const Section& section, const std::vector<Hertz>& grid) {
  std::vector<double> out;
  for (const Hertz f : grid) out.push_back(std::log(std::max(std::abs(section.response(f.rad_s())), 1e-300)));
  return out;
}

double largest_span(const std::vector<Section>& sections, const std::vector<Hertz>& grid) {
  std::vector<double> sum(grid.size(), 0.0);
  double worst = 0.0;
  for (const Section& section : sections) {
    const auto curve = log_curve(section, grid);
    for (std::size_t j = 0; j < sum.size(); ++j) sum[j] += curve[j];
    const auto [low, high] = std::minmax_element(sum.begin(), sum.end());
    worst = std::max(worst, *high - *low);
  }
  return worst;
}

/// ln(size) of every product of a subset of curves, at every frequency of the grid.
using SubsetSums = std::vector<std::vector<double>>;

SubsetSums subset_sums(const std::vector<std::vector<double>>& curves) {
  const std::size_t points = curves.empty() ? 0 : curves.front().size();
  SubsetSums out(std::size_t{1} << curves.size(), std::vector<double>(points, 0.0));
  for (std::size_t state = 1; state < out.size(); ++state) {
    const auto first = static_cast<std::size_t>(std::countr_zero(state));
    for (std::size_t j = 0; j < points; ++j) out[state][j] = out[state & (state - 1)][j] + curves[first][j];
  }
  return out;
}

/// Cheapest way through all subsets of curves from none to all, one a step, cost = largest span met.
std::vector<std::size_t> best_order(const std::vector<std::vector<double>>& curves) {
  const SubsetSums sums = subset_sums(curves);
  const std::size_t states = sums.size();
  std::vector<double> cost(states, INFINITY);
  std::vector<std::size_t> last(states, 0);
  cost[0] = 0.0;
  for (std::size_t state = 1; state < states; ++state) {
    const auto [low, high] = std::minmax_element(sums[state].begin(), sums[state].end());
    for (std::size_t i = 0; i < curves.size(); ++i) {
      if ((state >> i & 1u) == 0) continue;
      const double reach = std::max(*high - *low, cost[state ^ (std::size_t{1} << i)]);
      if (reach < cost[state]) {
        cost[state] = reach;
        last[state] = i;
      }
    }
  }
  std::vector<std::size_t> order;
  for (std::size_t state = states - 1; state != 0; state ^= std::size_t{1} << last[state])
    order.push_back(last[state]);
  std::ranges::reverse(order);
  return order;
}

/// Of the zeros (`sign` 1) or the poles (-1) of first-order sections.
SubsetSums root_sums(const std::vector<Section>& sections, const std::vector<Hertz>& grid,
                     std::vector<Complex> Section::*roots, double sign) {
  std::vector<std::vector<double>> curves(sections.size());
  for (std::size_t i = 0; i < sections.size(); ++i) {
    for (const Hertz f : grid) {
      const double size = std::abs(Complex(0.0, f.rad_s().value) - (sections[i].*roots)[0]);
      curves[i].push_back(sign * std::log(std::max(size, 1e-300)));
    }
  }
  return subset_sums(curves);
}

/// Largest less smallest of the sum of two curves.
double span_of_sum(const std::vector<double>& a, const std::vector<double>& b) {
  double low = INFINITY;
  double high = -INFINITY;
  for (std::size_t j = 0; j < a.size(); ++j) {
    low = std::min(low, a[j] + b[j]);
    high = std::max(high, a[j] + b[j]);
  }
  return high - low;
}

/// The sections along the best way: from[p * subsets + z] is the pair (pole * n + zero) used last.
std::vector<Section> pairs_along(const std::vector<Section>& sections,
                                 const std::vector<std::uint8_t>& from) {
  const std::size_t n = sections.size();
  const std::size_t subsets = std::size_t{1} << n;
  std::vector<Section> out;
  std::size_t p = subsets - 1;
  std::size_t z = subsets - 1;
  while (p != 0) {
    const std::size_t pair = from[p * subsets + z];
    Section section{.zeros = sections[pair % n].zeros, .poles = sections[pair / n].poles};
    out.push_back(std::move(section));
    p ^= std::size_t{1} << (pair / n);
    z ^= std::size_t{1} << (pair % n);
  }
  std::ranges::reverse(out);
  return out;
}

/// Pairs and order of first-order sections: after i sections i poles and i zeros are used, whichever pairs
/// they form.
std::vector<Section> best_pairs(const std::vector<Section>& sections, const std::vector<Hertz>& grid) {
  const std::size_t n = sections.size();
  const std::size_t subsets = std::size_t{1} << n;
  const SubsetSums poles = root_sums(sections, grid, &Section::poles, -1.0);
  const SubsetSums zeros = root_sums(sections, grid, &Section::zeros, 1.0);
  std::vector<double> cost(subsets * subsets, INFINITY);
  std::vector<std::uint8_t> from(subsets * subsets, 0);
  cost[0] = 0.0;
  for (std::size_t p = 1; p < subsets; ++p) {
    for (std::size_t z = 1; z < subsets; ++z) {
      if (std::popcount(p) != std::popcount(z)) continue;
      const double span = span_of_sum(poles[p], zeros[z]);
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < n; ++k) {
          if ((p >> i & 1u) == 0 || (z >> k & 1u) == 0) continue;
          const std::size_t before = (p ^ (std::size_t{1} << i)) * subsets + (z ^ (std::size_t{1} << k));
          // A thousandth of the way's own spread breaks ties in favour of near pairs.
          const double near =
              1e-3 * std::abs(log_size(sections[i].poles[0]) - log_size(sections[k].zeros[0]));
          const double reach = std::max(span, cost[before]) + 1e-3 * near;
          if (reach < cost[p * subsets + z]) {
            cost[p * subsets + z] = reach;
            from[p * subsets + z] = static_cast<std::uint8_t>(i * n + k);
          }
        }
      }
    }
  }
  return pairs_along(sections, from);
}

/// Makes one slot of the two neighbouring real poles that are nearest; false when there are no two.
bool join_nearest(std::vector<Group>& slots) {
  std::size_t best = slots.size();
  double distance = INFINITY;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    if (slots[i].roots.size() != 1) continue;
    for (std::size_t j = i + 1; j < slots.size(); ++j) {
      if (slots[j].roots.size() != 1) continue;
      if (slots[j].log_frequency - slots[i].log_frequency < distance) {
        distance = slots[j].log_frequency - slots[i].log_frequency;
        best = i;
      }
      break;
    }
  }
  if (best == slots.size()) return false;
  std::size_t other = best + 1;
  while (slots[other].roots.size() != 1) ++other;
  slots[best].roots.push_back(slots[other].roots[0]);
  slots[best].log_frequency = 0.5 * (slots[best].log_frequency + slots[other].log_frequency);
  slots.erase(slots.begin() + static_cast<std::ptrdiff_t>(other));
  return true;
}

std::size_t count_pairs(const std::vector<Group>& groups) {
  return static_cast<std::size_t>(
      std::ranges::count_if(groups, [](const Group& g) { return g.roots.size() == 2; }));
}

/// Zeros to the slots' poles: pairs to the nearest slot with room, then the real ones.
std::vector<Section> with_zeros(const std::vector<Group>& slots, const std::vector<Group>& zero_groups) {
  std::vector<Section> sections(slots.size());
  for (std::size_t i = 0; i < slots.size(); ++i) sections[i].poles = slots[i].roots;
  const auto place = [&](const Group& zero) {
    std::size_t best = sections.size();
    double distance = INFINITY;
    for (std::size_t i = 0; i < sections.size(); ++i) {
      if (sections[i].poles.size() - sections[i].zeros.size() < zero.roots.size()) continue;
      const double d = std::abs(slots[i].log_frequency - zero.log_frequency);
      if (d < distance) {
        distance = d;
        best = i;
      }
    }
    if (best == sections.size()) throw std::logic_error("a zero pair found no section");
    auto& list = sections[best].zeros;
    list.insert(list.end(), zero.roots.begin(), zero.roots.end());
  };
  for (const Group& zero : zero_groups) {
    if (zero.roots.size() == 2) place(zero);
  }
  // Real zeros in rising order with real poles in rising order keep interlaced pairs together.
  std::vector<Group> reals;
  std::copy_if(zero_groups.begin(), zero_groups.end(), std::back_inserter(reals),
               [](const Group& g) { return g.roots.size() == 1; });
  std::size_t room = 0;
  for (const Section& section : sections) room += section.poles.size() - section.zeros.size();
  if (room == reals.size()) {
    std::size_t next = 0;
    for (Section& section : sections) {
      while (section.zeros.size() < section.poles.size()) section.zeros.push_back(reals[next++].roots[0]);
    }
  } else {
    for (const Group& zero : reals) place(zero);
  }
  return sections;
}

/// How far the zeros lie from their poles, in nepers of frequency: what the sections must span.
double distance_within(const std::vector<Section>& sections) {
  double out = 0.0;
  for (const Section& section : sections) {
    std::vector<double> poles, zeros;
    for (const Complex& root : section.poles) poles.push_back(log_size(root));
    for (const Complex& root : section.zeros) zeros.push_back(log_size(root));
    std::ranges::sort(poles);
    std::ranges::sort(zeros);
    for (std::size_t i = 0; i < zeros.size(); ++i) out += std::abs(zeros[i] - poles[i]);
  }
  return out;
}

}  // namespace

PooledRoots pooled_roots(const Sections& sections) {
  PooledRoots out;
  out.gain = sections.gain;
  for (const Section& section : sections.sections) {
    out.gain *= section.gain;
    out.zeros.insert(out.zeros.end(), section.zeros.begin(), section.zeros.end());
    out.poles.insert(out.poles.end(), section.poles.begin(), section.poles.end());
  }
  return out;
}

Sections in_series(const std::vector<Sections>& parts) {
  if (parts.size() == 1) return parts.front();
  Sections out;
  for (const Sections& part : parts) {
    out.gain *= part.gain;
    out.delay_s += part.delay_s;
    out.sections.insert(out.sections.end(), part.sections.begin(), part.sections.end());
  }
  return out;
}

Sections as_biquads(const Sections& sections) {
  const PooledRoots roots = pooled_roots(sections);
  Sections out = make_sections(roots.gain, roots.zeros, roots.poles, {true});
  out.error = sections.error;
  return out;
}

Sections make_sections(double gain, std::vector<Complex> zeros, std::vector<Complex> poles,
                       const SectionMaking& making) {
  if (zeros.size() > poles.size()) throw std::logic_error("sections need at least as many poles as zeros");
  std::vector<Group> slots = group(std::move(poles));
  const std::vector<Group> zero_groups = group(std::move(zeros));
  // Neighbouring real poles join when there are more complex zero pairs than places for them, or on request.
  while (count_pairs(zero_groups) > count_pairs(slots) && join_nearest(slots)) {
  }
  while (making.biquads && join_nearest(slots)) {
  }
  std::vector<Section> sections = with_zeros(slots, zero_groups);
  // Or when a zero pair would otherwise go to poles far away: a section of such roots spans what the whole does not.
  constexpr double kNearer = 1.0;
  while (count_pairs(zero_groups) > 0 && join_nearest(slots)) {
    std::vector<Section> other = with_zeros(slots, zero_groups);
    if (distance_within(other) < distance_within(sections) - kNearer) sections = std::move(other);
  }
  Sections out;
  out.gain = gain;
  for (Section& section : sections) {
    normalise(section, out.gain);
    out.sections.push_back(std::move(section));
  }
  return out;
}

OrderedSections order_sections(const Sections& given, Band band) {
  OrderedSections out;
  out.sections = given;
  const std::size_t n = given.sections.size();
  if (n == 0) return out;
  const auto grid = log_grid(band, band.from == band.to ? 1 : 121);
  const double db = kDecibelPerNeper;
  out.span_before_db = db * largest_span(given.sections, grid);
  const bool first_order = std::ranges::all_of(
      given.sections, [](const Section& s) { return s.poles.size() == 1 && s.zeros.size() == 1; });
  std::vector<Section> sections = given.sections;
  const Complex whole = given.response(grid.front().rad_s());
  if (first_order && n <= kMaxPairs) {
    sections = best_pairs(given.sections, grid);
    out.exhaustive = true;
  } else if (n <= kMaxSections) {
    std::vector<std::vector<double>> curves;
    for (const Section& section : given.sections) curves.push_back(log_curve(section, grid));
    const auto order = best_order(curves);
    for (std::size_t i = 0; i < n; ++i) sections[i] = given.sections[order[i]];
    out.exhaustive = true;
  }
  // Gains: the stages' peaks in even steps from 1 to the whole's peak.
  double whole_peak = 0.0;
  for (const Hertz f : grid) whole_peak = std::max(whole_peak, std::abs(given.response(f.rad_s())));
  std::vector<Complex> product(grid.size(), 1.0);
  for (std::size_t i = 0; i < n; ++i) {
    sections[i].gain = 1.0;
    double peak = 0.0;
    for (std::size_t j = 0; j < grid.size(); ++j) {
      product[j] *= sections[i].response(grid[j].rad_s());
      peak = std::max(peak, std::abs(product[j]));
    }
    const double wanted = std::pow(whole_peak, static_cast<double>(i + 1) / static_cast<double>(n));
    sections[i].gain = wanted / peak;
    for (Complex& value : product) value *= sections[i].gain;
  }
  // The product is what was given: rounding and sign go to the cascade's own gain.
  out.sections.sections = sections;
  out.sections.gain = 1.0;
  const double correction = (whole / out.sections.response(grid.front().rad_s())).real();
  out.sections.gain = std::abs(correction - 1.0) < 1e-9 ? 1.0 : correction;
  if (out.sections.gain == 1.0) out.sections.sections.back().gain *= correction;
  out.span_after_db = db * largest_span(out.sections.sections, grid);
  return out;
}

}  // namespace bodesmith
