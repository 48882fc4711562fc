// This program's own CSV: foreign files become frequency_hz,magnitude_db,phase_deg or time_s,u,y.
#include "base/units.hpp"
#include "exchange/writer.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"

namespace bodesmith::exchange {
namespace {

class OwnCsvWriter : public Writer {
 public:
  std::string_view name() const override { return "csv"; }
  std::string_view endings() const override { return ".csv"; }
  std::string_view what() const override { return "this program's CSV of a response or a record"; }
  Written write(const Exportable& from, const ExportOptions&) const override {
    CsvWriter csv;
    if (from.record) {
      std::vector<double> time(from.record->size());
      for (std::size_t i = 0; i < time.size(); ++i) time[i] = from.record->time_s(i);
      csv.add(column::time_s, std::move(time));
      csv.add(column::input, from.record->u);
      if (!from.record->y.empty()) csv.add(column::output, from.record->y);
      return {csv.text(), {}};
    }
    const FrequencyRecord& record = need_response(from, *this);
    std::vector<double> frequency;
    std::vector<double> magnitude;
    std::vector<double> phase;
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

}  // namespace

BODESMITH_ENTRY(Writer, csv_writer, OwnCsvWriter)

}  // namespace bodesmith::exchange
