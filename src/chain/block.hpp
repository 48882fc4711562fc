#pragma once

#include <complex>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/units.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::chain {

class Block;

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

/// What a block type says about one of its parameters.
struct ParameterSpec {
  enum class Shape { number, list, flag, word };

  std::string name;  ///< key in model.toml, ending in its unit
  std::string what;  ///< one line for a person
  Shape shape = Shape::number;
  std::optional<double>
      standard;  ///< value when the key is absent; none: the key is needed (for a list: none)
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_excluded = false;            ///< the value must be above `low`, not at it
  bool optional_list = false;           ///< a list that may be left out
  std::vector<std::string> words = {};  ///< legal words of a Shape::word, the standard one first
};

/// One scalar of a block; a list of model.toml is one Parameter an entry.
struct Parameter {
  std::string key;   ///< as in model.toml
  int element = -1;  ///< place in its list; -1: not in a list
  double value = 0.0;
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_excluded = false;
  bool free = false;  ///< identify and diagnose may refit it

  /// "coefficients[2]" or "corner_hz".
  std::string name() const;
  /// Unit at the end of the key ("Hz", "s", "1/s", ...); empty: that of the signal, or none.
  std::string unit() const;
};

/// A type of block: its parameters, and what engines run for it. One object a type, in a file of its own
/// under chain/blocks/, listed in chain/registry.cpp.
class BlockType {
 public:
  virtual ~BlockType() = default;
  virtual std::string_view name() const = 0;
  virtual std::string_view what() const = 0;
  virtual const std::vector<ParameterSpec>& specs() const = 0;
  /// Relations between parameters; a message when they are broken, empty when all is well. Bounds of single
  /// parameters are checked by Block::check already.
  virtual std::string complaint(const Block&) const { return {}; }
  virtual Kernel kernel(const Block& block) const = 0;
  /// The exact H(jw), for linear blocks (offsets, hum and drift do not count; a fractional term is exact
  /// here, though its kernel is not). Nothing for the others.
  virtual std::optional<std::complex<double>> response(const Block&, RadPerSecond) const {
    return std::nullopt;
  }

  // What other rooms ask of a block, so that none of them has to know it by name.

  /// The slowest time constant of the block, in seconds: seven of them, and a step at its input is forgotten.
  /// (For a pure delay a seventh of it.) 0: nothing to wait for.
  virtual double slowest_time_constant_s(const Block&) const { return 0.0; }
  /// The straight line that the block is for every input at every time; nothing for any other block.
  virtual std::optional<Affine> affine(const Block&) const { return std::nullopt; }
  /// The delay of a block that does nothing else.
  virtual std::optional<double> pure_delay_s(const Block&) const { return std::nullopt; }
  /// Order of the circuit section (poles by amplifiers, resistors and capacitors) that the block stands for:
  /// 1 for a corner, 2 for a resonance; 0 for blocks that are no section.
  virtual int section_order() const { return 0; }
  /// Lists of coefficients whose powers of the input a circuit makes by multipliers.
  virtual std::vector<PolynomialList> polynomials() const { return {}; }
};

/// A block of a chain: its type and the values of its parameters. A value: copies are independent.
class Block {
 public:
  /// Standard values; list parameters empty.
  explicit Block(const BlockType& type);

  const BlockType& type() const { return *type_; }
  std::string_view type_name() const { return type_->name(); }

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

  /// Empty when every value is within its bounds and they fit together; else what is wrong.
  std::string complaint() const;
  Kernel kernel() const { return type_->kernel(*this); }
  std::optional<std::complex<double>> response(RadPerSecond w) const { return type_->response(*this, w); }
  double slowest_time_constant_s() const { return type_->slowest_time_constant_s(*this); }
  std::optional<Affine> affine() const { return type_->affine(*this); }
  /// True when the block multiplies by a constant and does nothing else.
  bool scales_only() const {
    const auto curve = affine();
    return curve && curve->constant == 0.0;
  }
  std::optional<double> pure_delay_s() const { return type_->pure_delay_s(*this); }
  int section_order() const { return type_->section_order(); }
  std::vector<PolynomialList> polynomials() const { return type_->polynomials(); }

  /// Line of model.toml it came from; 0: none.
  int line = 0;

 private:
  const ParameterSpec* spec(std::string_view key) const;
  const BlockType* type_;
  std::vector<Parameter> parameters_;
  std::vector<std::pair<std::string, std::string>> words_;
};

}  // namespace bodesmith::chain
