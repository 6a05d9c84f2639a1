// Parameters by name: each reaches a field of its own, with a default within its range.
#include "workload/vio/parameters.h"
#include "workload/vio/profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace leviosim::vio {
namespace {

/// A valid value that is not `value`.
double another(const Parameter& parameter, double value) {
  if (parameter.kind == Parameter::Kind::toggle) return 1 - value;
  return value == parameter.low ? parameter.high : parameter.low;
}

TEST(WorkloadParameters, HaveNamesOfTheirOwn) {
  std::set<std::string_view> names;
  for (const Parameter& p : parameters()) {
    EXPECT_TRUE(names.insert(p.name).second) << p.name;
    EXPECT_EQ(p.name.substr(0, kParameterPrefix.size()), kParameterPrefix);
    EXPECT_EQ(find_parameter(p.name), &p);
  }
  EXPECT_EQ(find_parameter("workload.windows"), nullptr);
}

TEST(WorkloadParameters, DefaultsAreValid) {
  for (const std::string& name : profile_names())
    for (const Parameter& p : parameters())
      EXPECT_TRUE(is_valid(p, p.get(profile_named(name, 1)))) << name << ' ' << p.name;
}

TEST(WorkloadParameters, EachSetsItsOwnFieldOnly) {
  const Profile before = profile_named("levio", 1);
  for (const Parameter& p : parameters()) {
    Profile after = before;
    const double value = another(p, p.get(before));
    vio::set_parameters(std::vector<Assignment>{{&p, value}}, after);
    EXPECT_EQ(static_cast<float>(p.get(after)), static_cast<float>(value)) << p.name;
    for (const Parameter& other : parameters()) {
      if (&other == &p) continue;
      EXPECT_EQ(other.get(after), other.get(before)) << p.name << ' ' << other.name;
    }
  }
}

TEST(WorkloadParameters, ReachTheProfile) {
  Profile profile = profile_named("levio", 1);
  vio::set_parameters(std::vector<Assignment>{{find_parameter("workload.window"), 5},
                                              {find_parameter("workload.keyframe_parallax"), 0.1},
                                              {find_parameter("workload.reprojection_noise"), 2},
                                              {find_parameter("workload.imu_noise.gyro"), 0.03},
                                              {find_parameter("workload.imu_noise.accel"), 0.3},
                                              {find_parameter("workload.gravity_updates"), 0}},
                      profile);
  EXPECT_EQ(profile.optimiser_keyframes, 5);
  EXPECT_EQ(profile.keyframe_parallax, 0.1f);
  EXPECT_EQ(profile.optimiser.visual.sigma_px, 2);
  EXPECT_EQ(profile.imu_noise.gyro, 0.03f);
  EXPECT_EQ(profile.imu_noise.accel, 0.3f);
  EXPECT_FALSE(profile.gravity_updates);
}

TEST(WorkloadParameters, RangesAndKindsAreKept) {
  const Parameter& window = *find_parameter("workload.window");
  EXPECT_TRUE(is_valid(window, 2));
  EXPECT_FALSE(is_valid(window, 1));
  EXPECT_FALSE(is_valid(window, 2.5));
  EXPECT_FALSE(is_valid(window, 33));
  EXPECT_FALSE(is_valid(*find_parameter("workload.gravity_updates"), 2));
  EXPECT_FALSE(is_valid(*find_parameter("workload.huber"), std::nan("")));
}

TEST(WorkloadParameters, AreWrittenAsUsersWriteThem) {
  const Parameter& parallax = *find_parameter("workload.keyframe_parallax");
  EXPECT_EQ(value_text(parallax, parallax.get(profile_named("levio", 1))), "0.05");
  const Assignment window{find_parameter("workload.window"), 6};
  EXPECT_EQ(window.text(), "workload.window=6");
  EXPECT_EQ((Assignment{find_parameter("workload.gravity_updates"), 0}).text(),
            "workload.gravity_updates=off");
}

}  // namespace
}  // namespace leviosim::vio
