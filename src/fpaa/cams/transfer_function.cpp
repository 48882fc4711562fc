#include "fpaa/cams/transfer_function.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/device/config_stream.hpp"
#include "signal/csv.hpp"

namespace bodesmith::fpaa {

std::size_t LookupTable::entry_of(double in_v) {
  return whole_number<std::size_t>(std::floor((in_v + kFullScaleV) * 256.0 / (2.0 * kFullScaleV)), 0, 255);
}

Outcome<LookupTable> LookupTable::of(const std::function<double(double)>& function) {
  LookupTable out;
  std::array<double, 256> wanted{};
  double peak = 0.0;
  for (std::size_t entry = 0; entry < wanted.size(); ++entry) {
    const double v = function(input_v(entry));
    if (!std::isfinite(v)) {
      return Refusal{
          fmt::format("the look-up function is not finite at {} V, expected a number at every input",
                      rounded_text(input_v(entry)))};
    }
    wanted[entry] = std::clamp(v, -kFullScaleV, kFullScaleV);
    peak = std::max(peak, std::abs(wanted[entry]));
  }
  if (peak == 0.0) return Refusal{"the look-up function is 0 everywhere, expected one that is not"};
  out.cout = nearest_whole<int>(254.0 / peak, 1, kMostUnits);
  for (std::size_t entry = 0; entry < wanted.size(); ++entry) {
    const double code = std::round(128.0 + 0.5 * wanted[entry] * out.cout);
    out.bytes[entry] = whole_number<std::uint8_t>(code);
  }
  return out;
}

std::string LookupTable::csv(const std::function<double(double)>& wanted) const {
  CsvTable table({"entry", "input_v", "wanted_v", "output_v", "byte"});
  for (std::size_t entry = 0; entry < bytes.size(); ++entry) {
    table.add_row({std::to_string(entry), number_text(input_v(entry)), number_text(wanted(input_v(entry))),
                   number_text(output_v(entry)), std::to_string(bytes[entry])});
  }
  return table.text();
}

namespace {

constexpr const char* kTableKey = "table_hex";

class TransferFunctionCam : public Cam {
 public:
  TransferFunctionCam()
      : Cam(CamFacts{
            .name = "TransferFunction",
            .resources =
                Resources{.opamps = 1, .capacitors = 5, .comparators = 1, .sars = 1, .lookup_tables = 1},
            .delay_cycles = 1.0,
            .clock_b_ratio = 16}) {}

  CamStep step(const PlacedCam& cam) const override {
    return [table = LookupTable::from(cam.requested)](std::span<const double> inputs) {
      return table.output(inputs[0]);
    };
  }
  std::string picture_text(const PlacedCam&) const override { return "256 bytes of look-up"; }
};

}  // namespace

CamValues LookupTable::values() const {
  return {{"cout", static_cast<double>(cout)}, {kTableKey, hex_text(bytes)}};
}

LookupTable LookupTable::from(const CamValues& values) {
  LookupTable out;
  const std::string_view hex = values.text(kTableKey);
  if (hex.size() != 2 * out.bytes.size()) {
    throw InputError(
        fmt::format("a look-up table has {} hex digits, expected {}", hex.size(), 2 * out.bytes.size()));
  }
  for (std::size_t i = 0; i < out.bytes.size(); ++i) {
    const auto [end, error] = std::from_chars(hex.data() + 2 * i, hex.data() + 2 * i + 2, out.bytes[i], 16);
    if (error != std::errc{} || end != hex.data() + 2 * i + 2)
      throw InputError(fmt::format("byte {} of a look-up table is not two hex digits", i));
  }
  out.cout = whole_number<int>(values.required_number("cout"));
  return out;
}

BODESMITH_ENTRY(Cam, transfer_function_cam, TransferFunctionCam)

}  // namespace bodesmith::fpaa
