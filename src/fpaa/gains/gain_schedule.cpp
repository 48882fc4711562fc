#include "fpaa/gains/gain_schedule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "fpaa/controller/scale.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr std::size_t kMaxSets = 4096;
constexpr double kBaud = 57600.0;  ///< of the board's serial line, 10 bits a byte
/// Beyond its range a set is kept for this part of the interval to the next.
constexpr double kKeepShare = 0.25;

/// The ratio of whole numbers up to 255 nearest `gain`, the larger numbers among equals.
GainCapacitors nearest_ratio(double gain, int fixed_under) {
  GainCapacitors best{gain, 0, 1};
  double least = 1e300;
  for (int under = fixed_under > 0 ? fixed_under : kMostUnits; under >= (fixed_under > 0 ? fixed_under : 1);
       --under) {
    const int over = nearest_whole<int>(std::min(gain * under, kMostUnits + 1.0));
    if (over < 1 || over > kMostUnits) continue;
    const double error = std::abs(static_cast<double>(over) / under - gain);
    if (error < least * (1.0 - 1e-12)) {
      least = error;
      best.over = over;
      best.under = under;
    }
  }
  return best;
}

void set_ranges(std::vector<GainSet>& sets) {
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const double f = sets[i].frequency.value;
    const double below = i > 0 ? sets[i - 1].frequency.value : f;
    const double above = i + 1 < sets.size() ? sets[i + 1].frequency.value : f;
    const auto at = [&](double end, double share) { return Hertz{f * std::pow(end / f, share)}; };
    sets[i].from = i > 0 ? at(below, 0.5) : Hertz{0.0};
    sets[i].to = i + 1 < sets.size() ? at(above, 0.5) : Hertz{1e12};
    sets[i].keep_from = i > 0 ? at(below, 0.5 + kKeepShare) : Hertz{0.0};
    sets[i].keep_to = i + 1 < sets.size() ? at(above, 0.5 + kKeepShare) : Hertz{1e12};
  }
}

void check_places(const std::vector<GainBranch>& branches) {
  std::set<std::pair<int, MemoryPlace>> used;
  for (const GainBranch& b : branches) {
    for (const std::vector<MemoryPlace>* list : {&b.place.over, &b.place.under}) {
      for (const MemoryPlace& place : *list) {
        if (used.emplace(b.place.address1, place).second) continue;
        throw DesignError(fmt::format(
            "{}: bank {}, byte {} of the chip at Address1 {} is set twice, expected capacitors of their own for "
            "each branch (where two gains share their Cout, give its units: CHIP.CAM:Cin1/200)",
            b.place.words, place.bank, place.byte, b.place.address1));
      }
    }
  }
}

/// Errors at every set and half-way to its neighbours, where the steps are worst.
void state_errors(GainSchedule& out, const Disturbance& d) {
  for (const GainSet& set : out.sets) {
    for (std::size_t b = 0; b < out.branches.size(); ++b) {
      const GainBranch& branch = out.branches[b];
      const double made = set.gains[b].realised() / branch.at_one;
      const double wanted = set.gains[b].wanted / branch.at_one;
      out.max_ratio_error_percent =
          std::max(out.max_ratio_error_percent, 100.0 * std::abs(made / wanted - 1.0));
      for (const Hertz f : {set.from, set.frequency, set.to}) {
        const double gain = d.rate_gain(branch.branch, f.value > 0.0 ? f : set.frequency);
        const double error = 100.0 * std::abs(made - gain);
        out.max_gain_error_percent = std::max(out.max_gain_error_percent, error / std::abs(gain));
        out.max_tracking_error_percent = std::max(
            out.max_tracking_error_percent, error * greatest_disturbance(d, branch.branch, DriveRange{}));
      }
    }
  }
}

/// Near a simple ratio p/q the next that 255 units make is 1/(255 q) away: near 1 the steps are .4 %. Another
/// gain at 1 (made up for elsewhere) leaves such ratios out.
void suggest_gains(GainSchedule& out) {
  for (std::size_t b = 0; b < out.branches.size(); ++b) {
    GainBranch& branch = out.branches[b];
    const auto worst = [&](double at_one) {
      double error = 0.0;
      for (const GainSet& set : out.sets) {
        const double gain = set.gains[b].wanted / branch.at_one * at_one;
        const GainCapacitors c = nearest_ratio(gain, branch.place.fixed_under);
        error = std::max(error, c.over == 0 ? 1.0 : std::abs(c.realised() / gain - 1.0));
      }
      return 100.0 * error;
    };
    branch.better_at_one = branch.at_one;
    branch.better_error_percent = worst(branch.at_one);
    for (int i = 50; i <= 150; ++i) {
      const double at_one = branch.at_one * i / 100.0;
      const double error = worst(at_one);
      if (error >= branch.better_error_percent) continue;
      branch.better_at_one = at_one;
      branch.better_error_percent = error;
    }
  }
}

