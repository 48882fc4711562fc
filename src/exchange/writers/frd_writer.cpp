// FRD: frequency in Hz, level in dB, phase in degrees, as loudspeaker and room programs read it.
#include <fmt/format.h>

#include <complex>

#include "base/text.hpp"
#include "base/units.hpp"
#include "exchange/writer.hpp"

namespace bodesmith::exchange {
namespace {

class FrdWriter : public Writer {
 public:
  std::string_view name() const override { return "frd"; }
  std::string_view endings() const override { return ".frd"; }
  std::string_view what() const override { return "frequency, dB, degrees"; }
  Written write(const Exportable& from, const ExportOptions&) const override {
    const FrequencyRecord& record = need_response(from, *this);
    Written out;
    out.content = fmt::format("* {}\n* Freq(Hz) SPL(dB) Phase(degrees)\n", from.source);
    for (std::size_t i = 0; i < record.frequency.size(); ++i) {
      out.content += fmt::format("{} {} {}\n", number_text(record.frequency[i].value),
                                 number_text(to_decibel(std::abs(record.response[i]))),
                                 number_text(to_degrees(std::arg(record.response[i]))));
    }
    out.said.push_back("0 dB is a gain of 1; phase from -180 to 180 degrees");
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(Writer, frd_writer, FrdWriter)

}  // namespace bodesmith::exchange
