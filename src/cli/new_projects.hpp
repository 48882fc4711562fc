#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "cli/command_line.hpp"

namespace bodesmith::cli {

/// A project to begin with: its files, and what a person is told of it.
struct NewProject {
  std::string about;
  std::string command;
  std::vector<std::string> schemas;
  struct File {
    std::string name;
    std::string what;
    std::string text;
  };
  std::vector<File> files;
  std::vector<std::string> next;
};

/// Flags, or a few questions where there are none and a person sits at a terminal.
class Answers {
 public:
  explicit Answers(const CommandLine& line);

  bool asks() const { return asks_; }
  std::string text(const std::string& option, const std::string& question) const;
  /// Above 0.
  double number(const std::string& option, const std::string& question) const;

 private:
  const CommandLine& line_;
  bool asks_;
};

/// A kind of project that `new` writes.
struct NewKind {
  std::string name;
  std::string what;
  NewProject (*make)(const CommandLine& line, const Answers& answers, Json& data);
};

/// All of them; one function a kind, in new_projects.cpp.
const std::vector<NewKind>& new_kinds();

/// A measured time record for an example: what a stage with a lag answers to three sines (frequencies in Hz), with noise.
std::string example_record(const std::array<double, 3>& frequencies, std::uint64_t seed);

}  // namespace bodesmith::cli
