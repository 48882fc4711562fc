#include "schematic/opamp_library.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/files.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::schematic {
namespace {

TEST(OpAmpLibrary, BuiltInTypesAreSane) {
  const OpAmpLibrary library = OpAmpLibrary::built_in();
  EXPECT_GE(library.types().size(), 8u);
  EXPECT_GT(library.named("OPA2140").gain_bandwidth, library.named("TL072").gain_bandwidth);
  EXPECT_THROW(library.named("uA709"), InputError);
}

TEST(OpAmpLibrary, ReadsAUsersListAndNamesTheLineOfAMistake) {
  const TemporaryFolder folder;
  write_file(folder / "own.toml",
             "schema = \"bodesmith.opamps/1\"\n[[opamp]]\nname = \"mine\"\ngain_bandwidth_hz = "
             "5e6\nslew_v_per_s = 1e6\n");
  Provenance from;
  const OpAmpLibrary own = OpAmpLibrary::read(folder / "own.toml", from);
  EXPECT_EQ(own.types()[0].name, "mine");
  EXPECT_EQ(own.named("mine").gain_bandwidth.value, 5e6);
  // A type of the same name takes the place of the built-in one, which all others follow.
  const std::size_t built_in = OpAmpLibrary::built_in().types().size();
  EXPECT_EQ(own.types().size(), built_in + 1);
  write_file(folder / "same.toml",
             "schema = \"bodesmith.opamps/1\"\n[[opamp]]\nname = \"TL072\"\ngain_bandwidth_hz = "
             "5e6\nslew_v_per_s = 1e6\n");
  const OpAmpLibrary same = OpAmpLibrary::read(folder / "same.toml", from);
  EXPECT_EQ(same.types().size(), built_in);
  EXPECT_EQ(same.named("TL072").gain_bandwidth.value, 5e6);
  for (const std::string& wrong :
       {std::string("gain_bandwith_hz = 5e6"), std::string("gain_bandwidth_hz = -1")}) {
    write_file(folder / "wrong.toml", "schema = \"bodesmith.opamps/1\"\n[[opamp]]\nname = \"mine\"\n" +
                                          wrong + "\nslew_v_per_s = 1e6\n");
    try {
      OpAmpLibrary::read(folder / "wrong.toml", from);
      FAIL() << wrong;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("wrong.toml:"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace bodesmith::schematic
