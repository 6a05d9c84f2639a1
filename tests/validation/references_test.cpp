// Published figures as data: what the file may say, how errors are judged, how it is kept current.
#include "tools/app/validation/references.h"

#include "tests/traces/test_folder.h"

namespace leviosim::tools {
namespace {

using traces::testing::expect_input_error;

const std::string kHeader = "name,value,unit,tolerance,guard,status,source\n";

Reference one(const std::string& row) { return parse_references("f.csv", kHeader + row).at(0); }

TEST(ValidationReferences, ReadsARow) {
  const Reference met = one("a.b,100,kcycles,12 %,,met,table 1\n");
  EXPECT_EQ(met.name, "a.b");
  EXPECT_EQ(met.value, 100);
  EXPECT_FALSE(met.limit);
  EXPECT_EQ(met.unit, "kcycles");
  EXPECT_EQ(met.tolerance.value, 12);
  EXPECT_TRUE(met.tolerance.relative);
  EXPECT_TRUE(met.met);
  EXPECT_FALSE(met.guard.has_value());
  EXPECT_EQ(met.source, "table 1");
  const Reference missed = one("a.b,<50,ms,0.5,2,missed: no caches,text\n");
  EXPECT_TRUE(missed.limit);
  EXPECT_FALSE(missed.tolerance.relative);
  EXPECT_FALSE(missed.met);
  EXPECT_EQ(missed.guard, 2);
  EXPECT_EQ(missed.reason, "no caches");
}

TEST(ValidationReferences, RefusesFaultsWithFileAndLine) {
  const auto refuse = [](const std::string& row, std::initializer_list<std::string> parts) {
    expect_input_error([&] { one("# a comment\n" + row); }, parts);
  };
  refuse("a,1,x,1,,met\n", {"f.csv line 3", "6 columns", "instead of 7"});
  refuse("a,1,x,1,,met,s,t\n", {"8 columns"});
  refuse("a,one,x,1,,met,s\n", {"f.csv line 3", "value", "'one'", "not a finite number"});
  refuse("a,1,x,-1,,met,s\n", {"tolerance", "0 or more"});
  refuse("a,1,,1,,met,s\n", {"unit"});
  refuse("a,1,x,1,,met,\n", {"source"});
  refuse("a,0,x,1 %,,met,s\n", {"value 0"});
  refuse("a,1,x,1,2,met,s\n", {"met", "no guard"});
  refuse("a,1,x,1,2,missed,s\n", {"status", "'missed'", "missed: REASON"});
  refuse("a,1,x,1,,missed: why,s\n", {"guard"});
  refuse("a,1,x,1,1,missed: why,s\n", {"guard", "more than the tolerance"});
  refuse("a,1,x,1,2 %,missed: why,s\n", {"both"});
  refuse("a,1,x,1,,met,s\na,1,x,1,,met,s\n", {"f.csv line 4", "'a' is there twice"});
  expect_input_error([] { parse_references("f.csv", "name,value\n"); },
                     {"f.csv line 1", "2 columns"});
  expect_input_error([] { parse_references("f.csv", ""); }, {"f.csv", "titles"});
}

TEST(ValidationReferences, ErrorsAreRelativeAbsoluteOrOfALimit) {
  const Reference relative = one("a,200,x,1 %,,met,s\n");
  EXPECT_DOUBLE_EQ(error_of(relative, 210), 5);
  EXPECT_DOUBLE_EQ(error_of(relative, 190), -5);
  const Reference absolute = one("a,7.46,x,0.35,,met,s\n");
  EXPECT_NEAR(error_of(absolute, 7.26), -0.2, 1e-12);
  const Reference limit = one("a,<50,x,10 %,,met,s\n");
  EXPECT_EQ(error_of(limit, 10), 0);
  EXPECT_EQ(error_of(limit, 50), 0);
  EXPECT_DOUBLE_EQ(error_of(limit, 60), 20);
}

TEST(ValidationReferences, WhatIsMissedIsGuardedAndWhatBecomesGoodIsNoticed) {
  const Reference met = one("a,100,x,5 %,,met,s\n");
  EXPECT_EQ(judge(met, 105), Verdict::Met);
  EXPECT_EQ(judge(met, 94.9), Verdict::Worse);
  const Reference missed = one("a,100,x,5 %,20 %,missed: why,s\n");
  EXPECT_EQ(judge(missed, 120), Verdict::Missed);
  EXPECT_EQ(judge(missed, 80), Verdict::Missed);
  EXPECT_EQ(judge(missed, 121), Verdict::Worse);
  EXPECT_EQ(judge(missed, 104), Verdict::Improved);
  EXPECT_EQ(judge(missed, {}), Verdict::NotCovered);
}

TEST(ValidationReferences, AnUpdateJudgesItsOwnRunAsMetOrMissed) {
  const std::string text = kHeader +
                           "# a comment\n"
                           "a,100,x,5 %,,met,s\n"
                           "b,100,x,5 %,20 %,missed: why,s\n"
                           "c,7.46,x,0.35,,met,s\n"
                           "d,<10,x,0,,met,s\n"
                           "e,1,x,5 %,,met,s\n";
  const std::vector<std::optional<double>> values{130.26, 101.0, 9.3, 12.345, {}};
  const std::string updated = updated_references("f.csv", text, values, "new");
  EXPECT_EQ(updated, kHeader +
                         "# a comment\n"
                         "a,100,x,5 %,30.3 %,missed: new,s\n"
                         "b,100,x,5 %,,met,s\n"
                         "c,7.46,x,0.35,1.85,missed: new,s\n"
                         "d,<10,x,0,2.35,missed: new,s\n"
                         "e,1,x,5 %,,met,s\n");
  const std::vector<Reference> references = parse_references("f.csv", updated);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(judge(references[i], values[i]), references[i].met ? Verdict::Met : Verdict::Missed)
        << references[i].name;
  EXPECT_EQ(updated_references("f.csv", updated, values, "other"), updated);
}

TEST(ValidationReferences, OfThePaperAreConsistentWithEachOther) {
  const std::vector<Reference> all = paper_references();
  const auto value = [&](const std::string& name) {
    for (const Reference& r : all)
      if (r.name == name) return r.value;
    ADD_FAILURE() << name;
    return 0.0;
  };
  double front = 0;
  for (const char* stage : {"feature_extraction", "frame_matching", "world_matching"}) {
    const std::string path = std::string("compute.") + stage;
    EXPECT_NEAR(value(path + ".single") / value(path + ".multi"), value(path + ".speedup"), 0.01);
    front += value(path + ".multi");
  }
  const double epnp = value("compute.epnp_ransac.multi");
  const double eight_point = value("compute.eight_point_ransac.multi");
  EXPECT_NEAR(100 * epnp / (front + epnp), value("share.epnp"), 0.1);
  EXPECT_NEAR(100 * eight_point / (front + eight_point), value("share.eight_point"), 0.05);
  EXPECT_NEAR((front + epnp) / 370, value("latency.epnp"), 0.005);
  EXPECT_NEAR((front + eight_point + 374) / 370, value("latency.eight_point_keyframe"), 0.005);
}

}  // namespace
}  // namespace leviosim::tools
