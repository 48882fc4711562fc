#include "fpaa/streams/update_stream.hpp"
#include "fpaa/streams/stream_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "fpaa/project_source.hpp"
#include "fpaa/seed_sections.hpp"

namespace bodesmith::fpaa {
namespace {

using ::testing::HasSubstr;

// Without a primary stream in the file nothing tells where a chip's name ends but the next underscore.
TEST(ApiCode, NamesWithoutAPrimaryStreamEndAtTheUnderscore) {
  const auto code = [](const std::string& name) {
    return "const an_Byte an_apiAddress1[1] = { 0x01 };\nextern const an_apiCapacitor " + name +
           "_Capacitor[1] = {\n /* Cin */ { 5, 7, },\n};\n";
  };
  const ApiProject project = parse_api_code(code("an_FPAA1_Gain_Inv1"), "A.c");
  EXPECT_EQ(project.prefix, "an");
  ASSERT_NE(project.find("FPAA1", "Gain_Inv1"), nullptr);
  EXPECT_EQ(project.find("FPAA1", "Gain_Inv1")->capacitors[0].bank, 5);
  EXPECT_EQ(project.find("FPAA1", "GainInv1"), nullptr);
  EXPECT_THROW(parse_api_code(code("an_Gain"), "A.c"), InputError);
}

TEST(ApiCode, ReadsTablesAddressesAndStreams) {
  const ApiProject project = parse_api_code(project_source(seed_plan()), "ApiCode.c");
  EXPECT_EQ(project.prefix, "an");
  ASSERT_EQ(project.chips.size(), 1u);
  EXPECT_EQ(project.chips[0].name, "FPAA1");
  ASSERT_EQ(project.cams.size(), 8u);
  const ApiProject::Cam* cam = project.find("FPAA1", "Section1a");
  ASSERT_NE(cam, nullptr);
  EXPECT_EQ(cam->capacitors[0].name, "Ca");
  EXPECT_EQ(cam->capacitors[0].bank, 3);
  EXPECT_EQ(cam->capacitors[0].byte, 7);
}

TEST(ApiCode, BrokenSourceIsRefusedWithItsLine) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      parse_api_code(text, "A.c");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message("int x;"), HasSubstr("A.c: has no capacitor tables"));
  EXPECT_THAT(message("\n/* never ends"), HasSubstr("A.c:2"));
  EXPECT_THAT(message("an_T an_F_G_Capacitor[1] = {\n /* Cin */ { 0x03 } };"), HasSubstr("A.c:2"));
  EXPECT_THAT(message("an_T an_F_G_Capacitor[1] = {\n /* Cin */ { 3, 32 } };"), HasSubstr("byte 32"));
  EXPECT_THAT(message("an_T an_F_G_Capacitor[1] = {\n { 3, 1 } };"), HasSubstr("no comment"));
  EXPECT_THAT(message("an_T an_F_G_Capacitor[1] = {\n /* Cin */ { 3, 1 }"), HasSubstr("does not end"));
}

TEST(UpdateStream, SetsWhatThePlanWantsAndVerifies) {
  const ApiProject project = parse_api_code(project_source(seed_plan()), "ApiCode.c");
  const ConfigStream stream = update_stream(seed_plan().chips[0], project, {});
  const Bytes bytes = encode(stream);
  const ConfigStream back = decode(from_ahf(to_ahf(bytes), "x"), "x");
  EXPECT_EQ(encode(back), bytes);
  EXPECT_TRUE(compare_with_plan(back, seed_plan().chips[0], project, {}).empty());
  EXPECT_EQ(back.control, 0x81);
  // 32 capacitors and three divisors (Clock 0, Sys1, Sys2).
  std::size_t count = 0;
  for (const ConfigBlock& block : back.blocks) count += block.data.size();
  EXPECT_EQ(count, 35u);
  // CAB 1's eight capacitors are one block, byte 0 the last one placed.
  const auto& cams = seed_plan().chips[0].cams;
  const ConfigBlock* cab1 = nullptr;
  for (const ConfigBlock& block : back.blocks) cab1 = block.bank == 3 ? &block : cab1;
  ASSERT_NE(cab1, nullptr);
  ASSERT_EQ(cab1->data.size(), 8u);
  EXPECT_EQ(cab1->data[7], cams[0].capacitors[0].units);
  EXPECT_EQ(cab1->data[0], cams[1].capacitors[3].units);
}

