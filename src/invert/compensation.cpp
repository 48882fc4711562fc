#include "invert/compensation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/documents/document.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "chain/model_file.hpp"
#include "invert/local_model.hpp"
#include "signal/period.hpp"

namespace bodesmith::invert {
namespace {

/// Records whose every sample is simulated to its last digit again and again.
constexpr std::size_t kMaxPolished = 20'000;
/// An error that counts as one that a limit is to blame for, as a part of the reference's range.
constexpr double kNoticed = 1e-3;

/// Samples that stand at a limit of the drive while the output is off.
class LimitCounts {
 public:
  LimitCounts(const TimeRecord& reference, const Compensation& found, const chain::DriveLimits& limits)
      : reference_(reference), found_(found), limits_(limits) {
    const auto [low, high] = std::minmax_element(reference.u.begin(), reference.u.end());
    noticed_ = kNoticed * (*high - *low);
  }

  std::vector<OutOfReach> all(std::vector<bool>& any, std::size_t delayed) {
    const std::vector<double>& u = found_.drive;
    const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-9 * (std::abs(b) + 1e-300); };
    if (limits_.lower)
      count("the drive's lower limit", any, delayed,
            [&](std::size_t i) { return near(u[i], *limits_.lower); });
    if (limits_.upper)
      count("the drive's upper limit", any, delayed,
            [&](std::size_t i) { return near(u[i], *limits_.upper); });
    if (limits_.max_rate_per_s) {
      const double reach = *limits_.max_rate_per_s * reference_.step_s;
      count("the drive's largest rate", any, delayed,
            [&](std::size_t i) { return i > 0 && std::abs(u[i] - u[i - 1]) >= (1.0 - 1e-9) * reach; });
    }
    return std::move(out_);
  }

 private:
  template <class Holds>
  void count(const std::string& why, std::vector<bool>& any, std::size_t delayed, Holds&& holds) {
    OutOfReach one{why, 0, 0.0, 0.0};
    for (std::size_t i = 0; i + delayed < found_.drive.size(); ++i) {
      const std::size_t heard = i + delayed;
      if (!holds(i) || std::abs(found_.predicted[heard] - reference_.u[heard]) <= noticed_) continue;
      if (one.samples++ == 0) one.from_s = reference_.time_s(heard);
      one.to_s = reference_.time_s(heard);
      any[heard] = true;
    }
    if (one.samples > 0) out_.push_back(std::move(one));
  }

  const TimeRecord& reference_;
  const Compensation& found_;
  const chain::DriveLimits& limits_;
  double noticed_ = 0.0;
  std::vector<OutOfReach> out_;
};

void check(const TimeRecord& reference, const Options& options) {
  if (reference.size() < 2) throw InputError("the reference has one sample, expected at least two");
  const chain::DriveLimits& limits = options.limits;
  if (limits.lower && limits.upper && !(*limits.lower < *limits.upper))
    throw InputError("the drive's lower limit is not below its upper limit");
  if (options.bandwidth && options.bandwidth->value * reference.step_s > 0.5)
    throw InputError(
        fmt::format("the drive's bandwidth of {} Hz is above half the reference's sampling rate, {} Hz",
                    number_text(options.bandwidth->value), rounded_text(0.5 / reference.step_s)));
}

}  // namespace

InverseFile InverseFile::read(const std::filesystem::path& path, Provenance& from) {
  const Node node = read_document(path, from);
  node.expect_schema("inverse");
  node.allow_only(
      {"schema", "model", "start", "preview", "lower", "upper", "max_rate_per_s", "bandwidth_hz"});
  const Node file = node.at("model");
  const std::filesystem::path target = path.parent_path() / file.string();
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(target, ignored))
    file.fail(fmt::format("names {}, which is not there", target.string()));
  InverseFile out{chain::read_model(target, from), {}};
  out.options.start = out.model.start.value_or(out.options.start);
  if (node.has("start"))
    out.options.start = one_of(node.at("start"), chain::Start::equilibrium, chain::Start::zero);
  out.options.preview = node.boolean_or("preview", true);
  if (node.has("lower")) out.options.limits.lower = node.at("lower").number();
  if (node.has("upper")) out.options.limits.upper = node.at("upper").number();
  if (out.options.limits.lower && out.options.limits.upper &&
      !(*out.options.limits.lower < *out.options.limits.upper))
    node.at("upper").fail("is not above lower");
  if (node.has("max_rate_per_s")) out.options.limits.max_rate_per_s = node.at("max_rate_per_s").positive();
  if (node.has("bandwidth_hz")) out.options.bandwidth = Hertz{node.at("bandwidth_hz").positive()};
  return out;
}

