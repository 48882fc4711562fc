#include "synthesis/generator/circuit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"
#include "numeric/interpolated.hpp"

namespace bodesmith::generator {
namespace {

bool is_generator(Purpose purpose) {
  return purpose == Purpose::powers || purpose == Purpose::branch;
}

/// What the generator reads, by another name: the last pass's argument becomes `argument`, those before it what they divide.
/// `divided`: what the last one divides becomes `argument`.
void rename_arguments(const DisturbanceCircuit& controller, const std::string& argument, bool divided,
                      schematic::Netlist& out) {
  const auto read = [&](std::size_t group, std::string& node) {
    const Purpose purpose = controller.purpose_of(group);
    if (divided && controller.stroke) {
      if (purpose == Purpose::division && node == controller.passes.back().from) node = argument;
      return;
    }
    if (!is_generator(purpose)) return;
    for (const Pass& one : controller.passes) {
      if (node == one.x) {
        node = &one == &controller.passes.back() ? argument : one.from;
        return;
      }
    }
  };
  for (Part& one : out.parts) {
    read(one.group, one.from);
    read(one.group, one.to);
  }
  for (Multiplier& one : out.multipliers) {
    for (std::string* node : {&one.x, &one.y, &one.z}) read(one.group, *node);
  }
}

}  // namespace

std::string_view to_string(Form form) {
  constexpr std::array kWords = {"open", "seed", "two-pass", "self-fed"};
  return kWords.at(static_cast<std::size_t>(form));
}

Form form_named(const std::string& name) {
  if (name == "seed" || name == "one-pass") return Form::one_pass;
  if (name == "two-pass") return Form::two_pass;
  if (name == "self-fed") return Form::self_fed;
  throw InputError(fmt::format("unknown form \"{}\", expected seed, two-pass or self-fed", name));
}

double polynomial(const std::vector<double>& a, double x) {
  double out = 0.0;
  for (std::size_t k = a.size(); k-- > 0;) out = (out + a[k]) * x;
  return out;
}

double peak(const std::vector<double>& a, double top) {
  double out = 0.0;
  for (int i = 0; i <= kPolynomialPoints; ++i)
    out = std::max(out, std::abs(polynomial(a, top * i / kPolynomialPoints)));
  return out;
}

int degree(const std::vector<double>& a) {
  std::size_t n = a.size();
  while (n > 0 && a[n - 1] == 0.0) --n;
  return static_cast<int>(n);
}

double DisturbanceCircuit::wanted(std::size_t branch, double x, double alpha) const {
  const double gain = amplitude ? interpolated(amplitude->alpha, amplitude->wanted[branch], alpha) : 1.0;
  return gain * polynomial(branches[branch].wanted, x);
}

double DisturbanceCircuit::realised(std::size_t branch, double x, double alpha) const {
  const double gain = amplitude ? interpolated(amplitude->alpha, amplitude->wanted[branch], alpha) : 1.0;
  return gain * polynomial(branches[branch].realised, x);
}

int DisturbanceCircuit::select_lines() const {
  int lines = 0;
  while ((2u << lines) < branches.size()) ++lines;
  return lines;
}

int DisturbanceCircuit::branch_at(int select, bool rising) const {
  const int count = static_cast<int>(branches.size());
  const int code = 2 * select + (rising ? 0 : 1);
  if (code < count) return code;
  return code == count && count % 2 == 1 ? count - 1 : -1;
}

double DisturbanceCircuit::rated_gain(Disturbance::Branch which, Hertz frequency) const {
  return rates ? disturbance.rate_gain(which, frequency) : 1.0;
}

double DisturbanceCircuit::amplitude_gain(Disturbance::Branch which, double alpha) const {
  return stroke ? disturbance.amplitude.at(which, alpha) : 1.0;
}

schematic::Netlist DisturbanceCircuit::generator() const {
  return schematic::subset(*this, [&](std::size_t one) { return purpose_of(one) != Purpose::slope_sign; });
}

schematic::Netlist DisturbanceCircuit::detector_netlist() const {
  return schematic::subset(*this, [&](std::size_t one) { return purpose_of(one) == Purpose::slope_sign; });
}

std::vector<std::string> DisturbanceCircuit::ports() const {
  std::vector<std::string> out = {"x", "out"};
  if (amplitude) out.emplace_back("amplitude");
  for (int line = 1; line <= select_lines(); ++line) out.push_back(fmt::format("select{}", line));
  return out;
}

schematic::Netlist opened(const DisturbanceCircuit& controller, double stroke) {
  schematic::Netlist out = schematic::subset(controller, [&](std::size_t group) {
    const Purpose purpose = controller.purpose_of(group);
    return purpose != Purpose::slope_sign && purpose != Purpose::slope_meter && purpose != Purpose::stroke;
  });
  rename_arguments(controller, kArgument, true, out);
  if (controller.stroke) {
    out.sources.push_back({"Vstroke", "", "al", stroke});
    out.sources.push_back({"Vminus", "", "an", -stroke});
  }
  for (Part& one : out.parts) {
    for (std::string* node : {&one.from, &one.to}) {
      if (*node == "sn") *node = "slope";
    }
  }
  for (schematic::Comparator& one : out.comparators) {
    one.in = "branch";
    one.gain = 40.0;
    one.threshold_v = 0.5;
  }
  return out;
}

schematic::Netlist generator_netlist(const DisturbanceCircuit& controller, bool cut, bool divided) {
  schematic::Netlist out = schematic::subset(controller, [&](std::size_t group) {
    const Purpose purpose = controller.purpose_of(group);
    return is_generator(purpose) || purpose == Purpose::branch_switch || purpose == Purpose::output ||
           (divided && purpose == Purpose::division);
  });
  out.sources = {{"Vr", "", "r", 0.0}};
  rename_arguments(controller, cut ? kArgument : controller.passes.back().from, divided, out);
  return out;
}

}  // namespace bodesmith::generator
