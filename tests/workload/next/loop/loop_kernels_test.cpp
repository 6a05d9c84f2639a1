// The parts of loop closure: transforms, storage, signatures, forgetting, matching, verification.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "sim/work/machine.h"
#include "tests/workload/next/loop/loop_world.h"
#include "workload/next/loop/densest_place.h"
#include "workload/next/loop/loop_graph.h"
#include "workload/next/loop/place_matching.h"
#include "workload/next/loop/view_signature.h"

namespace leviosim::vio::test {
namespace {

using Native = work::Native;
using Counting = work::Counting;

TEST(YawTransform, TurnsAboutTheVerticalAndMoves) {
  const YawTransform<Native> T{0.7f, {1, 2, 3}};
  const Pose<Native> pose = to_pose<Pose<Native>>(camera_pose({3, -1, 2}, 0.4, 0.1, -0.2));
  const Pose<Native> moved = T * pose;
  const Pose<Native> expected = to_pose<Pose<Native>>([] {
    Eigen::Isometry3d Rz = Eigen::Isometry3d::Identity();
    Rz.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    Rz.translation() = Eigen::Vector3d(1, 2, 3);
    return Rz * camera_pose({3, -1, 2}, 0.4, 0.1, -0.2);
  }());
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(moved.R.m[r][c], expected.R.m[r][c], 1e-6);
  EXPECT_LT((position_of(moved) - position_of(expected)).norm(), 2e-6);
  const Vec3<Native> to = T * pose.t;
  const YawTransform<Native> again = yaw_transform_between<Native>(0.7f, pose.t, to);
  EXPECT_NEAR(again.t.x, 1, 2e-6);
  EXPECT_NEAR(again.t.z, 3, 2e-6);
}

TEST(YawTransform, WrapsAngles) {
  EXPECT_NEAR(wrapped<Native>(3.5f), 3.5 - 2 * std::numbers::pi, 1e-6);
  EXPECT_NEAR(wrapped<Native>(-3.5f), 2 * std::numbers::pi - 3.5, 1e-6);
  EXPECT_EQ(wrapped<Native>(0.5f), 0.5f);
}

TEST(PlaceStore, KeepsPointsToHalfAMillimetre) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const auto x = static_cast<float>(random.uniform(-kFarthestPoint, kFarthestPoint));
    const int stored = stored_coordinate<Native>(x);
    EXPECT_GE(stored, 0);
    EXPECT_LE(stored, 0xffff);
    EXPECT_NEAR(loaded_coordinate<Native>(stored), x, 0.000504);
  }
}

