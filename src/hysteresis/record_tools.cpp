#include "hysteresis/record_tools.hpp"

namespace bodesmith::hysteresis {

Range input_range(std::span<const TimeRecord> records, double skip_s) {
  Range out;
  for (const TimeRecord& record : records)
    for (std::size_t i = first_counted(record, skip_s); i < record.size(); ++i) out.include(record.u[i]);
  return out;
}

Range output_range(std::span<const TimeRecord> records, double skip_s) {
  Range out;
  for (const TimeRecord& record : records)
    for (std::size_t i = first_counted(record, skip_s); i < record.size(); ++i) out.include(record.y[i]);
  return out;
}

std::size_t counted_samples(std::span<const TimeRecord> records, double skip_s) {
  std::size_t out = 0;
  for (const TimeRecord& record : records) out += record.size() - first_counted(record, skip_s);
  return out;
}

void operator_residual(const Operator& op, std::span<const TimeRecord> records, double skip_s,
                       Eigen::VectorXd& residual) {
  residual.resize(static_cast<Eigen::Index>(counted_samples(records, skip_s)));
  Eigen::Index at = 0;
  for (const TimeRecord& record : records) {
    const std::unique_ptr<Operator> run = op.clone();
    const std::size_t first = first_counted(record, skip_s);
    double y = run->reset(record.u[0]);
    for (std::size_t i = 0; i < record.size(); ++i) {
      if (i > 0) y = run->step(record.u[i], record.step_s);
      if (i >= first) residual(at++) = y - record.y[i];
    }
  }
}

std::vector<Branch> branches(const std::vector<double>& u, double dead) {
  std::vector<Branch> out;
  if (u.size() < 2) return out;
  Range range;
  for (const double value : u) range.include(value);
  const double least = dead * range.width();
  if (!(range.width() > 0.0)) return out;
  std::size_t first = 0;
  std::size_t extreme = 0;
  int direction = 0;
  for (std::size_t i = 1; i < u.size(); ++i) {
    if (direction == 0) {
      if (u[i] > u[first] + least) direction = 1;
      if (u[i] < u[first] - least) direction = -1;
      extreme = i;
      continue;
    }
    if ((u[i] - u[extreme]) * direction >= 0.0) {
      extreme = i;
    } else if ((u[extreme] - u[i]) * direction > least) {
      out.push_back({first, extreme, direction > 0});
      first = extreme;
      direction = -direction;
      extreme = i;
    }
  }
  if (direction != 0 && extreme > first) out.push_back({first, extreme, direction > 0});
  return out;
}

}  // namespace bodesmith::hysteresis
