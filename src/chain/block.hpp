#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/parameter.hpp"
#include "base/registry.hpp"
#include "base/units.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::hysteresis {
class ModelType;
}

namespace bodesmith::chain {

class Block;
struct FoundInput;
struct WantedOutput;

/// What a part's departure from its value does to the parameters of the block that it belongs to.
struct PartChange {
  std::string part;        ///< "Rd3"; "M2, offset of X"
  std::string unit = {};   ///< of the departure: "percent" of the value, or "v"
  double tolerance = 0.0;  ///< a good part is within so much of its value
  /// p(t) = p + slope t/(1 + bend t): any voltage of a resistive network depends on one of its resistors so
  /// (bilinear: Bode, Network Analysis and Feedback Amplifier Design, 1945, 10).
  struct Entry {
    std::string parameter;  ///< "descending[2]"
    double slope = 0.0;
    double bend = 0.0;
    double of(double departure) const { return slope * departure / (1.0 + bend * departure); }
  };
  std::vector<Entry> entries = {};
  /// Of an op-amp of a section, N = [d0, d1, d2]: 1/beta = (d0 + d1 s/w + d2 (s/w)^2)/P(s), P the section's denominator, 1 at DC,
  /// w its natural frequency or pole. With another gain-bandwidth f the section is H/(1 + s (1/f - 1/gain_bandwidth_hz)/(2 pi beta)):
  /// exact where nothing passes the section without the op-amp and the op-amp was ideal (Bode 1945, 5). Empty: no op-amp.
  std::vector<double> noise_gain = {};
  /// Of one that something passes without (it is dead: its output is at 0 V) a section N/P of two poles: F, likewise, F/D the
  /// response that is left. Then the section is (N + s (1/f - …) F/(2 pi))/(P + s (1/f - …) D/(2 pi)) (Blackman's and the asymptotic
  /// gain formula, Rosenstark, IEEE Trans. Circuits Syst. 21 (1974) 275). Empty: nothing passes.
  std::vector<double> feedthrough = {};
  double gain_bandwidth_hz = INFINITY;  ///< that the block's parameters hold

  bool is_offset() const { return unit == "v"; }
  /// The largest departure that is looked for: more of a value is a short or another decade, an offset is within so many
  /// tolerances.
  double most() const { return is_offset() ? 30.0 * tolerance : 60.0; }

  /// From the values of the parameters at `departure` to both sides, less those at none.
  void add(std::string parameter, double departure, double above, double below);
  /// The same for every parameter of `block` that differs by more than rounding in those with the departure.
  void add_differences(const Block& block, double departure, const Block& above, const Block& below);
};

/// y = factor u + constant.
struct Affine {
  double factor = 1.0;
  double constant = 0.0;
};

/// A list parameter of a block that holds the coefficients of a polynomial.
struct PolynomialList {
  std::string_view key;
  std::size_t first = 0;  ///< place of the coefficient of x^1 in it
};

/// One number of a block; a list of model.toml is one Parameter an entry.
struct Parameter {
  const ParameterSpec* spec = nullptr;  ///< the block type's, never null
  int element = -1;                     ///< place in its list; -1: not in a list
  double value = 0.0;
  bool free = false;  ///< identify and diagnose may refit it

  const std::string& key() const { return spec->name; }
  const std::string& unit() const { return spec->unit; }
  double min() const { return spec->min; }
  double max() const { return spec->max; }
  /// "corner_hz", or "coefficients[2]".
  std::string name() const;
};

/// What is wrong with a block.
struct ValidationError {
  const Parameter* parameter = nullptr;  ///< null: it is about several, and the message names them
  std::string message;                   ///< "is 3, expected at most 1"

  std::string text() const { return parameter == nullptr ? message : parameter->name() + " " + message; }
};

/// A type of block: its parameters, and what engines run for it. One object a type, in a file
/// under chain/blocks/, listed in chain/registry.cpp.
class BlockType {
 public:
  BlockType(std::string name, std::string what, std::vector<ParameterSpec> specs)
      : name_(std::move(name)), what_(std::move(what)), specs_(std::move(specs)) {}
  virtual ~BlockType() = default;
  BlockType(const BlockType&) = delete;
  BlockType& operator=(const BlockType&) = delete;

  const std::string& name() const { return name_; }
  const std::string& what() const { return what_; }  ///< one line for a person
  const std::vector<ParameterSpec>& specs() const { return specs_; }

