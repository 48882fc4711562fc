// Records and responses of hardware that is known exactly: what is said of them has a closed form.
#include "measured/measured.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <set>

#include "base/documents/json.hpp"
#include "chain/model_file.hpp"
#include "chain/registry.hpp"
#include "lti/frequency_grid.hpp"
#include "numeric/random.hpp"
#include "schematic/analysis/response.hpp"
#include "schematic/writers/spice_library.hpp"
#include "signal/csv.hpp"
#include "simulate/record/record_simulator.hpp"
#include "synthesis/circuit_file.hpp"
#include "synthesis/realise.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::measured {
namespace {

using chain::Block;
using chain::Chain;
using chain::PartChange;

/// A controller whose gain of 1 two resistors set, and whose square (0) a third; a stage of 2 m to a full stroke without a loop.
Chain straight_chain() {
  Block controller = chain::make_block("polynomial");
  controller.set("coefficients", std::vector<double>{0.0, 1.0, 0.0});
  controller.parts = std::make_shared<const std::vector<PartChange>>(
      std::vector<PartChange>{{"R1", "percent", 0.1, {{"coefficients[1]", 0.01, 0.0}}},
                              {"R2", "percent", 0.1, {{"coefficients[1]", -0.01, 0.01}}},
                              {"R3", "percent", 0.1, {{"coefficients[2]", 0.01, 0.0}}}});
  Block stage = chain::make_block("polynomial_hysteresis");
  stage.part = "stage";
  stage.set("ascending", std::vector<double>{0.1, -0.1, 0.0})
      .set("descending", std::vector<double>{0.2, -0.2, 0.0});
  Block stroke = chain::make_block("gain");
  stroke.part = "stroke_m";
  stroke.set("gain", 2.0);
  Chain out;
  out.blocks = {controller, stage, stroke};
  return out;
}

constexpr double kNoise = 2e-5;

/// Two periods of a triangle at 100 Hz through a chain, with noise.
void write_record(const std::filesystem::path& file, const Chain& chain) {
  constexpr int kPeriod = 200;
  TimeRecord record;
  record.step_s = 1.0 / (100.0 * kPeriod);
  for (int i = 0; i <= 2 * kPeriod; ++i)
    record.u.push_back(1.0 - std::abs(1.0 - 2.0 * (i % kPeriod) / static_cast<double>(kPeriod)));
  record.y = simulate::RecordSimulator(chain, record.step_s).run_once(record.u);
  Random random(5);
  CsvWriter csv;
  std::vector<double> time;
  for (std::size_t i = 0; i < record.size(); ++i) {
    time.push_back(record.time_s(i));
    record.y[i] += kNoise * random.normal();
  }
  csv.add("time_s", time);
  csv.add("u", record.u);
  csv.add("y", record.y);
  write_file(file, csv.text());
}

/// What `run` would have left, and one measurement of it.
class MeasuredRecord : public testing::Test {
 protected:
  MeasuredRecord() : designed_(straight_chain()) {
    write_file(folder_ / "model.toml", chain::model_text(designed_));
    Chain stage;
    stage.blocks = {designed_.blocks.begin() + 1, designed_.blocks.end()};
    write_file(folder_ / "stage.toml", chain::model_text(stage));
  }
  Measured of(const Chain& built) {
    write_record(folder_ / "record.csv", built);
    return measured_record(project::ProjectSource{{}, parse_toml("", "project.toml"), {}},
                           folder_ / "record.csv", folder_.path(), options_, files_, next_);
  }
  Chain with_part(std::size_t part, double departure) const {
    Chain out = designed_;
    out.blocks[0] = designed_.blocks[0].with((*designed_.blocks[0].parts)[part], departure);
    return out;
  }

