#include "fpaa/network/periodic_network.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "numeric/sinc.hpp"

namespace bodesmith::fpaa {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

Index index(std::size_t i) {
  return static_cast<Index>(i);
}

/// x of (turn - loop) x = b.
VectorXcd solve_periodic(Complex turn, const MatrixXd& loop, const VectorXcd& b) {
  if (loop.rows() == 1) return b / (turn - loop(0, 0));
  if (loop.rows() == 2) {  // most CAMs: by Cramer's rule, without a general LU and its room
    const Complex a = turn - loop(0, 0), d = turn - loop(1, 1);
    VectorXcd out(2);
    out << d * b(0) + loop(0, 1) * b(1), loop(1, 0) * b(0) + a * b(1);
    return out / (a * d - loop(0, 1) * loop(1, 0));
  }
  return solve_lu(Eigen::MatrixXcd(turn * Eigen::MatrixXcd::Identity(loop.rows(), loop.cols()) - loop), b);
}

Complex turned_by(double rate, Complex value) {
  return {-rate * value.imag(), rate * value.real()};
}

[[noreturn]] void too_many_instants() {
  throw DesignError(
      fmt::format("the board's clocks have no common period of fewer than {} switching instants, "
                  "expected clocks that divide one another",
                  ClockedNetwork::kMostInstants));
}

/// exp(j rate t) at rising times: most steps are as long as the one before, and cost a product then; from the argument itself
/// every few steps, so that rounding stays at some 1e-15.
class Turning {
 public:
  explicit Turning(double rate) : rate_(rate) {}

  Complex at(double t) {
    const double step = t - last_;
    last_ = t;
    if (step == step_ && ++since_ < kSteps) return value_ *= turn_;
    if (step != step_) turn_ = std::polar(1.0, rate_ * step);
    step_ = step;
    since_ = 0;
    return value_ = std::polar(1.0, rate_ * t);
  }

 private:
  static constexpr int kSteps = 32;
  double rate_;
  double last_ = -1.0, step_ = 0.0;
  int since_ = 0;
  Complex turn_ = 1.0, value_ = 1.0;
};

/// int exp(j rate t) dt over spans one behind the other: each its length times sinc at its middle.
class TurningSpans {
 public:
  explicit TurningSpans(double rate) : rate_(rate), middle_(rate) {}

  Complex over(double from, double to) {
    const double length = to - from;
    if (length != length_) size_ = length * sinc(0.5 * rate_ * length);
    length_ = length;
    const Complex turn = middle_.at(0.5 * (from + to));
    return {turn.real() * size_, turn.imag() * size_};
  }

 private:
  double rate_;
  Turning middle_;
  double length_ = -1.0, size_ = 0.0;
};

}  // namespace

double size_of_turns(double turn, double turns) {
  return turn == 0.0 ? turns : std::sin(0.5 * turns * turn) / std::sin(0.5 * turn);
}

/// Sources that nest with one another stay together; the others are parts of their own.
std::vector<std::vector<PeriodicNetworks::Source>> PeriodicNetworks::parts_of(
    std::int64_t own, const std::vector<Source>& sources) const {
  struct Part {
    std::int64_t period = 1;
    std::vector<Source> sources;
  };
  std::vector<Part> parts{{own, std::vector<Source>(sources.size())}};
  for (std::size_t k = 0; k < sources.size(); ++k) {
    if (sources[k].kind == Source::Kind::board_input) parts[0].sources[k] = sources[k];
    if (sources[k].kind != Source::Kind::network) continue;
    for (const std::size_t from : parts_[sources[k].network]) {
      const std::optional<std::int64_t> period =
          common_period(std::initializer_list<std::int64_t>{own, nodes_[from].period});
      if (!period) too_many_instants();
      const auto takes = [&](const Part& part) {
        return part.sources[k].kind == Source::Kind::nothing &&
               (*period % part.period == 0 || part.period % *period == 0);
      };
      auto at = std::ranges::find_if(parts, takes);
      if (at == parts.end()) at = parts.insert(at, {own, std::vector<Source>(sources.size())});
      at->period = std::max(at->period, *period);
      at->sources[k] = {Source::Kind::network, from};
    }
  }
  std::vector<std::vector<Source>> out;
  for (Part& part : parts) out.push_back(std::move(part.sources));
  return out;
}

