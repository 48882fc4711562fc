#include "fpaa/plan/assembly.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/whole_number.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

/// What of a chip is taken.
class ChipRoom {
 public:
  /// Takes a CAB (counted from 1); nothing when none has room.
  std::optional<int> take(const PlaceNeed& cam) {
    if (tables_ + cam.resources.lookup_tables > 1) return std::nullopt;
    std::vector<std::int64_t> divisors = divisors_;
    if (cam.divisor && std::ranges::find(divisors, *cam.divisor) == divisors.end())
      divisors.push_back(*cam.divisor);
    if (divisors.size() > kClocks || !common_system_divisor(divisors)) return std::nullopt;
    Resources in_cab = cam.resources;
    in_cab.lookup_tables = 0;  // one table of 256 bytes belongs to the chip, not to a CAB
    Resources* best = nullptr;
    for (Resources& used : used_) {
      Resources total = used;
      total += in_cab;
      if (total.fits_in(kPerCab) && (best == nullptr || used.capacitors > best->capacitors)) best = &used;
    }
    if (best == nullptr) return std::nullopt;
    *best += in_cab;
    tables_ += cam.resources.lookup_tables;
    divisors_ = std::move(divisors);
    return static_cast<int>(best - used_.data()) + 1;
  }

 private:
  std::array<Resources, kCabs> used_;  ///< of each CAB
  std::vector<std::int64_t> divisors_;
  int tables_ = 0;
};

void add_once(std::vector<std::string>& names, const std::string& name) {
  if (std::ranges::find(names, name) == names.end()) names.push_back(name);
}

bool same_clock(Hertz a, Hertz b) {
  return std::abs(a.value - b.value) <= 1e-9 * b.value;
}

/// ClockA and ClockB of every CAM of a chip, fastest first.
std::vector<Hertz> chip_clocks(const std::vector<WiredCam>& cams, int chip) {
  std::vector<Hertz> out;
  const auto add = [&](Hertz f) {
    if (std::ranges::none_of(out, [&](Hertz g) { return same_clock(f, g); })) out.push_back(f);
  };
  bool converter = false;
  for (const WiredCam& cam : cams) {
    if (cam.chip != chip) continue;
    add(cam.clock_a);
    if (const int ratio = cam.cam->facts().clock_b_ratio) {
      add({ratio * cam.clock_a.value});
      converter = true;
    }
  }
  std::ranges::sort(out, std::ranges::greater(), &Hertz::value);
  // Converters: the two clocks once more as Clock 2 and 3, which public streams give them.
  if (converter && out.size() == 2) out = {out[0], out[1], out[0], out[1]};
  return out;
}

ClockPlan clock_plan(const std::vector<Hertz>& clocks, const Board& board) {
  std::vector<std::int64_t> totals;
  for (const Hertz f : clocks)
    totals.push_back(nearest_whole<std::int64_t>(board.master_clock.value / f.value));
  const std::optional<int> common = common_system_divisor(totals);
  ClockPlan out{common.value_or(1), common.value_or(1), {}};
  for (const std::int64_t total : totals) {
    // Not without a system divisor: the one that this clock needs serves all that are as slow.
    if (!common && !is_legal_divisor(static_cast<int>(total)))
      out.sys2_divisor = std::max(
          out.sys2_divisor,
          nearest_clock(board, {board.master_clock.value / static_cast<double>(total)}).system_divisor);
  }
  for (const std::int64_t total : totals) {
    const bool first = common || is_legal_divisor(static_cast<int>(total));
    out.clocks.push_back(
        {first ? 1 : 2, static_cast<int>(total / (first ? out.sys1_divisor : out.sys2_divisor))});
  }
  return out;
}

/// "chip1.in2" for the second of the signals that enter chip 1.
std::string pin(int chip, const char* kind, const std::vector<std::string>& names, const std::string& name) {
  const auto at = std::ranges::find(names, name) - names.begin();
  return fmt::format("chip{}.{}{}", chip, kind, at + 1);
}

const WiredCam* find(const std::vector<WiredCam>& cams, const std::string& name) {
  const auto at = std::ranges::find(cams, name, &WiredCam::name);
  return at == cams.end() ? nullptr : &*at;
}