  TemporaryFolder folder_;
  Chain designed_;
  gap::SearchOptions options_;
  OutputSet files_, next_;
};

TEST_F(MeasuredRecord, OfWhatWasDesignedAccusesNothing) {
  const Measured out = of(designed_);
  EXPECT_EQ(out.of, "the controller and the stage");
  EXPECT_EQ(out.verdict, "nothing_missing");
  EXPECT_FALSE(out.wrong());
  EXPECT_EQ(out.advice, "");
  // The range is two metres.
  EXPECT_NEAR(out.gap_percent, 100.0 * kNoise / 2.0, 1e-4);
  EXPECT_NEAR(out.noise_percent, out.gap_percent, 2e-4);
  EXPECT_TRUE(next_.paths().empty());
  EXPECT_NE(out.summary("x").find("nothing is wrong"), std::string::npos);
  EXPECT_TRUE(out.json()["next"].is_null());
}

TEST_F(MeasuredRecord, OfPartsWithinTheirTolerancesAccusesNone) {
  const Measured out = of(with_part(2, 0.1));
  EXPECT_EQ(out.verdict, "nothing_missing");
  EXPECT_EQ(out.advice, "Parts within their tolerances make as much of a difference.");
  EXPECT_GT(out.gap_percent, 3.0 * out.noise_percent);
}

TEST_F(MeasuredRecord, NamesThePartWhoseCurveItIsAndForetellsItsExchange) {
  const Measured out = of(with_part(2, 8.0));
  ASSERT_EQ(out.found.size(), 1u);
  EXPECT_TRUE(out.found[0].starts_with("R3 is 8 % above its value (probability ")) << out.found[0];
  EXPECT_TRUE(out.tied.empty());
  ASSERT_EQ(out.next.size(), 2u);
  EXPECT_EQ(out.next[0], "exchange R3");
  EXPECT_EQ(out.next_name, "tracking_percent");
  // Loop of the stage alone: ±.05 (x - x^2) about a curve of .15; with the part a square of .08 above it.
  EXPECT_NEAR(out.after_percent, 100.0 * 0.15 * std::sqrt(1.0 / 30.0), 0.3);
  EXPECT_GT(out.before_percent, out.after_percent);
  EXPECT_NEAR(out.left_percent, out.noise_percent, 0.1 * out.noise_percent);
  const Node table = parse_json(to_text(out.json()), "measured.json");
  EXPECT_EQ(table.at("next").at("tracking_percent").at("predicted").number(), out.after_percent);
  EXPECT_EQ(next_.paths(), (std::vector<std::filesystem::path>{"as_built.toml", "gap.svg"}));
  EXPECT_NE(out.summary("x").find("next       exchange R3\n"), std::string::npos);
  // The model as built is the record's.
  const Node built = parse_toml(*next_.content("as_built.toml"), "as_built.toml");
  const Chain chain = chain::model_from_node(built);
  EXPECT_NEAR(chain.blocks[0].list("coefficients")[2], 0.08, 1e-3);
}

TEST_F(MeasuredRecord, WhereTwoPartsDoTheSameItIsOneOfThem) {
  const Measured out = of(with_part(0, 8.0));
  ASSERT_EQ(out.found.size(), 1u);
  // -.01 t/(1 + .01 t) = .08
  EXPECT_NE(out.found[0].find("R1 is 8 % above its value"), std::string::npos) << out.found[0];
  EXPECT_NE(out.found[0].find("R2 is 7.4 % below its value"), std::string::npos) << out.found[0];
  EXPECT_EQ(out.tied.size(), 2u);
  EXPECT_NE(out.advice.find("No record of this shape tells those apart"), std::string::npos);
  EXPECT_TRUE(out.next[0].starts_with("exchange, or identify anew, whichever it is of R")) << out.next[0];
}

TEST_F(MeasuredRecord, OfAnotherStageNamesItsCurves) {
  Chain other = designed_;
  other.blocks[1].set("descending", std::vector<double>{0.3, -0.3, 0.0});
  const Measured out = of(other);
  ASSERT_EQ(out.found.size(), 1u);
  // .1 (x - x^2) is .025 at most; what falls is said behind what rises.
  EXPECT_TRUE(out.found[0].starts_with("stage: its curves are others than the project's, by up to "))
      << out.found[0];
  EXPECT_NE(out.found[0].find("2.5 % of a full stroke (descending)"), std::string::npos) << out.found[0];
  EXPECT_TRUE(out.tied.empty());
  EXPECT_EQ(out.next_name, "");  // no exchange mends it
  EXPECT_NE(out.advice.find("A generator that is as much off does the same"), std::string::npos);
}

TEST_F(MeasuredRecord, OfTheControllerOrOfTheStageIsToldFromTheRecord) {
  Chain controller;
  controller.blocks = {with_part(2, 8.0).blocks[0]};
  const Measured drive = of(controller);
  EXPECT_EQ(drive.of, "the controller");
  EXPECT_TRUE(drive.found.at(0).starts_with("R3 is 8 % above"));
  EXPECT_NEAR(drive.after_percent, 100.0 * 0.15 * std::sqrt(1.0 / 30.0), 0.3);
  Chain stage;
  stage.blocks = {designed_.blocks[1], designed_.blocks[2]};
  EXPECT_EQ(of(stage).of, "the controller and the stage");  // the same here, and the first of those
  write_file(folder_ / "model.toml", chain::model_text(controller));
  stage.blocks[1].set("gain", 2e6);
  try {
    of(stage);
    ADD_FAILURE() << "micrometres are taken for metres";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("times what the controller and the stage would give"),
              std::string::npos)
        << error.what();
  }
  std::filesystem::remove(folder_ / "model.toml");
  std::filesystem::remove(folder_ / "stage.toml");
  EXPECT_THROW(of(stage), InputError);
}

