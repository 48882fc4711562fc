// Projects without a disturbance that say something wrong: one line that names file and line, exit 2, nothing left.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>

#include "base/documents/document.hpp"
#include "base/files.hpp"
#include "run_program.hpp"
#include "schematic/ngspice/ngspice.hpp"

namespace bodesmith {
namespace {

struct BadProject {
  const char* what;
  const char* text;  ///< after the line of the schema
  const char* said;
};

const BadProject kBad[] = {
    {"a family", "[target]\nfamily = \"elliptic\"\ncorner_hz = 1000",
     "p.toml:3: 'target.family' is not known here"},
    {"no target", "[hardware.circuit]", "p.toml: 'target' is missing"},
    {"two targets", "[target]\npoints = \"c.csv\"\nsections = \"s.json\"",
     "p.toml:2: 'target' expected one of points"},
    {"one edge", "[target]\npoints = \"c.csv\"\nfrom_hz = 20", "p.toml:2: 'target' has one end of a band"},
    {"edges the wrong way round", "[target]\npoints = \"c.csv\"\nfrom_hz = 2000\nto_hz = 20",
     "p.toml:5: 'target.to_hz' is not above from_hz"},
    {"a negative edge", "[target]\npoints = \"c.csv\"\nfrom_hz = -20\nto_hz = 20",
     "p.toml:4: 'target.from_hz' is -20, expected a number above 0"},
    {"an edge in words", "[target]\npoints = \"c.csv\"\nfrom_hz = \"twenty\"\nto_hz = 2000",
     "p.toml:4: 'target.from_hz' is a string"},
    {"a fraction without a band", "[target]\nfractional = \"f.toml\"",
     "p.toml:3: 'target.fractional' needs from_hz"},
    {"no such file", "[target]\npoints = \"n.csv\"", "p.toml:3: 'target.points' names"},
    {"a folder", "[target]\npoints = \".\"", "p.toml:3: 'target.points' names"},
    {"a method", "[target]\npoints = \"c.csv\"\n[fit]\nmethod = \"butterworth\"",
     "p.toml:5: 'fit.method' is \"butterworth\", expected one of: automatic"},
    {"order 0", "[target]\npoints = \"c.csv\"\n[fit]\norder = 0", "p.toml:5: 'fit.order' is 0"},
    {"order 1.5", "[target]\npoints = \"c.csv\"\n[fit]\norder = 1.5", "p.toml:5: 'fit.order' is 1.5"},
    {"more zeros away than poles", "[target]\npoints = \"c.csv\"\n[fit]\norder = 2\nrelative_degree = 3",
     "p.toml:6: 'fit.relative_degree' is 3, expected a whole number from 0 to 2"},
    {"a corner at 0", "[target]\npoints = \"c.csv\"\n[fit]\nmax_corner_hz = 0",
     "p.toml:5: 'fit.max_corner_hz' is 0"},
    {"an endless corner", "[target]\npoints = \"c.csv\"\n[fit]\nmax_corner_hz = inf",
     "p.toml:5: 'fit.max_corner_hz' is not finite"},
    {"a misspelt table", "[target]\npoints = \"c.csv\"\n[hardwear.circuit]",
     "p.toml:4: 'hardwear' is not known here"},
    {"a misspelt key", "[target]\npoints = \"c.csv\"\n[hardware.circuit]\nresistor = \"E96\"",
     "p.toml:5: 'hardware.circuit.resistor' is not known here"},
    {"a series", "[target]\npoints = \"c.csv\"\n[hardware.circuit]\nresistors = \"E97\"",
     "p.toml:5: 'hardware.circuit.resistors' cannot be taken: 'E97'"},
    {"a form", "[target]\npoints = \"c.csv\"\n[hardware.circuit]\nrealization = \"leapfrog\"",
     "p.toml:5: 'hardware.circuit.realization' cannot be taken: there is no realization 'leapfrog'"},
    {"a board", "[target]\npoints = \"c.csv\"\n[hardware.fpaa]\nboard = \"breadboard\"",
     "p.toml:5: 'hardware.fpaa.board' cannot be taken:"},
    {"a clock", "[target]\npoints = \"c.csv\"\n[hardware.fpaa]\nclock_hz = -1",
     "p.toml:5: 'hardware.fpaa.clock_hz' is -1"},
    {"an approximation", "[target]\npoints = \"c.csv\"\n[approximate]\nmethod = \"magic\"",
     "p.toml:5: 'approximate.method' cannot be taken:"},
    {"a tolerance", "[target]\npoints = \"c.csv\"\n[tolerances]\nresistor_percent = 100",
     "p.toml:5: 'tolerances.resistor_percent' is 100, expected less than 100"},
    {"a limit", "[target]\npoints = \"c.csv\"\n[limits]\npoints_db = -1",
     "p.toml:5: 'limits.points_db' is -1"},
    {"tracking", "[target]\npoints = \"c.csv\"\n[track]\nfrequency_hz = [1]",
     "p.toml:2: 'target.disturbance' is missing"},
    {"text for a table", "target = \"c.csv\"", "p.toml:2: 'target' is a string"},
    {"no TOML", "[target\npoints = \"c.csv\"", "p.toml:2: not valid TOML"},
};

TEST(FilterProject, BadOnesAreOneLineAndLeaveNothing) {
  const TemporaryFolder folder;
  write_file(folder / "c.csv", "frequency_hz,gain\n10,1\n100,0.9\n1000,0.5\n");
  write_file(folder / "s.json", R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[
    {"gain":1.0,"zeros_rad_s":[[-2000,0]],"poles_rad_s":[[-1000,0]]}]})");
  write_file(folder / "f.toml", R"(schema = "bodesmith.fractional/1"
[[numerator]]
coefficient = 1.0
power = 0.0
[[denominator]]
coefficient = 1.0
power = 0.5
)");
  for (const BadProject& one : kBad) {
    SCOPED_TRACE(one.what);
    write_file(folder / "p.toml", "schema = \"bodesmith.project/1\"\n" + std::string(one.text) + "\n");
    const ProgramResult run =
        run_shell("cd '" + folder.path().string() + "' && '" + BODESMITH_PROGRAM + "' run p.toml -o out");
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_NE(run.err.find(one.said), std::string::npos) << run.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  }
}

TEST(FilterProject, APlanThatIsMissingIsALimitThatIsNotMet) {
  const TemporaryFolder folder;
  write_file(folder / "s.json",
             R"({"schema": "bodesmith.sections/1", "gain": 1,
                 "sections": [{"gain": 1000, "zeros_rad_s": [], "poles_rad_s": [[0, 0]]}]})");
  write_file(folder / "p.toml",
             "schema = \"bodesmith.project/1\"\n[target]\nsections = \"s.json\"\nfrom_hz = 10\nto_hz = 1000\n"
             "[hardware.fpaa]\n[limits]\nfpaa_percent = 1\n");
  const ProgramResult result =
      run_bodesmith("run " + (folder / "p.toml").string() + " -o " + (folder / "out").string());
  EXPECT_EQ(result.status, 1) << result.err;
  EXPECT_NE(result.out.find("fpaa_percent 1: not made NOT met"), std::string::npos) << result.out;
  const Node run = parse_json(read_file(folder / "out/run.json"), "run.json");
  EXPECT_EQ(run.at("limits").items().front().at("got").kind(), Node::Kind::null);
}

