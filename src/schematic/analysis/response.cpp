#include "schematic/analysis/response.hpp"

#include <cmath>
#include <stdexcept>

#include "base/progress.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::schematic {
namespace {

Complex way(const Eigen::VectorXcd& ways, int place) {
  return place < 0 ? 0.0 : ways(place);
}

class Power final : public NoiseSources {
 public:
  explicit Power(const Eigen::VectorXcd& ways) : ways_(ways) {}
  void add(int from, int to, double density) override {
    sum += density * std::norm(way(ways_, from) - way(ways_, to));
  }
  double sum = 0.0;

 private:
  const Eigen::VectorXcd& ways_;
};

/// x(out) of M x = b by elimination with partial pivoting, in place. Most of a circuit's M is 0, and what is left is small: a third of
/// the time of a general LU with all of x.
Complex eliminated(Eigen::MatrixXcd& m, Eigen::VectorXcd& b, Eigen::Index out) {
  const Eigen::Index last = m.rows() - 1;
  m.col(out).swap(m.col(last));
  const auto take = [](Complex& from, const Complex& x, const Complex& y) {
    from -= Complex(x.real() * y.real() - x.imag() * y.imag(), x.real() * y.imag() + x.imag() * y.real());
  };
  for (Eigen::Index k = 0; k < last; ++k) {
    Eigen::Index pivot = k;
    for (Eigen::Index i = k + 1; i <= last; ++i) {
      if (std::norm(m(i, k)) > std::norm(m(pivot, k))) pivot = i;
    }
    if (pivot != k) {
      m.row(k).swap(m.row(pivot));
      std::swap(b(k), b(pivot));
    }
    for (Eigen::Index i = k + 1; i <= last; ++i) {
      if (m(i, k) == 0.0) continue;
      const Complex share = m(i, k) / m(k, k);
      for (Eigen::Index j = k + 1; j <= last; ++j) take(m(i, j), share, m(k, j));
      take(b(i), share, b(k));
    }
  }
  return b(last) / m(last, last);
}

}  // namespace

std::vector<double> output_noise(const Netlist& netlist, const std::vector<Hertz>& grid, bool flicker,
                                 const std::string& node, const std::string& input) {
  const Equations equations(netlist, {.input = input});
  std::vector<double> out;
  for (const Hertz f : grid) {
    const Eigen::VectorXcd ways = equations.ways_to(f.rad_s(), node);
    Power power(ways);
    for (const auto& element : equations.elements()) element->noise(f.rad_s(), flicker, power);
    out.push_back(std::sqrt(power.sum));
  }
  return out;
}

double output_noise_rms(const Netlist& netlist, Band band, bool flicker, const std::string& node, int points,
                        const std::string& input) {
  const std::vector<Hertz> grid = log_grid(band, points);
  const std::vector<double> density = output_noise(netlist, grid, flicker, node, input);
  double sum = 0.0;
  for (std::size_t i = 1; i < grid.size(); ++i) {
    const double a = density[i - 1] * density[i - 1] * grid[i - 1].value,
                 b = density[i] * density[i] * grid[i].value;
    sum += 0.5 * (a + b) * std::log(grid[i].value / grid[i - 1].value);
  }
  return std::sqrt(sum);
}

double worst_output_offset(const Netlist& netlist) {
  const Equations equations(netlist);
  const Eigen::VectorXcd ways = equations.ways_to({0.0});
  double out = 0.0;
  for (std::size_t i = 0; i < netlist.opamps.size(); ++i) {
    const OpAmp& opamp = netlist.opamps[i];
    const OpAmpModel& model = netlist.model_of(opamp);
    out += model.offset_v * std::abs(ways(equations.row_of_opamp(i)));
    out += model.bias_current_a * (std::abs(way(ways, equations.node(opamp.plus))) +
                                   std::abs(way(ways, equations.node(opamp.minus))));
  }
  return out;
}

