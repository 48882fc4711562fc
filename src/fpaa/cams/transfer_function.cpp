#include "fpaa/cams/transfer_function.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "fpaa/cams/cam_type.hpp"
#include "signal/csv.hpp"

namespace bodesmith::fpaa {

int LookupTable::entry_of(double in_v) {
  return static_cast<int>(std::clamp(std::floor((in_v + 3.0) * 256.0 / 6.0), 0.0, 255.0));
}

LookupTable LookupTable::of(const std::function<double(double)>& function, double full_scale_v) {
  LookupTable out;
  std::array<double, 256> wanted{};
  double most = 0.0;
  for (int entry = 0; entry < 256; ++entry) {
    const double v = function(input_v(entry));
    if (!std::isfinite(v)) {
      throw DesignError(
          fmt::format("the look-up function is not finite at {} V, expected a number at every input",
                      rounded_text(input_v(entry))));
    }
    wanted[static_cast<std::size_t>(entry)] = std::clamp(v, -full_scale_v, full_scale_v);
    most = std::max(most, std::abs(wanted[static_cast<std::size_t>(entry)]));
  }
  if (most == 0.0) throw DesignError("the look-up function is 0 everywhere, expected one that is not");
  out.cout = static_cast<int>(std::clamp(std::round(254.0 / most), 1.0, 255.0));
  for (std::size_t entry = 0; entry < 256; ++entry) {
    const double code = std::round(128.0 + 0.5 * wanted[entry] * out.cout);
    out.bytes[entry] = static_cast<std::uint8_t>(std::clamp(code, 0.0, 255.0));
  }
  return out;
}

std::string LookupTable::csv(const std::function<double(double)>& wanted) const {
  CsvTable table({"entry", "input_v", "wanted_v", "output_v", "byte"});
  for (int entry = 0; entry < 256; ++entry) {
    table.add_row({std::to_string(entry), number_text(input_v(entry)), number_text(wanted(input_v(entry))),
                   number_text(output_v(entry)), std::to_string(bytes[static_cast<std::size_t>(entry)])});
  }
  return table.text();
}

const CamType& transfer_function_type() {
  static const CamType type = [] {
    CamType t;
    t.name = "TransferFunction";
    t.parameters = {"table_v"};
    t.resources = Resources{.opamps = 1, .capacitors = 5, .comparators = 1, .sars = 1, .lookup_tables = 1};
    t.transfer = "2 V (LUT[input] - 128)/Cout, 256 entries over -3 to +3 V, one cycle late";
    t.transfer_ground = Ground::seen;
    t.delay_cycles = 1.0;
    t.clock_b_ratio = 16;
    t.limits = "one look-up table a chip";
    return t;
  }();
  return type;
}

}  // namespace bodesmith::fpaa