class MeasuredResponse : public testing::Test {
 protected:
  /// Poles at 1 and 20 kHz, a zero at 5 kHz.
  static Sections wanted() {
    Section one, two;
    one.gain = 0.5;
    one.zeros = {-30e3};
    one.poles = {-6e3};
    two.gain = 120e3;
    two.poles = {-120e3};
    Sections out;
    out.sections = {one, two};
    return out;
  }
  MeasuredResponse() { design(wanted()); }
  void design(const Sections& sections) {
    made_ = synthesis::realise(sections, {});
    Json circuit = json_header("circuit", {});
    circuit.update(synthesis::to_json(made_));
    write_file(folder_ / "spice/circuit.json", to_text(circuit));
  }
  Measured of(const synthesis::Circuit& built) {
    const std::vector<Hertz> grid = log_grid({Hertz{30.0}, Hertz{60e3}}, 40);
    Random random(7);
    std::vector<double> hz, db, deg;
    for (const auto& h : schematic::network_response(built, grid)) {
      hz.push_back(grid[hz.size()].value);
      db.push_back(20.0 * std::log10(std::abs(h)) + 0.002 * random.normal());
      deg.push_back(180.0 / 3.14159265358979 * std::arg(h) + 0.01 * random.normal());
    }
    CsvWriter csv;
    csv.add("frequency_hz", hz);
    csv.add("magnitude_db", db);
    csv.add("phase_deg", deg);
    write_file(folder_ / "bode.csv", csv.text());
    return measured_response(folder_ / "bode.csv", folder_.path(), {}, files_, next_);
  }

  TemporaryFolder folder_;
  synthesis::Realised made_;
  OutputSet files_, next_;
};

TEST_F(MeasuredResponse, OfWhatWasDesignedAccusesNothing) {
  const Measured out = of(made_.circuit);
  EXPECT_EQ(out.of, "the circuit");
  EXPECT_TRUE(out.found.empty() && out.next.empty());
  EXPECT_TRUE(next_.paths().empty());
  EXPECT_EQ(out.left_percent, out.gap_percent);
}

TEST_F(MeasuredResponse, OfAWrongPartNamesItAndMendsIt) {
  synthesis::Circuit built = made_.circuit;
  const auto capacitor =
      std::find_if(built.parts.begin(), built.parts.end(),
                   [](const schematic::Part& part) { return part.kind == schematic::Part::Kind::capacitor; });
  capacitor->realised *= 1.3;
  const Measured out = of(built);
  ASSERT_FALSE(out.found.empty());
  EXPECT_NE((out.found[0] + (out.found.size() > 1 ? out.found[1] : "")).find(capacitor->name),
            std::string::npos);
  EXPECT_LT(out.left_percent, 0.2 * out.gap_percent);
  EXPECT_EQ(out.next_name, "response_percent");
  EXPECT_LT(out.after_percent, 0.5 * out.before_percent);
  ASSERT_NE(next_.content("compensator.sub"), nullptr);
  EXPECT_NE(next_.content("as_built.sub"), nullptr);
}

/// Which resistor of an inverter is wrong shows nowhere: one more across either mends it, of its kind and between its nodes.
TEST_F(MeasuredResponse, APartAcrossIsOfTheKindOfWhatItMends) {
  Sections one = wanted();
  one.sections.pop_back();
  design(one);
  synthesis::Circuit built = made_.circuit;
  built.parts[1].realised *= 1.2;
  const Measured out = of(built);
  ASSERT_FALSE(out.next.empty());
  const schematic::SpiceLibrary mended =
      schematic::read_spice(*next_.content("compensator.sub"), "compensator.sub");
  std::vector<schematic::Part> parts;
  for (const auto& sub : mended.subcircuits)
    parts.insert(parts.end(), sub.netlist.parts.begin(), sub.netlist.parts.end());
  ASSERT_EQ(parts.size(), built.parts.size() + 1);
  const auto more = std::ranges::find_if(parts, [](const auto& part) { return part.name[1] == 'x'; });
  ASSERT_NE(more, parts.end());
  const auto across = std::ranges::find(parts, more->name.substr(3), &schematic::Part::name);
  ASSERT_NE(across, parts.end()) << more->name;
  EXPECT_EQ(more->name.substr(0, 3), "Rx_");
  EXPECT_EQ(more->kind, schematic::Part::Kind::resistor);
  EXPECT_EQ((std::set{more->from, more->to}), (std::set{across->from, across->to}));
  EXPECT_NEAR(synthesis::Series::named("E96").nearest(more->realised), more->realised, 1e-9 * more->realised);
  EXPECT_LT(out.after_percent, 0.1 * out.before_percent);
}

TEST_F(MeasuredResponse, NeedsSomethingThatCouldBeIt) {
  std::filesystem::remove(folder_ / "spice/circuit.json");
  EXPECT_THROW(of(made_.circuit), InputError);
}

TEST(GapPicture, HasASecondDrawingOnlyWhereThatIsKnown) {
  GapPicture picture{"time, s", false, {0.0, 1.0}, {1.0, 2.0}, {0.5, 0.6}, {}, {}, "Error of tracking"};
  EXPECT_EQ(picture.svg().find("Error of tracking"), std::string::npos);
  picture.before = {3.0, 4.0};
  picture.after = {0.1, 0.2};
  EXPECT_NE(picture.svg().find("Error of tracking"), std::string::npos);
}

}  // namespace
}  // namespace bodesmith::measured