std::size_t PeriodicNetworks::add(ClockedNetwork network, std::vector<Source> sources) {
  std::vector<std::size_t> made;
  bool fits = !may_follow_ || !network.has_noise();
  for (std::vector<Source>& part : parts_of(network.period(), sources)) {
    Node& node = nodes_.emplace_back(Node{.clocked = network, .sources = std::move(part)});
    fits = fits && lay_pieces(node);
    made.push_back(nodes_.size() - 1);
  }
  if (!fits) {
    may_follow_ = false;
    for (Node& node : nodes_) lay_pieces(node);
  }
  for (const std::size_t n : made) find_loop(nodes_[n]);
  parts_.push_back(std::move(made));
  return parts_.size() - 1;
}

void PeriodicNetworks::replace(std::size_t at, const ClockedNetwork& network) {
  for (const std::size_t n : parts_[at]) {
    nodes_[n].clocked = network;
    find_loop(nodes_[n]);
  }
}

std::size_t PeriodicNetworks::pieces() const {
  std::size_t out = 0;
  for (const Node& node : nodes_) out += node.pieces();
  return out;
}

std::size_t PeriodicNetworks::instants_of(const Node& node) const {
  if (!node.follows) return node.pieces();
  const Node& from = nodes_[*node.follows];
  return static_cast<std::size_t>(node.period / from.period) * instants_of(from);
}

std::size_t PeriodicNetworks::instants() const {
  std::size_t out = 0;
  for (const Node& node : nodes_) out += node.clocked.opamps() * instants_of(node);
  return out;
}

/// The one source, where the node's intervals take in whole periods of it.
std::optional<std::size_t> PeriodicNetworks::followed_by(const Node& node) const {
  std::optional<std::size_t> out;
  for (const Source& source : node.sources) {
    if (source.kind != Source::Kind::network) continue;
    if (out && *out != source.network) return std::nullopt;
    out = source.network;
  }
  if (!out || !may_follow_) return std::nullopt;
  const std::int64_t period = nodes_[*out].period;
  const auto& intervals = node.clocked.intervals();
  const bool whole =
      node.clocked.period() % period == 0 &&
      std::ranges::all_of(intervals, [&](const auto& interval) { return interval.start % period == 0; });
  return whole ? out : std::nullopt;
}

bool PeriodicNetworks::lay_pieces(Node& node) const {
  node = Node{
      .clocked = std::move(node.clocked), .sources = std::move(node.sources), .loop = std::move(node.loop)};
  node.follows = followed_by(node);
  const bool nested = node.follows.has_value();
  std::vector<std::int64_t> periods{node.clocked.period()};
  for (const Source& source : node.sources) {
    if (source.kind == Source::Kind::network) periods.push_back(nodes_[source.network].period);
  }
  const std::optional<std::int64_t> period = common_period(periods);
  const auto too_many = [&](std::int64_t count) { return count > ClockedNetwork::kMostInstants; };
  std::int64_t instants = 0;
  const auto count = [&](std::int64_t own, std::size_t pieces) {
    if (!period || too_many(*period / own)) {
      instants = ClockedNetwork::kMostInstants + 1;
    } else {
      instants += *period / own * static_cast<std::int64_t>(pieces);
    }
  };
  count(node.clocked.period(), node.clocked.intervals().size());
  for (const Source& source : node.sources) {
    if (source.kind == Source::Kind::network)
      count(nodes_[source.network].period, instants_of(nodes_[source.network]));
  }
  if (too_many(instants)) too_many_instants();
  node.period = *period;
  const auto& intervals = node.clocked.intervals();
  for (std::int64_t t = 0; t < node.period; t += node.clocked.period()) {
    for (const auto& interval : intervals) node.edges.push_back(t + interval.start);
  }
  for (const Source& source : node.sources) {
    if (source.kind != Source::Kind::network || nested) continue;
    const Node& from = nodes_[source.network];
    for (std::int64_t t = 0; t < node.period; t += from.period) {
      for (std::size_t i = 0; i + 1 < from.edges.size(); ++i) node.edges.push_back(t + from.edges[i]);
    }
  }
  std::ranges::sort(node.edges);
  node.edges.erase(std::unique(node.edges.begin(), node.edges.end()), node.edges.end());
  node.edges.push_back(node.period);
  const std::size_t pieces = node.edges.size() - 1;
  std::size_t next = 0;  // own intervals begun so far
  for (std::size_t i = 0; i < pieces; ++i) {
    const std::int64_t own = static_cast<std::int64_t>(next / intervals.size()) * node.clocked.period() +
                             intervals[next % intervals.size()].start;
    if (node.edges[i] == own) {
      if (i > 0) node.ends.back() = true;
      ++next;
    }
    node.interval.push_back(static_cast<std::uint32_t>((next - 1) % intervals.size()));
    node.ends.push_back(i + 1 == pieces);
  }
  for (const Source& source : node.sources) {
    std::vector<std::uint32_t> piece(pieces, 0);
    std::vector<std::uint32_t> turn(pieces, 0);
    if (source.kind == Source::Kind::network && !nested) {
      const Node& from = nodes_[source.network];
      if (from.follows && node.follows && *node.follows != *from.follows) return false;
      if (from.follows) node.follows = from.follows;
      std::size_t at = 0;
      std::uint32_t turns = 0;
      for (std::size_t i = 0; i < pieces; ++i) {
        while (from.edges[at + 1] + static_cast<std::int64_t>(turns) * from.period <= node.edges[i]) {
          if (++at + 1 == from.edges.size()) {
            at = 0;
            ++turns;
          }
        }
        piece[i] = static_cast<std::uint32_t>(at);
        turn[i] = turns;
      }
    }
    node.source_piece.push_back(std::move(piece));
    node.source_turn.push_back(std::move(turn));
  }
  return !node.follows || std::ranges::all_of(node.edges, [&](std::int64_t edge) {
    return edge % nodes_[*node.follows].period == 0;
  });
}

