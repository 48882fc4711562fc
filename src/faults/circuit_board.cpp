#include "faults/circuit_board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <set>

#include "base/error.hpp"
#include "base/text.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::faults {
namespace {

using schematic::Equations;

/// A uniform deviation within a tolerance has this standard deviation, a little widened.
constexpr double kSigmaOfTolerance = 0.6;
/// Time constant of a second pole, times the gain-bandwidth in rad/s: its standard deviation.
constexpr double kSecondPole = 0.3;
/// An op-amp that keeps less than this of its gain is as good as known by how much it keeps.
constexpr double kMostlyLost = 0.4;
/// Unknowns that move nothing measured by more than this are left out.
constexpr double kLeastSlope = 1e-5;

/// Numbers that stand for an ideal op-amp, so that faults that need its equation have one.
schematic::OpAmpModel computable(schematic::OpAmpModel model) {
  if (!model.is_ideal) return model;
  model.dc_gain = 1e9;
  model.gain_bandwidth = Hertz{1e12};
  model.output_resistance_ohm = 1e-3;
  return model;
}

Complex read_of(const Stamp& stamp, const Eigen::VectorXcd& x) {
  Complex out = stamp.constant;
  for (const Stamp::Entry& e : stamp.reads) {
    if (e.weight != 0.0) out += e.weight * x(e.at);
  }
  return out;
}

/// row' A^-1 u.
Complex through(const Eigen::MatrixXcd& inverse, int row, const Stamp& stamp) {
  Complex out = 0.0;
  for (const Stamp::Entry& e : stamp.into) {
    if (e.weight != 0.0) out += e.weight * inverse(row, e.at);
  }
  return out;
}

/// v_i' A^-1 u_j.
Complex coupling(const Eigen::MatrixXcd& inverse, const Stamp& reads, const Stamp& into) {
  Complex out = 0.0;
  for (const Stamp::Entry& e : reads.reads) {
    if (e.weight != 0.0) out += e.weight * through(inverse, e.at, into);
  }
  return out;
}

/// The changes' own equations (1 + M D) l = l0: what flows through each of them.
struct Changes {
  Eigen::MatrixXcd system;  ///< 1 + M D
  Eigen::VectorXcd delta;   ///< D
  Eigen::VectorXcd reads;   ///< l
};

Changes changes_of(const std::vector<Stamp>& stamps, Complex s, const Eigen::MatrixXcd& inverse,
                   const Eigen::VectorXcd& x) {
  const Eigen::Index k = eigen_index(stamps.size());
  Changes out;
  out.system = Eigen::MatrixXcd::Identity(k, k);
  out.delta.resize(k);
  Eigen::VectorXcd before(k);
  for (Eigen::Index j = 0; j < k; ++j) {
    out.delta(j) = stamps[std_index(j)].delta(s);
    before(j) = read_of(stamps[std_index(j)], x);
    for (Eigen::Index i = 0; i < k; ++i)
      out.system(i, j) += coupling(inverse, stamps[std_index(i)], stamps[std_index(j)]) * out.delta(j);
  }
  if (k == 1) {
    out.reads = before / out.system(0, 0);
  } else {
    out.reads = solve_lu(out.system, before);
  }
  return out;
}

}  // namespace

CircuitBoard::CircuitBoard(const schematic::Netlist& circuit, Measurement measured, const Spread& spread,
                           const CircuitBoard* like)
    : Board(std::move(measured)), circuit_(circuit), model_(computable(circuit.opamp)), spread_(spread) {
  circuit_.opamp = model_;
  const Equations equations(circuit_);
  for (const std::string& name : nodes()) nodes_[name] = equations.node(name);
  for (const Channel& channel : this->measured().channels) {
    if (!nodes_.contains(channel.node))
      throw InputError(fmt::format("{}: the circuit has no node '{}', expected one of {}", channel.file,
                                   channel.node, join(nodes(), ", ")));
    for (const Hertz f : channel.grid) solve(equations, f.rad_s(), nodes_.at(channel.node));
  }
  set_good(response({}));
  find_unknowns(like);
}

std::vector<std::string> CircuitBoard::nodes() const {
  std::set<std::string> names;
  for (const schematic::Part& part : circuit_.parts) names.insert({part.from, part.to});
  for (const schematic::OpAmp& one : circuit_.opamps) names.insert({one.plus, one.minus, one.out});
  names.erase("0");
  names.erase("in");
  return {names.begin(), names.end()};
}

std::vector<std::string> CircuitBoard::probe_nodes() const {
  std::vector<std::string> out = nodes();
  std::erase(out, "out");
  return out;
}