  /// Relations between parameters, each of them legal by itself: what is wrong, empty when all is well. A
  /// message about one number begins with its key.
  virtual std::string validate(const Block&) const { return {}; }
  virtual Kernel kernel(const Block& block) const = 0;
  /// The exact H(jw), for linear blocks (offsets, hum and drift do not count; a fractional term is exact
  /// here, though its kernel is not). Nothing for the others.
  virtual std::optional<Complex> response(const Block& block, RadPerSecond w) const {
    return transfer(block, {0.0, w.value});
  }
  /// The exact H(s), Re s >= 0, of a linear block whose kernel is an approximation of it, or has a state of its own.
  virtual std::optional<Complex> transfer(const Block&, Complex) const { return std::nullopt; }

  /// The input for a wanted output (chain/inverse.hpp), by the kernel where that is linear, a source or sampled (the same seed of a
  /// noise is the same signal). Nothing for blocks without one, a gain of 0 too, which compensate then inverts numerically.
  virtual std::optional<FoundInput> inverse(const Block& block, const WantedOutput& wanted) const;

  // What other rooms ask of a block, so that none of them has to know it by name.

  /// The slowest time constant of the block, in seconds: seven of them, and a step at its input is forgotten.
  /// (For a pure delay a seventh of it.) 0: nothing to wait for.
  virtual double slowest_time_constant_s(const Block&) const { return 0.0; }
  /// The straight line that the block is for every input at every time; nothing for any other block.
  virtual std::optional<Affine> affine(const Block&) const { return std::nullopt; }
  /// Order of the circuit section (poles by amplifiers, resistors and capacitors) that the block stands for:
  /// 1 for a corner, 2 for a resonance; 0 for blocks that are no section.
  virtual int section_order() const { return 0; }
  /// Lists of coefficients whose powers of the input a circuit makes by multipliers.
  virtual std::vector<PolynomialList> polynomials() const { return {}; }
  /// An equation solved in steps of its own within each sample, hundreds where it is steep: what runs a chain thousands
  /// of times passes it by.
  virtual bool steps_within_samples(const Block&) const { return false; }
  /// The model of a block that is one of hysteresis/, otherwise null.
  virtual const hysteresis::ModelType* hysteresis_model() const { return nullptr; }

 private:
  std::string name_;
  std::string what_;
  std::vector<ParameterSpec> specs_;
};

/// A block of a chain: its type and the values of its parameters. A value: copies are independent.
class Block {
 public:
  /// Default values (0 where there is none); lists empty.
  explicit Block(const BlockType& type);

  const BlockType& type() const { return *type_; }
  const std::string& type_name() const { return type_->name(); }

  std::vector<Parameter>& parameters() { return parameters_; }
  const std::vector<Parameter>& parameters() const { return parameters_; }

  /// The value of a parameter that is a number or flag. std::logic_error for an unknown key.
  double get(std::string_view key) const;
  bool flag(std::string_view key) const { return get(key) != 0.0; }
  std::vector<double> list(std::string_view key) const;
  bool has(std::string_view key) const;
  /// `name` may be a key or "key[i]".
  Block& set(std::string_view name, double value);
  Block& set(std::string_view key, const std::vector<double>& values);
  /// Parameters that are words (kinds, not numbers).
  const std::string& word(std::string_view key) const;
  Block& set_word(std::string_view key, std::string value);
  const std::vector<std::pair<std::string, std::string>>& words() const { return words_; }
  /// Frees a key (all entries of a list), or one entry "key[i]". False when there is no such parameter.
  bool free(std::string_view name);

  /// Nothing when every value is legal and they fit together.
  std::optional<ValidationError> validate() const;
  Kernel kernel() const { return type_->kernel(*this); }
  std::optional<Complex> response(RadPerSecond w) const { return type_->response(*this, w); }
  std::optional<Complex> transfer(Complex s) const { return type_->transfer(*this, s); }
  std::optional<FoundInput> inverse(const WantedOutput& wanted) const;
  double slowest_time_constant_s() const { return type_->slowest_time_constant_s(*this); }
  std::optional<Affine> affine() const { return type_->affine(*this); }
  /// True when the block multiplies by a constant and does nothing else.
  bool scales_only() const {
    const auto curve = affine();
    return curve && curve->constant == 0.0;
  }
  int section_order() const { return type_->section_order(); }
  std::vector<PolynomialList> polynomials() const { return type_->polynomials(); }
  bool steps_within_samples() const { return type_->steps_within_samples(*this); }
  const hysteresis::ModelType* hysteresis_model() const { return type_->hysteresis_model(); }

  /// Of the part it stands for ("Section3a"); empty: none.
  std::string part;
  /// What the parts that it is made of do to it; null: not known.
  std::shared_ptr<const std::vector<PartChange>> parts;
  /// The block as it is when one of its parts is off by so much.
  Block with(const PartChange& change, double departure) const;
  /// Line of model.toml it came from; 0: none.
  int line = 0;

 private:
  const BlockType* type_;
  std::vector<Parameter> parameters_;
  std::vector<std::pair<std::string, std::string>> words_;
};

}  // namespace bodesmith::chain