void PeriodicNetworks::find_loop(Node& node) {
  MatrixXd once =
      MatrixXd::Identity(node.clocked.intervals()[0].m.cols(), node.clocked.intervals()[0].m.cols());
  for (const auto& interval : node.clocked.intervals()) once = times(interval.m, once);
  node.loop = MatrixXd::Identity(once.rows(), once.cols());
  for (std::int64_t turns = node.period / node.clocked.period(); turns > 0; turns /= 2) {
    if (turns % 2 == 1) node.loop = times(once, node.loop);
    once = times(once, once);
  }
}

void PeriodicNetworks::find_inputs(const Node& node, const std::vector<SineWaveform>& known, double w,
                                   Inputs& out) const {
  const std::size_t pieces = node.pieces();
  const std::size_t count = node.clocked.inputs();
  const double per_tick = w / ticks_per_second_;
  out.w = w;
  for (std::vector<Complex>* of : {&out.alpha, &out.beta}) of->assign(pieces * count, 0.0);
  for (std::vector<Complex>* of :
       {&out.turn_at_end, &out.followed_at_end, &out.followed_rate_at_end, &out.peak})
    of->clear();
  for (std::vector<double>* of : {&out.gamma, &out.late}) of->clear();
  Turning turning(per_tick);
  for (std::size_t i = 0; i < pieces; ++i)
    out.turn_at_end.push_back(turning.at(static_cast<double>(node.edges[i + 1])));
  if (node.follows) {
    out.gamma.assign(pieces * count, 0.0);
    const Complex known_turn = std::polar(1.0, per_tick * static_cast<double>(nodes_[*node.follows].period));
    const Complex start = known[*node.follows].end / known_turn;
    for (const Complex turn : out.turn_at_end) out.followed_at_end.push_back(start * turn);
    out.followed_at_start = start;
    out.late.assign(pieces * count, 0.0);
    for (const Complex turn : out.turn_at_end)
      out.followed_rate_at_end.push_back(known[*node.follows].end_rate / known_turn * turn);
  }
  const bool late = node.clocked.is_late();
  if (late) out.peak.assign(pieces * count, 0.0);
  for (std::size_t k = 0; k < node.sources.size(); ++k) {
    const Source& source = node.sources[k];
    if (source.kind == Source::Kind::board_input) {
      for (std::size_t i = 0; i < pieces; ++i) out.beta[i * count + k] = 1.0;
    } else if (source.kind == Source::Kind::network && node.follows == source.network) {
      for (std::size_t i = 0; i < pieces; ++i) out.gamma[i * count + k] = 1.0;
    } else if (source.kind == Source::Kind::network) {
      const SineWaveform& from = known[source.network];
      const std::int64_t source_period = nodes_[source.network].period;
      std::uint32_t turns = 0;
      Complex turn = 1.0;
      for (std::size_t i = 0; i < pieces; ++i) {
        if (node.source_turn[k][i] != turns) {
          turns = node.source_turn[k][i];
          turn = std::polar(1.0, per_tick * static_cast<double>(source_period) * static_cast<double>(turns));
        }
        const std::uint32_t piece = node.source_piece[k][i];
        out.alpha[i * count + k] = from.alpha[piece] * turn;
        out.beta[i * count + k] = from.beta[piece];
        if (from.follows) out.gamma[i * count + k] = from.gamma[piece];
        if (!from.late.empty()) out.late[i * count + k] = from.late[piece];
        const bool begins = (*from.edges)[piece] + turns * source_period == node.edges[i];
        if (late && !from.peak.empty() && begins) out.peak[i * count + k] = from.peak[piece] * turn;
      }
    }
  }
  out.at_end.resize(pieces * count);
  for (std::size_t at = 0; at < out.at_end.size(); ++at) {
    out.at_end[at] = out.alpha[at] + out.beta[at] * out.turn_at_end[at / count];
    if (node.follows)
      out.at_end[at] += out.gamma[at] * out.followed_at_end[at / count] -
                        out.late[at] * out.followed_rate_at_end[at / count];
  }
  if (!late) return;
  out.rate_at_end.resize(pieces * count);
  for (std::size_t at = 0; at < out.rate_at_end.size(); ++at) {
    const Complex turn = out.turn_at_end[at / count];
    out.rate_at_end[at] = turned_by(w, out.beta[at] * turn);
    if (node.follows) out.rate_at_end[at] += out.gamma[at] * out.followed_rate_at_end[at / count];
  }
}

