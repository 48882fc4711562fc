#include "fpaa/streams/update_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/device/cells.hpp"
#include "fpaa/streams/c_source.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr std::size_t kUpdatedClocks = 4;

/// "bank 3, byte 7".
std::string place_text(MemoryPlace at) {
  return fmt::format("bank {}, byte {}", at.bank, at.byte);
}

struct Cell {
  int value = 0;
  std::string what;
};
using Memory = std::map<MemoryPlace, Cell>;

const ApiProject::Chip& project_chip(const ChipPlan& chip, const ApiProject& project) {
  // The plan's chips are numbered; the project's stand in the order of their arrays.
  if (std::cmp_greater(chip.chip, project.chips.size())) {
    throw DesignError(fmt::format("{}: has {} chip{}, the plan needs chip {}", project.file,
                                  project.chips.size(), project.chips.size() == 1 ? "" : "s", chip.chip));
  }
  return project.chips[static_cast<std::size_t>(chip.chip - 1)];
}

/// A plan's capacitors as the user's table has them.
std::vector<Capacitor> table_capacitors(const PlacedCam& cam, const ApiProject::Cam& table) {
  std::vector<std::string> names;
  for (const ApiProject::Capacitor& c : table.capacitors) names.push_back(c.name);
  return cam.cam->vendor_capacitors(cam, names);
}

const ApiProject::Cam& table_of(const PlacedCam& cam, const ApiProject::Chip& chip,
                                const ApiProject& project) {
  if (const ApiProject::Cam* table = project.find(chip.name, cam.name); table != nullptr) return *table;
  std::vector<std::string> names;
  for (const ApiProject::Cam& c : project.cams) {
    if (c.chip == chip.name) names.push_back(c.name);
  }
  throw DesignError(
      fmt::format("{}: chip {} has no CAM named {}, expected the names of the build sheet (it has: {})",
                  project.file, chip.name, cam.name, join(names, ", ")));
}

/// Place of a plan's capacitor in the user's table.
std::size_t index_of(const Capacitor& c, const ApiProject::Cam& table, const PlacedCam& cam,
                     const ApiProject& project, const UpdateOptions& options) {
  const auto renamed = options.names.find(c.name);
  const std::string& name = renamed == options.names.end() ? c.name : renamed->second;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < table.capacitors.size(); ++i) {
    if (table.capacitors[i].name == name) return i;
    names.push_back(table.capacitors[i].name);
  }
  throw DesignError(fmt::format(
      "{}:{}: {} has no capacitor {}, its table has {}; expected a map of {} to one of them (which is which stands in "
      "the CAM's dialog)",
      project.file, table.line, cam.name, name, join(names, ", "), c.name));
}

Memory memory_of(const ChipPlan& chip, const ApiProject& project, const UpdateOptions& options) {
  Memory out;
  const ApiProject::Chip& target = project_chip(chip, project);
  const auto set = [&](MemoryPlace address, int value, const std::string& what) {
    const auto [at, fresh] = out.try_emplace(address, Cell{value, what});
    if (!fresh && at->second.value != value) {
      throw DesignError(fmt::format("{}: {} and {} stand at the same address ({})", project.file,
                                    at->second.what, what, place_text(address)));
    }
  };
  for (const PlacedCam& cam : chip.cams) {
    const ApiProject::Cam& table = table_of(cam, target, project);
    for (const Capacitor& c : table_capacitors(cam, table)) {
      const auto& at = table.capacitors[index_of(c, table, cam, project, options)];
      set({at.bank, at.byte}, c.units, fmt::format("{} {}", cam.name, at.name));
    }
  }
  if (options.clocks) {
    for (std::size_t k = 0; k < std::min(chip.clocks.clocks.size(), kUpdatedClocks); ++k) {
      set(an231::clock_divisor_at(static_cast<int>(k)), divisor_byte(chip.clocks.clocks[k].divisor),
          fmt::format("Clock {} divisor", k));
    }
    set(an231::kSystem1, divisor_byte(chip.clocks.sys1_divisor), "Sys1 divisor");
    set(an231::kSystem2, divisor_byte(chip.clocks.sys2_divisor), "Sys2 divisor");
  }
  return out;
}

}  // namespace

