#include "cli/command_line.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <boost/program_options.hpp>
#include <sstream>
#include <utility>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "base/terminal.hpp"
#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "cli/commands.hpp"

namespace po = boost::program_options;

namespace bodesmith::cli {
namespace {

/// "a, b or c".
std::string join_alternatives(std::vector<std::string> words) {
  const std::string last = words.back();
  words.pop_back();
  return words.empty() ? last : join(words, ", ") + " or " + last;
}

constexpr std::string_view kWarning = "warning: ";
constexpr std::string_view kMissed = "NOT met";

constexpr std::string_view kMeasuredFormats =
    "Measured files may also be of Digilent WaveForms, Bode 100, REW/FRD/ZMA, Touchstone, ngspice,\n"
    "LTspice, MATLAB 5, WAV or plain tables, told apart by content. FILE:s11, FILE:v(out),\n"
    "FILE:v(in),v(out), FILE:gain, FILE:db choose what in them is meant (docs/formats.md).\n";

/// A limit that is missed stands out at a terminal.
std::string with_colours(std::string text) {
  if (!colours_wanted(STDOUT_FILENO)) return text;
  const std::string shown = coloured(kMissed, Tone::error, STDOUT_FILENO);
  for (std::size_t at = 0; (at = text.find(kMissed, at)) != std::string::npos; at += shown.size())
    text.replace(at, kMissed.size(), shown);
  return text;
}

std::vector<std::string>& waiting_notes() {
  static std::vector<std::string> notes;
  return notes;
}

/// What was converted of foreign files, each once, files that were read alike together.
class Conversions {
 public:
  void add(const std::string& path, const std::string& read_as) {
    auto at = std::ranges::find(said_, read_as, &Said::read_as);
    if (at == said_.end()) at = said_.insert(said_.end(), Said{read_as, {}});
    if (std::ranges::find(at->paths, path) == at->paths.end()) at->paths.push_back(path);
  }
  std::vector<std::string> texts() const {
    std::vector<std::string> out;
    for (const Said& one : said_)
      out.push_back(fmt::format("{} read as {}", join(one.paths, ", "), one.read_as));
    return out;
  }

 private:
  struct Said {
    std::string read_as;
    std::vector<std::string> paths;
  };
  std::vector<Said> said_;
};

/// Said in the summary or, with --json, as notes.
Conversions& waiting_conversions() {
  static Conversions conversions;
  return conversions;
}

/// What is parsed as a whole number without sign would take -1 for 2^64 - 1.
void refuse_negative_counts(const CommandLine& line, const po::parsed_options& parsed) {
  for (const po::option& one : parsed.options) {
    const po::option_description* known = parsed.description->find_nothrow(one.string_key, false);
    if (known == nullptr ||
        dynamic_cast<const po::typed_value<std::uint64_t>*>(known->semantic().get()) == nullptr)
      continue;
    for (const std::string& text : one.value) {
      if (text.starts_with('-'))
        line.fail(fmt::format("--{} is {}, expected a whole number not below 0", one.string_key, text));
    }
  }
}

}  // namespace

struct CommandLine::Options {
  std::vector<po::options_description> groups;  ///< the subcommand's own, then those with a heading
  std::vector<std::string> captions;            ///< of the groups
  po::variables_map values;