TEST(UpdateStream, EveryWrongByteIsNamed) {
  const ApiProject project = parse_api_code(project_source(seed_plan()), "ApiCode.c");
  ConfigStream stream = update_stream(seed_plan().chips[0], project, {});
  for (ConfigBlock& block : stream.blocks) {
    for (std::size_t i = 0; i < block.data.size(); ++i) {
      block.data[i] = static_cast<std::uint8_t>(block.data[i] ^ 0x40);
      const auto differences = compare_with_plan(stream, seed_plan().chips[0], project, {});
      ASSERT_EQ(differences.size(), 1u);
      EXPECT_THAT(differences[0], HasSubstr("bank " + std::to_string(block.bank)));
      block.data[i] = static_cast<std::uint8_t>(block.data[i] ^ 0x40);
    }
  }
  // A block goes on in the next bank behind byte 31.
  stream.blocks.push_back({.bank = 200, .byte = 30, .data = {1, 2, 3}});
  const auto strange = compare_with_plan(stream, seed_plan().chips[0], project, {});
  ASSERT_EQ(strange.size(), 3u);
  EXPECT_THAT(strange[1], HasSubstr("bank 200"));
  EXPECT_THAT(strange[2], HasSubstr("bank 201"));
  stream.blocks.pop_back();
  stream.blocks.pop_back();
  EXPECT_FALSE(compare_with_plan(stream, seed_plan().chips[0], project, {}).empty());
}

TEST(UpdateStream, MissingCamOrCapacitorSaysWhatToDo) {
  std::string source = project_source(seed_plan());
  const auto rename = [](std::string text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
    return text;
  };
  const auto message = [&](const std::string& text, const UpdateOptions& options) -> std::string {
    try {
      update_stream(seed_plan().chips[0], parse_api_code(text, "ApiCode.c"), options);
    } catch (const DesignError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message(rename(source, "Section3b", "FilterBilinear7"), {}),
              HasSubstr("no CAM named Section3b"));
  const std::string vendor = rename(source, "/* Ca ", "/* C9 ");
  EXPECT_THAT(message(vendor, {}), HasSubstr("a map of Ca"));
  UpdateOptions options;
  options.names = {{"Ca", "C9"}};
  EXPECT_EQ(message(vendor, options), "");
}

TEST(UpdateStream, TwoCapacitorsAtOneAddressMustBeEqual) {
  const ApiProject project = parse_api_code(project_source(seed_plan()), "ApiCode.c");
  ChipPlan chip = seed_plan().chips[0];
  auto& capacitors = chip.cams[0].capacitors;
  UpdateOptions options;
  options.names = {{capacitors[0].name, capacitors[1].name}};
  capacitors[0].units = capacitors[1].units;
  for (std::size_t i = 1; i < chip.cams.size(); ++i)
    chip.cams[i].capacitors[0].units = chip.cams[i].capacitors[1].units;
  EXPECT_NO_THROW(update_stream(chip, project, options));
  capacitors[0].units += 1;
  try {
    update_stream(chip, project, options);
    FAIL();
  } catch (const DesignError& error) {
    EXPECT_THAT(error.what(), HasSubstr("stand at the same address"));
  }
}

TEST(UpdateStream, CArraysReadBack) {
  const ApiProject project = parse_api_code(project_source(seed_plan()), "ApiCode.c");
  const Bytes bytes = encode(update_stream(seed_plan().chips[0], project, {}));
  const std::string source = c_arrays({{"update_chip1", bytes}, {"other", {1, 2}}}, "plan.json");
  const std::vector<FoundStream> found = find_streams(source, "u.c");  // the other is no stream
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].bytes, bytes);
  EXPECT_EQ(found[0].name, "u.c: update_chip1");
  // Nor are others before it, of whatever numbers and words.
  const std::string others = "const int table[] = { 7, 8 };\nconst int mixed[] = { 0xD5, SIZE };\n";
  const std::vector<FoundStream> again = find_streams(others + source, "u.c");
  ASSERT_EQ(again.size(), 1u);
  EXPECT_EQ(again[0].bytes, bytes);
}

TEST(UpdateStream, CCallsSetEveryCapacitorByItsPlaceInTheTable) {
  const ApiProject project = parse_api_code(project_source(seed_plan()), "ApiCode.c");
  const std::string source = c_calls(seed_plan(), project, {}, "plan.json");
  int calls = 0;
  for (std::size_t at = source.find("_SetCapValue("); at != std::string::npos;
       at = source.find("_SetCapValue(", at + 1))
    ++calls;
  EXPECT_EQ(calls, 32);
  const auto& cam = *seed_plan().cams()[3];
  EXPECT_THAT(source, HasSubstr("an_SetCapValue(an_FPAA1_Section2b, 1, " +
                                std::to_string(cam.capacitors[1].units) + ");"));
  EXPECT_THAT(source, HasSubstr("an_GetApexReconfigData(an_FPAA1, &count)"));
}

}  // namespace
}  // namespace bodesmith::fpaa
