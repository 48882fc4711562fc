#include "circuit/layout_budget.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "circuit/weights_search.hpp"

namespace bodesmith {
namespace {

constexpr int kPoints = 100;

/// One multiplier's departures.
struct Off {
  double x = 0.0, y = 0.0, w = 0.0, scale = 0.0, bend = 0.0;
};

double multiply(const MultiplierModel& m, double x, double y, const Off& off) {
  return (x + off.x) * (y + off.y) / (m.scale_v * (1.0 + off.scale)) * (1.0 + off.bend) + off.w;
}

/// The whole generator at rest; everything that may be off is a member.
struct Bench {
  const DisturbanceLayout& layout;
  std::map<int, Off> multiplier;    ///< by power
  std::map<int, double> resistor;   ///< relative, by place in parts
  std::map<size_t, double> offset;  ///< of the branch's op-amp
  double output_offset = 0.0, switch_relative = 0.0;

  double ohm(int index) const {
    const auto found = resistor.find(index);
    return layout.part(index).realised * (1.0 + (found == resistor.end() ? 0.0 : found->second));
  }

  double value(size_t b, double x) const {
    std::map<int, double> node = {{1, x}};
    for (const LayoutMultiplier& m : layout.multipliers) {
      const auto off = multiplier.find(m.power);
      node[m.power] = multiply(layout.multiplier, node[m.x_power], node[m.y_power],
                               off == multiplier.end() ? Off{} : off->second);
    }
    const LayoutBranch& branch = layout.branches[b];
    SummingResistors r;
    std::vector<double> signs;
    r.feedback = ohm(branch.feedback);
    double minus = 0.0;
    for (size_t k = 0; k < branch.weight.size(); ++k) {
      const bool used = branch.weight[k] >= 0;
      r.weights.push_back(used ? ohm(branch.weight[k]) : 0.0);
      signs.push_back(!used ? 0.0 : (branch.at_plus[k] ? 1.0 : -1.0));
      if (used && !branch.at_plus[k]) minus += 1.0 / r.weights.back();
    }
    if (branch.balance >= 0) {
      r.balance = ohm(branch.balance);
      r.balance_at_plus = layout.part(branch.balance).from == branch.plus;
      if (!r.balance_at_plus) minus += 1.0 / r.balance;
    }
    const std::vector<double> gains = summing_gains(r, signs);
    double v = 0.0;
    for (size_t k = 0; k < gains.size(); ++k)
      v += gains[k] * (signs[k] == 0.0 ? 0.0 : node[static_cast<int>(k) + 1]);
    if (const auto found = offset.find(b); found != offset.end())
      v += found->second * (1.0 + minus * r.feedback);
    const double input = ohm(layout.output_input) +
                         (layout.branches.size() > 1 ? layout.switch_on_ohm * (1.0 + switch_relative) : 0.0);
    const double gain = ohm(layout.output_feedback) / input;
    return -gain * v + output_offset * (1.0 + gain);
  }
};

double greatest(const std::function<double(double)>& f) {
  double out = 0.0;
  for (int i = 0; i <= kPoints; ++i) out = std::max(out, std::abs(f(static_cast<double>(i) / kPoints)));
  return out;
}

/// Horner on voltages, d = x (a1 + x (a2 + …)): the innermost product a_n x is a weight, every other a
/// multiplier.
double horner(const std::vector<double>& a, const MultiplierModel& m, double x, const std::vector<Off>& off) {
  double t = a.back() * x;
  size_t stage = 0;
  // The factor U of each product is taken up by the weights.
  for (size_t k = a.size() - 1; k-- > 0;) t = m.scale_v * multiply(m, a[k] + t, x, off[stage++]);
  return t;
}

std::vector<Off> kinds(const LayoutErrors& e) {
  return {{e.input_offset_v, 0, 0, 0, 0},
          {0, e.input_offset_v, 0, 0, 0},
          {0, 0, e.output_offset_v, 0, 0},
          {0, 0, 0, e.scale_percent / 100.0, 0},
          {0, 0, 0, 0, e.nonlinearity_percent / 100.0}};
}

}  // namespace

LayoutBudget layout_budget(const DisturbanceLayout& layout, const LayoutErrors& errors) {
  LayoutBudget out;
  out.errors = errors;
  const size_t branches = layout.branches.size();
  const auto line = [&](std::string cause, const std::function<void(Bench&)>& spoil) {
    LayoutBudgetLine one;
    one.cause = std::move(cause);
    Bench good{layout, {}, {}, {}, 0.0, 0.0}, bad{layout, {}, {}, {}, 0.0, 0.0};
    spoil(bad);
    for (size_t b = 0; b < branches; ++b) {
      one.percent.push_back(100.0 * greatest([&](double x) { return bad.value(b, x) - good.value(b, x); }));
    }
    out.lines.push_back(std::move(one));
  };
  static const char* const names[] = {"offset of X", "offset of Y", "offset of W", "scale U", "nonlinearity"};
  std::vector<double> by_multipliers(branches, 0.0);
  for (const LayoutMultiplier& m : layout.multipliers) {
    const std::vector<Off> all = kinds(errors);
    for (size_t i = 0; i < all.size(); ++i) {
      line(m.name + ", " + names[i], [&](Bench& bench) { bench.multiplier[m.power] = all[i]; });
      for (size_t b = 0; b < branches; ++b) by_multipliers[b] += out.lines.back().percent[b];
    }
  }
  for (size_t b = 0; b < branches; ++b) {
    line("op-amp of " + layout.branches[b].name + ", offset",
         [&](Bench& bench) { bench.offset[b] = errors.opamp_offset_v; });
  }
  line("output op-amp, offset", [&](Bench& bench) { bench.output_offset = errors.opamp_offset_v; });
  if (branches > 1) {
    line("switch, on-resistance",
         [&](Bench& bench) { bench.switch_relative = errors.switch_ohm_percent / 100.0; });
  }
  for (int i = 0; i < static_cast<int>(layout.parts.size()); ++i) {
    const LayoutPart& part = layout.part(i);
    if (part.kind != LayoutPart::Kind::resistor || part.role.starts_with("slope detector")) continue;
    line(part.name + ", tolerance",
         [&](Bench& bench) { bench.resistor[i] = errors.resistor_percent / 100.0; });
  }
  out.rss_percent.assign(branches, 0.0);
  out.worst_percent.assign(branches, 0.0);
  for (const LayoutBudgetLine& one : out.lines) {
    for (size_t b = 0; b < branches; ++b) {
      out.rss_percent[b] += one.percent[b] * one.percent[b];
      out.worst_percent[b] += one.percent[b];
    }
  }
  for (double& value : out.rss_percent) value = std::sqrt(value);
  const auto size = [](const LayoutBudgetLine& one) {
    return *std::max_element(one.percent.begin(), one.percent.end());
  };
  std::stable_sort(out.lines.begin(), out.lines.end(),
                   [&](const LayoutBudgetLine& a, const LayoutBudgetLine& b) { return size(a) > size(b); });

  out.shared_multipliers = static_cast<int>(layout.multipliers.size());
  std::map<int, int> depth = {{1, 0}};
  for (const LayoutMultiplier& m : layout.multipliers) {
    depth[m.power] = 1 + std::max(depth[m.x_power], depth[m.y_power]);
    out.shared_depth = std::max(out.shared_depth, depth[m.power]);
  }
  out.shared_worst_percent = *std::max_element(by_multipliers.begin(), by_multipliers.end());
  for (const LayoutBranch& branch : layout.branches) {
    std::vector<double> a = branch.wanted;
    while (a.size() > 1 && a.back() == 0.0) a.pop_back();
    const int count = static_cast<int>(a.size()) - 1;
    out.horner_multipliers += count;
    out.horner_depth = std::max(out.horner_depth, count);
    const std::vector<Off> none(static_cast<size_t>(std::max(count, 1)));
    double sum = 0.0;
    for (int stage = 0; stage < count; ++stage) {
      for (const Off& kind : kinds(errors)) {
        std::vector<Off> off = none;
        off[static_cast<size_t>(stage)] = kind;
        sum += 100.0 * greatest([&](double x) {
                 return horner(a, layout.multiplier, x, off) - horner(a, layout.multiplier, x, none);
               });
      }
    }
    out.horner_worst_percent = std::max(out.horner_worst_percent, sum);
  }
  return out;
}

Json LayoutBudget::to_json() const {
  Json out;
  out["assumed"] = {
      {"input_offset_v", errors.input_offset_v},        {"output_offset_v", errors.output_offset_v},
      {"scale_percent", errors.scale_percent},          {"nonlinearity_percent", errors.nonlinearity_percent},
      {"opamp_offset_v", errors.opamp_offset_v},        {"resistor_percent", errors.resistor_percent},
      {"switch_ohm_percent", errors.switch_ohm_percent}};
  out["rss_percent"] = rss_percent;
  out["worst_percent"] = worst_percent;
  out["causes"] = Json::array();
  for (const LayoutBudgetLine& one : lines)
    out["causes"].push_back({{"cause", one.cause}, {"percent", one.percent}});
  out["shared_powers"] = {{"multipliers", shared_multipliers},
                          {"depth", shared_depth},
                          {"multiplier_errors_percent", shared_worst_percent}};
  out["horner"] = {{"multipliers", horner_multipliers},
                   {"depth", horner_depth},
                   {"multiplier_errors_percent", horner_worst_percent}};
  return out;
}

}  // namespace bodesmith
