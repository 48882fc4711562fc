#include "spice/user_deck.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/files.hpp"
#include "spice/ngspice.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::spice {
namespace {

const char* const kDeck = R"(my own low-pass
* 1 kohm and 159.155 nF: 1 kHz
.include parts.inc
Vsig a 0 DC 0
+ AC 2 90
Xr a b part
C1 b 0 159.154943n
.ac dec 10 1 1meg
.print ac vdb(b)
.meas ac nothing max v(b)
.control
run
.endc
.end
this is never read
)";

TEST(UserDeck, ResponseOfAnRcLowPass) {
  if (!ngspice_available()) GTEST_SKIP() << "ngspice is not installed";
  const TemporaryFolder folder;
  write_file(folder / "x.cir", kDeck);
  write_file(folder / "parts.inc", ".subckt part p q\nR1 p q 1k\n.ends\n");
  const auto h = run_ac_of_deck(folder / "x.cir", {Hertz{1.0}, Hertz{1000.0}}, "b");
  EXPECT_NEAR(std::abs(h[0] - 1.0), 0.0, 2e-3);
  EXPECT_NEAR(std::abs(h[1] - std::complex<double>(0.5, -0.5)), 0.0, 1e-6);
}

TEST(UserDeck, MistakesNameFileAndLine) {
  const TemporaryFolder folder;
  const auto complaint = [&](const std::string& text) -> std::string {
    write_file(folder / "x.cir", text);
    try {
      read_user_deck(folder / "x.cir", "");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(complaint("t\nV1 in 0 1\nR1 in out 1\n").find("no source with an AC value"), std::string::npos);
  EXPECT_NE(complaint("t\nV1 in 0 AC 1\nV2 out 0 AC 1\n").find("x.cir:3"), std::string::npos);
  EXPECT_NE(complaint("t\nV1 in 0 AC 1\nR1 in b 1\n").find("no node named out"), std::string::npos);
  EXPECT_NE(complaint("t\nV1 in 0 AC 1\n.include none.sub\n").find("x.cir:3"), std::string::npos);
  EXPECT_NE(complaint("t\nV1 in 0 AC 1\n.control\nrun\n").find("x.cir:3"), std::string::npos);
  EXPECT_EQ(complaint("t\nV1 in 0 AC 1\nR1 in out 1k\nR2 out 0 1k\n.end\n"), "");
}

template <class Action>
std::string refusal_of_input(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// A user's file may describe a circuit and nothing else: no command of it runs, wherever it stands.
TEST(UserDeck, NothingInItRuns) {
  const TemporaryFolder folder;
  const std::string mark = (folder / "ran").string();
  const std::string run = "\nshell touch " + mark + "\n.endc\n";
  const std::string part = ".subckt part p q\nR1 p q 1k\n.ends\n";
  const std::string body = "Vsig a 0 AC 1\nXr a out part\nC1 out 0 1u\n.end\n";
  const auto answer = [&](const std::string& deck, const std::string& included) {
    write_file(folder / "x.cir", deck);
    write_file(folder / "parts.inc", included);
    return refusal_of_input([&] { run_ac_of_deck(folder / "x.cir", {Hertz{1.0}}); });
  };
  const std::string include = ".include parts.inc\n";
  for (const std::string begin : {".control", " .CONTROL now", ".controls", ".cont\n+rol"}) {
    EXPECT_NE(answer("t\n" + include + body, part + begin + run).find("parts.inc:4: has a .control section"),
              std::string::npos)
        << begin;
    write_file(folder / "lib.sub", part + begin + run);
    EXPECT_NE(refusal_of_input([&] { run_ac_of_sub(folder / "lib.sub", {Hertz{1.0}}); }).find("lib.sub:4"),
              std::string::npos);
  }
  // One level deeper.
  write_file(folder / "deep.inc", ".control" + run);
  EXPECT_NE(answer("t\n" + include + body, part + ".include 'deep.inc'\n").find("deep.inc:1"),
            std::string::npos);
  EXPECT_NE(
      answer("t\n" + include + body, part + ".model m d_process(process_file=\"x\")\n").find("parts.inc:4"),
      std::string::npos);
  // A node's name goes into a command.
  EXPECT_NE(answer("t\n" + include + "Vsig a 0 AC 1\nR1 a b`touch$IFS" + mark +
                       "` 1k\n.print ac v(b`touch$IFS" + mark + "`)\n.end\n",
                   part)
                .find("a node is named"),
            std::string::npos);
  if (ngspice_available()) {
    // The deck's own sections are left out, its title too.
    EXPECT_EQ(
        answer("*ng_script\n" + include + body.substr(0, body.size() - 5) + ".controlled" + run + ".end\n",
               part),
        "");
  }
  EXPECT_FALSE(std::filesystem::exists(mark));
}

}  // namespace
}  // namespace bodesmith::spice
