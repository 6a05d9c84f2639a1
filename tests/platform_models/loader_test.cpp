// Faults of platform files: each kind is refused with a message that helps.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <ostream>

#include "tests/platform_models/platform_test.h"

namespace leviosim::platform {
namespace {

/// One edit of gap9.yaml and what the message about it must contain.
struct BadEdit {
  const char* name;
  const char* from;
  const char* to;
  const char* at;  ///< text in the edited file whose line the message must name; empty for line 1
  std::vector<std::string_view> parts;
};

void PrintTo(const BadEdit& edit, std::ostream* out) { *out << edit.name; }

class BadFile : public ::testing::TestWithParam<BadEdit> {};

TEST_P(BadFile, IsRefusedWithPlaceAndAdvice) {
  const BadEdit& edit = GetParam();
  const std::string text = replaced(gap9_text(), edit.from, edit.to);
  const std::string message = fault_of([&] { resolve_platform_text("my.yaml", text); });
  const int line = edit.at[0] == '\0' ? 1 : line_of(text, edit.at);
  EXPECT_EQ(message.rfind("my.yaml:" + std::to_string(line) + ":", 0), 0u) << message;
  expect_parts(message, edit.parts);
}

INSTANTIATE_TEST_SUITE_P(
    Edits, BadFile,
    ::testing::Values(
        BadEdit{"unknown_key",
                "    units: {",
                "    untis: {",
                "untis:",
                {"cluster.fpu.untis", "unknown key", "did you mean 'cluster.fpu.units'"}},
        BadEdit{"unknown_section",
                "\nl2:\n",
                "\nl3:  # here\n",
                "# here",
                {"l3", "unknown key", "did you mean 'l2'"}},
        BadEdit{"header_in_a_section",
                "    banks: {",
                "    name: L1\n    banks: {",
                "name: L1",
                {"cluster.l1.name", "unknown key"}},
        BadEdit{"unknown_operation",
                "    load_l2:",
                "    loadl2:",
                "loadl2",
                {"isa.ops.loadl2", "unknown key", "'isa.ops.load_l2'"}},
        BadEdit{"unknown_key_of_a_parameter",
                "value: 8, unit: cores, source",
                "value: 8, unit: cores, sorce",
                "sorce",
                {"cluster.workers.sorce", "unknown key", "did you mean 'source'"}},
        BadEdit{"range_of_a_choice",
                "value: fixed,",
                "value: fixed, range: [0, 1],",
                "value: fixed",
                {"cluster.fpu.mapping.range", "unknown key"}},
        BadEdit{"duplicate_key",
                "  max_workers: { value: 8",
                "  workers: { value: 77",
                "value: 77",
                {"cluster.workers", "duplicate key", "first given on line"}},
        BadEdit{"duplicate_key_of_a_parameter",
                "value: 8, unit: cores",
                "value: 8, value: 4, unit: cores",
                "value: 4",
                {"cluster.workers.value", "duplicate key"}},
        BadEdit{"missing_parameter",
                "    banks: {",
                "    # banks: {",
                "  l1:\n",
                {"cluster.l1.banks", "missing key", "word-interleaved banks"}},
        BadEdit{"missing_column",
                "load_l2: { issue: 1, stall: 14,",
                "load_l2: { issue: 1,",
                "load_l2: {",
                {"isa.ops.load_l2", "missing key 'stall'"}},
        BadEdit{"missing_value",
                "value: 8, unit: cores, source",
                "unit: cores, source",
                "  workers:",
                {"cluster.workers", "missing key 'value'"}},
        BadEdit{"missing_unit",
                "value: 8, unit: cores, source",
                "value: 8, source",
                "  workers:",
                {"cluster.workers", "missing key 'unit'"}},
        BadEdit{"missing_source",
                "source: \"SDK-1 (FACTS.md#l1-memory)\", confidence: high",
                "confidence: high",
                "    banks:",
                {"cluster.l1.banks", "missing key 'source'"}},
        BadEdit{"missing_confidence",
                "source: \"SDK-1 (FACTS.md#l1-memory)\", confidence: high",
                "source: \"SDK-1 (FACTS.md#l1-memory)\"",
                "    banks:",
                {"cluster.l1.banks", "missing key 'confidence'"}},
        BadEdit{"empty_source",
                "source: \"SDK-1 (FACTS.md#l1-memory)\"",
                "source: \"\"",
                "    banks:",
                {"cluster.l1.banks.source", "is empty"}},
        BadEdit{"unlisted_source",
                "source: \"SDK-1 (FACTS.md#l1-memory)\"",
                "source: \"SDK-1, SDK9 (x)\"",
                "    banks:",
                {"cluster.l1.banks.source", "'SDK9'", "not listed", "'SDK-9'"}},
        BadEdit{"unknown_confidence",
                "source: \"SDK-1 (FACTS.md#l1-memory)\", confidence: high",
                "source: \"SDK-1 (FACTS.md#l1-memory)\", confidence: hihg",
                "    banks:",
                {"cluster.l1.banks.confidence", "'hihg'", "high, medium, low, assumed", "'high'"}},
        BadEdit{"wrong_unit",
                "value: 128, unit: KiB",
                "value: 128, unit: KB",
                "unit: KB",
                {"cluster.l1.size.unit", "'KB'", "a size", "B, kB, KiB, MB, MiB"}},
        BadEdit{"not_a_number",
                "value: 8, unit: cores",
                "value: eight, unit: cores",
                "value: eight",
                {"cluster.workers.value", "'eight' is not a number"}},
        BadEdit{"not_a_number_at_its_end",
                "value: 8, unit: cores",
                "value: 8x, unit: cores",
                "8x",
                {"cluster.workers.value", "'8x' is not a number"}},
        BadEdit{"no_value",
                "value: 8, unit: cores",
                "value: , unit: cores",
                "  workers:",
                {"cluster.workers.value", "is empty"}},
        BadEdit{"nan",
                "value: 0.25",
                "value: nan",
                "nan,",
                {"isa.load_use_fraction.value", "not a finite number"}},
        BadEdit{"infinite",
                "value: 0.25",
                "value: inf",
                "inf,",
                {"isa.load_use_fraction.value", "not a finite number"}},
        BadEdit{"yaml_nan",
                "value: 0.25",
                "value: .nan",
                ".nan,",
                {"isa.load_use_fraction.value", "is not a number"}},
        BadEdit{"negative",
                "value: 8, unit: cores",
                "value: -8, unit: cores",
                "-8",
                {"cluster.workers.value", "-8 cores is out of range", "1 to 1024 cores"}},
        BadEdit{"too_large",
                "value: 0.25",
                "value: 1.5",
                "1.5,",
                {"isa.load_use_fraction.value", "1.5 ratio is out of range", "0 to 1"}},
        BadEdit{"not_whole",
                "value: 8, unit: cores",
                "value: 7.5, unit: cores",
                "7.5",
                {"cluster.workers.value", "7.5 cores is no whole number"}},
        BadEdit{"zero_clock",
                "value: 370, unit: MHz",
                "value: 0, unit: MHz",
                "value: 0, unit: MHz",
                {"cluster.clock.value", "0 MHz is out of range", "0.001 to 100000 MHz"}},
        BadEdit{"unknown_choice",
                "value: fixed",
                "value: fxed",
                "fxed",
                {"cluster.fpu.mapping.value", "'fxed'", "fixed, dynamic", "did you mean 'fixed'"}},
        BadEdit{"unknown_unit_of_the_chip",
                "on: core",
                "on: coer",
                "coer",
                {"isa.ops.load_l2.on", "'coer'", "core, fpu, divider, int64", "'core'"}},
        BadEdit{"reversed_range",
                "range: [0, 0.6]",
                "range: [0.6, 0]",
                "[0.6, 0]",
                {"isa.load_use_fraction.range", "0.6 to 0", "does not contain the value 0.25"}},
        BadEdit{"range_off_the_value",
                "range: [0, 0.6]",
                "range: [0.3, 0.6]",
                "[0.3, 0.6]",
                {"isa.load_use_fraction.range", "does not contain the value 0.25"}},
        BadEdit{"range_of_one",
                "range: [0, 0.6]",
                "range: [0]",
                "range: [0]",
                {"isa.load_use_fraction.range", "[low, high]"}},
        BadEdit{"range_of_words",
                "range: [0, 0.6]",
                "range: [low, 0.6]",
                "[low, 0.6]",
                {"isa.load_use_fraction.range", "'low' is not a number"}},
        BadEdit{"range_beyond_limits",
                "range: [0, 0.6]",
                "range: [0, 6]",
                "range: [0, 6]",
                {"isa.load_use_fraction.range", "out of range", "0 to 1"}},
        BadEdit{"number_without_a_map",
                "value: 1.5625, unit: MiB",
                "value: [1], unit: MiB",
                "[1]",
                {"l2.size.value", "is a list", "expected a single value"}},
        BadEdit{"missing_name", "name: GAP9", "nmae: GAP9", "", {"name", "missing key"}},
        BadEdit{"missing_sources", "\nsources:", "\nsauces:", "", {"sources", "missing key"}},
        BadEdit{"syntax",
                "value: 8, unit: cores",
                "value: 8, unit: cores }}",
                "cores }}",
                {"not valid YAML"}},
        BadEdit{"second_document",
                "\nl2:\n",
                "\n---  # here\nl2:\n",
                "# here",
                {"second document", "expected one"}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Loader, RefusesParametersThatAreNoMaps) {
  const std::string text = replaced(gap9_text(), "  l1:\n", "  l1:\n    size: 128 KiB\n    # ");
  expect_parts(fault_of([&] { resolve_platform_text("my.yaml", text); }),
               {"cluster.l1.size", "is a single value", "value", "unit", "source", "confidence"});
}

TEST(Loader, RefusesSectionsThatAreNoMaps) {
  for (const char* section : {"cluster: 5", "cluster:", "cluster: []", "cluster: {}"}) {
    const std::string text = std::string("name: A\ndescription: B\nsources: {}\n") + section;
    EXPECT_THROW(resolve_platform_text("my.yaml", text), InputError) << section;
  }
}

TEST(Loader, RefusesFilesThatAreNoPlatforms) {
  for (const char* text : {"", "# nothing\n", "42", "- a\n- b\n", "? [a]\n: b\n", "name: [x]\n"})
    expect_parts(fault_of([&] { resolve_platform_text("my.yaml", text); }), {"my.yaml:1"});
}

TEST(Loader, UnknownPlatformListsTheKnownOnes) {
  expect_parts(fault_of([] { load_platform("gap8x"); }),
               {"unknown platform 'gap8x'", "did you mean 'gap8'",
                "built in: arm1176, cortex-m4f, cortex-m7, cortex-m7-h7a3, gap8, gap9, gap9-240mhz",
                ".yaml"});
}

TEST(Loader, UnreadableFileIsNamed) {
  expect_parts(fault_of([] { load_platform("/no/such/file.yaml"); }),
               {"/no/such/file.yaml", "cannot be opened as a platform file"});
  expect_parts(fault_of([] { load_platform("/"); }), {"/: cannot be opened as a platform file"});
}

TEST(Loader, LoadsFilesByPath) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() /
      ("leviosim_platform_" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
       "_loads_files.yaml");
  std::ofstream(path) << replaced(gap9_text(), "value: 370, unit: MHz", "value: 240, unit: MHz");
  EXPECT_EQ(load_platform(path.string()).cluster.clock.count(), 240'000'000);
  std::filesystem::remove(path);
}

TEST(Loader, BuiltInPlatformsAreListedAndLoad) {
  EXPECT_EQ(platform_names(),
            (std::vector<std::string>{"arm1176", "cortex-m4f", "cortex-m7", "cortex-m7-h7a3",
                                      "gap8", "gap9", "gap9-240mhz", "gap9-370mhz", "gap9-corners",
                                      "gap9-eigen", "gap9-hamming"}));
  for (const std::string& name : platform_names()) EXPECT_NO_THROW(load_platform(name));
}

TEST(Loader, KeepsSourcesRangesAndNotes) {
  for (const Parameter& p : resolve_platform("gap9").parameters) {
    if (p.path != "cluster.dma.programming") continue;
    EXPECT_EQ(p.value, "20");
    EXPECT_EQ(p.unit, "cycles");
    EXPECT_EQ(p.source, "DOC-3, derived (FACTS.md#cluster-dma)");
    EXPECT_EQ(p.confidence, "medium");
    ASSERT_TRUE(p.range);
    EXPECT_EQ(p.range->low, 10);
    EXPECT_EQ(p.range->high, 30);
    EXPECT_FALSE(p.note.empty());
    return;
  }
  FAIL() << "no such parameter";
}

// Differences of the cores hold whatever the order of sections in the file.
TEST(Loader, OrderOfSectionsDoesNotMatter) {
  const std::string text = gap9_text();
  const std::size_t isa = text.find("\nisa:");
  const std::size_t cluster = text.find("\ncluster:");
  const std::string moved =
      text.substr(0, isa) + text.substr(cluster) + text.substr(isa, cluster - isa) + "\n";
  EXPECT_EQ(numbers_of(resolve_platform_text("moved.yaml", moved).config),
            numbers_of(load_platform("gap9")));
}

// A chip without floating-point hardware is one whose operations run on the core.
}  // namespace
}  // namespace leviosim::platform
