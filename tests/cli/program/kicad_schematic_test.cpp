#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>

#include "base/files.hpp"
#include "cli/dialect.hpp"
#include "cli/example_circuits.hpp"
#include "run_program.hpp"
#include "schematic/kicad_reader.hpp"

namespace bodesmith {
namespace {

/// compensator.sub with its stages written out, read by this test's own means.
KicadNetlist read_netlist(const std::string& path) {
  struct Line {
    std::vector<std::string> words;
  };
  std::map<std::string, std::vector<Line>> bodies;
  std::istringstream text(read_file(path));
  std::string line, inside;
  while (std::getline(text, line)) {
    std::istringstream words(line);
    Line one;
    for (std::string word; words >> word;) one.words.push_back(word);
    if (one.words.empty() || one.words[0][0] == '*') continue;
    if (one.words[0] == ".subckt") {
      inside = one.words[1];
    } else if (one.words[0] == ".ends") {
      inside.clear();
    } else if (!inside.empty()) {
      bodies[inside].push_back(one);
    }
  }
  KicadNetlist out;
  for (const Line& call : bodies.at("compensator")) {
    const std::string number = call.words[0].substr(1);
    const std::string body =
        call.words[3] == "compensator_stage" + number ? call.words[3] : std::string("missing");
    const auto node = [&](const std::string& local) {
      if (local == "0") return local;
      if (local == "in") return call.words[1];
      if (local == "out") return call.words[2];
      return "s" + number + "_" + local;
    };
    for (const Line& element : bodies.at(body)) {
      const std::string& name = element.words[0];
      KicadNetlist::Element one;
      if (name[0] == 'X') {
        one.nodes = {node(element.words[1]), node(element.words[2]), node(element.words[3])};
        out.opamps[name.substr(1)] = one;
      } else {
        one.nodes = {node(element.words[1]), node(element.words[2])};
        one.value = std::strtod(element.words[3].c_str(), nullptr);
        out.parts[name] = one;
      }
    }
  }
  return out;
}

/// The schematic joins exactly what the netlist joins, with the same parts and values.
KicadSchematic expect_same(const std::string& folder, double tolerance = 0.0) {
  const KicadNetlist netlist = read_netlist(folder + "/compensator.sub");
  KicadSchematic schematic = read_kicad(folder);
  expect_joined(schematic, netlist, read_references(folder + "/bom.csv"), tolerance);
  EXPECT_TRUE(std::filesystem::exists(folder + "/compensator.kicad_pro"));
  EXPECT_TRUE(std::filesystem::exists(folder + "/bodesmith.kicad_sym"));
  return schematic;
}

const char* const kTwoPoles = R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[
{"gain":2e6,"zeros_rad_s":[],"poles_rad_s":[[-400,900],[-400,-900]]},
{"gain":0.5,"zeros_rad_s":[[0,0],[0,0]],"poles_rad_s":[[-40,30],[-40,-30]]},
{"gain":900,"zeros_rad_s":[[0,0]],"poles_rad_s":[[-400,900],[-400,-900]]}]})";
// Sallen-Key with gains above 1; low-passes below 1; a high-pass below 1.
const char* const kLowHigh = R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[
{"gain":3e6,"zeros_rad_s":[],"poles_rad_s":[[-500,800],[-500,-800]]},
{"gain":2.5,"zeros_rad_s":[[0,0],[0,0]],"poles_rad_s":[[-30,30],[-30,-30]]}]})";
const char* const kLow = R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[
{"gain":4e5,"zeros_rad_s":[],"poles_rad_s":[[-400,900],[-400,-900]]},
{"gain":4e5,"zeros_rad_s":[],"poles_rad_s":[[-500,800],[-500,-800]]}]})";
const char* const kHigh = R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[
{"gain":0.5,"zeros_rad_s":[[0,0],[0,0]],"poles_rad_s":[[-40,30],[-40,-30]]}]})";
const char* const kSeed = R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[
{"gain":0.918,"zeros_rad_s":[[-48.79,0],[-14.8,0]],"poles_rad_s":[[-47.49,0],[-13.99,0]]},
{"gain":1.885,"zeros_rad_s":[[-107.6,0],[-63.68,0]],"poles_rad_s":[[-126.4,0],[-102.2,0]]},
{"gain":0.318,"zeros_rad_s":[[-380.2,0],[-221.6,0]],"poles_rad_s":[[-214.9,0],[-124.8,0]]},
{"gain":2.628,"zeros_rad_s":[[-400,0],[-365.6,0]],"poles_rad_s":[[-652.1,0],[-589.4,0]]}]})";
const char* const kMixed = R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[
{"gain":1.0,"zeros_rad_s":[[-40,90],[-40,-90]],"poles_rad_s":[[-20,97],[-20,-97]]},
{"gain":2.0,"zeros_rad_s":[[50,0]],"poles_rad_s":[[-300,0]]},
{"gain":300.0,"zeros_rad_s":[],"poles_rad_s":[[-300,0]]},
{"gain":1.5,"zeros_rad_s":[[0,0]],"poles_rad_s":[[-30,0]]},
{"gain":-1.0,"zeros_rad_s":[[300,0]],"poles_rad_s":[[-300,0]]}]})";

