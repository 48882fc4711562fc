#include "cli/command_line.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <sstream>

#include "base/error.hpp"
#include "base/json.hpp"

namespace po = boost::program_options;

namespace bodesmith::cli {

CommandLine::CommandLine(std::string name, std::string example, std::string what)
    : name_(std::move(name)), example_(std::move(example)), what_(std::move(what)), options_("Options", 100) {
  options_.add_options()("help,h", "show this text")("json", "print the summary as one JSON object");
}

void CommandLine::positional(const std::string& name, int least, int most) {
  positional_name_ = name;
  least_ = least;
  most_ = most;
}

void CommandLine::output(const std::string& what, bool optional) {
  output_needed_ = !optional;
  options_.add_options()("output,o", po::value<std::string>(), what.c_str());
}

void CommandLine::seed() {
  options_.add_options()("seed", po::value<std::uint64_t>()->default_value(1),
                         "seed of everything left to chance");
}

bool CommandLine::parse(const std::vector<std::string>& arguments) {
  po::options_description all;
  all.add(options_);
  all.add_options()("__files", po::value<std::vector<std::string>>());
  po::positional_options_description places;
  places.add("__files", -1);
  try {
    const int style = po::command_line_style::default_style & ~po::command_line_style::allow_guessing;
    po::store(po::command_line_parser(arguments).options(all).positional(places).style(style).run(), values_);
    if (values_.count("help") > 0) {
      std::ostringstream text;
      text << options_;
      fmt::print("Example:\n  {}\n\n{}\n\nUsage: bodesmith {}{} [options]\n{}", example_, what_, name_,
                 positional_name_.empty() ? "" : " " + positional_name_, text.str());
      return false;
    }
    po::notify(values_);
  } catch (const po::error& error) {
    fail(error.what());
  }
  const int given = static_cast<int>(files().size());
  if (given < least_) fail(fmt::format("{} is missing", positional_name_));
  if (most_ >= 0 && given > most_)
    fail(fmt::format("'{}' is one file too many", files()[static_cast<size_t>(most_)]));
  if (output_needed_ && values_.count("output") == 0) fail("-o is missing, expected where the result goes");
  if (values_.count("output") > 0 && get<std::string>("output").empty()) fail("-o is empty");
  return true;
}

std::vector<std::string> CommandLine::files() const {
  if (values_.count("__files") == 0) return {};
  return values_["__files"].as<std::vector<std::string>>();
}

double CommandLine::positive(const std::string& option) const {
  const double value = get<double>(option);
  if (!(value > 0.0) || !std::isfinite(value)) {
    fail(fmt::format("--{} is {}, expected a number above 0", option, value));
  }
  return value;
}

void CommandLine::fail(const std::string& message) const {
  throw InputError(fmt::format("{}: {} (see bodesmith {} --help)", name_, message, name_));
}

void print_summary(const CommandLine& line, const std::string& text, const Json& json) {
  if (line.json()) {
    fmt::print("{}", to_text(json));
  } else {
    fmt::print("{}", text);
  }
}

void note(const std::string& text) {
  fmt::print(stderr, "bodesmith: {}\n", text);
}

}  // namespace bodesmith::cli
