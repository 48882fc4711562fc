#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "base/provenance.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith::cli {

/// One option of a subcommand, as its Boost.Program_options description has it.
struct OptionEntry {
  std::string name;    ///< without the dashes
  std::string letter;  ///< of a short form; empty where there is none
  std::string group;   ///< heading of --help under which it stands
  std::string what;
  std::string default_text;
  std::vector<std::string> words;  ///< values that are words; empty: any text or number
  bool takes_value = false;
  bool several = false;  ///< several values, or may be given several times
};

/// What a subcommand takes: the same that --help shows, for manual pages and shells. CommandLine::table() makes it from the
/// descriptions that parse the command line, so that there is no second list.
struct CommandTable {
  std::string name;  ///< "fit", "fpaa streams"
  std::string example;
  std::string what;
  std::string positional;
  bool reads_measurements = false;
  std::vector<OptionEntry> options;

  /// The first sentence of `what`, without its full stop.
  std::string first_sentence() const;
};

/// Where CommandLine::parse() puts its table instead of parsing; null as a rule.
std::vector<CommandTable>*& tables_wanted();

/// The tables of all subcommands, and of those below them, in the order of `bodesmith --help`.
std::vector<CommandTable> command_tables();

/// The options of one subcommand. Every subcommand has --help, --json, --quiet and (when it writes) -o.
class CommandLine {
 public:
  /// `example` is the line that --help shows first.
  CommandLine(std::string name, std::string example, std::string what);
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;
  ~CommandLine();

  /// Adds --name with a value of type T (int, double, std::string, std::uint64_t).
  /// A double may be typed with a prefix and a unit: 4k7, 10n, 13.2kHz (base/text.hpp).
  template <class T>
  void option(const std::string& name, const std::string& what) {
    if constexpr (std::is_same_v<T, double>) {
      add_quantity(name, std::nullopt, what);
    } else {
      add<T>(name, std::nullopt, what);
    }
  }
  template <class T>
  void option(const std::string& name, const std::string& what, const T& default_value) {
    if constexpr (std::is_same_v<T, double>) {
      add_quantity(name, default_value, what);
    } else {
      add<T>(name, default_value, what);
    }
  }
  /// Adds --name without a value.
  void flag(const std::string& name, const std::string& what);
  /// Adds --name with several values (T: double or std::string) after one name; the option's value is a std::vector<T>.
  template <class T>
  void list(const std::string& name, const std::string& what) {
    if (std::is_same_v<T, double>) quantities_[name];
    add_texts(name, what);
  }
  /// Adds --name that may be given several times; the option's value is a std::vector<std::string>.
  void repeatable(const std::string& name, const std::string& what);
  /// The words that an option takes: offered by shells, and shown by the manual.
  void words(const std::string& option, std::vector<std::string> words) { words_[option] = std::move(words); }
  /// Options added from here on stand under this heading of --help.
  void group(const std::string& caption);

  /// Positional files, kept in the order given. `max` < 0: any number.
  void positional(const std::string& name, int min, int max);
  /// Has --help name the formats of other programs that are read wherever this command reads measured files.
  void reads_measurements() { reads_measurements_ = true; }
  /// The same of a command that reads records: adds --sample-hz, which new_provenance() hands to the readers.
  void reads_records();
  Provenance new_provenance() const;
  /// Adds -o/--output; required unless `optional`.
  void output(const std::string& what, bool optional = false);
  /// Adds --seed.
  void seed();
  /// Adds --from-hz and --to-hz.
  void band(const std::string& from_what, const std::string& to_what);

  /// False when --help was asked for and shown. Throws InputError for bad usage.
  bool parse(const std::vector<std::string>& arguments);
  /// What --help shows, for manual and completion.
  CommandTable table() const;

