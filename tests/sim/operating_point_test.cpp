// Clocks and voltages on the line between two points.
#include "sim/energy/supply.h"

#include <gtest/gtest.h>

namespace leviosim::sim {
namespace {

constexpr SupplyConfig kSupply{
    Volts(0.8), Volts(0.05), {Volts(0.65), Hertz(240'000'000)}, {Volts(0.80), Hertz(370'000'000)}};

TEST(OperatingPoint, TheHighestClockLiesOnALine) {
  EXPECT_EQ(highest_clock(kSupply, Volts(0.65)), Hertz(240'000'000));
  EXPECT_EQ(highest_clock(kSupply, Volts(0.80)), Hertz(370'000'000));
  EXPECT_EQ(highest_clock(kSupply, Volts(0.725)), Hertz(305'000'000));
}

TEST(OperatingPoint, TheSupplyHasSteps) {
  for (const double volts : {0.65, 0.7, 0.75, 0.8}) EXPECT_TRUE(can_supply(kSupply, Volts(volts)));
  for (const double volts : {0.6, 0.66, 0.725, 0.85})
    EXPECT_FALSE(can_supply(kSupply, Volts(volts))) << volts;
}

TEST(OperatingPoint, TheLowestVoltageForAClockIsAStepThatReachesIt) {
  EXPECT_NEAR(lowest_voltage(kSupply, Hertz(1)).value().count(), 0.65, 1e-12);
  EXPECT_NEAR(lowest_voltage(kSupply, Hertz(240'000'000)).value().count(), 0.65, 1e-12);
  EXPECT_NEAR(lowest_voltage(kSupply, Hertz(240'000'001)).value().count(), 0.70, 1e-12);
  EXPECT_NEAR(lowest_voltage(kSupply, Hertz(300'000'000)).value().count(), 0.75, 1e-12);
  EXPECT_NEAR(lowest_voltage(kSupply, Hertz(370'000'000)).value().count(), 0.80, 1e-12);
  EXPECT_FALSE(lowest_voltage(kSupply, Hertz(370'000'001)));
}

TEST(OperatingPoint, OneVoltageIsALineToo) {
  SupplyConfig fixed = kSupply;
  fixed.lowest.voltage = Volts(0.8);
  EXPECT_EQ(highest_clock(fixed, Volts(0.8)), Hertz(370'000'000));
  EXPECT_FALSE(lowest_voltage(fixed, Hertz(370'000'001)));
}

}  // namespace
}  // namespace leviosim::sim
