// Responses (and records) as lines of numbers: this program's own CSV, FRD, Touchstone.
#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "exchange/writer.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"

namespace bodesmith::exchange {
namespace {

/// `head`, then a line a frequency: that in Hz, and the response as `numbers` writes it.
template <class Numbers>
std::string response_lines(std::string head, const FrequencyRecord& record, Numbers numbers) {
  for (std::size_t i = 0; i < record.frequency.size(); ++i)
    head += fmt::format("{} {}\n", number_text(record.frequency[i].value), numbers(record.response[i]));
  return head;
}

/// Foreign files become frequency_hz,magnitude_db,phase_deg or time_s,u,y.
class OwnCsvWriter : public Writer {
 public:
  OwnCsvWriter() : Writer("csv", ".csv", "this program's CSV of a response or a record") {}
  Written write(const Exportable& from, const ExportOptions&) const override {
    CsvWriter csv;
    if (from.record) {
      csv.add(column::time_s, from.record->times_s());
      csv.add(column::input, from.record->u);
      if (!from.record->y.empty()) csv.add(column::output, from.record->y);
      return {csv.text(), {}};
    }
    const FrequencyRecord& record = need_response(from, *this);
    std::vector<double> frequency, magnitude, phase;
    for (std::size_t i = 0; i < record.frequency.size(); ++i) {
      frequency.push_back(record.frequency[i].value);
      magnitude.push_back(to_decibel(std::abs(record.response[i])));
      phase.push_back(to_degrees(std::arg(record.response[i])));
    }
    csv.add(column::frequency_hz, std::move(frequency));
    csv.add(column::magnitude_db, std::move(magnitude));
    csv.add(column::phase_deg, std::move(phase));
    return {csv.text(), {}};
  }
};

/// Frequency in Hz, level in dB, phase in degrees, as loudspeaker and room programs read it.
class FrdWriter : public Writer {
 public:
  FrdWriter() : Writer("frd", ".frd", "frequency, dB, degrees") {}
  Written write(const Exportable& from, const ExportOptions&) const override {
    const auto numbers = [](const Complex& h) {
      return fmt::format("{} {}", number_text(to_decibel(std::abs(h))), number_text(to_degrees(std::arg(h))));
    };
    return {response_lines(fmt::format("* {}\n* Freq(Hz) SPL(dB) Phase(degrees)\n", from.source),
                           need_response(from, *this), numbers),
            {"0 dB is a gain of 1; phase from -180 to 180 degrees"}};
  }
};

/// Touchstone 1: a two-port whose S21 is the response and whose other parameters are 0: a matched device that passes nothing
/// backwards, so that cascading in a microwave program multiplies responses.
class TouchstoneWriter : public Writer {
 public:
  TouchstoneWriter() : Writer("touchstone", ".s2p .ts", "Touchstone 1, S21 is the response") {}
  Written write(const Exportable& from, const ExportOptions&) const override {
    const auto numbers = [](const Complex& h) {
      return fmt::format("0 0 {} {} 0 0 0 0", number_text(h.real()), number_text(h.imag()));
    };
    return {response_lines(
                fmt::format("! {}: S21 is the response, S11 = S12 = S22 = 0\n# HZ S RI R 50\n", from.source),
                need_response(from, *this), numbers),
            {"S21 is the response, S11, S12 and S22 are 0; real and imaginary part, Hz, 50 ohm"}};
  }
};

}  // namespace

BODESMITH_ENTRY(Writer, csv_writer, OwnCsvWriter)
BODESMITH_ENTRY(Writer, frd_writer, FrdWriter)
BODESMITH_ENTRY(Writer, touchstone_writer, TouchstoneWriter)

}  // namespace bodesmith::exchange
