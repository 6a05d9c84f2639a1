// Exact ties on the Pareto front: what is as good in everything is not worse.
#include "tools/app/study/sweep/pareto_front.h"
#include "tools/app/study/sweep/sweep_store.h"

#include <gtest/gtest.h>

namespace leviosim::tools {
namespace {

using Values = std::array<std::optional<double>, kObjectives.size()>;

SweepOutcome outcome(int point, const Values& values) { return {point, "", values}; }

std::vector<int> front_of(const std::vector<SweepOutcome>& outcomes) {
  std::vector<int> points;
  for (const SweepOutcome& o : pareto_front(outcomes)) points.push_back(o.point);
  return points;
}

TEST(ParetoTies, EqualPointsAreAllOnTheFront) {
  const Values same{1, 2, 3, 4, 5};
  EXPECT_FALSE(dominates(outcome(1, same), outcome(2, same)));
  EXPECT_EQ(front_of({outcome(3, same), outcome(1, same), outcome(2, same)}),
            (std::vector{1, 2, 3}));
}

TEST(ParetoTies, APointThatIsWorseInOneAndEqualInTheRestIsBeaten) {
  for (std::size_t k = 0; k < kObjectives.size(); ++k) {
    Values worse{1, 2, 3, 4, 5};
    *worse[k] += 0.5;
    const SweepOutcome good = outcome(2, {1, 2, 3, 4, 5}), bad = outcome(1, worse);
    EXPECT_TRUE(dominates(good, bad)) << k;
    EXPECT_FALSE(dominates(bad, good)) << k;
    EXPECT_EQ(front_of({bad, good}), std::vector{2}) << k;
  }
}

TEST(ParetoTies, AFigureThatIsMissingIsTheWorstAndEqualToOneThatIsMissing) {
  const Values without{1, 2, 3, std::nullopt, 5};
  EXPECT_EQ(front_of({outcome(1, without), outcome(2, {1, 2, 3, 4, 5})}), std::vector{2});
  EXPECT_EQ(front_of({outcome(1, without), outcome(2, without)}), (std::vector{1, 2}));
}

TEST(ParetoTies, AFailureIsOnNoFront) {
  SweepOutcome failed = outcome(1, {0, 0, 0, 0, 0});
  failed.failure = "too little L1";
  EXPECT_EQ(front_of({failed, outcome(2, {1, 2, 3, 4, 5})}), std::vector{2});
}

}  // namespace
}  // namespace leviosim::tools