std::vector<Wire> wires_of(const std::vector<WiredCam>& cams, const std::vector<ChipSignals>& signals,
                           bool wired_on) {
  std::vector<Wire> out;
  const auto of = [&](int chip) -> const ChipSignals& { return signals[static_cast<std::size_t>(chip - 1)]; };
  for (const WiredCam& cam : cams) {
    const std::string own = fmt::format("chip{}.{}", cam.chip, cam.name);
    for (std::size_t i = 0; i < cam.inputs.size(); ++i) {
      const WiredCam* source = find(cams, cam.inputs[i]);
      const bool inside = source != nullptr && source->chip == cam.chip;
      out.push_back({inside ? fmt::format("chip{}.{}", cam.chip, source->name)
                            : pin(cam.chip, "in", of(cam.chip).in, cam.inputs[i]),
                     own, static_cast<int>(i) + 1});
    }
    const std::vector<std::string>& leaving = of(cam.chip).out;
    if (std::ranges::find(leaving, cam.name) != leaving.end())
      out.push_back({own, pin(cam.chip, "out", leaving, cam.name)});
  }
  std::map<std::string, std::string> entered;  // from outside: by which pin
  for (std::size_t c = 0; c < signals.size(); ++c) {
    const int chip = static_cast<int>(c) + 1;
    for (const std::string& name : signals[c].in) {
      const std::string entry = pin(chip, "in", signals[c].in, name);
      if (const WiredCam* source = find(cams, name)) {
        out.push_back({pin(source->chip, "out", of(source->chip).out, name), entry});
      } else if (const auto [first, fresh] = entered.try_emplace(name, entry); wired_on && !fresh) {
        out.push_back({first->second, entry});
      }
    }
  }
  return out;
}

}  // namespace

Outcome<std::vector<Place>> place(const std::vector<PlaceNeed>& cams, const Board& board) {
  std::map<int, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < cams.size(); ++i) groups[cams[i].group].push_back(i);
  std::vector<ChipRoom> rooms(static_cast<std::size_t>(board.chips));
  std::vector<Place> out(cams.size());
  std::size_t present = 0;
  int placed = 0;
  const auto put = [&](const std::vector<std::size_t>& which) {
    for (std::size_t i = 0; i < rooms.size(); ++i) {
      const std::size_t chip = (present + i) % rooms.size();
      ChipRoom trial = rooms[chip];
      const bool fits = std::ranges::all_of(which, [&](std::size_t cam) {
        const std::optional<int> cab = trial.take(cams[cam]);
        out[cam] = {static_cast<int>(chip) + 1, cab.value_or(0)};
        return cab.has_value();
      });
      if (!fits) continue;
      rooms[chip] = std::move(trial);
      present = chip;
      placed += static_cast<int>(which.size());
      return true;
    }
    return false;
  };
  for (const auto& [group, which] : groups) {
    if (put(which)) continue;
    for (const std::size_t cam : which) {
      if (put({cam})) continue;
      int opamps = 0;
      for (const PlaceNeed& need : cams) opamps += need.resources.opamps;
      return Refusal{fmt::format(
          "the design needs {} CAMs with {} op-amps, {} of them fit on the {} chips of {}; expected fewer poles (a "
          "lower order, or a larger error), or the rest made with spice",
          cams.size(), opamps, placed, board.chips, board.name)};
    }
  }
  return out;
}

std::vector<ChipSignals> chip_signals(const std::vector<WiredCam>& cams,
                                      const std::vector<std::string>& leaving, const Board& board) {
  std::vector<ChipSignals> out(static_cast<std::size_t>(board.chips));
  const auto of = [&](int chip) -> ChipSignals& { return out[static_cast<std::size_t>(chip - 1)]; };
  for (const WiredCam& cam : cams) {
    for (const std::string& input : cam.inputs) {
      const WiredCam* source = find(cams, input);
      if (source == nullptr || source->chip != cam.chip) add_once(of(cam.chip).in, input);
      if (source != nullptr && source->chip != cam.chip) add_once(of(source->chip).out, input);
    }
  }
  for (const std::string& name : leaving) {
    if (const WiredCam* source = find(cams, name)) add_once(of(source->chip).out, name);
  }
  return out;
}

Plan assembled(const std::vector<WiredCam>& cams, const std::vector<std::string>& leaving, const Board& board,
               bool wired_on) {
  Plan out;
  out.board = board.name;
  for (int chip = 1; chip <= board.chips; ++chip) {
    const std::vector<Hertz> clocks = chip_clocks(cams, chip);
    if (clocks.empty()) continue;
    ChipPlan made{chip, board.master_clock, clock_plan(clocks, board), {}};
    for (const WiredCam& cam : cams) {
      if (cam.chip != chip) continue;
      made.cams.push_back(cam);
      for (std::size_t k = 0; k < clocks.size(); ++k) {
        if (same_clock(clocks[k], cam.clock_a)) made.cams.back().clock_index = static_cast<int>(k);
      }
    }
    out.chips.push_back(std::move(made));
  }
  out.wires = wires_of(cams, chip_signals(cams, leaving, board), wired_on);
  return out;
}

}  // namespace bodesmith::fpaa