/// The charges behind a piece: M q + N u, and of slow parts -L du/dt; without allocating for what is small.
void PeriodicNetworks::step(const Node& node, const Inputs& in, std::size_t piece, VectorXcd& q,
                            VectorXcd& next) {
  const ClockedNetwork::Interval& at = node.clocked.intervals()[node.interval[piece]];
  const std::size_t first = piece * node.clocked.inputs();
  next.resize(at.m.rows());
  for (Index r = 0; r < at.m.rows(); ++r) {
    Complex sum = 0.0;
    for (Index k = 0; k < at.m.cols(); ++k) sum += at.m(r, k) * q(k);
    for (Index k = 0; k < at.n.cols(); ++k)
      sum += at.n(r, k) * in.at_end[first + static_cast<std::size_t>(k)];
    for (Index k = 0; k < at.late_n.cols(); ++k)
      sum -= at.late_n(r, k) * in.rate_at_end[first + static_cast<std::size_t>(k)];
    next(r) = sum;
  }
  q.swap(next);
}

VectorXcd PeriodicNetworks::start_of(const Node& node, const Inputs& in) {
  VectorXcd q = VectorXcd::Zero(node.loop.rows());
  VectorXcd next;
  for (std::size_t i = 0; i < node.pieces(); ++i) {
    if (node.ends[i]) step(node, in, i, q, next);
  }
  return solve_periodic(in.turn_at_end.back(), node.loop, q);
}

/// What is late of a node's output, piece by piece.
class PeriodicNetworks::LateOutput {
 public:
  LateOutput(const Node& node, const Inputs& in) : node_(node), in_(in) {}

  /// `q`: charges at the piece's beginning.
  void follow(std::size_t i, const VectorXcd& q, SineWaveform& out) {
    const auto& at = node_.clocked.intervals()[node_.interval[i]];
    const std::size_t count = node_.clocked.inputs(), first = i * count;
    if (out.peak.empty()) out.peak.assign(node_.pieces(), 0.0);
    if (node_.follows && out.late.empty()) out.late.assign(node_.pieces(), 0.0);
    const Complex turn = i == 0 ? 1.0 : in_.turn_at_end[i - 1];
    Complex stored = 0.0, moves = 0.0;
    for (Index k = 0; k < q.size(); ++k) stored += at.behind_q(k) * q(k);
    const Index output = index(node_.clocked.output());
    for (std::size_t k = 0; k < count; ++k) {
      const double behind_s = at.behind_u(index(k)), follows = at.d(output, index(k));
      Complex begin = in_.alpha[first + k] + in_.beta[first + k] * turn;
      if (node_.follows) {
        begin += in_.gamma[first + k] * (i == 0 ? in_.followed_at_start : in_.followed_at_end[i - 1]);
        out.late[i] += behind_s * in_.gamma[first + k] + follows * in_.late[first + k];
      }
      stored += behind_s * begin;
      moves += behind_s * in_.beta[first + k];
      out.peak[i] += follows * in_.peak[first + k];
    }
    out.beta[i] -= turned_by(in_.w, moves);
    out.peak[i] -= stored;
    if (i > 0) out.peak[i] += stored_before(i, i - 1);
    last_q_ = q;
    if (i + 1 < node_.pieces()) return;
    // The first piece comes after the last one of the period before.
    out.peak[0] += stored_before(0, i) * std::conj(in_.turn_at_end[i]);
    // As what has settled moves: that it is late changes this to the second order.
    for (std::size_t k = 0; k < count; ++k)
      out.end_rate += at.d(output, index(k)) * in_.rate_at_end[first + k];
  }