ConfigStream update_stream(const ChipPlan& chip, const ApiProject& project, const UpdateOptions& options) {
  std::map<MemoryPlace, int> memory;
  for (const auto& [place, cell] : memory_of(chip, project, options)) memory[place] = cell.value;
  ConfigStream out = update_of(project_chip(chip, project).address1, memory);
  if (options.clocks) out.control |= ConfigStream::kUpdateClocks;
  return out;
}

std::vector<std::string> compare_with_plan(const ConfigStream& stream, const ChipPlan& chip,
                                           const ApiProject& project, const UpdateOptions& options) {
  std::map<MemoryPlace, int> memory;
  for (const ConfigBlock& block : stream.blocks) {
    for (std::size_t i = 0; i < block.data.size(); ++i) {
      const int behind = block.byte + static_cast<int>(i);
      memory[{block.bank + behind / 32, behind % 32}] = block.data[i];
    }
  }
  std::vector<std::string> out;
  const Memory wanted = memory_of(chip, project, options);
  const int address1 = project_chip(chip, project).address1;
  if (stream.address1 != address1) {
    out.push_back(
        fmt::format("Address1 is {}, the project's chip {} has {}", stream.address1, chip.chip, address1));
  }
  for (const auto& [address, cell] : wanted) {
    const auto at = memory.find(address);
    const std::string place = place_text(address);
    if (at == memory.end()) {
      // A primary stream leaves out what is 0.
      if (stream.primary && cell.value == 0) continue;
      out.push_back(
          fmt::format("{} ({}) is not in the stream, the plan requires {}", cell.what, place, cell.value));
    } else if (at->second != cell.value) {
      out.push_back(
          fmt::format("{} ({}) is {}, the plan requires {}", cell.what, place, at->second, cell.value));
    }
  }
  if (!stream.primary) {
    for (const auto& [address, value] : memory) {
      if (wanted.count(address) == 0) {
        out.push_back(
            fmt::format("{} is set to {}, the plan does not mention it", place_text(address), value));
      }
    }
  }
  return out;
}

std::string c_calls(const Plan& plan, const ApiProject& project, const UpdateOptions& options,
                    const std::string& plan_file) {
  Json data;
  data["plan"] = plan_file;
  data["p"] = project.prefix;
  data["chips"] = Json::array();
  for (const ChipPlan& chip : plan.chips) {
    const ApiProject::Chip& target = project_chip(chip, project);
    Json cams = Json::array();
    for (const PlacedCam& cam : chip.cams) {
      const ApiProject::Cam& table = table_of(cam, target, project);
      Json calls = Json::array();
      for (const Capacitor& c : table_capacitors(cam, table)) {
        const std::size_t index = index_of(c, table, cam, project, options);
        calls.push_back({{"index", index}, {"units", c.units}, {"capacitor", table.capacitors[index].name}});
      }
      cams.push_back(
          {{"cam", fmt::format("{}_{}_{}", project.prefix, target.name, cam.name)}, {"calls", calls}});
    }
    data["chips"].push_back(
        {{"chip", chip.chip}, {"id", fmt::format("{}_{}", project.prefix, target.name)}, {"cams", cams}});
  }
  return render_template("fpaa/set_capacitors.c", data);
}

std::string c_arrays(const std::vector<std::pair<std::string, Bytes>>& arrays, const std::string& plan_file) {
  Json data;
  data["plan"] = plan_file;
  data["arrays"] = Json::array();
  for (const auto& [name, bytes] : arrays) {
    data["arrays"].push_back({{"name", name}, {"count", bytes.size()}, {"rows", c_rows(bytes)}});
  }
  return render_template("fpaa/update_streams.c", data);
}

}  // namespace bodesmith::fpaa
