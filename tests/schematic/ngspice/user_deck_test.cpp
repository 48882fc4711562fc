#include "schematic/ngspice/user_deck.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/files.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::ngspice {
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
  if (!is_available()) GTEST_SKIP() << "ngspice is not installed";
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
  EXPECT_NE(complaint("t\nV1 in 0 AC 1e308meg\nR1 in out 1k\n").find("x.cir:2: has an AC value beyond"),
            std::string::npos);
  EXPECT_EQ(complaint("t\nV1 in 0 AC 1\nR1 in out 1k\nR2 out 0 1k\n.end\n"), "");
  write_file(folder / "x.cir", "t\nV1 in 0 AC -2 90\nR1 in out 1k\nR2 out 0 1k\n.end\n");
  EXPECT_NEAR(std::abs(read_user_deck(folder / "x.cir", "").source - std::complex<double>(0.0, -2.0)), 0.0,
              1e-15);
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
  for (const std::string begin :
       {".control", " .CONTROL now", ".controls", ".cont\n+rol", ".co\n+n\n+trol"}) {
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
  // The same over lines that ngspice joins, past a comment between them.
  EXPECT_NE(answer("t\n" + include + body, part + ".model m\n* x\n+ d_process(process_file=\"x\")\n")
                .find("parts.inc:4"),
            std::string::npos);
  // ngspice takes "*# …" for a command wherever it stands; in the deck itself comments are left out.
  for (const std::string hidden :
       {"*# shell touch ", "  *#shell touch ", "*# # x ; shell touch ", "*# `touch "}) {
    write_file(folder / "lib.sub", part + hidden + mark + "`\n");
    EXPECT_NE(refusal_of_input([&] {
                run_ac_of_sub(folder / "lib.sub", {Hertz{1.0}});
              }).find("lib.sub:4: has a command in a comment"),
              std::string::npos)
        << hidden;
    EXPECT_NE(answer("t\n" + include + body, part + hidden + mark + "\n").find("parts.inc:4"),
              std::string::npos);
    EXPECT_EQ(answer("t\n" + hidden + mark + "\n" + body, part).find("command"), std::string::npos);
    EXPECT_NE(refusal_of_input([&] {
                run_ac_of_text(part + hidden + mark + "\n", "text", {Hertz{1.0}});
              }).find("text:4"),
              std::string::npos);
  }
  const std::string rulers = answer("t\n" + include + body, "*####\n*#-----\n" + part);
  EXPECT_EQ(rulers.find("command"), std::string::npos) << rulers;
  // A node's name goes into a command.
  EXPECT_NE(answer("t\n" + include + "Vsig a 0 AC 1\nR1 a b`touch$IFS" + mark +
                       "` 1k\n.print ac v(b`touch$IFS" + mark + "`)\n.end\n",
                   part)
                .find("a node is named"),
            std::string::npos);
  if (is_available()) {
    // The deck's own sections are left out, its title too.
    EXPECT_EQ(
        answer("*ng_script\n" + include + body.substr(0, body.size() - 5) + ".controlled" + run + ".end\n",
               part),
        "");
  }
  EXPECT_FALSE(std::filesystem::exists(mark));
}

// A netlist includes what stands in its own folder or below, nothing else of this machine.
TEST(UserDeck, IncludesStayInTheFolderOfTheDeck) {
  const TemporaryFolder folder;
  const std::string part = ".subckt part p q\nR1 p q 1k\n.ends\n";
  write_file(folder / "outside.lib", part);
  write_file(folder / "mine/parts/in.lib", part);
  write_file(folder / "mine/typical.lib", ".lib typ\n" + part + ".endl typ\n");
  std::filesystem::create_symlink("../outside.lib", folder / "mine/link.lib");
  const std::string body = "Vsig a 0 AC 1\nXr a out part\nC1 out 0 1u\n.end\n";
  const auto answer = [&](const std::string& line) {
    write_file(folder / "mine/x.cir", "t\n" + line + "\n" + body);
    return refusal_of_input([&] {
      if (is_available()) {
        run_ac_of_deck(folder / "mine/x.cir", {Hertz{1.0}});
      } else {
        read_user_deck(folder / "mine/x.cir", "");
      }
    });
  };
  for (const char* line :
       {".include parts/in.lib", ".INCLUDE 'parts/in.lib' $ a comment", ".inc ./parts/in.lib",
        ".lib parts/in.lib", ".lib typical.lib typ", ".include link.lib"})
    EXPECT_EQ(answer(line), "") << line;
  const std::string absolute = (folder / "outside.lib").string();
  for (const std::string& line :
       {std::string(".include ../outside.lib"), ".include " + absolute, ".lib \"" + absolute + "\" typ",
        std::string(".include parts/../../outside.lib"), std::string(".incl ~/outside.lib"),
        std::string(".lib ../outside.lib"), std::string(".include \"../outside.lib\"")}) {
    const std::string said = answer(line);
    EXPECT_NE(said.find("x.cir:2: includes"), std::string::npos) << line << ": " << said;
    EXPECT_NE(said.find("expected a file in its own folder"), std::string::npos) << line << ": " << said;
  }
  EXPECT_NE(answer(".include parts").find("which is not there"), std::string::npos);
  // The same holds for what is included, and for libraries.
  write_file(folder / "mine/parts/in.lib", ".include ../typical.lib\n" + part);
  EXPECT_NE(answer(".include parts/in.lib").find("in.lib:1: includes ../typical.lib"), std::string::npos);
  write_file(folder / "mine/lib.sub", part + ".lib " + absolute + " typ\n");
  EXPECT_NE(refusal_of_input([&] { run_ac_of_sub(folder / "mine/lib.sub", {Hertz{1.0}}); }).find("lib.sub:4"),
            std::string::npos);
  EXPECT_NE(refusal_of_input([&] {
              run_ac_of_text(part + ".include parts/in.lib\n", "text", {Hertz{1.0}});
            }).find("text:4: includes parts/in.lib"),
            std::string::npos);
}

}  // namespace
}  // namespace bodesmith::ngspice
