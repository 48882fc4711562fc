// `diagnose --circuit` and `diagnose --course` from outside. The example of docs/jobs/faulty_board.md is run by docs_jobs_test.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "base/documents/document.hpp"
#include "base/files.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

const std::string kExamples = std::string(BODESMITH_SOURCE_DIR) + "/examples";

/// A folder with the circuit of examples/faulty_board as it was designed.
void design_board(const std::string& at) {
  ASSERT_EQ(run_bodesmith("design bandpass --family butterworth --order 1 --from-hz 800 --to-hz 1250 -o " +
                          at + "/sections.json")
                .status,
            0);
  ASSERT_EQ(run_bodesmith("spice " + at + "/sections.json -o " + at + "/spice").status, 0);
}

TEST(DiagnoseBoard, SaysWhatCannotBeToldApartAndWhereToProbe) {
  const TemporaryFolder folder;
  const std::string at = folder.path().string();
  design_board(at);
  const auto run = run_bodesmith("diagnose --circuit " + at + "/spice/circuit.json --data " + kExamples +
                                 "/faulty_board/output.csv --json -o " + at + "/out");
  ASSERT_EQ(run.status, 0) << run.err;
  Provenance from;
  const Node found = read_document(folder / "out/faults.json", from);
  found.expect_schema("faults");
  EXPECT_EQ(found.at("verdict").string(), "tie");
  EXPECT_EQ(found.at("tied").size(), 4u);
  EXPECT_EQ(found.at("probe").at("node").string(), "n1");
  EXPECT_LT(found.at("nothing_wrong_probability").number(), 1e-3);
  EXPECT_GT(found.at("timing_s").at("compute").number(), 0.0);
  EXPECT_EQ(found.at("inputs").size(), 2u);
  EXPECT_EQ(found.at("tolerances").at("capacitor_percent").number(), 5.0);  // as `spice` orders them
  EXPECT_NE(read_file(folder / "out/report.html").find("<svg"), std::string::npos);
  EXPECT_NE(run.out.find("\"verdict\": \"tie\""), std::string::npos);
}

TEST(DiagnoseBoard, RefusesWhatIsNoMeasurementOfThisBoard) {
  const TemporaryFolder folder;
  const std::string at = folder.path().string();
  design_board(at);
  const std::string circuit = "diagnose --circuit " + at + "/spice/circuit.json -o " + at + "/out --data ";
  write_file(folder / "short.csv", "frequency_hz,magnitude_db\n1,0\n2,0\n");
  write_file(folder / "half.csv", "frequency_hz,magnitude_db,phase_deg\n1,0,0\n2,x,0\n3,0,0\n");
  for (const std::string& command :
       {circuit + at + "/short.csv", circuit + at + "/half.csv", circuit + at + "/missing.csv",
        circuit + kExamples + "/faulty_board/output.csv --node nowhere=" + kExamples +
            "/faulty_board/node_n1.csv",
        circuit + kExamples + "/faulty_board/output.csv --node n1",
        circuit + kExamples + "/faulty_board/output.csv --plan " + at + "/spice/circuit.json"}) {
    const auto run = run_bodesmith(command);
    EXPECT_EQ(run.status, 2) << command << run.out;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "out/faults.json"));
}

TEST(DiagnoseCourse, ListsItsCasesAndComparesWithTheSealedAnswers) {
  const TemporaryFolder folder;
  const auto list = run_bodesmith("diagnose --course " + kExamples + "/course");
  ASSERT_EQ(list.status, 0) << list.err;
  EXPECT_NE(list.out.find("10 records"), std::string::npos);
  const std::string out = folder.path().string() + "/out";
  const auto run = run_bodesmith("diagnose --course " + kExamples + "/course -o " + out);
  ASSERT_EQ(run.status, 0) << run.err;
  const std::size_t count = run.out.find(" of 10 right");
  ASSERT_NE(count, std::string::npos) << run.out;
  EXPECT_GE(std::stoi(run.out.substr(run.out.rfind('\n', count) + 1)), 8) << run.out;
  // A diagnosis that is there is taken as it is: here one that names nothing.
  std::string text = read_file(folder / "out/01/diagnosis.json");
  text.replace(text.find("\"steps\""), 7, "\"steps\": [], \"not_steps\"");
  write_file(folder / "out/01/diagnosis.json", text);
  const auto again = run_bodesmith("diagnose --course " + kExamples + "/course --case 01 -o " + out);
  EXPECT_NE(again.out.find("named: nothing: wrong"), std::string::npos) << again.out;
  EXPECT_EQ(run_bodesmith("diagnose --course " + kExamples + "/course --case 99").status, 2);
  EXPECT_EQ(run_bodesmith("diagnose --course " + kExamples + "/riaa").status, 2);
}

}  // namespace
}  // namespace bodesmith