 private:
  /// At the end of the piece `before`, as this piece's lateness weighs it.
  Complex stored_before(std::size_t i, std::size_t before) const {
    const auto& at = node_.clocked.intervals()[node_.interval[i]];
    const bool same = !node_.ends[before];
    const Eigen::RowVectorXd& of_q = same ? at.behind_q : at.behind_last_q;
    const Eigen::RowVectorXd& of_u = same ? at.behind_u : at.behind_last_u;
    const std::size_t count = node_.clocked.inputs();
    Complex out = 0.0;
    for (Index k = 0; k < last_q_.size(); ++k) out += of_q(k) * last_q_(k);
    for (std::size_t k = 0; k < count; ++k) out += of_u(index(k)) * in_.at_end[before * count + k];
    return out;
  }

  const Node& node_;
  const Inputs& in_;
  VectorXcd last_q_;  ///< of the last piece
};

std::vector<SineWaveform> PeriodicNetworks::waveforms(const Node& node, const Inputs& in,
                                                      std::span<const std::size_t> opamps) {
  const std::size_t count = node.clocked.inputs();
  const std::size_t pieces = node.pieces();
  std::vector<SineWaveform> out(opamps.size());
  for (SineWaveform& one : out) {
    one.edges = &node.edges;
    one.alpha.resize(pieces);
    one.beta.resize(pieces);
    one.follows = node.follows;
    if (node.follows) one.gamma.assign(pieces, 0.0);
  }
  VectorXcd q = start_of(node, in);
  VectorXcd next;
  std::optional<LateOutput> late;
  if (node.clocked.is_late()) late.emplace(node, in);
  for (std::size_t i = 0; i < pieces; ++i) {
    const auto& at = node.clocked.intervals()[node.interval[i]];
    for (std::size_t o = 0; o < opamps.size(); ++o) {
      const Index row = index(opamps[o]);
      Complex alpha = 0.0;
      Complex beta = 0.0;
      for (Index k = 0; k < q.size(); ++k) alpha += at.c(row, k) * q(k);
      for (std::size_t k = 0; k < count; ++k) {
        alpha += at.d(row, index(k)) * in.alpha[i * count + k];
        beta += at.d(row, index(k)) * in.beta[i * count + k];
      }
      out[o].alpha[i] = alpha;
      out[o].beta[i] = beta;
      for (std::size_t k = 0; k < count && node.follows; ++k)
        out[o].gamma[i] += at.d(row, index(k)) * in.gamma[i * count + k];
      if (late && opamps[o] == node.clocked.output()) late->follow(i, q, out[o]);
    }
    if (node.ends[i]) step(node, in, i, q, next);
  }
  for (SineWaveform& one : out) {
    one.end = one.alpha.back() + one.beta.back() * in.turn_at_end.back();
    if (node.follows) one.end += one.gamma.back() * in.followed_at_end.back();
    if (!one.late.empty()) one.end -= one.late.back() * in.followed_rate_at_end.back();
  }
  return out;
}

std::vector<SineWaveform> PeriodicNetworks::outputs(double w) const {
  std::vector<SineWaveform> out;
  out.reserve(nodes_.size());
  Inputs in;
  for (const Node& node : nodes_) {
    const std::size_t read[] = {node.clocked.output()};
    find_inputs(node, out, w, in);
    out.push_back(std::move(waveforms(node, in, read)[0]));
  }
  return out;
}

