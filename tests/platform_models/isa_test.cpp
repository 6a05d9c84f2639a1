// Instruction sets as files: how a platform builds on one, what each costs, and the faults.
#include <filesystem>
#include <fstream>

#include "sim/chip/cost.h"
#include "sim/work/op.h"
#include "tests/platform_models/platform_test.h"

namespace leviosim::platform {
namespace {

using work::Op;

sim::CoreConfig core_of(const std::string& base) {
  return load_platform("gap9", {"isa.base=" + base}).cluster.core;
}

double cycles(const sim::CoreConfig& core, Op op) { return core[op].issue + core[op].stall; }

TEST(Isa, EveryBuiltInSetCompletesAPlatform) {
  std::vector<std::string> names;
  for (const base::BuiltinFile& file : builtin_instruction_sets()) names.emplace_back(file.name);
  EXPECT_EQ(names, (std::vector<std::string>{"armv6_vfp", "rv32imc_xpulp", "rv32imfc",
                                             "rv32imfc_xpulp", "thumb2_fp", "thumb2_m7"}));
  for (const std::string& name : names) {
    const ResolvedPlatform platform = resolve_platform("gap9", {"isa.base=" + name});
    for (const Parameter& p : platform.parameters) {
      EXPECT_FALSE(p.overridden) << p.path;
      if (!p.unit.empty() && p.confidence != "high") {
        EXPECT_TRUE(p.range) << name << ": " << p.path << " is uncertain and has no range";
      }
    }
    EXPECT_EQ(numbers_of(resolve_platform_text("again.yaml", to_yaml(platform)).config),
              numbers_of(platform.config));
  }
}

TEST(Isa, EverySourceOfAFileIsUsedInIt) {
  for (const auto& files : {builtin_platforms(), builtin_instruction_sets()})
    for (const base::BuiltinFile& file : files) {
      const std::string text(file.text);
      if (text.find("\nsources:\n") == std::string::npos) continue;  // those of what it extends
      const std::size_t begin = text.find("\nsources:\n") + 10;
      const std::size_t end = text.find("\n\n", begin);
      for (std::size_t at = begin; at < end; at = text.find('\n', at) + 1) {
        const std::string key = text.substr(at + 2, text.find(':', at) - at - 2);
        EXPECT_NE(text.find(key, end), std::string::npos) << file.name << ": " << key;
      }
    }
}

// What Xpulp buys: an iteration of a dot product takes 5 instructions (GCC 12: 7 with 2 stalls).
TEST(Isa, XpulpSavesLoopControlAddressesAndMultiplyAdds) {
  const auto iteration = [](const sim::CoreConfig& core) {
    return 2 * cycles(core, Op::LoadStream) + cycles(core, Op::IntMac) +
           cycles(core, Op::LoopIteration);
  };
  EXPECT_EQ(iteration(core_of("rv32imfc")), 7 + 2);
  EXPECT_EQ(iteration(core_of("rv32imfc_xpulp")), 3);
  EXPECT_EQ(cycles(core_of("rv32imfc"), Op::Popcount), 14);
  EXPECT_EQ(cycles(core_of("rv32imfc_xpulp"), Op::Popcount), 1);
}

TEST(Isa, SetsOfAFamilyShareWhatTheyDoNotChange) {
  for (const Op op : {Op::IntAlu, Op::IntDiv, Op::BranchTaken, Op::Straddle}) {
    EXPECT_EQ(cycles(core_of("rv32imc_xpulp"), op), cycles(core_of("rv32imfc"), op));
    EXPECT_EQ(core_of("rv32imc_xpulp")[op].routine, core_of("rv32imfc")[op].routine);
  }
}

// FACTS.md#cortex-m4f.
TEST(Isa, Thumb2CostsWhatItsReferenceSays) {
  const sim::CoreConfig core = core_of("thumb2_fp");
  for (const Op op : {Op::IntAlu, Op::IntMul, Op::IntMac, Op::BranchNotTaken})
    EXPECT_EQ(cycles(core, op), 1);
  EXPECT_EQ(cycles(core, Op::F32Fma), 3);
  EXPECT_EQ(cycles(core, Op::F32Div), 14);
  EXPECT_EQ(cycles(core, Op::F32Sqrt), 14);
  EXPECT_EQ(cycles(core, Op::BranchTaken), 3);
}

TEST(Isa, WithoutFpuNothingNeedsAUnit) {
  const std::vector<std::string> bare = {"isa.base=rv32imc_xpulp", "cluster.fpu.units=0",
                                         "cluster.fpu.dividers=0", "cluster.fpu.int64_units=0"};
  EXPECT_EQ(load_platform("gap9", bare).cluster.fpu.units, 0);
}

// ---- files of one's own ----

class IsaFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    for (const base::BuiltinFile& file : builtin_instruction_sets())
      if (file.name == "rv32imfc_xpulp") xpulp_ = std::string(file.text);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  /// A platform that builds on my.yaml beside it, with rows of its own.
  std::string platform(const std::string& rows = "") const {
    const std::string text = replaced(gap9_text(), "base: rv32imfc_xpulp", "base: ./my.yaml");
    return write("chip.yaml", replaced(text, "\n  ops:\n", "\n  ops:\n" + rows));
  }
  std::string fault(const std::string& path) const {
    return fault_of([&] { resolve_platform(path); });
  }