void CircuitBoard::solve(const schematic::Equations& equations, RadPerSecond w, int out) {
  const SparseSystem system = equations.small_signal(w);
  Point point;
  point.s = Complex(0.0, w.value);
  point.out = out;
  point.inverse = inverse(system.dense());
  point.x = point.inverse * system.b;
  points_.push_back(std::move(point));
}

int CircuitBoard::node(const std::string& name) const {
  if (name == "0") return schematic::kGround;
  if (name == "in") return schematic::kInput;
  return nodes_.at(name);
}

Stamp CircuitBoard::admittance(const std::string& from, const std::string& to, double g, double c) const {
  Stamp out;
  out.g = g;
  out.c = c;
  const std::array<int, 2> ends = {node(from), node(to)};
  for (std::size_t i = 0; i < 2; ++i) {
    const double sign = i == 0 ? 1.0 : -1.0;
    if (ends[i] == schematic::kInput) out.constant += sign;
    if (ends[i] < 0) continue;
    out.into[i] = {ends[i], sign};
    out.reads[i] = {ends[i], sign};
  }
  return out;
}

Stamp CircuitBoard::slower(std::size_t opamp, double g, double c) const {
  const int row = static_cast<int>(nodes_.size() + opamp);
  Stamp out;
  out.into[0] = {row, 1.0};
  out.reads = {{{node(circuit_.opamps[opamp].out), 1.0}, {row, model_.output_resistance_ohm}}};
  out.g = -g;
  out.c = -c;
  return out;
}

Effect CircuitBoard::slowed(std::size_t opamp, double factor, bool known) const {
  const double ft = 2.0 * std::numbers::pi * model_.gain_bandwidth.value;
  Effect out;
  out.stamps = {slower(opamp, 0.0, (1.0 / factor - 1.0) / ft)};
  const std::size_t unknown = unknown_of_opamp_[opamp];
  out.spread = {{unknown, known ? 0.0 : 1.0 / factor}, {unknown + 1, 1.0 / (factor * factor)}};
  return out;
}

Stamp CircuitBoard::plus_follows(std::size_t opamp, const std::string& name, double part) const {
  Stamp out;
  out.into[0] = {static_cast<int>(nodes_.size() + opamp), 1.0};
  out.g = part;
  if (const int at = node(name); at >= 0) {
    out.reads[0] = {at, 1.0};
  } else if (at == schematic::kInput) {
    out.constant = 1.0;
  }
  return out;
}

Effect CircuitBoard::inputs_follow(std::size_t opamp, double kept) const {
  Effect out;
  out.stamps = {plus_follows(opamp, circuit_.opamps[opamp].minus, 1.0 - kept)};
  if (kept < kMostlyLost) out.spread = {{unknown_of_opamp_[opamp], 0.0}};
  return out;
}

double CircuitBoard::tolerance(std::size_t part) const {
  const bool resistor = circuit_.parts[part].kind == schematic::Part::Kind::resistor;
  return 0.01 * (resistor ? spread_.resistor_percent : spread_.capacitor_percent);
}

Stamp CircuitBoard::times_admittance(std::size_t part, double factor) const {
  const schematic::Part& p = circuit_.parts[part];
  const bool resistor = p.kind == schematic::Part::Kind::resistor;
  return admittance(p.from, p.to, resistor ? factor / p.realised : 0.0, resistor ? 0.0 : factor * p.realised);
}

Effect CircuitBoard::changed(std::size_t part, double factor) const {
  const bool resistor = circuit_.parts[part].kind == schematic::Part::Kind::resistor;
  const double more = resistor ? 1.0 / factor : factor;  // of the admittance
  Effect out;
  out.stamps = {times_admittance(part, more - 1.0)};
  out.spread = {{unknown_of_part_[part], more}};
  return out;
}

Effect CircuitBoard::replaced(std::size_t part, double siemens) const {
  Effect out = changed(part, circuit_.parts[part].kind == schematic::Part::Kind::resistor
                                 ? std::numeric_limits<double>::infinity()
                                 : 0.0);
  out.stamps[0].g += siemens;
  return out;
}