Complex PeriodicNetworks::mean(const SineWaveform& of, const std::vector<SineWaveform>& known, double w,
                               double line) const {
  const std::vector<std::int64_t>& edges = *of.edges;
  Complex sum = 0.0;
  TurningSpans constant(-line / ticks_per_second_);
  TurningSpans moving((w - line) / ticks_per_second_);
  Turning begins(-line / ticks_per_second_);
  for (std::size_t i = 0; i < of.alpha.size(); ++i) {
    const auto from = static_cast<double>(edges[i]);
    const auto to = static_cast<double>(edges[i + 1]);
    if (of.alpha[i] != 0.0) sum += of.alpha[i] * constant.over(from, to);
    if (!of.peak.empty()) sum += of.peak[i] * ticks_per_second_ * begins.at(from);
    if (of.beta[i] != 0.0) sum += of.beta[i] * (line == w ? Complex(to - from) : moving.over(from, to));
  }
  if (of.follows) {
    const std::int64_t period = nodes_[*of.follows].period;
    const double once = static_cast<double>(period);
    const Complex one = once * mean(known[*of.follows], known, w, line);
    const double turn = std::remainder((w - line) / ticks_per_second_ * once, 2.0 * std::numbers::pi);
    for (std::size_t i = 0; i < of.gamma.size(); ++i) {
      const auto from = static_cast<double>(edges[i] / period);
      const auto turns = static_cast<double>((edges[i + 1] - edges[i]) / period);
      const Complex gamma = of.late.empty() ? of.gamma[i] : of.gamma[i] - turned_by(line, of.late[i]);
      sum += gamma * one * std::polar(1.0, turn * (from + 0.5 * (turns - 1.0))) * size_of_turns(turn, turns);
    }
  }
  return sum / static_cast<double>(edges.back());
}

/// Both ends of every piece, those of what is followed in it.
void PeriodicNetworks::for_each_instant(const SineWaveform& of, const std::vector<SineWaveform>& known,
                                        double w, const AtInstant& at) const {
  const std::vector<std::int64_t>& edges = *of.edges;
  const double per_tick = w / ticks_per_second_;
  Turning turning(per_tick), begins(per_tick);
  Complex before = 1.0;
  for (std::size_t i = 0; i < of.alpha.size(); ++i) {
    const Complex after = turning.at(static_cast<double>(edges[i + 1]));
    if (!of.follows) {
      for (const Complex turn : {before, after}) at(turn, of.alpha[i] + of.beta[i] * turn);
    } else {
      const std::int64_t period = nodes_[*of.follows].period;
      for (std::int64_t t = edges[i]; t < edges[i + 1]; t += period) {
        const Complex later = begins.at(static_cast<double>(t));
        for_each_instant(known[*of.follows], known, w, [&](Complex turn, Complex value) {
          const Complex now = turn * later;
          at(now, of.alpha[i] + of.beta[i] * now + of.gamma[i] * (value * later));
        });
      }
    }
    before = after;
  }
}

Complex PeriodicNetworks::gain(RadPerSecond w) const {
  return components(w, {&w, 1})[0];
}

std::vector<Complex> PeriodicNetworks::components(RadPerSecond sine,
                                                  std::span<const RadPerSecond> lines) const {
  std::vector<Complex> out(lines.size(), 0.0);
  const std::vector<SineWaveform> known = output_ ? outputs(sine.value) : std::vector<SineWaveform>{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!output_) out[i] = lines[i].value == sine.value ? 1.0 : 0.0;
    for (const std::size_t part : output_ ? parts_[*output_] : std::vector<std::size_t>{})
      out[i] += mean(known[part], known, sine.value, lines[i].value);
  }
  return out;
}

std::vector<std::vector<PeriodicNetworks::NodeSize>> PeriodicNetworks::nodes(RadPerSecond w) const {
  std::vector<SineWaveform> known;
  std::vector<std::vector<NodeSize>> of_node;           // each part by itself
  std::vector<std::vector<double>> departures_of_part;  // largest departure of each from its own sine
  Inputs in;
  for (const Node& node : nodes_) {
    find_inputs(node, known, w.value, in);
    std::vector<std::size_t> all;
    for (std::size_t k = 0; k < node.clocked.opamps(); ++k) all.push_back(k);
    std::vector<SineWaveform> waves = waveforms(node, in, all);
    std::vector<NodeSize> sizes;
    std::vector<double> departures;
    for (const SineWaveform& wave : waves) {
      NodeSize size{mean(wave, known, w.value, w.value), 0.0};
      double largest = 0.0, departure = 0.0;  // squared
      for_each_instant(wave, known, w.value, [&](Complex turn, Complex v) {
        largest = std::max(largest, std::norm(v));
        departure = std::max(departure, std::norm(v - size.gain * turn));
      });
      size.largest = std::sqrt(largest);
      sizes.push_back(size);
      departures.push_back(std::sqrt(departure));
    }
    known.push_back(std::move(waves[node.clocked.output()]));
    of_node.push_back(std::move(sizes));
    departures_of_part.push_back(std::move(departures));
  }
  std::vector<std::vector<NodeSize>> out;
  for (const std::vector<std::size_t>& parts : parts_) {
    std::vector<NodeSize> sum = of_node[parts[0]];
    // Clocks without a common period meet in every phase: departures add.
    for (std::size_t k = 0; k < sum.size() && parts.size() > 1; ++k) {
      double departure = 0.0;
      sum[k].gain = 0.0;
      for (const std::size_t part : parts) {
        sum[k].gain += of_node[part][k].gain;
        departure += departures_of_part[part][k];
      }
      sum[k].largest = std::abs(sum[k].gain) + departure;
    }
    out.push_back(std::move(sum));
  }
  return out;
}

