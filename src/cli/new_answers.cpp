#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/quantity.hpp"
#include "base/terminal.hpp"
#include "base/text.hpp"
#include "cli/new_projects.hpp"

namespace bodesmith::cli {
namespace {

std::string answer_to(const std::string& question, const std::string& standard) {
  hide_progress();
  fmt::print("{} [{}]: ", question, standard);
  std::fflush(stdout);
  std::string out;
  if (!std::getline(std::cin, out)) throw InputError("no answer, expected one line");
  return std::string(trim(out));
}

}  // namespace

Answers::Answers(const CommandLine& line)
    : line_(line), asks_(!line.has("kind") && on_terminal(STDIN_FILENO) && on_terminal(STDOUT_FILENO)) {}

std::string Answers::text(const std::string& option, const std::string& question) const {
  const std::string standard = line_.maybe<std::string>(option).value_or("");
  if (!asks_ || line_.has(option)) return standard;
  const std::string given = answer_to(question, standard);
  return given.empty() ? standard : given;
}

double Answers::number(const std::string& option, const std::string& question) const {
  const double standard = line_.positive(option);
  if (!asks_ || line_.has(option)) return standard;
  const std::string given = answer_to(question, rounded_text(standard));
  double value = standard;
  if (!given.empty() && (!parse_quantity(given, value) || !(value > 0.0)))
    line_.fail(fmt::format("'{}' is no number above 0", given));
  return value;
}

}  // namespace bodesmith::cli