  std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) /
      ("isa_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
  std::string xpulp_;
};

constexpr const char* kSlowAdd =
    "    f32_add: { issue: 1, stall: 1, unit: cycles, on: core, source: \"assumption\",\n"
    "      confidence: high }\n";

TEST_F(IsaFiles, ArePathsRelativeToThePlatform) {
  write("my.yaml", xpulp_);
  EXPECT_EQ(numbers_of(load_platform(platform())), numbers_of(load_platform("gap9")));
}

TEST_F(IsaFiles, RowsOfThePlatformReplaceRowsOfTheBaseAsAWhole) {
  write("my.yaml", xpulp_);
  const ResolvedPlatform chip = resolve_platform(platform(kSlowAdd));
  EXPECT_EQ(chip.config.cluster.core[Op::F32Add].unit, sim::Unit::Core);
  EXPECT_EQ(chip.config.controller.core[Op::F32Add].stall, 1);
  for (const Parameter& p : chip.parameters) {
    EXPECT_NE(p.path, "isa.ops.f32_add.busy") << "left over from the base";
  }
  EXPECT_EQ(to_yaml(resolve_platform_text("again.yaml", to_yaml(chip))), to_yaml(chip));
}

TEST_F(IsaFiles, FaultsNameTheirFileAndLine) {
  const std::string bad = replaced(xpulp_, "    popcount:", "    pop_count:");
  const std::string path = write("my.yaml", bad);
  expect_parts(fault(platform()), {"my.yaml:" + std::to_string(line_of(bad, "pop_count")) + ":",
                                   "isa.ops.pop_count", "'isa.ops.popcount'"});
}

TEST_F(IsaFiles, ARowThatNobodyGivesIsMissed) {
  const std::string text = gap9_text();
  const std::string less = replaced(text, "    load_l2: {", "    # load_l2: {");
  const std::string message =
      fault(write("chip.yaml", replaced(less,
                                        "confidence: medium, issue_range: [1, 1], stall_range: "
                                        "[7, 24],\n      note: \"blocking",
                                        "# confidence\n      # note: \"blocking")));
  expect_parts(message, {"chip.yaml:", "isa.ops.load_l2", "missing key"});
}

TEST_F(IsaFiles, UnknownNamesAreRefusedWithTheNearest) {
  const std::string text = replaced(gap9_text(), "base: rv32imfc_xpulp", "base: rv32imfc_xplp");
  expect_parts(
      fault_of([&] { resolve_platform_text("my.yaml", text); }),
      {"my.yaml:" + std::to_string(line_of(text, "xplp")) + ": isa.base",
       "unknown instruction set 'rv32imfc_xplp'", "did you mean 'rv32imfc_xpulp'", "thumb2_fp"});
  expect_parts(fault(platform()), {"chip.yaml:", "isa.base", "there is no file", "my.yaml"});
}

TEST_F(IsaFiles, NoneBuildsOnItself) {
  write("my.yaml", replaced(xpulp_, "base: rv32imfc\n", "base: ./other.yaml\n"));
  write("other.yaml", replaced(xpulp_, "base: rv32imfc\n", "base: ./my.yaml\n"));
  expect_parts(fault(platform()), {"other.yaml:", "isa.base", "builds on itself"});
}

TEST_F(IsaFiles, DescribeNoChips) {
  const std::string text = xpulp_ + "\ncluster: {}\n";
  write("my.yaml", text);
  expect_parts(fault(platform()), {"my.yaml:" + std::to_string(line_of(text, "cluster: {}")),
                                   "cluster", "unknown key", "isa"});
}

TEST_F(IsaFiles, ASourceStandsForOneThing) {
  write("my.yaml", replaced(xpulp_, "  SDK-2: \"", "  SDK-2: \"not the same "));
  expect_parts(fault(platform()), {"'SDK-2' stands for something else", "rv32imfc.yaml"});
}

TEST_F(IsaFiles, OverridesOfTheBaseAreChecked) {
  const auto with = [](const std::string& override) {
    return fault_of([&] { load_platform("gap9", {override}); });
  };
  expect_parts(with("isa.base=rv32"), {"-p isa.base=rv32: unknown instruction set 'rv32'"});
  expect_parts(with("isa.base="), {"-p isa.base=: expected a value"});
  expect_parts(fault_of([] {
                 load_platform("gap9", {"isa.base=rv32imfc", "isa.base=thumb2_fp"});
               }),
               {"already given by -p isa.base=rv32imfc"});
  const std::string whole = to_yaml(resolve_platform("gap9"));
  expect_parts(fault_of([&] { resolve_platform_text("whole.yaml", whole, {"isa.base=rv32imfc"}); }),
               {"-p isa.base=rv32imfc: whole.yaml names no isa.base"});
}

TEST_F(IsaFiles, OverridesOfRowsReachThroughTheBase) {
  EXPECT_EQ(load_platform("gap9", {"isa.base=rv32imfc", "isa.ops.popcount.issue=20"})
                .cluster.core[Op::Popcount]
                .issue,
            20);
}

}  // namespace
}  // namespace leviosim::platform