/// What the output's component owes to alpha of every piece, from the last network to the first.
class PeriodicNetworks::NoisePass {
 public:
  NoisePass(const PeriodicNetworks& board, double w)
      : board_(board),
        per_tick_(w / board.ticks_per_second_),
        turns_(board.nodes_.size(), 1),
        owed_(turns_.size()) {
    find_turns();
    for (std::size_t n = 0; n < turns_.size(); ++n)
      owed_[n].assign(turns_[n] * board.nodes_[n].pieces(), 0.0);
    for (const std::size_t n : board.parts_[*board.output_]) {
      const Node& last = board.nodes_[n];
      const double whole = static_cast<double>(last.period) * static_cast<double>(turns_[n]);
      TurningSpans spans(-per_tick_);
      for (std::size_t at = 0; at < owed_[n].size(); ++at) {
        const std::size_t i = at % last.pieces();
        const double turn = static_cast<double>(at / last.pieces()) * static_cast<double>(last.period);
        owed_[n][at] = spans.over(turn + static_cast<double>(last.edges[i]),
                                  turn + static_cast<double>(last.edges[i + 1])) /
                       whole;
      }
    }
  }

  /// Two-sided density from this node's switches, in ticks; its sources owe their share.
  double density(std::size_t n) {
    const Node& node = board_.nodes_[n];
    const double whole = static_cast<double>(node.period) * static_cast<double>(turns_[n]);
    MatrixXd loop = MatrixXd::Identity(node.loop.rows(), node.loop.cols());
    for (std::size_t turn = 0; turn < turns_[n]; ++turn) loop = times(node.loop, loop);
    VectorXcd q = VectorXcd::Zero(loop.rows());  // owed to the charges at the end of the piece at hand
    for (std::size_t at = owed_[n].size(); at-- > 0;) back(n, at, q);
    // Owed at the end: what is owed at the beginning, a period later.
    q = solve_periodic(std::polar(1.0, per_tick_ * whole), loop.transpose(), q);
    const bool is_read = std::ranges::count(board_.parts_[*board_.output_], n) > 0;
    double out = 0.0;
    double direct = 0.0;  // what the op-amps' noise is at the output in addition to what it leaves in charges
    for (std::size_t at = owed_[n].size(); at-- > 0;) {
      const std::size_t i = at % node.pieces();
      const auto& interval = node.clocked.intervals()[node.interval[i]];
      if (is_read) {
        const double end = static_cast<double>(at / node.pieces()) * static_cast<double>(node.period) +
                           static_cast<double>(node.edges[i + 1]);
        direct += interval.direct_noise_s * static_cast<double>(node.edges[i + 1] - node.edges[i]) / whole;
        if (node.ends[i])
          direct +=
              2.0 *
              (std::polar(1.0, -per_tick_ * end) * q.dot(interval.noise_about_end_s.cast<Complex>())).real();
      }
      for (Index r = 0; node.ends[i] && r < q.size(); ++r) {
        Complex sum = 0.0;
        for (Index k = 0; k < q.size(); ++k) sum += interval.noise(r, k) * q(k);
        out += (std::conj(q(r)) * sum).real();
      }
      for (std::size_t k = 0; k < node.sources.size(); ++k) {
        Complex sum = interval.d(index(node.clocked.output()), index(k)) * owed_[n][at];
        for (Index r = 0; node.ends[i] && r < q.size(); ++r) sum += interval.n(r, index(k)) * q(r);
        if (node.sources[k].kind == Source::Kind::network) hand_on(n, at, k, sum);
      }
      back(n, at, q);
    }
    return out * whole + direct * board_.ticks_per_second_;
  }

