// The same seed gives the same bytes, on one core and on all of them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "run_program.hpp"

namespace bodesmith {
namespace {

namespace fs = std::filesystem;

/// Every file below a folder, by name, without what tells the time.
std::string contents(const fs::path& folder) {
  static const std::regex timing(
      R"re("(timing_s|wall_s|ngspice_s|compute|seconds)": *(\{[^}]*\}|[-+.0-9e]+))re");
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::string out;
  for (const fs::path& file : files)
    out += fs::relative(file, folder).string() + "\n" + std::regex_replace(read_file(file), timing, "time") +
           "\n";
  return out;
}

void write_inputs(const fs::path& folder) {
  std::string curve = "frequency_hz,gain\n", record = "time_s,u,y\n";
  for (int i = 0; i < 150; ++i) {
    const double f = 20.0 * std::pow(1000.0, i / 149.0);
    curve += fmt::format("{:.9g},{:.9g}\n", f, 1.0 / std::sqrt(f) * (1.0 + 0.01 * std::sin(1e3 * i)));
  }
  for (int i = 0; i < 300; ++i)
    record += fmt::format("{:.3f},{:.9g},{:.9g}\n", 1e-3 * i, std::sin(0.05 * i),
                          0.9 * std::sin(0.05 * i) + 0.05 * std::pow(std::sin(0.05 * i), 2));
  write_file(folder / "curve.csv", curve);
  write_file(folder / "record.csv", record);
  write_file(
      folder / "sections.json",
      R"({"schema":"bodesmith.sections/1","gain":1,"sections":[{"gain":2,"zeros_rad_s":[[-30000,0]],)"
      R"("poles_rad_s":[[-10000,0]]},{"gain":1,"zeros_rad_s":[[-40000,0]],"poles_rad_s":[[-90000,0]]}]})");
  write_file(folder / "model.toml",
             "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"polynomial\"\ncoefficients = [0, 1, 0.2]\n"
             "[[block]]\ntype = \"lowpass\"\ncorner_hz = 40.0\n");
}

TEST(SameBytes, WhateverTheNumberOfCores) {
  if (run_shell("taskset -c 0 true").status != 0) GTEST_SKIP() << "taskset is not there";
  const TemporaryFolder folder;
  const std::string commands[] = {
      "fit curve.csv --direct --order 3 --seed 5 -o fit.json",
      "yield sections.json --samples 200 --seed 3 -o yield.json",
      "identify record.csv --model prandtl_ishlinskii -o model_out.toml",
      "simulate model.toml --input record.csv -o y.csv --spectra s.csv --loops l.csv",
      "bode sections.json --count 20000 -o bode.csv",
  };
  for (const std::string& command : commands) {
    std::string first;
    int run = 0;
    for (const std::string cores : {"", "taskset -c 0 "}) {
      const fs::path at = folder / std::to_string(run++);
      fs::remove_all(at);
      fs::create_directories(at);
      write_inputs(at);
      const ProgramResult result =
          run_shell(fmt::format("cd {} && {}{} {}", at.string(), cores, BODESMITH_PROGRAM, command));
      EXPECT_LE(result.status, 1) << command << result.err;
      if (cores.empty()) {
        first = contents(at);
      } else {
        EXPECT_EQ(first, contents(at)) << command;
      }
    }
  }
}

}  // namespace
}  // namespace bodesmith
