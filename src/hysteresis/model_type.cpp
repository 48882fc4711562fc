#include "hysteresis/model_type.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "hysteresis/identification.hpp"

namespace bodesmith::hysteresis {

ModelType::ModelType(std::string name, std::string what, std::string source,
                     std::vector<ParameterSpec> parameters)
    : name_(std::move(name)),
      what_(std::move(what)),
      source_(std::move(source)),
      parameters_(std::move(parameters)) {}

Model ModelType::model(const Parameters& values) const {
  Model out{this, completed(values, parameters_, name_)};
  validate(out.parameters);
  return out;
}

namespace {

/// Squares and products of four of the record's numbers stay far inside a double's range, or the searches would go on
/// and on comparing infinities.
void require_measured_sizes(const TimeRecord& record) {
  constexpr double kSmallest = 1e-50;
  constexpr double kLargest = 1e50;
  const auto require = [&](const std::vector<double>& signal, std::string_view name) {
    double size = 0.0;
    for (const double v : signal) size = std::max(size, std::abs(v));
    if (size == 0.0 || (size >= kSmallest && size <= kLargest)) return;
    throw InputError(record.file, 0,
                     fmt::format("{} reaches {}, expected {} to {}: state it in another unit", name,
                                 rounded_text(size, 3), kSmallest, kLargest));
  };
  require(record.u, "u");
  require(record.y, "y");
}

}  // namespace

Identified ModelType::identify(std::span<const TimeRecord> records, const IdentifyOptions& options) const {
  for (const TimeRecord& record : records) require_measured_sizes(record);
  const Stopwatch watch;
  Identified out = fit(records, options);
  out.compute_s = watch.seconds();
  return out;
}

std::unique_ptr<Operator> make_operator(const Model& model) {
  return model.type->make_operator(model.parameters);
}

std::unique_ptr<Inverse> make_inverse(const Model& model) {
  return model.type->make_inverse(model.parameters);
}

}  // namespace bodesmith::hysteresis