  po::options_description shown() const {
    po::options_description all;
    for (const po::options_description& some : groups) all.add(some);
    return all;
  }
};

CommandLine::CommandLine(std::string name, std::string example, std::string what)
    : name_(std::move(name)),
      example_(std::move(example)),
      what_(std::move(what)),
      options_(std::make_unique<Options>()) {
  group("Options");
  flag("help,h", "show this text");
  flag("json", "print the summary as one JSON object");
  flag("quiet", "no summary (but that of --json), notes and progress: errors alone");
}

bool CommandLine::is_given(const std::string& option) const {
  return has_value(option) && !options_->values[option].defaulted();
}

bool CommandLine::has_value(const std::string& option) const {
  return options_->values.count(option) > 0;
}

template <class T>
const T& CommandLine::value(const std::string& option) const {
  return options_->values[option].as<T>();
}
template const int& CommandLine::value(const std::string&) const;
template const std::string& CommandLine::value(const std::string&) const;
template const std::uint64_t& CommandLine::value(const std::string&) const;
template const std::vector<std::string>& CommandLine::value(const std::string&) const;

template <class T>
void CommandLine::add(const std::string& name, const std::optional<T>& default_value,
                      const std::string& what) {
  auto* value = po::value<T>();
  if (default_value) value->default_value(*default_value);
  options_->groups.back().add_options()(name.c_str(), value, what.c_str());
}
template void CommandLine::add(const std::string&, const std::optional<int>&, const std::string&);
template void CommandLine::add(const std::string&, const std::optional<std::string>&, const std::string&);
template void CommandLine::add(const std::string&, const std::optional<std::uint64_t>&, const std::string&);

void CommandLine::add_quantity(const std::string& name, std::optional<double> default_value,
                               const std::string& what) {
  quantities_[name];
  add<std::string>(name, default_value ? std::optional(fmt::format("{}", *default_value)) : std::nullopt,
                   what);
}

void CommandLine::add_texts(const std::string& name, const std::string& what) {
  options_->groups.back().add_options()(name.c_str(), po::value<std::vector<std::string>>()->multitoken(),
                                        what.c_str());
}

void CommandLine::repeatable(const std::string& name, const std::string& what) {
  options_->groups.back().add_options()(name.c_str(), po::value<std::vector<std::string>>()->composing(),
                                        what.c_str());
}

void CommandLine::read_quantities() {
  for (auto& [name, numbers] : quantities_) {
    if (!has_value(name)) continue;
    const boost::any& given = options_->values[name].value();
    const auto* one = boost::any_cast<std::string>(&given);
    const std::vector<std::string> texts =
        one != nullptr ? std::vector{*one} : boost::any_cast<const std::vector<std::string>&>(given);
    for (const std::string& text : texts) {
      double value = 0.0;
      if (!parse_quantity(text, value))
        fail(fmt::format("--{} is '{}', expected a number such as 4700 or 4k7", name, text));
      numbers.push_back(value);
    }
  }
}

void CommandLine::flag(const std::string& name, const std::string& what) {
  options_->groups.back().add_options()(name.c_str(), what.c_str());
}

void CommandLine::group(const std::string& caption) {
  options_->captions.push_back(caption);
  options_->groups.emplace_back(caption, 100);
}

void CommandLine::positional(const std::string& name, int min, int max) {
  positional_name_ = name;
  min_files_ = min;
  max_files_ = max;
}

void CommandLine::refuse_group(const std::string& caption) const {
  for (std::size_t i = 0; i < options_->captions.size(); ++i) {
    if (options_->captions[i] != caption) continue;
    for (const auto& option : options_->groups[i].options()) {
      if (is_given(option->long_name()))
        fail(fmt::format("--{} is for another kind of work: '{}'", option->long_name(), caption));
    }
  }
}

CommandLine::~CommandLine() {
  ask_before_writing({});
}

void CommandLine::refuse_unread() const {
  static const std::set<std::string> kOfAllCommands = {"help", "json", "quiet", "output", "__files"};
  for (const auto& [name, value] : options_->values) {
    if (value.defaulted() || read_.count(name) > 0 || kOfAllCommands.count(name) > 0) continue;
    fail(fmt::format("--{} does nothing with what is asked for here", name));
  }
}

void CommandLine::reads_records() {
  reads_measurements();
  option<double>("sample-hz", "sampling rate of records without a column of times");
}

Provenance CommandLine::new_provenance() const {
  Provenance out;
  out.sample_hz = maybe_positive("sample-hz");
  return out;
}

void CommandLine::output(const std::string& what, bool optional) {
  output_needed_ = !optional;
  option<std::string>("output,o", what);
}

void CommandLine::seed() {
  option<std::uint64_t>("seed", "seed of the random numbers", 1);
}

void CommandLine::band(const std::string& from_what, const std::string& to_what) {
  option<double>("from-hz", from_what);
  option<double>("to-hz", to_what);
}

void CommandLine::show_help() const {
  std::ostringstream text;
  text << options_->shown();
  fmt::print("Example:\n  {}\n\n{}\n\nUsage: bodesmith {}{} [options]\n{}", example_, what_, name_,
             positional_name_.empty() ? "" : " " + positional_name_, text.str());
  if (reads_measurements_) fmt::print("\n{}", kMeasuredFormats);
}

CommandTable CommandLine::table() const {
  CommandTable out{name_, example_, what_, positional_name_, reads_measurements_, {}};
  for (std::size_t i = 0; i < options_->groups.size(); ++i) {
    for (const auto& option : options_->groups[i].options()) {
      OptionEntry entry;
      entry.name = option->long_name();
      // "-o [ --output ]" where there is a short name.
      if (const std::string both = option->format_name(); both[1] != '-') entry.letter = both.substr(1, 1);
      entry.group = options_->captions[i];
      entry.what = option->description();
      entry.takes_value = option->semantic()->max_tokens() > 0;
      entry.several = option->semantic()->max_tokens() > 1 || option->semantic()->is_composing();
      const std::string shown = option->format_parameter();  // "arg (=auto)"
      if (const auto at = shown.find("(="); at != std::string::npos)
        entry.default_text = shown.substr(at + 2, shown.size() - at - 3);
      if (const auto words = words_.find(entry.name); words != words_.end()) entry.words = words->second;
      out.options.push_back(std::move(entry));
    }
  }
  return out;
}

void CommandLine::fail_unknown(const std::string& given) const {
  std::vector<std::string> known;
  for (const OptionEntry& option : table().options) known.push_back(option.name);
  const std::string bare = given.substr(std::min(given.find_first_not_of('-'), given.size()));
  fail(fmt::format("unrecognised option '{}'{}", given, did_you_mean(bare, known, "--")));
}

bool CommandLine::parse(const std::vector<std::string>& arguments) {
  if (tables_wanted() != nullptr) {
    tables_wanted()->push_back(table());
    return false;
  }
  po::options_description all = options_->shown();
  all.add_options()("__files", po::value<std::vector<std::string>>());
  po::positional_options_description places;
  places.add("__files", -1);
  try {
    const int style = po::command_line_style::default_style & ~po::command_line_style::allow_guessing;
    const auto parsed = po::command_line_parser(arguments).options(all).positional(places).style(style).run();
    refuse_negative_counts(*this, parsed);
    for (const auto& option : parsed.options) {
      if (option.position_key >= 0 || !std::ranges::count(option.value, "")) continue;
      fail(option.string_key == "output" ? "-o is empty" : fmt::format("--{} is empty", option.string_key));
    }
    po::store(parsed, options_->values);
    if (has_value("help")) {
      show_help();
      return false;
    }
    po::notify(options_->values);
    read_quantities();
  } catch (const po::unknown_option& error) {
    fail_unknown(error.get_option_name());
  } catch (const po::error& error) {
    fail(error.what());
  }
  const int given = static_cast<int>(files().size());
  if (given < min_files_) fail(fmt::format("{} is missing", positional_name_));
  if (max_files_ >= 0 && given > max_files_) {
    fail(fmt::format("'{}' is one file too many", files()[static_cast<std::size_t>(max_files_)]));
  }
  if (output_needed_ && !has_value("output")) fail("-o is missing, expected where to write the result");
  if (quiet()) be_quiet();
  if (has_value("output")) {
    ask_before_writing([this, output = output_path().lexically_normal()](const std::filesystem::path& path) {
      const std::filesystem::path below = path.lexically_normal().lexically_relative(output);
      if (!below.empty() && *below.begin() != "..") refuse_unread();
    });
  }
  show_progress(name_);
  return true;
}

std::vector<std::string> CommandLine::files() const {
  if (!has_value("__files")) return {};
  return value<std::vector<std::string>>("__files");
}

double CommandLine::positive(const std::string& option) const {
  const double value = get<double>(option);
  if (!above_zero(value)) {
    fail(
        fmt::format("--{} is {}, expected a number above {}", option, value, value > 0.0 ? "2.3e-308" : "0"));
  }
  return value;
}

Hertz CommandLine::analog(const std::string& option, double given) const {
  if (!(given >= 1e-6 && given <= 1e9))
    fail(fmt::format("--{} is {}, expected 1e-6 to 1e9 Hz", option, given));
  return Hertz{given};
}

Hertz CommandLine::analog_frequency(const std::string& option) const {
  return analog(option, get<double>(option));
}

std::vector<Hertz> CommandLine::analog_frequencies(const std::string& option) const {
  std::vector<Hertz> out;
  for (const double f : all<double>(option)) out.push_back(analog(option, f));
  return out;
}

std::optional<double> CommandLine::maybe_positive(const std::string& option) const {
  if (!has_value(option)) return std::nullopt;
  return positive(option);
}

int CommandLine::integer(const std::string& option, int min, int max) const {
  const int value = get<int>(option);
  if (value < min || value > max) fail(fmt::format("--{} is {}, expected {} to {}", option, value, min, max));
  return value;
}

std::optional<Band> CommandLine::maybe_band() const {
  if (has("from-hz") != has("to-hz")) fail("--from-hz and --to-hz must be given together");
  if (!has("from-hz")) return std::nullopt;
  const Band band{Hertz{positive("from-hz")}, Hertz{positive("to-hz")}};
  if (!(band.from < band.to)) fail("--from-hz is not below --to-hz");
  return band;
}

void CommandLine::fail(const std::string& message) const {
  throw InputError(fmt::format("{}: {} (see bodesmith {} --help)", name_, message, name_));
}

void CommandLine::fail_choice(const std::string& option, const std::string& given,
                              const std::vector<std::string>& words) const {
  fail(fmt::format("--{} is '{}'{}, expected {}", option, given, did_you_mean(given, words),
                   join_alternatives(words)));
}

int print_summary(const CommandLine& line, const std::string& text, const Json& json, bool met) {
  line.refuse_unread();
  const int status = met ? kDone : kLimitMissed;
  if (line.json()) {
    show_notes();
    fmt::print("{}", to_text(json));
    return status;
  }
  Conversions conversions = std::exchange(waiting_conversions(), {});
  show_notes();
  if (line.quiet()) return status;
  fmt::print("{}", with_colours(folded_text(text)));
  for (const Json& input : json.value("inputs", Json::array())) {
    if (input.contains("read_as"))
      conversions.add(input["path"].get<std::string>(), input["read_as"].get<std::string>());
  }
  for (const std::string& one : conversions.texts()) fmt::print("{}\n", folded_text(one));
  return status;
}

void note(const std::string& text) {
  waiting_notes().push_back(text);
}

void show_notes() {
  hide_progress();
  for (const std::string& one : std::exchange(waiting_conversions(), {}).texts()) note(one);
  for (const std::string& text : std::exchange(waiting_notes(), {})) {
    if (quiet()) continue;
    const bool warning = text.starts_with(kWarning);
    const std::string folded =
        folded_text("bodesmith: " + text).substr(std::string_view("bodesmith: ").size());
    fmt::print(stderr, "bodesmith: {}\n", warning ? coloured(folded, Tone::warning, STDERR_FILENO) : folded);
  }
}

void warn_each(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) note(std::string(kWarning) + warning);
}