  bool has(const std::string& option) const {
    read_.insert(option);
    return is_given(option);
  }
  template <class T>
  T get(const std::string& option) const {
    read_.insert(option);
    if constexpr (std::is_same_v<T, double>) {
      return quantities_.at(option).front();
    } else if constexpr (std::is_same_v<T, std::vector<double>>) {
      return quantities_.at(option);
    } else {
      return value<T>(option);
    }
  }
  template <class T>
  std::optional<T> maybe(const std::string& option) const {
    if (!has_value(option)) return std::nullopt;
    return get<T>(option);
  }
  /// Every value of a list or of an option that may be given several times; none where it was not.
  template <class T>
  std::vector<T> all(const std::string& option) const {
    return maybe<std::vector<T>>(option).value_or(std::vector<T>{});
  }
  /// The one of `choices` whose to_string() was given.
  template <class Enum>
  Enum choice(const std::string& option, std::initializer_list<Enum> choices) const {
    const auto given = get<std::string>(option);
    std::vector<std::string> words;
    for (const Enum value : choices) {
      words.emplace_back(to_string(value));
      if (words.back() == given) return value;
    }
    fail_choice(option, given, words);
  }
  /// A number option that must be finite and above 0.
  double positive(const std::string& option) const;
  std::optional<double> maybe_positive(const std::string& option) const;
  /// A frequency at which parts that one can buy do something: 1e-6 (a turn in eleven days) to 1e9 Hz.
  Hertz analog_frequency(const std::string& option) const;
  /// The same of a list; empty when it was not given.
  std::vector<Hertz> analog_frequencies(const std::string& option) const;
  /// An integer option that must be within [min, max].
  int integer(const std::string& option, int min, int max) const;
  /// --from-hz and --to-hz together, or neither.
  std::optional<Band> maybe_band() const;
  /// Options under this heading of --help, which do nothing in the mode that was asked for, are an error.
  void refuse_group(const std::string& caption) const;
  /// Options that were given and that nobody has asked for: they do nothing in this mode, and are an error. Done before
  /// the command's output is written, and before its summary is shown.
  void refuse_unread() const;
  std::vector<std::string> files() const;
  std::filesystem::path output_path() const { return get<std::string>("output"); }
  std::uint64_t seed_value() const { return get<std::uint64_t>("seed"); }
  bool json() const { return has_value("json"); }
  bool quiet() const { return has_value("quiet"); }
  /// Throws InputError "NAME: message (see bodesmith NAME --help)".
  [[noreturn]] void fail(const std::string& message) const;

 private:
  /// Whether it was given.
  bool is_given(const std::string& option) const;
  /// Whether it was given or has a default.
  bool has_value(const std::string& option) const;
  // T: int, std::string, std::uint64_t or std::vector<std::string>; compiled in the .cpp alone.
  template <class T>
  const T& value(const std::string& option) const;
  template <class T>
  void add(const std::string& name, const std::optional<T>& default_value, const std::string& what);
  void add_quantity(const std::string& name, std::optional<double> default_value, const std::string& what);
  void add_texts(const std::string& name, const std::string& what);
  void show_help() const;
  /// "unrecognised option '--oder'", with the option that may be meant.
  [[noreturn]] void fail_unknown(const std::string& given) const;
  /// Reads the text of every quantity that was given.
  void read_quantities();
  [[noreturn]] void fail_choice(const std::string& option, const std::string& given,
                                const std::vector<std::string>& words) const;
  Hertz analog(const std::string& option, double given) const;

  std::string name_;
  std::string example_;
  std::string what_;
  std::string positional_name_;
  int min_files_ = 0;
  int max_files_ = 0;
  bool output_needed_ = false;
  bool reads_measurements_ = false;
  struct Options;  ///< what Boost.Program_options knows of them: half a second to compile wherever it is seen
  std::unique_ptr<Options> options_;
  std::map<std::string, std::vector<std::string>> words_;
  mutable std::set<std::string> read_;                     ///< options that the command has asked for
  std::map<std::string, std::vector<double>> quantities_;  ///< numbers typed with or without prefix and unit
};

/// Prints either the text or, with --json, the JSON object (which should carry "schema" and "timing_s"). The exit
/// status: whether the limits that were asked for are met.
int print_summary(const CommandLine& line, const std::string& text, const Json& json, bool met = true);
/// A note or warning for a person: one line on stderr, once the command has done its work. A command that fails says
/// one line only, its error.
void note(const std::string& text);
/// The notes so far, and none of them again.
void show_notes();
void warn_each(const std::vector<std::string>& warnings);

/// What was converted of foreign files, which print_summary() says; every output says it too (timed_document()).
void note_conversions(const Provenance& from);

/// A JSON document with header, `body` and the time of the work itself.
Json timed_document(std::string_view schema, const Provenance& from, const Json& body, double seconds);

/// "the limit of 0.5 dB is NOT met\n"
std::string limit_not_met(double limit, std::string_view unit);
/// Whether `value` keeps the limit, if there is one; where it does not, the summary's text and JSON (`limit_missed`) say so.
bool keeps_limit(std::optional<double> limit, double value, std::string_view unit, std::string& text,
                 Json& json);

}  // namespace bodesmith::cli
