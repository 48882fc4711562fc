// d(x) as a variant's CAMs make it at rest.
#include <algorithm>
#include <cmath>
#include <map>

#include "fpaa/cams/cam.hpp"
#include "fpaa/controller/branches.hpp"

namespace bodesmith::fpaa {
namespace {

/// Of the stroke, at which the polynomials are compared.
constexpr int kStrokePoints = 4001;

/// Signals at rest, all of them functions of the argument's volts. Only CAMs without memory stand there.
class RestingBranches {
 public:
  RestingBranches(const ControllerVariant& variant, std::string argument)
      : variant_(variant), argument_(std::move(argument)) {}

  double value(const std::string& name, double argument_v) {
    if (name == argument_) return argument_v;
    if (const OutsidePart* part = variant_.find_outside(name)) {
      if (part->kind == OutsidePart::Kind::constant) return part->value;
      return value(part->inputs[0], argument_v) * value(part->inputs[1], argument_v) * part->value;
    }
    const ControllerCam& cam = *variant_.find(name);
    std::vector<double> inputs;
    for (const std::string& input : cam.inputs) inputs.push_back(value(input, argument_v));
    const auto [step, fresh] = steps_.try_emplace(name);
    if (fresh) step->second = cam.cam->step(cam);
    if (step->second) return step->second(inputs);
    double sum = 0.0;
    for (std::size_t i = 0; i < inputs.size(); ++i) sum += cam.z.dc_gain(i + 1) * inputs[i];
    return sum;
  }

 private:
  const ControllerVariant& variant_;
  std::string argument_;
  std::map<std::string, CamStep> steps_;
};

/// The last CAM of a branch before any compensator: of the pass that makes the drive.
const ControllerCam* branch_end(const ControllerVariant& variant, const std::string& branch) {
  for (const char* kind : {"Amplitude", "Gain", "Sum"}) {
    if (const ControllerCam* cam = variant.find(branch + kind)) return cam;
  }
  return nullptr;
}

}  // namespace

void set_polynomial_error(ControllerVariant& variant, const Disturbance& disturbance) {
  const ControllerCam* output = variant.find("Output");
  const double weight = -output->realised.required_number("gain_2");
  const std::string argument = variant.structure == ControllerStructure::loop       ? variant.drive
                               : variant.structure == ControllerStructure::two_pass ? "FirstOutputHold"
                                                                                    : "r";
  RestingBranches resting(variant, argument);
  double sum = 0.0;
  for (const Disturbance::Branch branch : kBranches) {
    const ControllerCam* end = branch_end(variant, ControllerBranches::name_of(branch));
    for (int i = 0; i < kStrokePoints; ++i) {
      const double x = i / (kStrokePoints - 1.0);
      const double made =
          weight * resting.value(end->name, variant.scale.volts(x)) / variant.scale.volts_per_stroke;
      const double error = 100.0 * (made - disturbance.value(branch, x));
      variant.max_error_percent = std::max(variant.max_error_percent, std::abs(error));
      sum += error * error;
    }
  }
  variant.rms_error_percent = std::sqrt(sum / (2.0 * kStrokePoints));
}

}  // namespace bodesmith::fpaa