TEST(KicadSchematic, EveryRealizationIsTheNetlist) {
  const TemporaryFolder folder;
  write_file(folder / "two.json", kTwoPoles);
  write_file(folder / "lowhigh.json", kLowHigh);
  write_file(folder / "low.json", kLow);
  write_file(folder / "high.json", kHigh);
  write_file(folder / "seed.json", kSeed);
  write_file(folder / "mixed.json", kMixed);
  for (const std::string arguments :
       {"mixed.json --series E24", "mixed.json --realization khn", "two.json --realization khn",
        "two.json --realization tow-thomas --opamp TL072", "two.json --realization multiple-feedback",
        "lowhigh.json --realization sallen-key --opamp NE5532", "low.json --realization sallen-key",
        "high.json --realization sallen-key", "lowhigh.json --realization multiple-feedback", "seed.json",
        "seed.json --realization foster1", "seed.json --realization foster2",
        "seed.json --realization cauer1", "seed.json --realization cauer2 --opamp OPA2134"}) {
    SCOPED_TRACE(arguments);
    const ProgramResult run = run_shell("cd '" + (folder / "").string() + "' && " + BODESMITH_PROGRAM +
                                        " spice " + arguments + " --allow-shortfall -o made");
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(expect_same((folder / "made").string()).sheets, 1);
  }
}

/// The schematic joins what the netlist joins, and every simulator reads its deck.
TEST(KicadSchematic, EveryExampleIsTheNetlistAndItsDecksAreReadAlike) {
  const TemporaryFolder folder;
  for (const ExampleCircuit& example : example_circuits()) {
    const std::string sections = example_sections(example, folder);
    for (const std::string options : {" --series exact --opamp ideal", " --opamp TL072"}) {
      // Preferred values and a real op-amp do the same to every example: one with many stages and one with few.
      if (options == " --opamp TL072" && example.name != "nanopositioner" && example.name != "riaa") continue;
      SCOPED_TRACE(example.name + options);
      const std::filesystem::path made = folder / "made";
      std::filesystem::remove_all(made);
      const ProgramResult run =
          run_bodesmith("spice " + sections + example.limits + options + " -o " + made.string());
      ASSERT_EQ(run.status, 0) << run.err;
      expect_same(made.string(), options.find("exact") != std::string::npos ? 1e-5 : 0.0);
      EXPECT_THAT(library_errors(made / "compensator.sub"), testing::IsEmpty());
      int decks = 0;
      for (const auto& file : std::filesystem::directory_iterator(made)) {
        if (file.path().extension() != ".cir") continue;
        ++decks;
        const std::string name = file.path().filename().string();
        const Dialect dialect = name.starts_with("ltspice") ? Dialect::ltspice
                                : name.starts_with("xyce")  ? Dialect::xyce
                                                            : Dialect::ngspice;
        EXPECT_THAT(dialect_errors(file.path(), dialect), testing::IsEmpty()) << name;
      }
      EXPECT_EQ(decks, 7);
    }
  }
}

TEST(KicadSchematic, ManyStagesGoOnSheetsOfTheirOwn) {
  const TemporaryFolder folder;
  std::string text = R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[)";
  for (int i = 0; i < 40; ++i) {
    const double pole = 10.0 * std::pow(1.2, i);
    text += (i > 0 ? "," : "") + std::string(R"({"gain":1.0,"zeros_rad_s":[[)") +
            std::to_string(-pole * 1.1) + R"(,0]],"poles_rad_s":[[)" + std::to_string(-pole) + ",0]]}";
  }
  write_file(folder / "many.json", text + "]}");
  const std::string out = (folder / "made").string();
  const ProgramResult run =
      run_bodesmith("spice " + (folder / "many.json").string() + " --opamp TL072 -o " + out);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_GT(expect_same(out).sheets, 2);
}

TEST(KicadSchematic, SameCircuitSameBytes) {
  const TemporaryFolder folder;
  write_file(folder / "mixed.json", kMixed);
  const std::string sections = (folder / "mixed.json").string();
  for (const char* out : {"a", "b"})
    ASSERT_EQ(run_bodesmith("spice " + sections + " -o " + (folder / out).string()).status, 0);
  EXPECT_EQ(read_file(folder / "a" / "compensator.kicad_sch"),
            read_file(folder / "b" / "compensator.kicad_sch"));
}

// The reader itself must see a wire that is not there and one too many.
TEST(KicadSchematic, ReaderSeesABrokenWire) {
  const TemporaryFolder folder;
  write_file(folder / "mixed.json", kMixed);
  const std::string out = (folder / "made").string();
  ASSERT_EQ(run_bodesmith("spice " + (folder / "mixed.json").string() + " -o " + out).status, 0);
  const KicadSchematic whole = read_kicad(out);
  const std::string text = read_file(folder / "made" / "compensator.kicad_sch");
  const size_t at = text.find("  (wire ");
  std::string cut = text;
  cut.erase(at, cut.find('\n', at) - at);
  write_file(folder / "made" / "compensator.kicad_sch", cut);
  EXPECT_GT(read_kicad(out).dangling_ends, whole.dangling_ends);
}

}  // namespace
}  // namespace bodesmith