 private:
  /// Periods over which a node's noise is followed: the common one of all that reads it.
  void find_turns() {
    const auto& nodes = board_.nodes_;
    for (std::size_t n = nodes.size(); n-- > 0;) {
      const std::int64_t all = nodes[n].period * static_cast<std::int64_t>(turns_[n]);
      for (const Source& source : nodes[n].sources) {
        if (source.kind != Source::Kind::network) continue;
        const Node& from = nodes[source.network];
        const std::int64_t so_far = from.period * static_cast<std::int64_t>(turns_[source.network]);
        const auto period = common_period(std::initializer_list<std::int64_t>{so_far, all});
        const auto most = ClockedNetwork::kMostInstants / static_cast<std::int64_t>(from.pieces());
        if (period && *period / from.period <= most)
          turns_[source.network] = static_cast<std::size_t>(*period / from.period);
      }
    }
  }

  /// From the end of a piece to its beginning.
  void back(std::size_t n, std::size_t at, VectorXcd& q) {
    const Node& node = board_.nodes_[n];
    const std::size_t i = at % node.pieces();
    const auto& interval = node.clocked.intervals()[node.interval[i]];
    const Index output = index(node.clocked.output());
    if (node.ends[i]) {
      before_.resize(interval.m.cols());
      for (Index k = 0; k < before_.size(); ++k) {
        before_(k) = 0.0;
        for (Index r = 0; r < q.size(); ++r) before_(k) += interval.m(r, k) * q(r);
      }
      q.swap(before_);
    }
    for (Index k = 0; k < q.size(); ++k) q(k) += interval.c(output, k) * owed_[n][at];
  }

  void hand_on(std::size_t n, std::size_t at, std::size_t input, Complex owed) {
    const Node& node = board_.nodes_[n];
    const std::size_t source = node.sources[input].network;
    const Node& from = board_.nodes_[source];
    const std::size_t i = at % node.pieces();
    const auto per_period = static_cast<std::size_t>(node.period / from.period);
    const std::size_t turn = at / node.pieces() * per_period + node.source_turn[input][i];
    // The reader's common period may be a part of the source's, or the other way round.
    const std::size_t readers = turns_[n] * per_period;
    const std::size_t repeats = std::max<std::size_t>(1, turns_[source] / readers);
    if (turned_.size() < repeats) turned_.resize(repeats, {0.0, 1.0});
    for (std::size_t repeat = 0; repeat < repeats; ++repeat) {
      const std::size_t to = (turn + repeat * readers) % turns_[source];
      const double later =
          (static_cast<double>(turn) - static_cast<double>(to)) * static_cast<double>(from.period);
      auto& [known, by] = turned_[repeat];
      if (later != known) known = later, by = std::polar(1.0, per_tick_ * later);
      owed_[source][to * from.pieces() + node.source_piece[input][i]] +=
          owed * by / static_cast<double>(repeats);
    }
  }

  const PeriodicNetworks& board_;
  double per_tick_;
  std::vector<std::size_t> turns_;
  std::vector<std::vector<Complex>> owed_;  ///< [node][turn * pieces + piece]
  VectorXcd before_;                        ///< room for back()
  std::vector<std::pair<double, Complex>>
      turned_;  ///< of each repeat, at the last handing on: ticks, and their turn
};

std::vector<double> PeriodicNetworks::noise_density(RadPerSecond w) const {
  std::vector<double> out(parts_.size(), 0.0);
  if (!output_) return out;
  NoisePass pass(*this, w.value);
  for (std::size_t network = parts_.size(); network-- > 0;) {
    // A network's own noise is in one part of it; the others hand on what they read.
    for (const std::size_t n : parts_[network]) {
      const double density = pass.density(n);
      if (n == parts_[network][0]) out[network] = 2.0 * density / ticks_per_second_;
    }
  }
  return out;
}

double PeriodicNetworks::settled() const {
  double out = std::numeric_limits<double>::infinity();
  for (const Node& node : nodes_) {
    const auto& intervals = node.clocked.intervals();
    for (std::size_t i = 0; i < intervals.size(); ++i) {
      const std::int64_t end = i + 1 < intervals.size() ? intervals[i + 1].start : node.clocked.period();
      const double seconds = static_cast<double>(end - intervals[i].start) / ticks_per_second_;
      if (intervals[i].slowest_s > 0.0) out = std::min(out, seconds / intervals[i].slowest_s);
    }
  }
  return out;
}

}  // namespace bodesmith::fpaa