std::string InverseFile::text(const std::string& model, const Options& options) {
  std::string out = fmt::format(
      "# The inverse of a model, for any reference: feedforward of a controller.toml, or bodesmith compensate.\n"
      "schema = \"bodesmith.inverse/1\"\nmodel = \"{}\"\nstart = \"{}\"\npreview = {}\n",
      model, simulate::to_string(options.start), options.preview);
  const auto number = [&out](const char* key, const std::optional<double>& value) {
    if (value) out += fmt::format("{} = {}\n", key, number_text(*value));
  };
  number("lower", options.limits.lower);
  number("upper", options.limits.upper);
  number("max_rate_per_s", options.limits.max_rate_per_s);
  if (options.bandwidth) number("bandwidth_hz", options.bandwidth->value);
  return out;
}

Compensation compensate(const chain::Chain& chain, const TimeRecord& reference, const Options& options) {
  check(reference, options);
  const TimeRecord record = as_read_back(reference);
  DriveSearch search(chain, record, options);
  Compensation out;
  search.by_structure();
  search.improve(options.max_steps);
  if (record.size() <= kMaxPolished) search.polish(3);
  out.drive = search.drive();
  simulate::Result result = search.simulated(out.drive);
  out.predicted = std::move(result.y);
  out.error_estimate = result.error_estimate;
  out.steps = search.steps();
  out.delay_s = search.delay_s();
  out.without_inverse = search.without_inverse();
  out.out_of_reach = search.refused();
  std::vector<bool> any = search.refused_samples();
  const double late = std::min(std::round(out.delay_s / record.step_s), static_cast<double>(record.size()));
  for (OutOfReach& one : LimitCounts(record, out, options.limits).all(any, static_cast<std::size_t>(late)))
    out.out_of_reach.push_back(std::move(one));
  out.samples_out_of_reach = static_cast<std::size_t>(std::ranges::count(any, true));
  return out;
}

TimeRecord as_read_back(TimeRecord record) {
  const auto steps = static_cast<double>(record.size() - 1);
  record.step_s = (record.time_s(record.size() - 1) - record.start_s) / steps;
  return record;
}

SteadyState steady_state_of(const chain::Chain& chain, const TimeRecord& reference, const Options& options,
                            std::optional<double> skip_s) {
  const std::size_t n = reference.size();
  if (skip_s) {
    if (!(*skip_s < reference.duration_s()))
      throw InputError("the time to skip is not shorter than the reference, expected a part of it");
    return {whole_number<std::size_t>(std::ceil(*skip_s / reference.step_s - 1e-9)),
            "after the time skipped"};
  }
  if (const auto repeats = find_repetition(reference.u); repeats && n >= 2 * repeats->samples)
    return {n - repeats->samples, "the last period"};
  std::vector<chain::Kernel> kernels;
  double slowest = 0.0;
  for (const chain::Block& block : chain.blocks) {
    kernels.push_back(block.kernel());
    slowest += 7.0 * block.slowest_time_constant_s();
  }
  double wait = total_delay_s(kernels);
  if (options.start == simulate::Start::zero) wait += slowest;
  const double samples = std::min(std::ceil(wait / reference.step_s), static_cast<double>(n / 2));
  return {std::max<std::size_t>(static_cast<std::size_t>(samples), 1), "after the start"};
}

}  // namespace bodesmith::invert