std::vector<Complex> log_sensitivities(const Equations& equations, std::size_t parts, RadPerSecond w) {
  const Eigen::VectorXcd x = solve_sparse(equations.small_signal(w)), y = equations.ways_to(w);
  const Complex h = x(equations.node("out"));
  std::vector<Complex> out(parts, 0.0);
  if (!(std::abs(h) > 0.0)) return out;
  std::vector<Stamps::Slope> slopes;
  for (std::size_t i = 0; i < parts; ++i) {
    const auto power = equations.part(i).power_of_value();
    if (!power) continue;
    slopes.clear();
    Stamps stamps({}, {}, slopes);
    equations.part(i).stamp({}, stamps);
    Complex change = 0.0;
    for (const Stamps::Slope& one : slopes)
      change -= y(one.row) * Complex(one.f, w.value * one.q) * (one.column == kInput ? 1.0 : x(one.column));
    change *= *power / h;
    if (std::isfinite(change.real()) && std::isfinite(change.imag())) out[i] = change;
  }
  return out;
}

std::vector<Complex> network_response(const Netlist& netlist, const std::vector<Hertz>& grid,
                                      const Assumptions& assumptions) {
  const Equations equations(netlist, assumptions);
  std::vector<Complex> out;
  out.reserve(grid.size());
  for (const Hertz f : grid) {
    stop_if_interrupted();
    out.push_back(equations.response(f.rad_s()));
  }
  return out;
}

void ResponseOfParts::System::add(const Stamps::Slope& slope, double factor) {
  const Complex value(factor * slope.f, factor * w * slope.q);
  if (slope.column == kInput) {
    b(slope.row) -= value;
  } else {
    m(slope.row, slope.column) += value;
  }
}

ResponseOfParts::ResponseOfParts(const Netlist& netlist, const std::vector<Hertz>& grid,
                                 const Assumptions& assumptions)
    : response_(grid.size()) {
  const Equations equations(netlist, assumptions);
  std::vector<Stamps::Slope> slopes;
  for (std::size_t i = 0; i < netlist.parts.size(); ++i) {
    const auto power = equations.part(i).power_of_value();
    if (!power)
      throw std::invalid_argument(netlist.parts[i].name + " has no value that the response could follow");
    parts_.push_back({netlist.parts[i].realised, *power, 1.0, {}});
    Stamps stamps({}, {}, parts_.back().slopes);
    equations.part(i).stamp({}, stamps);
  }
  for (const Hertz f : grid) {
    const SparseSystem whole = equations.small_signal(f.rad_s());
    others_.push_back({f.rad_s().value, whole.dense(), whole.b});
    for (const Part& part : parts_) {
      for (const Stamps::Slope& slope : part.slopes) others_.back().add(slope, -1.0);
    }
  }
  out_ = equations.node("out");
}

const std::vector<Complex>& ResponseOfParts::at(std::span<const double> values) {
  for (std::size_t p = 0; p < parts_.size(); ++p)
    parts_[p].factor = std::pow(values[p] / parts_[p].nominal, parts_[p].power);
  for (std::size_t i = 0; i < others_.size(); ++i) {
    all_ = others_[i];
    for (const Part& part : parts_) {
      for (const Stamps::Slope& slope : part.slopes) all_.add(slope, part.factor);
    }
    response_[i] = out_ < 0 ? Complex(out_ == kInput ? 1.0 : 0.0) : eliminated(all_.m, all_.b, out_);
  }
  return response_;
}

std::vector<Complex> return_ratios(const Equations& equations, const Netlist& netlist,
                                   const std::vector<std::size_t>& opamps, RadPerSecond w) {
  const SparseSystem s = equations.small_signal(w);
  const Eigen::Index n = s.b.size(), count = eigen_index(opamps.size());
  Eigen::MatrixXcd b = Eigen::MatrixXcd::Zero(n, count);
  for (Eigen::Index k = 0; k < count; ++k) b(equations.row_of_opamp(opamps[std_index(k)]), k) = 1.0;
  const Eigen::MatrixXcd x = solve_sparse(s, b);
  std::vector<Complex> out;
  for (Eigen::Index k = 0; k < count; ++k) {
    const std::size_t opamp = opamps[std_index(k)];
    const OpAmp& one = netlist.opamps[opamp];
    const OpAmpModel& model = netlist.model_of(one);
    const auto at = [&](const std::string& name) {
      const int place = equations.node(name);
      return place < 0 ? Complex(0.0) : x(place, k);
    };
    // Its own equation gives way to that of a source of 1 V: M x = e becomes (M + e (r - m)') y = e, y = x/(r'x).
    const Complex own = at(one.out) + model.output_resistance_ohm * x(equations.row_of_opamp(opamp), k);
    out.push_back(-model.open_loop(w) * (at(one.plus) - at(one.minus)) / own);
  }
  return out;
}

}  // namespace bodesmith::schematic
