#include <array>

#include "signal/csv.hpp"
#include "signal/spectrum.hpp"
#include "simulate/loop.hpp"
#include "simulate/sweep.hpp"

namespace bodesmith::simulate {
namespace {

/// Rows of numbers under named columns.
template <std::size_t N>
class SignalTable {
 public:
  explicit SignalTable(const std::array<const char*, N>& names) : names_(names) {}
  void add(const std::array<double, N>& row) {
    for (std::size_t k = 0; k < N; ++k) columns_[k].push_back(row[k]);
  }
  std::string csv() && {
    CsvWriter writer;
    for (std::size_t k = 0; k < N; ++k) writer.add(names_[k], std::move(columns_[k]));
    return writer.text();
  }

 private:
  std::array<const char*, N> names_;
  std::array<std::vector<double>, N> columns_;
};

}  // namespace

std::string sweep_loops_csv(const std::vector<SweepRow>& rows) {
  SignalTable<6> table({"frequency_hz", "amplitude", "u", "ascending", "descending", "height_percent"});
  for (const SweepRow& row : rows) {
    const Loop loop = hysteresis_loop(row.u, row.y);
    for (std::size_t i = 0; i < loop.u.size(); ++i) {
      table.add({row.frequency.value, row.amplitude, loop.u[i], loop.ascending[i], loop.descending[i],
                 loop.height_percent});
    }
  }
  return std::move(table).csv();
}

std::string sweep_spectra_csv(const std::vector<SweepRow>& rows) {
  SignalTable<7> table(
      {"frequency_hz", "amplitude", "harmonic", "u_amplitude", "u_phase_deg", "y_amplitude", "y_phase_deg"});
  for (const SweepRow& row : rows) {
    const double step = 1.0 / (row.frequency.value * static_cast<double>(row.u.size()));
    const Spectrum u = spectrum_of(row.u, 0.0, step, true);
    const Spectrum y = spectrum_of(row.y, 0.0, step, true);
    for (std::size_t k = 0; k < u.amplitude.size(); ++k) {
      table.add({row.frequency.value, row.amplitude, static_cast<double>(k), u.amplitude[k], u.phase_deg[k],
                 y.amplitude[k], y.phase_deg[k]});
    }
  }
  return std::move(table).csv();
}

}  // namespace bodesmith::simulate