// The model of what was built, and a built circuit with one capacitor off as ngspice measures it.
TEST(FilterProject, ItsModelNamesThePartThatIsOff) {
  if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed: nothing to measure with";
  const TemporaryFolder folder;
  write_file(folder / "s.json",
             R"({"schema": "bodesmith.sections/1", "gain": 1, "sections": [
                 {"gain": 3.9478e7, "zeros_rad_s": [], "poles_rad_s": [[-3927, 4905], [-3927, -4905]]},
                 {"gain": 2, "zeros_rad_s": [[-2000, 0]], "poles_rad_s": [[-9000, 0]]}]})");
  write_file(
      folder / "p.toml",
      "schema = \"bodesmith.project/1\"\n[target]\nsections = \"s.json\"\nfrom_hz = 50\nto_hz = 10000\n"
      "[hardware.circuit]\n");
  const auto run = [&](const std::string& words) {
    const ProgramResult done =
        run_shell("cd '" + folder.path().string() + "' && '" + BODESMITH_PROGRAM + "' " + words);
    EXPECT_EQ(done.status, 0) << words << "\n" << done.err;
  };
  run("run p.toml -o out");
  const Node circuit = parse_json(read_file(folder / "out/spice/circuit.json"), "circuit.json");
  for (const Node& stage : circuit.at("stages").items()) {
    bool tried = false;  // one of each stage
    for (const Node& part : stage.at("parts").items()) {
      if (!part.has("realised_f") || std::exchange(tried, true)) continue;
      const std::string name = part.at("part").string();
      SCOPED_TRACE(name);
      // Its line of the netlist: "C1_2 a b 1e-09".
      std::string netlist = read_file(folder / "out/spice/compensator.sub");
      const std::size_t at = netlist.rfind(' ', netlist.find('\n', netlist.find("\n" + name + " ") + 1)) + 1;
      netlist.replace(at, netlist.find('\n', at) - at,
                      std::to_string(1.12e9 * part.at("realised_f").number()) + "n");
      write_file(folder / "faulty.sub", netlist);
      run("bode faulty.sub --from-hz 50 --to-hz 10000 --count 60 -o measured.csv");
      std::string table = read_file(folder / "measured.csv");
      table.replace(0, table.find('\n'), "frequency_hz,magnitude_db,phase_deg");
      write_file(folder / "measured.csv", table);
      run("diagnose out/model.toml --data measured.csv -o gap");
      const Node found = parse_json(read_file(folder / "gap/diagnosis.json"), "diagnosis.json");
      ASSERT_EQ(found.at("steps").size(), 1u);
      const Node step = found.at("steps")[0];
      EXPECT_EQ(step.at("effect").string(), "capacitor_mismatch");
      EXPECT_EQ(step.at("placed").string().find(name + " "), 0u) << step.at("placed").string();
      EXPECT_NEAR(step.at("parameters").at("off_percent").at("value").number(), 12.0, 0.5);
    }
  }
}

}  // namespace
}  // namespace bodesmith
