// Touchstone 1: one port as it is, or a two-port whose S21 is the response and whose other parameters are 0: a matched
// device that passes nothing backwards, so that cascading in a microwave program multiplies responses.
#include <fmt/format.h>

#include "base/text.hpp"
#include "exchange/writer.hpp"

namespace bodesmith::exchange {
namespace {

class TouchstoneWriter : public Writer {
 public:
  std::string_view name() const override { return "touchstone"; }
  std::string_view endings() const override { return ".s2p .ts"; }
  std::string_view what() const override { return "Touchstone 1, S21 is the response"; }
  Written write(const Exportable& from, const ExportOptions&) const override {
    const FrequencyRecord& record = need_response(from, *this);
    Written out;
    out.content =
        fmt::format("! {}: S21 is the response, S11 = S12 = S22 = 0\n# HZ S RI R 50\n", from.source);
    for (std::size_t i = 0; i < record.frequency.size(); ++i) {
      out.content +=
          fmt::format("{} 0 0 {} {} 0 0 0 0\n", number_text(record.frequency[i].value),
                      number_text(record.response[i].real()), number_text(record.response[i].imag()));
    }
    out.said.push_back("S21 is the response, S11, S12 and S22 are 0; real and imaginary part, Hz, 50 ohm");
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(Writer, touchstone_writer, TouchstoneWriter)

}  // namespace bodesmith::exchange
