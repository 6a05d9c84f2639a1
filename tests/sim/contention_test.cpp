// How a unit that is too small is shared: whoever asks for less than a fair share gets it, and the
// others share the rest.
#include "sim/chip/contention.h"

#include <gtest/gtest.h>

#include "tests/sim/chip_test_config.h"

namespace leviosim::sim {
namespace {

Runner asking(int core, Unit unit, double requests, double busy) {
  Runner runner;
  runner.core = core;
  runner.units[static_cast<std::size_t>(unit)] = {requests, requests * busy};
  return runner;
}

TEST(Contention, ALightUserOfTheDividerIsServedAndTheOthersShareTheRest) {
  Contention contention(test_cluster());
  std::vector<Progress> progress;
  contention.solve({asking(0, Unit::Divider, 0.01, 10), asking(1, Unit::Divider, 0.1, 10),
                    asking(2, Unit::Divider, 0.1, 10)},
                   progress);
  EXPECT_NEAR(progress[0].rate, 1, 1e-9);  // a tenth of the divider
  for (const std::size_t i : {1, 2}) {
    EXPECT_NEAR(progress[i].rate, 0.45, 1e-9);  // of the nine tenths that are left, a half each
    EXPECT_NEAR(progress[i].divider, 0.55, 1e-9);
  }
}

TEST(Contention, RequestsOfDifferentLengthTakeTurns) {
  Contention contention(test_cluster());
  std::vector<Progress> progress;
  contention.solve({asking(0, Unit::Divider, 0.1, 5), asking(1, Unit::Divider, 0.1, 10)}, progress);
  // In turns of 5 and 10 cycles each makes one request every 15.
  for (const Progress& p : progress) EXPECT_NEAR(p.rate, 10.0 / 15, 1e-9);
}

TEST(Contention, AWaitForABankAddsToThatForBanksOnAverage) {
  Contention contention(test_cluster());
  std::vector<Progress> progress;
  Runner a = asking(0, Unit::Bank, 0.8, 1), b = asking(1, Unit::Bank, 0.8, 1);
  a.scattered = b.scattered = 0.2;
  contention.solve({a, b}, progress);
  for (const Progress& p : progress) {
    EXPECT_NEAR(p.rate, 1 / 1.6, 1e-6);
    EXPECT_NEAR(p.rate + p.banks, 1, 1e-6);
  }
}

}  // namespace
}  // namespace leviosim::sim