GainSet make_set(Hertz frequency, const Disturbance& d, const std::vector<GainBranch>& branches,
                 const std::string& file) {
  GainSet set;
  set.frequency = frequency;
  std::map<int, std::map<MemoryPlace, int>> memory;
  for (const GainBranch& b : branches) {
    const double gain = b.at_one * d.rate_gain(b.branch, frequency);
    const GainCapacitors c =
        gain > 0.0 ? nearest_ratio(gain, b.place.fixed_under) : GainCapacitors{gain, 0, 1};
    if (c.over == 0 || std::abs(c.realised() - gain) > 0.05 * gain) {
      throw DesignError(fmt::format("{}: {} needs a gain of {} at {} Hz, which {} do not make within 5 %",
                                    file, b.place.words, rounded_text(gain), rounded_text(frequency.value),
                                    b.place.fixed_under > 0
                                        ? fmt::format("1 to 255 units over {}", b.place.fixed_under)
                                        : std::string("1 to 255 units over 1 to 255")));
    }
    set.gains.push_back(c);
    for (const MemoryPlace& place : b.place.over) memory[b.place.address1][place] = c.over;
    for (const MemoryPlace& place : b.place.under) memory[b.place.address1][place] = c.under;
  }
  for (const auto& [address1, cells] : memory) set.streams[address1] = encode(update_of(address1, cells));
  return set;
}

}  // namespace

std::vector<Hertz> gain_set_frequencies(const Disturbance& d, double step_percent, int most) {
  const std::vector<Hertz>& table = d.rate.frequency;
  std::vector<Hertz> out;
  for (std::size_t i = 0; i < table.size(); ++i) {
    out.push_back(table[i]);
    if (i + 1 == table.size()) break;
    double largest = 0.0;
    for (const Disturbance::Branch branch : kBranches) {
      const double a = d.rate.of(branch)[i], z = d.rate.of(branch)[i + 1];
      largest = std::max(largest, std::abs(z - a) / std::max(1e-9, std::min(std::abs(a), std::abs(z))));
    }
    const int parts = whole_number<int>(std::ceil(100.0 * largest / step_percent - 1e-9), 1, most);
    for (int k = 1; k < parts; ++k)
      out.push_back(
          {table[i].value * std::pow(table[i + 1].value / table[i].value, k / static_cast<double>(parts))});
  }
  return out;
}

GainSchedule make_gain_schedule(const Disturbance& disturbance, const std::vector<GainBranch>& branches,
                                double step_percent, const std::string& file) {
  using enum Disturbance::Branch;
  if (disturbance.is_static(ascending) && disturbance.is_static(descending)) {
    throw DesignError(
        fmt::format("{}: no branch changes with the frequency, expected a table 'rate' with other "
                    "gains than 1",
                    file));
  }
  for (const auto& [branch, name] :
       {std::pair{ascending, "ascending"}, std::pair{descending, "descending"}}) {
    const bool placed =
        std::ranges::any_of(branches, [b = branch](const GainBranch& one) { return one.branch == b; });
    if (!placed && !disturbance.is_static(branch)) {
      throw DesignError(
          fmt::format("{0}: the {1} branch changes with the frequency, expected --{1} with the CAM "
                      "that makes its gain",
                      file, name));
    }
  }
  check_places(branches);
  GainSchedule out;
  out.branches = branches;
  out.step_percent = step_percent;
  for (const Hertz f : disturbance.rate.frequency) make_set(f, disturbance, branches, file);  // within reach?
  const std::vector<Hertz> frequencies =
      gain_set_frequencies(disturbance, step_percent, static_cast<int>(kMaxSets) + 1);
  if (frequencies.size() > kMaxSets) {
    throw DesignError(fmt::format("{}: steps of {} % need more than {} sets, expected a larger step", file,
                                  rounded_text(step_percent), kMaxSets));
  }
  for (const Hertz f : frequencies) out.sets.push_back(make_set(f, disturbance, branches, file));
  set_ranges(out.sets);
  for (const GainSet& set : out.sets) {
    out.update_s = std::max(out.update_s, 10.0 * static_cast<double>(out.packets(set).size()) / kBaud);
  }
  state_errors(out, disturbance);
  if (out.max_ratio_error_percent > step_percent / 2.0) suggest_gains(out);
  return out;
}

std::string GainSchedule::packets(const GainSet& set) const {
  std::string out;
  for (const auto& [address1, bytes] : set.streams) out += to_packet(bytes, false);
  return out;
}

}  // namespace bodesmith::fpaa
