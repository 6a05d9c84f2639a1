// Tables of compiled code are found by their names.
#include "platform_models/loader/compiled_code.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "platform_models/loader/loader.h"
#include "sim/base/error.h"

namespace leviosim::platform {
namespace {

TEST(CompiledCode, IsTheTableOfItsName) {
  const work::CodeMap named = code_map_named("rv32imfc");
  EXPECT_GT(named.pieces().size(), 100u);
  ASSERT_EQ(compiled_code().pieces().size(), named.pieces().size());
  for (std::size_t i = 0; i < named.pieces().size(); ++i)
    EXPECT_EQ(compiled_code().pieces()[i].key, named.pieces()[i].key);
}

work::CompiledWork executed(const work::CodeMap& map, std::string_view function,
                            work::CompiledFor set) {
  const int piece =
      map.find(work::CodeMap::piece_key(work::CodeName(function).key, work::CodeMap::kEntry));
  EXPECT_NE(piece, work::CodeMap::kUnknown) << function;
  return work::compiled_of(map.pieces().at(static_cast<std::size_t>(piece)).compiled, set);
}

/// A table by itself says what it says as that of the first instruction set.
TEST(CompiledCode, HasWhatEachInstructionSetExecutes) {
  for (std::size_t k = 0; k < work::kCompiledFor.size(); ++k) {
    const auto set = static_cast<work::CompiledFor>(k);
    const work::CodeMap table = code_map_named(work::kCompiledFor[k]);
    for (const char* function : {"harris_response", "solve_gauss", "is_fast_corner"})
      EXPECT_EQ(executed(compiled_code(), function, set),
                executed(table, function, work::CompiledFor::Rv32imfc))
          << function;
  }
}

TEST(CompiledCode, RowsOfOthersAreCheckedWhenTheyAreAdded) {
  const std::string header =
      "function,after,lines,visits,refetches,executed,priced,loads,used_at_once,executed_loops,"
      "priced_loops\n";
  const auto refused = [](const std::string& set, const std::string& text, const char* part) {
    try {
      add_compiled_code({set, text});
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  refused("rv64", header, "no table of compiled code 'rv64'");
  refused("rv32imfc", "x\n", "rv32imfc.csv of a workload:1: expected the header");
  refused("rv32imfc", header + "mine,,1\n", "of a workload:2: expected a row of");
  refused("rv32imfc", header + "harris_response,,1,1,0,1,1,1,1,1,1\n", "is there twice");
}

/// As measured of the same sources, which the rows that there are now hardly differ from.
TEST(CompiledCode, HasSizesByInstructionSet) {
  const work::CodeMap rv32 = code_map_named(kCompiledCode);
  for (std::size_t k = 0; k < work::kCompiledFor.size(); ++k) {
    const work::CodeMap table = code_map_named(work::kCompiledFor[k]);
    double bytes = 0, bytes_rv32 = 0;
    for (const work::CodeMap::Piece& piece : rv32.pieces()) {
      const int there = table.find(piece.key);
      if (there == work::CodeMap::kUnknown) continue;
      bytes += table.pieces()[static_cast<std::size_t>(there)].bytes;
      bytes_rv32 += piece.bytes;
    }
    EXPECT_NEAR(size_of_code(static_cast<work::CompiledFor>(k)) / (bytes / bytes_rv32), 1, 0.005)
        << work::kCompiledFor[k];
  }
  EXPECT_EQ(size_of_code(work::CompiledFor::Rv32imfc), 1);
}

TEST(CompiledCode, IsChosenByTheInstructionSetOfTheChip) {
  const std::map<std::string, work::CompiledFor> expected = {
      {"gap9", work::CompiledFor::Rv32imfcXpulp},
      {"gap8", work::CompiledFor::Rv32imfcXpulp},
      {"cortex-m4f", work::CompiledFor::Thumb2},
      {"cortex-m7", work::CompiledFor::Thumb2},
      {"arm1176", work::CompiledFor::Armv6}};
  for (const auto& [name, set] : expected) {
    const sim::ChipConfig chip = resolve_platform(name).config;
    EXPECT_EQ(chip.cluster.core.code, set) << name;
    EXPECT_EQ(chip.controller.core.code, set) << name;
    EXPECT_EQ(chip.cluster.icache.measured_size, size_of_code(set)) << name;
    EXPECT_EQ(chip.controller.icache.measured_size, size_of_code(set)) << name;
  }
}

TEST(CompiledCode, OfAnotherNameIsRefusedWithThoseThatThereAre) {
  try {
    code_map_named("rv32imac");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("'rv32imac'"), std::string::npos) << text;
    EXPECT_NE(text.find("there is armv6, rv32imfc, rv32imfc_xpulp, thumb2"), std::string::npos)
        << text;
  }
}

}  // namespace
}  // namespace leviosim::platform
