#include <fmt/format.h>

#include <cmath>

#include "base/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "part_errors/report.hpp"

namespace bodesmith::part_errors {
namespace {

std::string volts_text(double volts) {
  return fmt::format("{:.4f} V", std::abs(volts) < 5e-5 ? 0.0 : volts);
}

std::string range_text(const TrimStep& step) {
  return step.trim.unit.empty() ? fmt::format("+-{} %", rounded_text(100.0 * step.range, 3))
                                : fmt::format("+-{} m{}", rounded_text(1e3 * step.range, 3), step.trim.unit);
}

/// What the whole range of a potentiometer moves the reading by.
std::string moves_text(const TrimStep& step) {
  return fmt::format("{} mV", rounded_text(1e3 * std::abs(2.0 * step.range * step.volts_per_setting), 2));
}

Json expected_points(const controller::AnalogController& controller) {
  const controller::RestWiring wiring(controller);
  const Board board(wiring, copy_of(controller, {}, {}));
  Json out = Json::array();
  for (const double r : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    out.push_back({{"r", fmt::format("{:.2f}", r)},
                   {"rising", fmt::format("{:.4f}", board.at_rest(r, true) + 0.0)},
                   {"falling", fmt::format("{:.4f}", board.at_rest(r, false) + 0.0)}});
  }
  return out;
}

}  // namespace

std::string trim_page(const Report& report, const controller::AnalogController& controller,
                      const std::string& title) {
  const TrimStudy& trims = report.trims;
  const Hertz fastest = report.study.frequencies.back();
  Json data = {{"title", title}, {"steps", Json::array()}};
  for (std::size_t i = 0; i < trims.steps.size(); ++i) {
    const TrimStep& step = trims.steps[i];
    data["steps"].push_back({{"number", std::to_string(i + 1)},
                             {"trim", step.trim.name},
                             {"how", step.trim.how},
                             {"range", range_text(step)},
                             {"reading", step.reading.words(controller, fastest)},
                             {"expected", volts_text(step.expected_v)},
                             {"moves", moves_text(step)},
                             {"way", step.volts_per_setting > 0.0 ? "rises" : "falls"}});
  }
  data["any"] = !trims.steps.empty();
  data["rounds"] = std::to_string(trims.rounds);
  data["points"] = expected_points(controller);
  data["at"] = Json::array();
  for (std::size_t i = 0; i < trims.after_at.size(); ++i) {
    data["at"].push_back({{"frequency", rounded_text(report.study.frequencies[i].value)},
                          {"before_median", rounded_text(trims.before_at[i].median_percent, 2)},
                          {"before_p95", rounded_text(trims.before_at[i].p95_percent, 2)},
                          {"after_median", rounded_text(trims.after_at[i].median_percent, 2)},
                          {"after_p95", rounded_text(trims.after_at[i].p95_percent, 2)}});
  }
  data["parts"] = Json::array();
  for (std::size_t i = 0; i < report.study.parts.size() && i < 8; ++i) {
    const Share& one = report.study.parts[i];
    data["parts"].push_back({{"name", one.name},
                             {"share", rounded_text(100.0 * one.share, 2)},
                             {"rms", rounded_text(one.rms_percent, 2)}});
  }
  data["rates"] = controller.slope.has_value();
  if (controller.slope) {
    const Reading slope{Reading::Kind::slope, 0.0};
    const controller::RestWiring wiring(controller);
    const Board board(wiring, copy_of(controller, {}, {}));
    const Input input = input_of(tracking::Reference(), fastest, 256);
    data["slope_words"] = slope.words(controller, fastest);
    data["slope_v"] = volts_text(board.mean_slope_v(input));
  }
  return render_template("controller/trim.md", data);
}

}  // namespace bodesmith::part_errors
