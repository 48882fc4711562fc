#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "base/files.hpp"
#include "cli/example_circuits.hpp"
#include "run_program.hpp"
#include "schematic/kicad_reader.hpp"

/// The sheets as KiCad itself understands them, where `kicad-cli` (KiCad 7 and later) is installed: it must find the
/// nets that this house's reader finds, which the other tests compare with the netlists, and no electrical error.
namespace bodesmith {
namespace {

using Pin = std::pair<std::string, std::string>;
using Nets = std::set<std::set<Pin>>;

bool kicad_is_here() {
  return run_shell("kicad-cli version").status == 0;
}

/// Text between the next pair of quotation marks; moves behind it.
std::string next_quoted(const std::string& text, std::size_t& at) {
  const std::size_t from = text.find('"', at) + 1;
  const std::size_t to = text.find('"', from);
  at = to + 1;
  return text.substr(from, to - from);
}

/// Nets of a netlist in KiCad's own format; those of a single pin are left out.
Nets exported_nets(const std::string& text) {
  Nets out;
  std::set<Pin> net;
  const auto close = [&] {
    if (net.size() > 1) out.insert(net);
    net.clear();
  };
  for (std::size_t at = text.find("(nets"); at != std::string::npos;) {
    const std::size_t next_net = text.find("(net ", at), node = text.find("(node ", at);
    if (node == std::string::npos) break;
    if (next_net < node) {
      close();
      at = next_net + 5;
      continue;
    }
    at = text.find("(ref ", node);
    const std::string reference = next_quoted(text, at);
    at = text.find("(pin ", at);
    const std::string pin = next_quoted(text, at);
    if (reference[0] != '#') net.insert({reference, pin});
  }
  close();
  return out;
}

Nets read_nets(const KicadSchematic& schematic) {
  std::map<int, std::set<Pin>> nets;
  for (const auto& [reference, component] : schematic.components) {
    for (const auto& [pin, net] : component.pin_nets) nets[net].insert({reference, pin});
  }
  Nets out;
  for (const auto& [number, net] : nets) {
    if (net.size() > 1) out.insert(net);
  }
  return out;
}

/// KiCad's nets and values of `stem`.kicad_sch are this reader's, and its rule checker has no error.
void expect_kicad_agrees(const TemporaryFolder& folder, const std::string& made, const std::string& stem) {
  const std::string sheet = made + "/" + stem + ".kicad_sch", out = (folder / "out").string();
  const std::string program = "KICAD_CONFIG_HOME='" + (folder / "settings").string() + "' HOME='" +
                              folder.path().string() + "' kicad-cli sch ";
  const ProgramResult exported = run_shell(program + "export netlist -o '" + out + ".net' '" + sheet + "'");
  ASSERT_EQ(exported.status, 0) << exported.err;
  const KicadSchematic ours = read_kicad(made, stem + ".kicad_sch");
  const std::string netlist = read_file(out + ".net");
  EXPECT_EQ(exported_nets(netlist), read_nets(ours));
  for (const auto& [reference, component] : ours.components) {
    const std::size_t at = netlist.find("(comp (ref \"" + reference + "\")");
    ASSERT_NE(at, std::string::npos) << reference;
    std::size_t value = netlist.find("(value ", at);
    EXPECT_EQ(next_quoted(netlist, value), component.value) << reference;
  }
  const ProgramResult rules =
      run_shell(program + "erc --severity-error --exit-code-violations -o '" + out + ".erc' '" + sheet + "'");
  EXPECT_EQ(rules.status, 0) << read_file(out + ".erc");
}

TEST(KicadProgram, FindsTheNetsOfTheCompensators) {
  if (!kicad_is_here()) GTEST_SKIP() << "kicad-cli is not installed";
  const TemporaryFolder folder;
  const std::string made = (folder / "made").string();
  auto examples = example_circuits();
  examples.resize(std::min<std::size_t>(examples.size(), 4));  // an example takes KiCad a second
  for (const ExampleCircuit& example : examples) {
    SCOPED_TRACE(example.name);
    const std::string sections = example_sections(example, folder);
    ASSERT_EQ(run_bodesmith("spice " + sections + example.limits + " --opamp TL072 -o " + made).status, 0);
    expect_kicad_agrees(folder, made, "compensator");
    std::filesystem::remove_all(made);
  }
}

TEST(KicadProgram, FindsTheNetsOfSeveralSheets) {
  if (!kicad_is_here()) GTEST_SKIP() << "kicad-cli is not installed";
  const TemporaryFolder folder;
  std::string text = R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[)";
  for (int i = 0; i < 40; ++i) {
    const double pole = 10.0 * std::pow(1.2, i);
    text += (i > 0 ? "," : "") + std::string(R"({"gain":1.0,"zeros_rad_s":[[)") +
            std::to_string(-pole * 1.1) + R"(,0]],"poles_rad_s":[[)" + std::to_string(-pole) + ",0]]}";
  }
  write_file(folder / "many.json", text + "]}");
  const std::string made = (folder / "made").string();
  ASSERT_EQ(run_bodesmith("spice " + (folder / "many.json").string() + " -o " + made).status, 0);
  expect_kicad_agrees(folder, made, "compensator");
}

TEST(KicadProgram, FindsTheNetsOfTheController) {
  if (!kicad_is_here()) GTEST_SKIP() << "kicad-cli is not installed";
  const TemporaryFolder folder;
  const std::string made = (folder / "made").string();
  write_file(folder / "disturbance.json", R"({"schema": "bodesmith.disturbance/1",
    "ascending": [0.3546, -0.6433, 0.2887], "descending": [-0.2398, 0.0838, 0.156],
    "rate": {"frequency_hz": [1, 10, 100], "ascending": [1, 0.8, 1.1], "descending": [1, 1.1, 1.17]}})");
  ASSERT_EQ(run_bodesmith("controller " + (folder / "disturbance.json").string() +
                          " --track-hz 50 --allow-unstable -o " + made)
                .status,
            0);
  expect_kicad_agrees(folder, made, "controller");
}

}  // namespace
}  // namespace bodesmith