void CircuitBoard::find_unknowns(const CircuitBoard* like) {
  const double ft = 2.0 * std::numbers::pi * model_.gain_bandwidth.value;
  for (std::size_t i = 0; i < circuit_.parts.size(); ++i) {
    const bool resistor = circuit_.parts[i].kind == schematic::Part::Kind::resistor;
    const double sigma = kSigmaOfTolerance * tolerance(i);
    unknown_of_part_.push_back(unknowns_.size());
    unknowns_.push_back({circuit_.parts[i].name, true, times_admittance(i, resistor ? -sigma : sigma)});
  }
  std::vector<Unknown> small;
  const double opamp_sigma = 0.01 * spread_.opamp_percent;
  for (std::size_t i = 0; i < circuit_.opamps.size(); ++i) {
    const std::string& name = circuit_.opamps[i].name;
    unknown_of_opamp_.push_back(unknowns_.size());
    unknowns_.push_back({name + " gain-bandwidth", false, slower(i, 0.0, -opamp_sigma / ft)});
    Stamp second = slower(i, 0.0, kSecondPole / (ft * model_.dc_gain));
    second.d = -kSecondPole / (ft * ft);
    unknowns_.push_back({name + " second pole", false, second});
    Stamp resistance =
        slower(i, 1.0 / model_.dc_gain, 1.0 / ft).times(opamp_sigma * model_.output_resistance_ohm);
    resistance.reads[0] = {resistance.reads[1].at, 1.0};
    resistance.reads[1] = {};
    small.push_back({name + " output resistance", false, resistance});
  }
  for (const std::string& name : nodes())
    small.push_back({name + " stray capacitance", false, admittance(name, "0", 0.0, spread_.stray_f)});
  for (Unknown& one : small) {
    if (like != nullptr) {
      const auto same = [&](const Unknown& u) { return u.name == one.name; };
      if (std::ranges::any_of(like->unknowns_, same)) unknowns_.push_back(std::move(one));
      continue;
    }
    double largest = 0.0;
    for (const Point& point : points_) {
      const Complex change = through(point.inverse, point.out, one.stamp) * one.stamp.delta(point.s) *
                             read_of(one.stamp, point.x);
      largest = std::max(largest, std::abs(change) / std::max(std::abs(point.x(point.out)), 1e-12));
    }
    if (largest > kLeastSlope) unknowns_.push_back(std::move(one));
  }
}

Complex CircuitBoard::at(const Point& point, const Effect& effect, int row) {
  Complex out = point.x(row);
  if (effect.stamps.empty()) return out;
  if (effect.stamps.size() == 1) {
    const Stamp& stamp = effect.stamps.front();
    const Complex delta = stamp.delta(point.s);
    return out - through(point.inverse, row, stamp) * delta * read_of(stamp, point.x) /
                     (1.0 + coupling(point.inverse, stamp, stamp) * delta);
  }
  const Changes changes = changes_of(effect.stamps, point.s, point.inverse, point.x);
  for (std::size_t j = 0; j < effect.stamps.size(); ++j) {
    const Eigen::Index i = eigen_index(j);
    out -= through(point.inverse, row, effect.stamps[j]) * changes.delta(i) * changes.reads(i);
  }
  return out;
}

