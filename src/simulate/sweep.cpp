#include "simulate/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <mutex>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/provenance.hpp"
#include "base/text.hpp"
#include "numeric/fourier.hpp"
#include "numeric/parallel_for.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"
#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"
#include "simulate/signal_study.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {
namespace {

std::pair<std::vector<double>, double> output_for(const chain::Chain& chain, const SweepOptions& options,
                                                  const TimeRecord& u) {
  if (options.loop) {
    LoopResult result = simulate_loop(chain, *options.loop, u, options.simulation);
    return {std::move(result.y), result.error_estimate.value_or(0.0)};
  }
  Result result = simulate(chain, u, options.simulation);
  return {std::move(result.y), result.error_estimate.value_or(0.0)};
}

/// The figures of one period of u and y.
SweepRow figures(std::span<const double> u, std::span<const double> y) {
  constexpr std::size_t kMaxHarmonic = 20;
  SweepRow row;
  const auto [low, high] = std::minmax_element(y.begin(), y.end());
  const ErrorFigures difference = error_figures(u, y);  // range of y, as eq. 8
  row.rms_percent = difference.rms_percent;
  row.max_percent = *high > *low ? 100.0 * difference.max / (*high - *low) : 0.0;
  row.loop_height_percent = hysteresis_loop(u, y).height_percent;
  const std::vector<Complex> in = half_spectrum(u), out = half_spectrum(y);
  if (std::abs(in[1]) > 0.0 && std::abs(out[1]) > 0.0) {
    row.gain_db = to_decibel(std::abs(out[1] / in[1]));
    row.phase_deg = to_degrees(std::arg(out[1] / in[1]));
    double power = 0.0;
    for (std::size_t k = 2; k <= std::min(kMaxHarmonic, u.size() / 2 - 1); ++k) power += std::norm(out[k]);
    row.distortion_percent = 100.0 * std::sqrt(power) / std::abs(out[1]);
  }
  return row;
}

SweepRow measure(const chain::Chain& chain, const SweepOptions& options, Hertz frequency, double amplitude) {
  ReferenceSpec spec;
  spec.kind = options.kind;
  spec.frequency = frequency;
  spec.amplitude = amplitude;
  spec.offset = options.offset.value_or(amplitude);
  spec.duration_s = options.periods / frequency.value;
  spec.step_s = 1.0 / frequency.value / options.samples_per_period;
  const TimeRecord u = make_reference(spec);
  const auto [output, error_estimate] = output_for(chain, options, u);
  const auto last = static_cast<std::size_t>(options.samples_per_period);
  const std::size_t from = u.size() - 1 - last;
  const std::span<const double> x(u.u.data() + from, last);
  const std::span<const double> y(output.data() + from, last);
  SweepRow row = figures(x, y);
  row.frequency = frequency;
  row.amplitude = amplitude;
  row.error_estimate = error_estimate;
  if (options.keep_periods) {
    row.u.assign(x.begin(), x.end());
    row.y.assign(y.begin(), y.end());
  }
  return row;
}

void validate_sweep(const SweepOptions& options) {
  if (options.frequencies.empty() || options.amplitudes.empty())
    throw InputError("a sweep needs at least one frequency and one amplitude");
  if (!can_be_swept(options.kind)) {
    throw InputError(
        fmt::format("a sweep cannot use the reference '{}', expected triangle, sine or stair", options.kind));
  }
  if (options.periods < 1 || options.samples_per_period < 8 || options.samples_per_period % 2 != 0) {
    throw InputError("a sweep needs at least one period of an even number of samples, 8 or more");
  }
}

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

std::vector<SweepRow> run_sweep(const chain::Chain& chain, const SweepOptions& options,
                                const std::vector<SweepRow>& known) {
  validate_sweep(options);
  const std::size_t total = options.frequencies.size() * options.amplitudes.size();
  std::vector<std::optional<SweepRow>> rows(total);
  std::size_t done = 0;
  std::mutex lock;
  Progress progress("sweep");
  parallel_for(total, thread_count(options.threads), [&](std::size_t i) {
    if (interrupted()) return;
    const Hertz frequency = options.frequencies[i / options.amplitudes.size()];
    const double amplitude = options.amplitudes[i % options.amplitudes.size()];
    const auto old = std::ranges::find_if(
        known, [&](const SweepRow& r) { return r.frequency == frequency && r.amplitude == amplitude; });
    try {
      rows[i] = old != known.end() ? *old : measure(chain, options, frequency, amplitude);
    } catch (const Interrupted&) {
      return;  // what is ready is kept
    }
    const std::scoped_lock guard(lock);
    progress.at(static_cast<double>(++done) / static_cast<double>(total));
  });
  std::vector<SweepRow> out;
  for (const auto& row : rows) {
    if (row) out.push_back(*row);
  }
  return out;
}

namespace {

/// Of a table of rows, behind their frequency.
constexpr std::pair<std::string_view, double SweepRow::*> kSweepColumns[] = {
    {"amplitude", &SweepRow::amplitude},
    {"rms_percent", &SweepRow::rms_percent},
    {"max_percent", &SweepRow::max_percent},
    {"loop_height_percent", &SweepRow::loop_height_percent},
    {"gain_db", &SweepRow::gain_db},
    {column::phase_deg, &SweepRow::phase_deg},
    {"distortion_percent", &SweepRow::distortion_percent},
    {"error_estimate", &SweepRow::error_estimate}};

}  // namespace

std::string sweep_csv(const std::vector<SweepRow>& rows, const std::string& key) {
  CsvWriter csv;
  std::vector<double> frequencies;
  for (const SweepRow& r : rows) frequencies.push_back(r.frequency.value);
  csv.add(column::frequency_hz, std::move(frequencies));
  for (const auto& [name, value] : kSweepColumns) {
    std::vector<double> column;
    for (const SweepRow& r : rows) column.push_back(r.*value);
    csv.add(name, std::move(column));
  }
  return "# sweep of " + key + "\n" + csv.text();
}

std::vector<SweepRow> read_sweep_csv(const std::filesystem::path& path, const std::string& key) {
  if (!std::filesystem::exists(path)) return {};
  const std::string text = read_file(path);
  if (!text.starts_with("# sweep of " + key + "\n")) return {};
  const Csv csv = Csv::parse(text, path.string());
  std::vector<SweepRow> rows(csv.rows());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].frequency = Hertz{csv.column(column::frequency_hz)[i]};
    for (const auto& [name, value] : kSweepColumns) rows[i].*value = csv.column(name)[i];
  }
  return rows;
}

std::string sweep_key(const std::string& files_sha256, const SweepOptions& options) {
  const Options& s = options.simulation;
  return sha256_hex(fmt::format("{} {} {} {} {} {} {} {} {} {}", files_sha256, options.kind,
                                options.offset ? number_text(*options.offset) : "amplitude", options.periods,
                                options.samples_per_period, static_cast<int>(s.engine),
                                s.start ? std::string(to_string(*s.start)) : "model's",
                                number_text(s.relative_tolerance), s.oversample, s.estimate_error));
}

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
