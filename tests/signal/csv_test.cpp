#include "signal/csv.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/files.hpp"
#include "signal/bode_points.hpp"
#include "signal/time_record.hpp"
#include "temporary_folder.hpp"

namespace bodesmith {
namespace {

template <class Action>
std::string error_of(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string parse_error(const std::string& text) {
  return error_of([&] { Csv::parse(text, "f.csv"); });
}

TEST(Csv, TakesCommentsBlankLinesCrlfAndByteOrderMark) {
  const Csv csv = Csv::parse("\xEF\xBB\xBF# note\r\n\r\n a , \"b\"\r\n1, 2\r\n# more\r\n+3,-4e-1", "f.csv");
  EXPECT_EQ(csv.names(), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(csv.column("a"), (std::vector<double>{1, 3}));
  EXPECT_EQ(csv.column("b"), (std::vector<double>{2, -0.4}));
  EXPECT_EQ(csv.line(0), 4);
  EXPECT_EQ(csv.line(1), 6);
}

TEST(Csv, ComplaintsNameTheLine) {
  EXPECT_EQ(parse_error("a,b\n1,2\n3\n"), "f.csv:3: has 1 cells, expected 2 as in the header");
  EXPECT_EQ(parse_error("a,b\n1,x\n"), "f.csv:2: 'x' in column 'b' is not a finite number");
  EXPECT_EQ(parse_error("a\n\nnan\n"), "f.csv:3: 'nan' in column 'a' is not a finite number");
  EXPECT_EQ(parse_error("1,2\n3,4\n"),
            "f.csv:1: '1' is not a column name, expected a header row such as time_s,u,y");
  EXPECT_EQ(parse_error("a,a\n1,2\n"), "f.csv:1: column 'a' is named twice");
  EXPECT_EQ(parse_error("a,b\n"), "f.csv:1: has no rows below the header");
  EXPECT_EQ(parse_error(""), "f.csv: has no header row, expected column names such as time_s,u,y");
}

/// Rows enough for several pieces, with what interrupts them.
std::string long_text(std::size_t rows, std::size_t odd_row, const std::string& odd) {
  std::string out = "t,u\n";
  for (std::size_t i = 0; i < rows; ++i) {
    if (i % 50000 == 7) out += "# a note\n\n";
    out += i == odd_row ? odd
                        : std::to_string(i) + ".25,-" + std::to_string(3 * i) + (i % 2 == 0 ? "\r\n" : "\n");
  }
  return out;
}

TEST(Csv, LongFilesKeepEveryRowAndLine) {
  constexpr std::size_t kRows = 150000;  // 3 MB: read in pieces
  const Csv csv = Csv::parse(long_text(kRows, 120000, " +7.5 ,\t1e3 \n"), "f.csv");
  ASSERT_EQ(csv.rows(), kRows);
  int line = 2;
  for (std::size_t i = 0; i < kRows; ++i, ++line) {
    if (i % 50000 == 7) line += 2;
    ASSERT_EQ(csv.line(i), line);
    ASSERT_EQ(csv.column("t")[i], i == 120000 ? 7.5 : static_cast<double>(i) + 0.25);
    ASSERT_EQ(csv.column("u")[i], i == 120000 ? 1000.0 : -3.0 * static_cast<double>(i));
  }
}

TEST(Csv, LongFilesComplainOfTheFirstBadLine) {
  EXPECT_EQ(parse_error(long_text(150000, 130000, "1,two\n") + "3\n"),
            "f.csv:130008: 'two' in column 'u' is not a finite number");
  EXPECT_EQ(parse_error(long_text(150000, 10, "1,2,3\n") + "x\n"),
            "f.csv:14: has 3 cells, expected 2 as in the header");
  // What no double holds.
  EXPECT_EQ(parse_error(long_text(150000, 149999, "1e999,0\n")),
            "f.csv:150007: '1e999' in column 't' is not a finite number");
}

TEST(CsvWriter, LongTablesReadBackAsTheyWere) {
  std::vector<double> x, y;
  for (int i = 0; i < 100000; ++i) {
    x.push_back(1e-3 * i);
    y.push_back(std::sin(i) * std::pow(10.0, i % 600 - 300));
  }
  CsvWriter writer;
  writer.add("x", x);
  writer.add("y", y);
  const std::string text = writer.text();
  const Csv csv = Csv::parse(text, "f.csv");
  EXPECT_EQ(csv.column("x"), x);
  EXPECT_EQ(csv.column("y"), y);
  EXPECT_EQ(text.substr(0, 16), "x,y\n0,0\n0.001,8.");
}

TEST(CsvWriter, WritesNumbersThatReadBack) {
  CsvWriter writer;
  writer.add("x", {0.1, 1e-300});
  writer.add("y", {1.0 / 3.0, -2.0});
  const Csv csv = Csv::parse(writer.text(), "f.csv");
  EXPECT_EQ(csv.column("x"), (std::vector<double>{0.1, 1e-300}));
  EXPECT_EQ(csv.column("y"), (std::vector<double>{1.0 / 3.0, -2.0}));
}

template <class Read>
std::string file_error(const std::string& text, const Read& read) {
  const TemporaryFolder folder;
  write_file(folder / "r.csv", text);
  std::string what = error_of([&] { read(folder / "r.csv"); });
  const std::string path = (folder / "r.csv").string();
  if (what.rfind(path, 0) == 0) what = what.substr(path.size());
  return what;
}

TEST(BodePoints, SortsAndRefuses) {
  const TemporaryFolder folder;
  write_file(folder / "p.csv", "frequency_hz,magnitude_db,weight\n100,20,2\n1,0,1\n");
  Provenance from;
  const BodePoints points = BodePoints::read_csv(folder / "p.csv", from);
  ASSERT_EQ(points.points.size(), 2u);
  EXPECT_EQ(points.points[0].frequency.value, 1.0);
  EXPECT_DOUBLE_EQ(points.points[1].gain, 10.0);
  EXPECT_EQ(points.points[1].weight, 2.0);
  EXPECT_EQ(from.inputs.size(), 1u);
  const auto read = [](const std::filesystem::path& path) {
    Provenance ignored;
    BodePoints::read_csv(path, ignored);
  };
  EXPECT_EQ(file_error("frequency_hz,gain\n1,1\n1,2\n", read), ":3: 1 Hz is given twice");
  EXPECT_EQ(file_error("frequency_hz,gain\n0,1\n", read), ":2: frequency_hz is 0, expected above 0");
  EXPECT_EQ(file_error("frequency_hz,gain\n1,-1\n", read),
            ":2: the gain is -1, expected a finite number above 0");
  EXPECT_EQ(file_error("frequency_hz,g\n1,1\n", read), ":1: has neither a column 'gain' nor 'magnitude_db'");
  EXPECT_EQ(file_error("frequency_hz,magnitude_db\n1,99999\n", read),
            ":2: the gain is inf, expected a finite number above 0");
}

TEST(TimeRecord, RefusesGapsAndJitterByLine) {
  const auto read = [](const std::filesystem::path& path) {
    Provenance ignored;
    TimeRecord::read_csv(path, ignored, true);
  };
  EXPECT_EQ(file_error("time_s,u,y\n0,0,0\n1,0,0\n2,0,0\n4,0,0\n5,0,0\n", read),
            ":5: time_s steps by 2 s, expected 1 s within 1 % (uniform sampling)");
  EXPECT_EQ(file_error("time_s,u,y\n0,0,0\n1,0,0\n2.02,0,0\n3.02,0,0\n", read),
            ":4: time_s steps by 1.02 s, expected 1 s within 1 % (uniform sampling)");
  EXPECT_EQ(file_error("time_s,u,y\n0,0,0\n1.005,0,0\n2,0,0\n", read), "no error");
  EXPECT_EQ(file_error("time_s,u\n0,0\n1,0\n", read), ":1: has no column 'y', found: time_s, u");
  EXPECT_EQ(file_error("time_s,u,y\n0,0,0\n", read), ":2: is the only row, expected at least two samples");
  EXPECT_EQ(file_error("time_s,u,y\n1,0,0\n0,0,0\n", read),
            ":3: time_s does not rise, expected uniform sampling");
}

/// A file is this program's own, and none of the instruments' formats is tried, where its columns say so.
TEST(TimeRecord, OwnColumnsNeedNoOtherFormat) {
  const TemporaryFolder folder;
  const auto own = [&](const std::string& text, bool times_given) {
    write_file(folder / "r.csv", text);
    Provenance from;
    if (times_given) from.sample_hz = 2.0;
    TimeRecord::read_csv(folder / "r.csv", from);
    return from.inputs.at(0).read_as.empty();
  };
  EXPECT_TRUE(own("time_s,u\n0,1\n1,2\n", false));
  EXPECT_TRUE(own("# a note\nu,y\n1,2\n3,4\n", true));
  EXPECT_FALSE(own("Time (s),Channel 1 (V)\n0,1\n1,2\n", false));
}

TEST(FrequencyRecord, BecomesComplex) {
  const TemporaryFolder folder;
  write_file(folder / "f.csv", "frequency_hz,magnitude_db,phase_deg\n1,0,90\n2,20,180\n");
  Provenance from;
  const FrequencyRecord record = FrequencyRecord::read_csv(folder / "f.csv", from);
  EXPECT_NEAR(std::abs(record.response[0] - std::complex<double>(0, 1)), 0.0, 1e-15);
  EXPECT_NEAR(std::abs(record.response[1] + 10.0), 0.0, 1e-14);
}

TEST(Csv, SemicolonsSeparateWhereTheHeaderHasNoComma) {
  const Csv csv = Csv::parse("time_s;u\n0;1.5\n1;2.5\n", "x.csv");
  EXPECT_EQ(csv.column("u"), (std::vector<double>{1.5, 2.5}));
  EXPECT_EQ(Csv::parse("time_s;u\n0;1,5\n1,0;-2e-1\n", "x.csv").column("u"),
            (std::vector<double>{1.5, -0.2}));
  EXPECT_EQ(Csv::parse("time_s\tu\n0\t1,5\n", "x.csv").column("u"), (std::vector<double>{1.5}));
  EXPECT_EQ(parse_error("a;b\n1;1.000,5\n"), "f.csv:2: '1.000,5' in column 'b' is not a finite number");
}

TEST(Csv, NothingThatIsNotFiniteIsWritten) {
  CsvWriter csv;
  csv.add("y", {1.0, std::numeric_limits<double>::quiet_NaN()});
  EXPECT_THROW(csv.text(), InputError);
}

}  // namespace
}  // namespace bodesmith
