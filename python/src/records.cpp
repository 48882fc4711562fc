#include "records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace bodesmith::python {
namespace {

void expect_length(std::size_t got, std::size_t wanted, const std::string& name) {
  if (got != wanted) throw InputError(fmt::format("{} has {} values, expected {}", name, got, wanted));
}

std::span<const double> frequencies_of(const Call& call, const std::string& name) {
  const auto f = call.array(name);
  for (std::size_t i = 0; i < f.size(); ++i) {
    if (!(f[i] > 0.0) || !std::isfinite(f[i]))
      throw InputError(fmt::format("{}[{}] is {}, expected a finite number above 0", name, i, f[i]));
  }
  return f;
}

std::vector<std::size_t> rising_order(std::span<const double> f, const std::string& name) {
  std::vector<std::size_t> order(f.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return f[a] < f[b]; });
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (f[order[i]] == f[order[i - 1]])
      throw InputError(fmt::format("{} has {} Hz twice", name, f[order[i]]));
  }
  return order;
}

}  // namespace

void expect_finite(std::span<const double> values, const std::string& name) {
  const auto bad =
      std::find_if(values.begin(), values.end(), [](double value) { return !std::isfinite(value); });
  if (bad != values.end())
    throw InputError(fmt::format("{}[{}] is {}, expected a finite number", name, bad - values.begin(), *bad));
}

BodePoints points_of(const Call& call, const std::string& ending) {
  const auto f = frequencies_of(call, "frequency_hz" + ending);
  const auto gain = call.array("gain" + ending);
  expect_length(gain.size(), f.size(), "gain" + ending);
  for (std::size_t i = 0; i < gain.size(); ++i) {
    if (!(gain[i] > 0.0) || !std::isfinite(gain[i]))
      throw InputError(fmt::format("gain{}[{}] is {}, expected a finite number above 0", ending, i, gain[i]));
  }
  std::span<const double> phase, weight;
  if (call.has_array("phase_deg" + ending)) {
    phase = call.array("phase_deg" + ending);
    expect_length(phase.size(), f.size(), "phase_deg" + ending);
    expect_finite(phase, "phase_deg" + ending);
  }
  if (call.has_array("weight" + ending)) {
    weight = call.array("weight" + ending);
    expect_length(weight.size(), f.size(), "weight" + ending);
    expect_finite(weight, "weight" + ending);
    for (std::size_t i = 0; i < weight.size(); ++i) {
      if (weight[i] < 0.0)
        throw InputError(fmt::format("weight[{}] is {}, expected at least 0", i, weight[i]));
    }
  }
  BodePoints out;
  out.file = "the points";
  for (const std::size_t i : rising_order(f, "frequency_hz" + ending)) {
    BodePoint point;
    point.frequency = Hertz{f[i]};
    point.gain = gain[i];
    if (!phase.empty()) point.phase_deg = phase[i];
    if (!weight.empty()) point.weight = weight[i];
    out.points.push_back(point);
  }
  return out;
}

FrequencyRecord response_of(const Call& call, const std::string& ending) {
  const auto f = frequencies_of(call, "frequency_hz" + ending);
  const auto parts = call.array("response" + ending);
  expect_length(parts.size(), 2 * f.size(), "response" + ending + " (real and imaginary parts)");
  expect_finite(parts, "response" + ending);
  FrequencyRecord out;
  out.file = "the response" + ending;
  for (const std::size_t i : rising_order(f, "frequency_hz" + ending)) {
    out.frequency.push_back(Hertz{f[i]});
    out.response.emplace_back(parts[2 * i], parts[2 * i + 1]);
  }
  return out;
}

TimeRecord record_of(const Call& call, const Node& about, const std::string& ending) {
  TimeRecord out;
  out.file = about.string_or("name", "the record");
  out.step_s = about.at("step_s").positive();
  out.start_s = about.number_or("start_s", 0.0);
  expect_finite(call.array("u" + ending), "u" + ending);
  out.u = call.copy("u" + ending);
  if (out.u.size() < 2) throw InputError(fmt::format("{} has fewer than two samples", out.file));
  if (!call.has_array("y" + ending)) return out;
  expect_finite(call.array("y" + ending), "y" + ending);
  out.y = call.copy("y" + ending);
  expect_length(out.y.size(), out.u.size(), "y" + ending);
  return out;
}

std::vector<TimeRecord> records_of(const Call& call, const std::string& name) {
  std::vector<TimeRecord> out;
  if (!call.options.has(name)) return out;
  const auto items = call.options.at(name).items();
  for (std::size_t i = 0; i < items.size(); ++i)
    out.push_back(record_of(call, items[i], fmt::format("_{}{}", name, i)));
  return out;
}

std::vector<double> interleaved(const std::vector<std::complex<double>>& values) {
  std::vector<double> out;
  out.reserve(2 * values.size());
  for (const std::complex<double>& value : values) {
    out.push_back(value.real());
    out.push_back(value.imag());
  }
  return out;
}

}  // namespace bodesmith::python