Eigen::VectorXcd CircuitBoard::outputs(const std::vector<Point>& points, const Effect& effect) {
  Eigen::VectorXcd out(eigen_index(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k) out(eigen_index(k)) = at(points[k], effect, points[k].out);
  return out;
}

Eigen::VectorXcd CircuitBoard::response(const Effect& effect) const {
  return outputs(points_, effect);
}

/// Every point's inverse with the changes in it, so that what comes on top is of rank one again.
class CircuitBoard::Changed : public ChangedBoard {
 public:
  Changed(const std::vector<Point>& points, const Effect& effect) : points_(points) {
    for (Point& point : points_) build_in(effect.stamps, point);
  }
  Eigen::VectorXcd response(const Effect& further) const override { return outputs(points_, further); }

 private:
  static void build_in(const std::vector<Stamp>& stamps, Point& point) {
    if (stamps.empty()) return;
    const Changes changes = changes_of(stamps, point.s, point.inverse, point.x);
    const Eigen::Index n = point.inverse.rows();
    const Eigen::Index k = changes.delta.size();
    Eigen::MatrixXcd columns = Eigen::MatrixXcd::Zero(n, k);  // A^-1 U D
    Eigen::MatrixXcd rows = Eigen::MatrixXcd::Zero(k, n);     // V' A^-1
    for (Eigen::Index j = 0; j < k; ++j) {
      for (const Stamp::Entry& e : stamps[std_index(j)].into) {
        if (e.weight != 0.0) columns.col(j) += e.weight * changes.delta(j) * point.inverse.col(e.at);
      }
      for (const Stamp::Entry& e : stamps[std_index(j)].reads) {
        if (e.weight != 0.0) rows.row(j) += e.weight * point.inverse.row(e.at);
      }
    }
    point.x -= columns * changes.reads;
    point.inverse -= columns * solve_lu_columns(changes.system, rows);
  }

  std::vector<Point> points_;
};

std::unique_ptr<ChangedBoard> CircuitBoard::changed_by(const Effect& effect) const {
  return std::make_unique<Changed>(points_, effect);
}

Eigen::VectorXcd CircuitBoard::at_node(const std::string& name, const Effect& effect) const {
  const std::size_t count = measured().channels.front().grid.size();
  Eigen::VectorXcd out(eigen_index(count));
  for (std::size_t k = 0; k < count; ++k) out(eigen_index(k)) = at(points_[k], effect, nodes_.at(name));
  return out;
}

Prediction CircuitBoard::predict(const Effect& effect) const {
  Prediction out;
  out.model_error = effect.model_error;
  if (effect.model_error > 0.0) {
    Effect exact;
    std::copy_if(effect.stamps.begin(), effect.stamps.end(), std::back_inserter(exact.stamps),
                 [](const Stamp& stamp) { return !stamp.rough; });
    if (!exact.stamps.empty()) out.reference = response(exact);
  }
  out.response.resize(eigen_index(points_.size()));
  out.slopes.resize(eigen_index(points_.size()), eigen_index(unknowns_.size()));
  std::vector<double> spread(unknowns_.size(), 1.0);
  for (const auto& [unknown, factor] : effect.spread) spread[unknown] *= factor;
  Eigen::VectorXcd x;
  Eigen::RowVectorXcd row;  // of the changed inverse: how everything reaches the node that is read
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const Point& point = points_[k];
    x = point.x;
    row = point.inverse.row(point.out);
    if (!effect.stamps.empty()) {
      const Changes changes = changes_of(effect.stamps, point.s, point.inverse, point.x);
      Eigen::VectorXcd weights(changes.delta.size());
      for (Eigen::Index j = 0; j < weights.size(); ++j)
        weights(j) = through(point.inverse, point.out, effect.stamps[std_index(j)]) * changes.delta(j);
      const Eigen::VectorXcd onward = solve_lu(changes.system.transpose(), weights);
      for (Eigen::Index j = 0; j < weights.size(); ++j) {
        const Stamp& stamp = effect.stamps[std_index(j)];
        for (const Stamp::Entry& e : stamp.into) {
          if (e.weight != 0.0)
            x -= (e.weight * changes.delta(j) * changes.reads(j)) * point.inverse.col(e.at);
        }
        for (const Stamp::Entry& e : stamp.reads) {
          if (e.weight != 0.0) row -= (e.weight * onward(j)) * point.inverse.row(e.at);
        }
      }
    }
    const Complex h = x(point.out);
    out.response(eigen_index(k)) = h;
    const Complex scale = -1.0 / (std::abs(h) > 1e-12 ? h : Complex(1e-12, 0.0));
    for (std::size_t u = 0; u < unknowns_.size(); ++u) {
      const Stamp& stamp = unknowns_[u].stamp;
      Complex reaches = 0.0;
      for (const Stamp::Entry& e : stamp.into) {
        if (e.weight != 0.0) reaches += e.weight * row(e.at);
      }
      out.slopes(eigen_index(k), eigen_index(u)) =
          scale * spread[u] * reaches * stamp.delta(point.s) * read_of(stamp, x);
    }
  }
  return out;
}

std::unique_ptr<Board> CircuitBoard::with_parts(const Eigen::VectorXd& deviations) const {
  schematic::Netlist moved = circuit_;
  for (std::size_t i = 0; i < moved.parts.size(); ++i)
    moved.parts[i].realised *=
        std::exp(kSigmaOfTolerance * tolerance(i) * deviations(eigen_index(unknown_of_part_[i])));
  auto out = std::make_unique<CircuitBoard>(moved, measured(), spread_, this);
  out->set_good(good_response());
  return out;
}

std::vector<Board::SolderedPart> CircuitBoard::soldered_parts() const {
  std::vector<SolderedPart> out;
  for (const schematic::Part& p : circuit_.parts)
    out.push_back({p.name, p.realised, p.kind == schematic::Part::Kind::resistor ? "Ω" : "F"});
  return out;
}

Effect CircuitBoard::in_parallel(std::size_t part, double factor) const {
  const bool resistor = circuit_.parts[part].kind == schematic::Part::Kind::resistor;
  Effect out;
  out.stamps = {times_admittance(part, resistor ? 1.0 / factor : factor)};
  return out;
}

}  // namespace bodesmith::faults
