#include "gap/cases/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace hidden {
namespace {

struct Count {
  int cases = 0, right = 0, exact = 0, alone = 0;
  void add(const Outcome& o) {
    ++cases;
    right += o.right ? 1 : 0;
    exact += o.exact ? 1 : 0;
    alone += o.exact && o.further() == 0 ? 1 : 0;
  }
};

/// Where the share lies that k of n were drawn from, at 95 % (Wilson 1927).
std::string interval(int k, int n) {
  constexpr double kZ = 1.96;
  const auto count = static_cast<double>(n);
  const double share = static_cast<double>(k) / count;
  const double middle = share + kZ * kZ / (2.0 * count);
  const double reach = kZ * std::sqrt(share * (1.0 - share) / count + kZ * kZ / (4.0 * count * count));
  const double whole = 1.0 + kZ * kZ / count;
  return fmt::format("{:.2f} to {:.2f} %", std::max(0.0, 100.0 * (middle - reach) / whole),
                     100.0 * (middle + reach) / whole);
}

std::string of(int part, int whole) {
  return whole == 0 ? "–" : fmt::format("{} of {} ({:.1f} %)", part, whole, 100.0 * part / whole);
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v.size() % 2 == 1 ? v[v.size() / 2] : 0.5 * (v[v.size() / 2 - 1] + v[v.size() / 2]);
}

std::string size_table(const std::vector<Outcome>& outcomes) {
  std::map<double, Count> sizes;
  std::map<double, std::vector<double>> closures;
  for (const auto& o : outcomes) {
    if (o.specification.kind != Kind::effect) continue;
    sizes[o.specification.ratio].add(o);
    closures[o.specification.ratio].push_back(o.closure);
  }
  if (sizes.empty()) return {};
  std::string text =
      "| size over noise | named (ties counted) | named outright | and nothing else | closure of the gap, "
      "held-out, median |\n"
      "|---|---|---|---|---|\n";
  for (const auto& [ratio, c] : sizes) {
    text += fmt::format("| {} | {} | {} | {} | {:.3f} |\n", ratio, of(c.right, c.cases), of(c.exact, c.cases),
                        of(c.alone, c.cases), median(closures[ratio]));
  }
  return text + "\n";
}

std::string effect_table(const std::vector<Outcome>& outcomes) {
  std::set<double> sizes;
  std::map<std::string, std::map<double, Count>> effects;
  for (const auto& o : outcomes) {
    if (o.specification.kind != Kind::effect) continue;
    sizes.insert(o.specification.ratio);
    effects[o.specification.what_text()][o.specification.ratio].add(o);
  }
  if (effects.empty()) return {};
  std::string text = "| hidden |";
  std::string rule = "|---|";
  for (const double s : sizes) {
    text += fmt::format(" at {} |", s);
    rule += "---|";
  }
  text += "\n" + rule + "\n";
  for (const auto& [effect, row] : effects) {
    text += "| " + effect + " |";
    for (const double s : sizes) {
      const auto at = row.find(s);
      text += at == row.end() ? " – |" : fmt::format(" {}/{} |", at->second.right, at->second.cases);
    }
    text += "\n";
  }
  return text + "\n";
}

std::string base_table(const std::vector<Outcome>& outcomes) {
  std::map<std::string, std::map<Kind, Count>> bases;
  for (const auto& o : outcomes)
    bases[fmt::format("{} `{}`", to_string(o.specification.world), o.specification.base)]
         [o.specification.kind]
             .add(o);
  std::string text =
      "| records by, base | effects | pairs | controls left alone | outside, told |\n|---|---|---|---|---|\n";
  for (auto& [base, kinds] : bases) {
    text += "| " + base + " |";
    for (const Kind kind : {Kind::effect, Kind::pair, Kind::control, Kind::outside})
      text += fmt::format(
          " {} |", kinds[kind].cases == 0 ? "–" : fmt::format("{}/{}", kinds[kind].right, kinds[kind].cases));
    text += "\n";
  }
  return text + "\n";
}

std::string sentences(const std::vector<Outcome>& outcomes) {
  Count pairs, controls, outside;
  int one_of_two = 0, alarms = 0;
  std::vector<double> closures;
  for (const auto& o : outcomes) {
    switch (o.specification.kind) {
      case Kind::effect:
        closures.push_back(o.closure);
        break;
      case Kind::pair:
        pairs.add(o);
        one_of_two += o.right || std::any_of(o.named.begin(), o.named.end(), [&](const std::string& n) {
                        const auto& what = o.specification.what;
                        return std::find(what.begin(), what.end(), n) != what.end();
                      });
        break;
      case Kind::control:
        controls.add(o);
        alarms += o.named.empty() ? 0 : 1;
        break;
      case Kind::outside:
        outside.add(o);
        break;
    }
  }
  std::string text;
  if (!closures.empty())
    text += fmt::format("Closure of the gap, held-out, median of all sizes: {:.3f}\n\n", median(closures));
  if (pairs.cases > 0)
    text += fmt::format("Pairs: both named {}; at least one {}\n\n", of(pairs.right, pairs.cases),
                        of(one_of_two, pairs.cases));
  if (controls.cases > 0)
    text += fmt::format(
        "False alarms: an effect named in {} controls (95 %: {}); verdict `nothing_missing` in {}\n\n",
        of(alarms, controls.cases), interval(alarms, controls.cases), of(controls.right, controls.cases));
  if (outside.cases > 0)
    text += fmt::format("Abstention: something outside the catalogue told as such in {}\n\n",
                        of(outside.right, outside.cases));
  return text;
}

std::string taken_for(const std::vector<Outcome>& outcomes) {
  std::map<std::string, std::map<std::string, int>> table;
  for (const auto& o : outcomes) {
    const auto& s = o.specification;
    const std::string what = s.what_text();
    switch (s.kind) {
      case Kind::effect:
        ++table[what][o.exact ? what : o.right ? "(in a tie)" : o.named.empty() ? o.verdict : o.named[0]];
        break;
      case Kind::pair: {
        std::string named;
        for (const auto& n : o.named) named += (named.empty() ? "" : "+") + n;
        ++table["pair: " + what][o.exact         ? "both"
                                 : o.right       ? "(in a tie)"
                                 : named.empty() ? o.verdict
                                                 : named];
        break;
      }
      case Kind::control:
        ++table["control: " + what][o.named.empty() ? o.verdict : o.named[0]];
        break;
      case Kind::outside:
        ++table["outside: " + what][o.verdict];
        break;
    }
  }
  std::string text = "| hidden | taken for (cases) |\n|---|---|\n";
  for (const auto& [truth, row] : table) {
    std::vector<std::pair<int, std::string>> cells;
    for (const auto& [got, count] : row) cells.emplace_back(-count, got);
    std::sort(cells.begin(), cells.end());
    text += "| " + truth + " | ";
    for (const auto& [count, got] : cells)
      text += fmt::format("{}{} {}", &got == &cells[0].second ? "" : ", ", -count, got);
    text += " |\n";
  }
  return text;
}

}  // namespace

std::string confusion_tables(const std::vector<Outcome>& outcomes) {
  return size_table(outcomes) + sentences(outcomes) + effect_table(outcomes) + base_table(outcomes) +
         taken_for(outcomes);
}

}  // namespace hidden
