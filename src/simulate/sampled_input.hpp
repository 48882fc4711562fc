#pragma once

#include <cstddef>
#include <span>

#include "signal/time_record.hpp"

namespace bodesmith::simulate {

/// The input of a TimeRecord, or of samples that lie elsewhere; a view.
struct SampledInput {
  double start_s = 0.0;
  double step_s = 0.0;
  std::span<const double> u;

  SampledInput(double start, double step, std::span<const double> samples)
      : start_s(start), step_s(step), u(samples) {}
  SampledInput(const TimeRecord& record) : SampledInput(record.start_s, record.step_s, record.u) {}

  std::size_t size() const { return u.size(); }
};

}  // namespace bodesmith::simulate