void note_conversions(const Provenance& from) {
  for (const InputFile& input : from.inputs) {
    if (!input.read_as.empty()) waiting_conversions().add(input.path, input.read_as);
  }
}

Json timed_document(std::string_view schema, const Provenance& from, const Json& body, double seconds) {
  note_conversions(from);
  return timed_json(schema, from, body, seconds);
}

std::string limit_not_met(double limit, std::string_view unit) {
  return fmt::format("the limit of {} {} is NOT met\n", rounded_text(limit), unit);
}

bool keeps_limit(std::optional<double> limit, double value, std::string_view unit, std::string& text,
                 Json& json) {
  if (!limit || value <= *limit) return true;
  text += limit_not_met(*limit, unit);
  json["limit_missed"] = true;
  return false;
}

std::string CommandTable::first_sentence() const {
  std::string out;
  for (const char c : what) {
    const bool ends = c == '.' || c == ';' || (c == ':' && out.size() > 20);
    if (ends) break;
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

std::vector<CommandTable>*& tables_wanted() {
  static std::vector<CommandTable>* wanted = nullptr;
  return wanted;
}

std::vector<CommandTable> command_tables() {
  std::vector<CommandTable> out;
  tables_wanted() = &out;
  for (const Command& command : commands()) {
    command.run({});
    for (const Command& verb : verbs_of(command.name)) verb.run({});
  }
  tables_wanted() = nullptr;
  return out;
}

}  // namespace bodesmith::cli
