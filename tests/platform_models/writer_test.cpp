// The resolved platform as a file: it loads to the same configuration.
#include "platform_models/loader/loader.h"
#include "platform_models/loader/new_platform.h"
#include "sim/work/op.h"
#include "tests/platform_models/platform_test.h"

namespace leviosim::platform {
namespace {

ResolvedPlatform reloaded(const ResolvedPlatform& platform) {
  return resolve_platform_text("resolved.yaml", to_yaml(platform));
}

TEST(Writer, Gap9ReadsBackInFull) {
  const ResolvedPlatform before = resolve_platform("gap9");
  const ResolvedPlatform after = reloaded(before);
  EXPECT_EQ(after.name, before.name);
  EXPECT_EQ(after.description, before.description);
  EXPECT_EQ(after.sources, before.sources);
  EXPECT_EQ(numbers_of(after.config), numbers_of(before.config));
  ASSERT_EQ(after.parameters.size(), before.parameters.size());
  for (std::size_t i = 0; i < after.parameters.size(); ++i) {
    const Parameter& a = after.parameters[i];
    const Parameter& b = before.parameters[i];
    EXPECT_EQ(a.path, b.path);
    EXPECT_EQ(a.value, b.value) << a.path;
    EXPECT_EQ(a.unit, b.unit) << a.path;
    EXPECT_EQ(a.source, b.source) << a.path;
    EXPECT_EQ(a.confidence, b.confidence) << a.path;
    EXPECT_EQ(a.note, b.note) << a.path;
    ASSERT_EQ(a.range.has_value(), b.range.has_value()) << a.path;
    if (!a.range) continue;
    EXPECT_EQ(a.range->low, b.range->low) << a.path;
    EXPECT_EQ(a.range->high, b.range->high) << a.path;
  }
}

TEST(Writer, ANewPlatformBeginsWithAllNumbersOfAnother) {
  for (const std::string& name : platform_names()) {
    const ResolvedPlatform before = resolve_platform(name);
    const std::string text = new_platform("mychip", before, name);
    const ResolvedPlatform after = resolve_platform_text("mychip.yaml", text);
    EXPECT_EQ(after.name, "mychip");
    EXPECT_EQ(numbers_of(after.config), numbers_of(before.config)) << name;
  }
}

/// The line of a key whose record has no other columns.
std::string line_of_key(const std::string& text, const std::string& key) {
  const std::size_t at = text.find('\n' + key);
  EXPECT_NE(at, std::string::npos) << key;
  return text.substr(at + 1, text.find('\n', at + 1) - at - 1);
}

TEST(Writer, ANewPlatformMarksWhatDependsOnClockVoltageAndMemory) {
  const std::string text = new_platform("mychip", resolve_platform("gap9"), "gap9");
  const auto ends = [&](const std::string& key, const std::string& marks) {
    EXPECT_TRUE(line_of_key(text, key).ends_with(marks)) << line_of_key(text, key);
  };
  ends("  clock: ", "}  # (clock)");
  ends("  workers: ", "}");
  ends("    shared_miss: ", "}  # (clock) (memory)");
  ends("    load_l2: ", "}  # (clock) (memory)");
  ends("    f32_add: ", "}");
  ends("    instruction: ", "}  # (voltage)");
  ends("    access: ", "}  # (voltage) (memory)");
  ends("    banks: ", "}  # (memory)");
  ends("  core: ", "}");  // kilogates of the section area
  for (const Dependence& d : dependences())
    EXPECT_NE(text.find("#   (" + std::string(d.mark) + ") "), std::string::npos) << d.mark;
}

/// Traces that were recorded before the key came into being have a platform without it.
TEST(Writer, APlatformOfAnOlderRecordingReadsBack) {
  std::string text = to_yaml(resolve_platform("gap9"));
  const std::size_t key = text.find("unmeasured_instructions:");
  ASSERT_NE(key, std::string::npos);
  const std::size_t begin = text.rfind('\n', key) + 1;
  text.erase(begin, text.find('\n', key) + 1 - begin);
  EXPECT_EQ(resolve_platform_text("older.yaml", text).config.cluster.core.unmeasured_instructions,
            1);
}

/// As they were before the operation came into being: a sum and a shift.
TEST(Writer, APlatformWithoutShiftedSumsReadsBackWithTwoInstructions) {
  std::string text = to_yaml(resolve_platform("gap9"));
  std::size_t removed = 0;
  for (std::size_t key = 0; (key = text.find("int_add_shift:", key)) != std::string::npos;) {
    const std::size_t begin = text.rfind('\n', key) + 1;
    text.erase(begin, text.find('\n', key) + 1 - begin);
    key = begin;
    ++removed;
  }
  ASSERT_GE(removed, 1u);
  const sim::CoreConfig& core = resolve_platform_text("older.yaml", text).config.cluster.core;
  EXPECT_EQ(core[work::Op::IntAddShift].issue, 2);
  EXPECT_EQ(resolve_platform("gap9").config.cluster.core[work::Op::IntAddShift].issue, 1);
}

TEST(Writer, WritingAgainGivesTheSameBytes) {
  const ResolvedPlatform platform = resolve_platform("gap9");
  const std::string text = to_yaml(platform);
  EXPECT_EQ(to_yaml(reloaded(platform)), text);
  EXPECT_EQ(to_yaml(resolve_platform("gap9")), text);
}

// Numbers without a short decimal form, optional rows, other units, names.
TEST(Writer, OverridesReadBackExactly) {
  const ResolvedPlatform before = resolve_platform(
      "gap9", {"cluster.clock=0.333GHz", "isa.load_use_fraction=0.12345678901234568",
               "cluster.core.load_use_stall=0.1", "cluster.core.ops.f64_add.issue=33.3",
               "controller.core.ops.int_alu.stall=0.7", "cluster.fpu.mapping=dynamic",
               "isa.ops.int_mul.on=fpu", "cluster.l1.size=100kB"});
  const ResolvedPlatform after = reloaded(before);
  EXPECT_EQ(numbers_of(after.config), numbers_of(before.config));
  EXPECT_EQ(after.config.cluster.clock.count(), 333'000'000);
  EXPECT_EQ(after.config.cluster.core.load_use_stall, 0.1);
}

TEST(Writer, OverriddenValuesSaySo) {
  const ResolvedPlatform after =
      reloaded(resolve_platform("gap9", {"cluster.workers=4", "isa.ops.load_l2.stall=20"}));
  int found = 0;
  for (const Parameter& p : after.parameters) {
    const bool row = p.path == "isa.ops.load_l2.stall" || p.path == "isa.ops.load_l2.issue";
    if (p.path != "cluster.workers" && !row) continue;
    ++found;
    EXPECT_EQ(p.source.rfind("override (-p)", 0), 0u) << p.source;
    EXPECT_EQ(p.confidence, "assumed") << p.path;
    EXPECT_EQ(p.source.find("stall; the rest: SDK-1") != std::string::npos, row) << p.source;
  }
  EXPECT_EQ(found, 3);
}

TEST(Writer, EscapesWhatYamlWouldTakeForItsOwn) {
  std::string text =
      replaced(gap9_text(), "name: GAP9", "name: \"a: \\\"b\\\" # c\\t\\\\ \\x01 é\"");
  const ResolvedPlatform before = resolve_platform_text("odd.yaml", text);
  EXPECT_EQ(before.name, "a: \"b\" # c\t\\ \x01 é");
  EXPECT_EQ(reloaded(before).name, before.name);
}

}  // namespace
}  // namespace leviosim::platform
