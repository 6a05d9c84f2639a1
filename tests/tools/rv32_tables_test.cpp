// The tables that tools/rv32/measure.sh leaves in the repository fit the sources they were made
// from. Nothing is compiled or traced here.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "platform_models/loader/loader.h"
#include "sim/base/csv.h"
#include "sim/work/compiled_work.h"
#include "sim/work/op.h"
#include "tests/support/named_functions.h"
#include "tests/support/paths.h"

namespace leviosim::tools {
namespace {

const std::filesystem::path kSource = leviosim::tests::source_folder();

struct Segment {
  std::string function, after;
  double lines, visits, refetches;
  double executed = 0, priced = 0;  ///< of a visit; 0 where it was not measured
};

/// The tables of all instruction sets have the same functions.
class CompiledTables : public ::testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(All, CompiledTables, ::testing::ValuesIn(work::kCompiledFor),
                         [](const auto& set) { return std::string(set.param); });

std::vector<Segment> segments(std::string_view table) {
  base::CsvReader csv(kSource / fmt::format("platform_models/code/{}.csv", table),
                      base::Separator::comma,
                      {"function", "after", "lines", "visits", "refetches", "executed", "priced",
                       "loads", "used_at_once", "executed_loops", "priced_loops"});
  const base::CsvRow* row = csv.next();
  EXPECT_EQ(row->text(0), "function");
  std::vector<Segment> result;
  while ((row = csv.next()) != nullptr) {
    result.push_back({std::string(row->text(0)), std::string(row->text(1)), row->number(2),
                      row->number(3), row->number(4)});
    if (row->text(5).empty()) continue;
    result.back().executed = row->number(5);
    result.back().priced = row->number(6);
  }
  return result;
}

const std::set<std::string> kLibrary = {"f64_add",    "f64_sub",     "f64_mul",
                                        "f64_div",    "f64_compare", "f64_widen",
                                        "f64_narrow", "popcount",    "memset"};

TEST_P(CompiledTables, HasAnEntryForEveryNamedFunctionOfTheWorkload) {
  std::set<std::string> measured;
  for (const Segment& segment : segments(GetParam()))
    if (segment.after.empty()) measured.insert(segment.function);
  const std::set<std::string> names = leviosim::tests::named_functions();
  EXPECT_GT(names.size(), 50u);
  for (const std::string& name : names)
    EXPECT_TRUE(measured.contains(name))
        << name << " has no footprint: run tools/rv32/measure.sh";
}

/// A chip that executes the code of each table, and what is set on it.
struct ChipOfTable {
  std::string name;
  std::vector<std::string> overrides;
};
const std::map<std::string_view, ChipOfTable> kChips{{"rv32imfc", {"gap9", {"isa.base=rv32imfc"}}},
                                                     {"rv32imfc_xpulp", {"gap9", {}}},
                                                     {"thumb2", {"cortex-m4f", {}}},
                                                     {"armv6", {"arm1176", {}}}};

/// The range that code gets which was not measured: the middle four fifths of the work of code that
/// was, by its ratio of executed to counted instructions.
TEST_P(CompiledTables, TheRangeOfUnmeasuredCodeIsThatOfMeasuredCode) {
  if (GetParam() == "rv32imfc_xpulp")
    GTEST_SKIP() << "its range is that of kernels with published cycles: bands_test.cpp";
  std::vector<std::pair<double, double>> works_of_ratios;
  double all = 0;
  for (const Segment& segment : segments(GetParam())) {
    if (!(segment.priced > 0)) continue;
    const double work = segment.priced * segment.visits;
    works_of_ratios.emplace_back(segment.executed / segment.priced, work);
    all += work;
  }
  std::sort(works_of_ratios.begin(), works_of_ratios.end());
  const auto quantile = [&](double share) {
    double sum = 0;
    for (const auto& [ratio, work] : works_of_ratios)
      if ((sum += work) >= share * all) return ratio;
    return works_of_ratios.back().first;
  };
  const ChipOfTable& of_table = kChips.at(GetParam());
  const platform::ResolvedPlatform chip =
      platform::resolve_platform(of_table.name, of_table.overrides);
  const auto parameter =
      std::find_if(chip.parameters.begin(), chip.parameters.end(),
                   [](const auto& p) { return p.path == "isa.unmeasured_instructions"; });
  ASSERT_NE(parameter, chip.parameters.end());
  EXPECT_NEAR(quantile(0.1), parameter->range->low, 0.05);
  EXPECT_NEAR(quantile(0.9), parameter->range->high, 0.05);
}

TEST_P(CompiledTables, NamesNoFunctionThatTheWorkloadDoesNotHave) {
  const std::set<std::string> names = leviosim::tests::named_functions();
  for (const Segment& segment : segments(GetParam())) {
    EXPECT_TRUE(names.contains(segment.function) || kLibrary.contains(segment.function))
        << segment.function << " is gone: run tools/rv32/measure.sh";
    EXPECT_TRUE(segment.after.empty() || names.contains(segment.after)) << segment.after;
  }
}

TEST_P(CompiledTables, IsSortedWithoutRepetitionAndPlausible) {
  const std::vector<Segment> table = segments(GetParam());
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Segment& segment = table[i];
    EXPECT_GE(segment.lines, 0) << segment.function;
    EXPECT_LT(segment.lines, 1000) << segment.function;
    EXPECT_GE(segment.visits, 1) << segment.function;
    EXPECT_GE(segment.refetches, 0) << segment.function;
    // What fits into the small cache is fetched once.
    if (segment.lines <= 25) {
      EXPECT_LT(segment.refetches, segment.lines + 1) << segment.function;
    }
    if (i > 0) {
      EXPECT_LT(std::pair(table[i - 1].function, table[i - 1].after),
                std::pair(segment.function, segment.after));
    }
  }
}

/// Executed instructions of units of work beside those of the release.
/// @param section  the title above the table
void expect_units_within_a_tenth(const std::string& page, const std::string& section, int count) {
  const std::string text = base::read_text_file(kSource / "tools/rv32" / page);
  const std::size_t begin = text.find(section);
  ASSERT_NE(begin, std::string::npos) << page;
  const std::string table = text.substr(begin);
  static const std::regex row(R"(\n\| ([^|]+) \| ([0-9,]+) \| ([0-9,.]+) \| ([0-9.]+) \|)");
  int units = 0;
  for (std::sregex_iterator it(table.begin(), table.end(), row), end; it != end; ++it, ++units)
    EXPECT_NEAR(std::stod((*it)[4]), 1, 0.1) << (*it)[1];
  EXPECT_EQ(units, count) << page;
}

TEST(Rv32Units, AreThoseOfTheReleasedProgramWithinATenth) {
  expect_units_within_a_tenth("units.md", "# Units of the released program's work", 12);
  expect_units_within_a_tenth("rv32imfc_xpulp.md", "## Units of the released program's work", 1);
}

/// Operations of the vocabulary that the compiled workload does not use have no row.
TEST(Rv32Costs, PriceKnownOperationsOnce) {
  const std::string text = base::read_text_file(kSource / "tools/rv32/rv32imfc_costs.csv");
  std::multiset<std::string> priced;
  static const std::regex row("\n([a-z0-9_]+),([0-9.]+),");
  for (std::sregex_iterator it(text.begin(), text.end(), row), end; it != end; ++it)
    priced.insert((*it)[1]);
  EXPECT_GE(priced.size(), 30u);
  for (const std::string& name : priced) {
    EXPECT_EQ(priced.count(name), 1u) << name;
    EXPECT_TRUE(std::any_of(work::kOps.begin(), work::kOps.end(), [&](const work::OpInfo& info) {
      return info.name == name;
    })) << name;
  }
}

}  // namespace
}  // namespace leviosim::tools
