// What the accelerometer of a recording reads at rest.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "traces/datasets/rest_gravity.h"

namespace leviosim::traces {
namespace {

Dataset samples_of(double seconds, const std::function<ImuSample(double)>& at) {
  Dataset data;
  for (int i = 0; i <= static_cast<int>(200 * seconds); ++i) {
    ImuSample sample = at(i / 200.0);
    sample.t_ns = std::int64_t{i} * 5'000'000;
    data.imu.push_back(sample);
  }
  return data;
}

TEST(GravityAtRest, IsThatOfTheQuietestSecond) {
  const auto flight = [](double rest_reads, bool turns) {
    return samples_of(6, [=](double t) {
      ImuSample sample;
      const bool rests = t >= 2 && t < 4;
      sample.accel = {rests ? 0 : 3 * std::sin(20 * t), 0, rests ? rest_reads : 9.81};
      if (turns) sample.gyro = {0, 0.5, 0};
      return sample;
    });
  };
  EXPECT_NEAR(gravity_at_rest(flight(10.1, false)).value(), 10.1, 1e-6);
  EXPECT_FALSE(gravity_at_rest(flight(10.1, true))) << "it turns";
  EXPECT_FALSE(gravity_at_rest(samples_of(0.5, [](double) {
    return ImuSample{0, {}, {0, 0, 9.81}};
  })));
}

}  // namespace
}  // namespace leviosim::traces
