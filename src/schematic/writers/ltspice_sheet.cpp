#include "schematic/writers/ltspice_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"

namespace bodesmith::schematic {
namespace {

/// Pins of a symbol that is not turned, from its origin, in LTspice's units (16 a grid point).
struct PinPlace {
  int x;
  int y;
};
constexpr PinPlace kResistorPins[] = {{16, 16}, {16, 96}};
constexpr PinPlace kCapacitorPins[] = {{16, 0}, {16, 64}};
constexpr PinPlace kSourcePins[] = {{0, 16}, {0, 96}};
constexpr PinPlace kOpAmpMinus = {-32, 48};
constexpr PinPlace kOpAmpPlus = {-32, 80};
constexpr PinPlace kOpAmpOut = {32, 64};
constexpr double kIdealBandwidth = 1e12;  // hertz
constexpr int kStub = 16;
constexpr int kColumn = 192;
constexpr int kRow = 288;

class Sheet {
 public:
  void symbol(const std::string& name, int x, int y, const std::string& instance,
              const std::string& attributes) {
    symbols_ += fmt::format("SYMBOL {} {} {} R0\nSYMATTR InstName {}\n{}", name, x, y, instance, attributes);
  }
  /// A wire from a pin to the name of its net, in the direction given.
  void net(int x, int y, PinPlace pin, int dx, int dy, const std::string& name) {
    const int x1 = x + pin.x;
    const int y1 = y + pin.y;
    wires_ += fmt::format("WIRE {} {} {} {}\n", x1 + dx * kStub, y1 + dy * kStub, x1, y1);
    flags_ += fmt::format("FLAG {} {} {}\n", x1 + dx * kStub, y1 + dy * kStub, name);
  }
  void text(int x, int y, const std::string& line) {
    texts_ += fmt::format("TEXT {} {} Left 2 {}\n", x, y, line);
  }
  std::string content(int width, int height) const {
    return fmt::format("Version 4\nSHEET 1 {} {}\n", width, height) + wires_ + flags_ + symbols_ + texts_;
  }

 private:
  std::string wires_, flags_, symbols_, texts_;
};

}  // namespace

std::string ltspice_sheet(const Netlist& netlist, Band band, const std::string& source) {
  const double bandwidth = netlist.opamp.gain_bandwidth.value;
  Sheet sheet;
  std::size_t stages = 0;
  std::vector<int> column;  // the next free one of each stage's row
  const auto place = [&](std::size_t stage) {
    if (stage >= column.size()) column.resize(stage + 1, 0);
    stages = std::max(stages, stage + 1);
    return PinPlace{kColumn * ++column[stage], kRow * static_cast<int>(stage)};
  };
  for (const OpAmp& opamp : netlist.opamps) {
    const auto [x, y] = place(opamp.group);
    sheet.symbol("Opamps\\\\opamp", x, y, opamp.name,
                 fmt::format("SYMATTR SpiceLine Aol={}\nSYMATTR SpiceLine2 GBW={}\n",
                             rounded_text(netlist.opamp.dc_gain, 6),
                             rounded_text(std::isfinite(bandwidth) ? bandwidth : kIdealBandwidth, 6)));
    sheet.net(x, y, kOpAmpMinus, -1, 0, opamp.minus);
    sheet.net(x, y, kOpAmpPlus, -1, 0, opamp.plus);
    sheet.net(x, y, kOpAmpOut, 1, 0, opamp.out);
  }
  for (const Part& part : netlist.parts) {
    const auto [x, y] = place(part.group);
    const bool capacitor = part.kind == Part::Kind::capacitor;
    const auto& pins = capacitor ? kCapacitorPins : kResistorPins;
    sheet.symbol(capacitor ? "cap" : "res", x, y, part.name,
                 fmt::format("SYMATTR Value {}\n", number_text(part.realised)));
    sheet.net(x, y, pins[0], 0, -1, part.from);
    sheet.net(x, y, pins[1], 0, 1, part.to);
  }
  sheet.symbol("voltage", 0, 0, "V1", "SYMATTR Value 0\nSYMATTR Value2 AC 1\n");
  sheet.net(0, 0, kSourcePins[0], 0, -1, "in");
  sheet.net(0, 0, kSourcePins[1], 0, 1, "0");
  const int bottom = kRow * static_cast<int>(stages);
  sheet.text(0, bottom, "!.lib opamp.sub");
  sheet.text(0, bottom + 48,
             fmt::format("!.ac dec 50 {} {}", number_text(band.from.value / 10.0),
                         number_text(band.to.value * 10.0)));
  sheet.text(0, bottom + 96, ";" + source + ", written by bodesmith: input at net in, output at net out");
  int width = 1;
  for (const int count : column) width = std::max(width, count + 2);
  return sheet.content(kColumn * width, bottom + 200);
}

}  // namespace bodesmith::schematic