/// The largest that users can ask for, which is the default.
TEST(PlaceStore, TakesNoMoreThan256kBAndAllOfItAtOnce) {
  LoopFlight<Native> flight{LoopOptions{}};
  const Bytes before = flight.memory().used();
  EXPECT_LE(before.count(), 256'000);
  EXPECT_GT(before.count(), 240'000);
  const HallOptions hall;
  const std::vector<WorldPoint> world = make_panels(hall);
  Random random(1);
  for (double path = 0; path < 50; path += 0.31)
    flight.show(look(world, pose_on_lap(hall, path), random), pose_on_lap(hall, path));
  EXPECT_GT(flight.removed, 0);
  EXPECT_EQ(flight.memory().used(), before);
}

TEST(Signature, HasABitForEveryByteAndCountsWhatIsShared) {
  std::array<std::uint32_t, kSignatureWords> a{}, b{};
  const Native::Span<std::uint32_t> first(a.data(), kSignatureWords),
      second(b.data(), kSignatureWords);
  EXPECT_EQ(similarity<Native>(first, second), 0);
  const Descriptor words{0x11, 1, 0xff, 1, 0x00, 1, 0x20, 1};
  add_to_signature<Native>(words, first);
  EXPECT_EQ(a[0], 1u << 0x11);
  EXPECT_EQ(a[8 + 7], 1u << 31);
  EXPECT_EQ(a[16], 1u);
  EXPECT_EQ(a[24 + 1], 1u);
  add_to_signature<Native>(words, second);
  EXPECT_EQ(similarity<Native>(first, second), 1000);
  add_to_signature<Native>(Descriptor{0x12, 0, 0xfe, 0, 0x01, 0, 0x20, 0}, second);
  EXPECT_EQ(similarity<Native>(first, second), 2000 * 4 / (4 + 7));
}

TEST(Signature, RanksAViewOfThePlaceFirst) {
  const HallOptions hall;
  const std::vector<WorldPoint> world = make_panels(hall);
  Random random(2);
  const auto signature_at = [&](double path) {
    std::array<std::uint32_t, kSignatureWords> words{};
    int number = 0;
    for (const Sight::Feature& f : look(world, pose_on_lap(hall, path), random).features)
      if (f.tracked && number++ < 48)
        add_to_signature<Native>(f.descriptor,
                                 Native::Span<std::uint32_t>(words.data(), kSignatureWords));
    return words;
  };
  const auto like = [](std::array<std::uint32_t, kSignatureWords> a,
                       std::array<std::uint32_t, kSignatureWords> b) {
    return similarity<Native>(Native::Span<std::uint32_t>(a.data(), kSignatureWords),
                              Native::Span<std::uint32_t>(b.data(), kSignatureWords));
  };
  int first = 0;
  for (int i = 0; i < 20; ++i) {
    const auto query = signature_at(i);
    const int here = like(query, signature_at(i));
    int better = 0;
    for (int other = 0; other < 20; ++other)
      if (std::abs(other - i) > 3 && like(query, signature_at(other)) > here) ++better;
    first += better == 0;
  }
  EXPECT_GE(first, 18);
}

/// Places in a row along x, all looking along x.
PlaceList<Native> row_of_places(work::Arena& arena, const std::vector<double>& xs) {
  PlaceList<Native> list(arena, {}, {});
  for (const double x : xs) {
    const int i = list.count++;
    list.set_odometry(i, to_pose<Pose<Native>>(camera_pose({x, 0, 0}, 0)));
    list.set_node(i, {0, {static_cast<float>(x), 0, 0}});
    list.travelled[i] = static_cast<float>(i);
    list.slots[i] = static_cast<std::uint16_t>(100 + i);
    list.features[i] = static_cast<std::uint16_t>(i);
  }
  return list;
}

TEST(Forgetting, TakesTheLaterOfTheTwoNearestPlaces) {
  work::Machine machine({8, "L1", Bytes(1 << 17), 1, false});
  const auto stage = machine.stage("forgetting");
  const auto densest = [&](const std::vector<double>& xs) {
    const work::Arena::Frame frame(machine.local());
    return densest_place(machine, row_of_places(machine.local(), xs), 1.0f);
  };
  EXPECT_EQ(densest({0, 1, 2, 2.9, 4, 5}), 3);
  EXPECT_EQ(densest({0, 1, 2, 3, 4, 0.1, 5}), 5);
  EXPECT_EQ(densest({0, 0.5, 2, 3, 4, 5, 4.9}), 1);  // the newest stays
  EXPECT_EQ(densest({0, 1, 2}), 1);
  const work::Arena::Frame frame(machine.local());
  PlaceList<Native> turned = row_of_places(machine.local(), {0, 1, 2, 2.5, 4, 6});
  turned.set_odometry(3, to_pose<Pose<Native>>(camera_pose({2.5, 0, 0}, 2.0)));
  EXPECT_EQ(densest_place(machine, turned, 1.0f), 1) << "it looks the other way";
}

/// What a closure says about two other places does not change if the odometry is right.
TEST(Forgetting, HandsClosuresOnToThePlaceBefore) {
  work::Arena arena("L1", Bytes(1 << 17));
  PlaceList<Native> list = row_of_places(arena, {0, 1, 2, 3, 4, 5});
  add_closure<Native>(list, {1, 4, {3, 0, 0}, 0, 0});
  add_closure<Native>(list, {2, 5, {3, 0, 0}, 0, 0.5f});
  add_closure<Native>(list, {0, 1, {1, 0, 0}, 0, 0});
  EXPECT_EQ(remove_place(list, 4), 104);
  ASSERT_EQ(list.closure_count, 3);
  EXPECT_EQ(list.closure(0).to, 3);
  EXPECT_NEAR(list.closure(0).between.x, 2, 1e-6);
  EXPECT_EQ(list.closure(0).path, 1);
  EXPECT_EQ(list.closure(1).to, 4) << "the same place, which has moved up";
  EXPECT_EQ(list.slots[4], 105);
  EXPECT_EQ(remove_place(list, 1), 101);
  ASSERT_EQ(list.closure_count, 2) << "the third joins the first place to itself";
  EXPECT_EQ(list.closure(0).from, 0);
  EXPECT_EQ(list.closure(0).to, 2);
  EXPECT_NEAR(list.closure(0).between.x, 3, 1e-6);
  EXPECT_EQ(list.closure(0).path, 2);
  EXPECT_EQ(list.count, 4);
}

TEST(Forgetting, HandsOnAcrossATurnOfTheOdometry) {
  work::Arena arena("L1", Bytes(1 << 17));
  PlaceList<Native> list = row_of_places(arena, {0, 1, 2, 3});
  add_closure<Native>(list, {0, 3, {5, 0, 0}, static_cast<float>(std::numbers::pi / 2), 0});
  list.set_odometry(2, to_pose<Pose<Native>>(camera_pose({3, 2, 0}, 0)));  // 2 to the left of 3
  remove_place(list, 3);
  EXPECT_NEAR(list.closure(0).between.x, 3, 1e-5);
  EXPECT_NEAR(list.closure(0).between.y, 0, 1e-5);
}

TEST(Forgetting, GivesUpTheClosureThatFollowsMostClosely) {
  work::Arena arena("L1", Bytes(1 << 17));
  LoopGraphOptions graph;
  graph.closures = 3;
  PlaceList<Native> list = row_of_places(arena, {0, 1, 2, 3, 4, 5, 6, 7});
  PlaceList<Native> few(arena, {}, graph);
  list.closures = few.closures;
  list.closure_from = few.closure_from;
  list.closure_to = few.closure_to;
  for (const int to : {3, 6, 7}) add_closure<Native>(list, {0, to, {1, 0, 0}, 0, 0});
  add_closure<Native>(list, {1, 7, {2, 0, 0}, 0, 0});
  ASSERT_EQ(list.closure_count, 3);
  EXPECT_EQ(list.closure(1).to, 6);
  EXPECT_EQ(list.closure(2).from, 1);
}

int bits_between(const Descriptor& a, const Descriptor& b) {
  int bits = 0;
  for (std::size_t w = 0; w < a.size(); ++w) bits += std::popcount(a[w] ^ b[w]);
  return bits;
}

/// By the definition, one pair after the other.
std::vector<std::pair<int, int>> expected_matches(const std::vector<Descriptor>& features,
                                                  const std::vector<Descriptor>& place,
                                                  const VerificationOptions& options) {
  std::vector<std::pair<int, int>> matches;
  for (std::size_t i = 0; i < place.size(); ++i) {
    std::vector<std::pair<int, int>> by_distance;
    for (std::size_t f = 0; f < features.size(); ++f)
      by_distance.emplace_back(bits_between(place[i], features[f]), static_cast<int>(f));
    std::stable_sort(by_distance.begin(), by_distance.end());
    const auto [distance, feature] = by_distance.front();
    if (distance >= options.max_distance) continue;
    if (100 * distance > options.ratio_percent * by_distance[1].first) continue;
    bool contested = false;
    for (std::size_t j = 0; j < place.size(); ++j)
      contested = contested ||
                  (j != i && bits_between(place[j], features[std::size_t(feature)]) <= distance);
    if (!contested) matches.emplace_back(feature, static_cast<int>(i));
  }
  return matches;
}

TEST(PlaceMatching, IsWhatItSays) {
  Random random(4);
  for (int trial = 0; trial < 5; ++trial) {
    std::vector<Descriptor> place, features;
    for (int i = 0; i < 30; ++i) {
      place.push_back(i % 7 == 6 ? with_flipped_bits(place.back(), random, 0.03)
                                 : random_descriptor(random));
      features.push_back(with_flipped_bits(place.back(), random, 0.12));
      if (i % 5 == 0) features.push_back(with_flipped_bits(place.back(), random, 0.14));
    }
    for (int i = 0; i < 40; ++i) features.push_back(random_descriptor(random));
    const VerificationOptions options;
    const auto expected = expected_matches(features, place, options);
    EXPECT_GT(expected.size(), 5u);
    EXPECT_LT(expected.size(), 28u);
    work::Machine machine({8, "L1", Bytes(1 << 17), 1, false});
    const auto stage = machine.stage("matching");
    work::Arena& local = machine.local();
    FeatureList<Native> list = alloc_features<Native>(local, static_cast<int>(features.size()));
    list.count = list.capacity;
    for (std::size_t i = 0; i < features.size(); ++i)
      std::copy(features[i].begin(), features[i].end(), list.descriptors.data() + 8 * i);
    const auto words = local.alloc<Native::Span<std::uint32_t>>("place", 8 * 30);
    for (std::size_t i = 0; i < place.size(); ++i)
      std::copy(place[i].begin(), place[i].end(), words.data() + 8 * i);
    MatchList<Native> matches = alloc_matches<Native>(local, 30);
    match_place<Native>(machine, list, words, 30, options, matches);
    ASSERT_EQ(matches.count, static_cast<int>(expected.size()));
    for (int i = 0; i < matches.count; ++i) {
      EXPECT_EQ(matches.query[i], expected[std::size_t(i)].first);
      EXPECT_EQ(matches.reference[i], expected[std::size_t(i)].second);
    }
  }
}

}  // namespace
}  // namespace leviosim::vio::test
