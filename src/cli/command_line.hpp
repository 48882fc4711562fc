#pragma once

#include <boost/program_options.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "base/provenance.hpp"

namespace bodesmith::cli {

/// The options of one subcommand. Every subcommand has --help, --json and (when it writes) -o.
class CommandLine {
 public:
  /// `example` is the line that --help shows first.
  CommandLine(std::string name, std::string example, std::string what);

  /// For `.add_options()("order", po::value<int>(), "…")`.
  boost::program_options::options_description& options() { return options_; }
  /// Positional files, kept in the order given. `most` < 0: any number.
  void positional(const std::string& name, int least, int most);
  /// Adds -o/--output; required unless `optional`.
  void output(const std::string& what, bool optional = false);
  /// Adds --seed.
  void seed();

  /// False when --help was asked for and shown. Throws InputError for bad usage.
  bool parse(const std::vector<std::string>& arguments);

  bool has(const std::string& option) const {
    return values_.count(option) > 0 && !values_[option].defaulted();
  }
  template <class T>
  T get(const std::string& option) const {
    return values_[option].as<T>();
  }
  template <class T>
  std::optional<T> maybe(const std::string& option) const {
    if (values_.count(option) == 0) return std::nullopt;
    return values_[option].as<T>();
  }
  /// A number option that must be finite and above 0.
  double positive(const std::string& option) const;
  std::vector<std::string> files() const;
  std::filesystem::path output_path() const { return get<std::string>("output"); }
  std::uint64_t seed_value() const { return get<std::uint64_t>("seed"); }
  bool json() const { return values_.count("json") > 0; }
  /// Throws InputError "bodesmith NAME: message, see --help".
  [[noreturn]] void fail(const std::string& message) const;

 private:
  std::string name_;
  std::string example_;
  std::string what_;
  std::string positional_name_;
  int least_ = 0;
  int most_ = 0;
  bool output_needed_ = false;
  boost::program_options::options_description options_;
  boost::program_options::variables_map values_;
};

/// Prints either the text or, with --json, the JSON object (which should carry "schema" and "timing_s").
void print_summary(const CommandLine& line, const std::string& text, const Json& json);
/// A note or warning for a person: one line on stderr.
void note(const std::string& text);

}  // namespace bodesmith::cli
