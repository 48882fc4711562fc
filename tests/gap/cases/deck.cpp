#include "gap/cases/deck.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/error.hpp"
#include "gap/cases/random.hpp"
#include "schematic/ngspice/ngspice.hpp"

namespace hidden {
namespace {

using std::string;
constexpr double kOhm = 10e3;
constexpr double kOpenLoopGain = 1e6;

/// Never the exponent forms that a simulator may read as a suffix.
string n(double value) {
  return fmt::format("{:.12e}", value);
}

/// The macro: a current limited by tanh into the integrating capacitor, the clamp on that very node.
string opamp_text(const OpAmp& a, const string& plus, const string& minus, const string& out, int id,
                  const string& tail = "") {
  constexpr double c = 1e-9;
  const string x = fmt::format("x{}{}", id, tail);
  const string p = fmt::format("p{}{}", id, tail);
  const double current = a.slew_v_per_s * c;
  const double slope = kTwoPi * a.gain_bandwidth_hz / a.slew_v_per_s;
  string t = fmt::format("Vos{0}{1} {2} {3} DC {4}\n", id, tail, p, plus, n(a.offset_v));
  t += fmt::format("Gm{0}{1} 0 {2} VALUE={{{3}*tanh({4}*V({5},{6}))}}\n", id, tail, x, n(current), n(slope),
                   p, minus);
  t += fmt::format("Cx{0}{1} {2} 0 {3}\nRx{0}{1} {2} 0 {4}\n", id, tail, x, n(c),
                   n(kOpenLoopGain / (kTwoPi * a.gain_bandwidth_hz * c)));
  // Steep enough to hold the full current within a millivolt.
  t += fmt::format("Gc{0}{1} {2} 0 VALUE={{{3}*(max(V({2})-({4}),0)+min(V({2})-({5}),0))}}\n", id, tail, x,
                   n(current * 1e3), n(a.upper_v), n(a.lower_v));
  t += fmt::format("Eo{0}{1} {2} 0 {3} 0 1\n", id, tail, out, x);
  return t;
}

string buffer(const string& in, const string& out, const string& name) {
  return fmt::format("E{} {} 0 {} 0 1\n", name, out, in);
}

constexpr const char* kDiode = ".model sharp D(IS=1e-12 N=0.01)\n";

/// The pair of diodes with their sources from node `a` to node `b`.
string diode_pair(const string& a, const string& b, double half_v, const string& id) {
  return fmt::format(
      "Vu{0} {1} u{0} DC {3}\nDu{0} u{0} {2} sharp\nVl{0} l{0} {1} DC {3}\nDl{0} {2} l{0} sharp\n", id, a, b,
      n(half_v));
}

string square_and_cube(const string& in, const Multiplier& m, int id) {
  // W = scale (x + offset) y + output offset.
  return fmt::format(
      "Es{0} s{0} 0 VALUE={{{2}*(V({1})+({3}))*V({1})+({4})}}\n"
      "Ek{0} k{0} 0 VALUE={{{2}*(V(s{0})+({3}))*V({1})+({4})}}\n",
      id, in, n(m.scale), n(m.x_offset_v), n(m.output_offset_v));
}

}  // namespace

TwoPort section_port(SectionParts s, OpAmp opamp) {
  return [=](const string& in, const string& out, int id) {
    const double r1 = kOhm;
    const double r2 = s.gain * kOhm;
    const double c1 = (1.0 + s.input_mismatch) / (kTwoPi * s.zero_hz * r1);
    const double c2 = (1.0 + s.feedback_mismatch) / (kTwoPi * s.pole_hz * r2);
    const string minus = fmt::format("m{}", id);
    return fmt::format("R1_{0} {1} {2} {4}\nC1_{0} {1} {2} {5}\nR2_{0} {2} {3} {6}\nC2_{0} {2} {3} {7}\n", id,
                       in, minus, out, n(r1), n(c1), n(r2), n(c2)) +
           opamp_text(opamp, "0", minus, out, id);
  };
}

TwoPort inverter_port(double gain, OpAmp opamp) {
  return [=](const string& in, const string& out, int id) {
    const string minus = fmt::format("m{}", id);
    return fmt::format("R1_{0} {1} {2} {4}\nR2_{0} {2} {3} {5}\n", id, in, minus, out, n(kOhm),
                       n(gain * kOhm)) +
           opamp_text(opamp, "0", minus, out, id);
  };
}

TwoPort follower_port(OpAmp opamp) {
  return [=](const string& in, const string& out, int id) { return opamp_text(opamp, in, out, out, id); };
}

TwoPort lowpass_port(double corner_hz) {
  return [=](const string& in, const string& out, int id) {
    return buffer(in, fmt::format("a{}", id), fmt::format("a{}", id)) +
           fmt::format("R{0} a{0} b{0} {1}\nC{0} b{0} 0 {2}\n", id, n(kOhm),
                       n(1.0 / (kTwoPi * corner_hz * kOhm))) +
           buffer(fmt::format("b{}", id), out, fmt::format("b{}", id));
  };
}

TwoPort rlc_port(double hz, double damping) {
  return [=](const string& in, const string& out, int id) {
    const double w = kTwoPi * hz;
    const double l = 2.0 * kOhm / w;
    return buffer(in, fmt::format("a{}", id), fmt::format("a{}", id)) +
           fmt::format("R{0} a{0} r{0} {1}\nL{0} r{0} b{0} {2}\nC{0} b{0} 0 {3}\n", id,
                       n(2.0 * damping * w * l), n(l), n(1.0 / (w * w * l))) +
           buffer(fmt::format("b{}", id), out, fmt::format("b{}", id));
  };
}

TwoPort line_port(double delay_s) {
  return [=](const string& in, const string& out, int id) {
    return buffer(in, fmt::format("a{}", id), fmt::format("a{}", id)) +
           fmt::format("T{0} a{0} 0 b{0} 0 Z0=50 TD={1}\nR{0} b{0} 0 50\n", id, n(delay_s)) +
           buffer(fmt::format("b{}", id), out, fmt::format("b{}", id));
  };
}

TwoPort dead_zone_port(double width_v) {
  return [=](const string& in, const string& out, int id) {
    const string name = fmt::format("z{}", id);
    return buffer(in, fmt::format("a{}", id), fmt::format("a{}", id)) +
           diode_pair(fmt::format("a{}", id), fmt::format("b{}", id), 0.5 * width_v, name) +
           fmt::format("R{0} b{0} 0 {1}\n", id, n(kOhm)) +
           buffer(fmt::format("b{}", id), out, fmt::format("b{}", id));
  };
}

TwoPort plays_port(std::vector<double> widths, std::vector<double> weights) {
  return [=](const string& in, const string& out, int id) {
    string t = buffer(in, fmt::format("a{}", id), fmt::format("a{}", id));
    string sum = fmt::format("V(a{})", id);
    for (size_t k = 0; k < widths.size(); ++k) {
      const string own = fmt::format("{}_{}", id, k);
      t += diode_pair(fmt::format("a{}", id), "c" + own, 0.5 * widths[k], own);
      t += fmt::format("C{0} c{0} 0 1e-9\n", own);
      sum += fmt::format("+{}*V(c{})", n(weights[k]), own);
    }
    return t + fmt::format("Eb{} {} 0 VALUE={{{}}}\n", id, out, sum);
  };
}

TwoPort play_port(double width_v) {
  return [=](const string& in, const string& out, int id) {
    return buffer(in, fmt::format("a{}", id), fmt::format("a{}", id)) +
           diode_pair(fmt::format("a{}", id), fmt::format("c{}", id), 0.5 * width_v, fmt::format("y{}", id)) +
           fmt::format("C{0} c{0} 0 1e-9\n", id) +
           buffer(fmt::format("c{}", id), out, fmt::format("b{}", id));
  };
}

TwoPort hold_port(double clock_hz) {
  return [=](const string& in, const string& out, int id) {
    const double period = 1.0 / clock_hz;
    const double open = period / 200.0;
    return buffer(in, fmt::format("a{}", id), fmt::format("a{}", id)) +
           fmt::format(
               "Vck{0} ck{0} 0 PULSE(0 1 0 {1} {1} {2} {3})\n.model switch{0} SW(VT=0.5 VH=0 RON=10 "
               "ROFF=1e13)\n"
               "S{0} a{0} h{0} ck{0} 0 switch{0}\nC{0} h{0} 0 {4}\n",
               id, n(0.02 * open), n(open), n(period), n(0.05 * open / 10.0)) +
           buffer(fmt::format("h{}", id), out, fmt::format("b{}", id));
  };
}

TwoPort absorption_port(std::vector<double> gains, std::vector<double> tau) {
  return [=](const string& in, const string& out, int id) {
    string t = buffer(in, fmt::format("a{}", id), fmt::format("a{}", id));
    string sum = fmt::format("V(a{})", id);
    for (size_t k = 0; k < tau.size(); ++k) {
      // R1_2 is the first resistor of the second amplifier.
      t += fmt::format("Rq{0}_{1} a{0} q{0}_{1} {2}\nCq{0}_{1} q{0}_{1} 0 {3}\n", id, k, n(kOhm),
                       n(tau[k] / kOhm));
      sum += fmt::format("+{}*V(q{}_{})", n(gains[k]), id, k);
    }
    return t + fmt::format("Eb{} {} 0 VALUE={{{}}}\n", id, out, sum);
  };
}

TwoPort hum_port(double amplitude_v, double hz, double phase_deg) {
  return [=](const string& in, const string& out, int id) {
    return fmt::format("Vh{0} {1} a{0} SIN(0 {2} {3} 0 0 {4})\nRh{0} {1} 0 {5}\n", id, out, n(amplitude_v),
                       n(hz), n(phase_deg), n(kOhm)) +
           buffer(in, fmt::format("a{}", id), fmt::format("a{}", id));
  };
}

TwoPort series_port(double offset_v) {
  return [=](const string& in, const string& out, int id) {
    return fmt::format("Vh{0} {1} a{0} DC {2}\nRh{0} {1} 0 {3}\n", id, out, n(offset_v), n(kOhm)) +
           buffer(in, fmt::format("a{}", id), fmt::format("a{}", id));
  };
}

TwoPort drift_port(double rate) {
  return [=](const string& in, const string& out, int id) {
    constexpr double c = 1e-9;
    // Off at t = 0, so that the capacitor starts empty.
    return fmt::format(
               "Id{0} 0 c{0} PULSE(0 {1} 0 1e-12 1e-12 1e6 2e6)\nCd{0} c{0} 0 {2}\nRd{0} c{0} 0 1e18\n", id,
               n(rate * c), n(c)) +
           fmt::format("Eb{0} {1} 0 VALUE={{V({2})+V(c{0})}}\n", id, out, in);
  };
}

TwoPort diode_port(double load_s, double drop_v) {
  return [=](const string& in, const string& out, int id) {
    return buffer(in, fmt::format("a{}", id), fmt::format("a{}", id)) +
           fmt::format("Vd{0} a{0} d{0} DC {1}\nDd{0} d{0} b{0} sharp\nR{0} b{0} 0 {2}\nC{0} b{0} 0 {3}\n",
                       id, n(drop_v), n(kOhm), n(load_s / kOhm)) +
           buffer(fmt::format("b{}", id), out, fmt::format("b{}", id));
  };
}

TwoPort curve_port(double c2, double c3, Multiplier m) {
  return [=](const string& in, const string& out, int id) {
    return square_and_cube(in, m, id) +
           fmt::format("Eb{0} {1} 0 VALUE={{V({2})+({3})*V(s{0})+({4})*V(k{0})}}\n", id, out, in, n(c2),
                       n(c3));
  };
}

TwoPort branches_port(std::vector<double> up, std::vector<double> down, Multiplier m, double line_s) {
  return [=](const string& in, const string& out, int id) {
    string t = square_and_cube(in, m, id);
    // The line to the switch, then two conductances that a steep tanh trades against each other.
    t += fmt::format("Rl{0} branch w{0} {1}\nCl{0} w{0} 0 {2}\n", id, n(kOhm),
                     n(std::max(line_s, 1e-12) / kOhm));
    const auto sum = [&](const std::vector<double>& a) {
      return fmt::format("V({1})+({2})*V({1})+({3})*V(s{0})+({4})*V(k{0})", id, in, n(a[0]), n(a[1]),
                         n(a[2]));
    };
    t += fmt::format("Eu{0} up{0} 0 VALUE={{{1}}}\nEd{0} dn{0} 0 VALUE={{{2}}}\n", id, sum(up), sum(down));
    t += fmt::format(
        "Gu{0} up{0} j{0} VALUE={{0.5e-3*(1+tanh(100*(V(w{0})-0.5)))*V(up{0},j{0})}}\n"
        "Gd{0} dn{0} j{0} VALUE={{0.5e-3*(1-tanh(100*(V(w{0})-0.5)))*V(dn{0},j{0})}}\nRj{0} j{0} 0 1e12\n",
        id);
    return t + buffer(fmt::format("j{}", id), out, fmt::format("b{}", id));
  };
}

TwoPort spring_port(SpringParts s) {
  return [=](const string& in, const string& out, int id) {
    constexpr double c = 1e-9;
    const double w = kTwoPi * s.hz;
    // States y and v = y'/w, each on a capacitor.
    string t = fmt::format("Gy{0} 0 y{0} VALUE={{{1}*V(v{0})}}\nCy{0} y{0} 0 {2}\nRy{0} y{0} 0 1e15\n", id,
                           n(w * c), n(c));
    t += fmt::format(
        "Gv{0} 0 v{0} "
        "VALUE={{{1}*({2}*V({3})-V(y{0})*(1+V(y{0})*({4}+({5})*V(y{0})))-{6}*V(v{0})-{7}*max(V(v{0}),-V(v{0})"
        ")*"
        "V(v{0}))}}\nCv{0} v{0} 0 {8}\nRv{0} v{0} 0 1e15\n",
        id, n(w * c), n(s.gain), in, n(s.quadratic), n(s.cubic), n(2.0 * s.damping), n(s.drag * w), n(c));
    return t + buffer(fmt::format("y{}", id), out, fmt::format("b{}", id));
  };
}

std::vector<double> run_deck(const std::vector<TwoPort>& ports, const std::vector<double>& u, double step_s,
                             bool with_branch, bool resonant) {
  string deck = "hidden effect\n";
  deck += kDiode;
  deck += "Vin n0 0 PWL(\n";
  for (size_t i = 0; i < u.size(); ++i)
    deck += fmt::format("+ {} {}\n", n(step_s * static_cast<double>(i)), n(u[i]));
  deck += fmt::format("+ {} {} )\n", n(step_s * static_cast<double>(u.size() + 2)), n(u.back()));
  if (with_branch) {
    const double edge = 2e-3 * step_s;
    bool rising = true;
    string points = "Vbranch branch 0 PWL(\n+ 0 1\n";
    for (size_t i = 0; i + 1 < u.size(); ++i) {
      const bool next = u[i + 1] > u[i] ? true : u[i + 1] < u[i] ? false : rising;
      const double t = step_s * static_cast<double>(i);
      if (next != rising && i > 0)
        points += fmt::format("+ {} {}\n+ {} {}\n", n(t), rising ? 1 : 0, n(t + edge), next ? 1 : 0);
      rising = next;
    }
    deck +=
        points + fmt::format("+ {} {} )\n", n(step_s * static_cast<double>(u.size() + 2)), rising ? 1 : 0);
  }
  for (size_t i = 0; i < ports.size(); ++i) {
    const string out = i + 1 == ports.size() ? "out" : fmt::format("n{}", i + 1);
    deck += ports[i](fmt::format("n{}", i), out, static_cast<int>(i) + 1);
  }
  // Gear keeps the stiff op-amps quiet but damps a resonance of its own accord; the trapezoidal rule does
  // not, apart from the Euler step that follows each corner of the input, a tenth of the last step long.
  deck += fmt::format(".options method={} reltol={} abstol=1e-12 vntol=1e-7 interp\n",
                      resonant ? "trap" : "gear", resonant ? "1e-5" : "3e-5");
  const size_t parts = resonant ? 8 : 1;
  const double step = step_s / static_cast<double>(parts);
  // One sample more than is wanted: the last one may fall to rounding.
  const auto run = bodesmith::ngspice::run_transient(deck, {"out"}, step,
                                                     step_s * static_cast<double>(u.size()), "hidden.cir");
  std::vector<double> y;
  for (size_t i = 0; i < u.size(); ++i) {
    const size_t at = i * parts;
    if (at >= run.time_s.size() || std::abs(run.time_s[at] / step_s - static_cast<double>(i)) > 1e-3)
      throw bodesmith::InputError(
          fmt::format("hidden.cir: ngspice did not keep to the samples at {} of {}", i, u.size()));
    y.push_back(run.v[0][at]);
  }
  return y;
}

}  // namespace hidden
