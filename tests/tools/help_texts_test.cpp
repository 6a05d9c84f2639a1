// What users read of a parameter or a statistic begins with what it is: a noun, to which its unit
// belongs.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "platform_models/loader/fields.h"
#include "tests/tools/example_run.h"
#include "tools/app/record/statistics.h"
#include "tools/app/result/summary.h"
#include "workload/vio/parameters.h"

namespace leviosim::tools {
namespace {

/// Words with which a text goes on that says nothing by itself ("of a patch"), tells a rule ("a
/// frame with fewer is no keyframe") or an order ("move features").
const std::set<std::string_view> kNoBeginning{
    "a",      "above", "after",   "align",  "all",    "an",       "and",  "as",      "at",
    "before", "below", "between", "beyond", "by",     "do",       "drop", "farther", "for",
    "from",   "how",   "if",      "in",     "its",    "kept",     "look", "measure", "move",
    "nearer", "no",    "of",      "on",     "one",    "optimise", "over", "per",     "recognise",
    "rely",   "seen",  "since",   "such",   "than",   "that",     "the",  "then",    "this",
    "times",  "to",    "turned",  "under",  "unseen", "what",     "when", "where",   "whether",
    "which",  "while", "whose",   "with",   "without"};

void expect_noun_first(const std::string& name, std::string_view text) {
  const std::string_view first = text.substr(0, text.find_first_of(" ,;:"));
  EXPECT_FALSE(first.empty() || kNoBeginning.contains(first)) << name << ": " << text;
}

TEST(HelpTexts, OfParametersOfTheWorkloadBeginWithANoun) {
  ASSERT_GT(vio::parameters().size(), 100u);
  for (const vio::Parameter& parameter : vio::parameters())
    expect_noun_first(std::string(parameter.name), parameter.description);
}

TEST(HelpTexts, OfParametersOfChipsBeginWithANoun) {
  const std::vector<platform::Field> fields = platform::all_fields();
  ASSERT_GT(fields.size(), 100u);
  for (const platform::Field& field : fields) expect_noun_first(field.path, field.description);
}

TEST(HelpTexts, OfStatisticsBeginWithANoun) {
  const RunFigures figures = figures_of(testing::example_run());
  ASSERT_GT(figures.statistics.size(), 100u);
  for (const Statistic& statistic : figures.statistics)
    if (statistic.name.find(".breakdown.") ==
        std::string::npos)  // a cause: "the master works alone"
      expect_noun_first(statistic.name, statistic.description);
}

}  // namespace
}  // namespace leviosim::tools
