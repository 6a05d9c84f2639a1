#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <string>

#include "pose_graph_fixture.h"
#include "sim/work/machine.h"

namespace leviosim::vio::test {
namespace {

using work::Counting;
using work::Native;

GraphCapacity small(int keyframes, int landmarks, int observations) {
  return {keyframes, landmarks, observations};
}

TEST(PoseGraph, OccupiesWhatThePaperSaysPlusItsInertialRecords) {
  GraphFixture<Counting> f;
  std::map<std::string, std::int64_t> bytes;
  for (const work::Block& block : f.memory.live())
    bytes[std::string(block.name)] += block.size.count();
  const std::int64_t landmarks =
      bytes["landmark points"] + bytes["landmark descriptors"] + bytes["landmark ages"];
  const std::int64_t observations = bytes["observed landmarks"] + bytes["observed u"] +
                                    bytes["observed v"] + bytes["observing keyframes"] +
                                    bytes["observed generations"];
  EXPECT_EQ(landmarks, 1000 * (12 + 32 + 1));
  EXPECT_EQ(observations, 2400 * 8);
  EXPECT_EQ(landmarks + observations, 64'200);
  EXPECT_LT(f.memory.used().count(), 64'200 * 1.11);
}

TEST(PoseGraph, KeepsTheLatestKeyframesInARing) {
  GraphFixture<Native> f(small(3, 10, 20));
  for (int i = 0; i < 7; ++i) {
    f.add_keyframe(static_cast<float>(i));
    const int count = std::min(i + 1, 3);
    ASSERT_EQ(f.graph.keyframe_count(), count);
    for (int k = 0; k < count; ++k) {
      const int slot = f.graph.keyframe_slot(k);
      EXPECT_EQ(f.graph.keyframe(slot).T_world_camera.t.x, static_cast<float>(i - count + 1 + k));
      EXPECT_EQ(f.graph.keyframe_ids[slot], i - count + 1 + k);
    }
  }
}

TEST(PoseGraph, DroppingTheOldestKeyframeRemovesItsObservationsOnly) {
  GraphFixture<Native> f(small(2, 10, 20));
  const int first = f.add_keyframe();
  const int a = f.add_landmark(1), b = f.add_landmark(2);
  f.observe(first, a, 10, 11);
  const int second = f.add_keyframe();
  f.observe(first, b, 20, 21);  // a new landmark is seen by the keyframe before as well
  f.observe(second, b, 22, 23);
  f.observe(second, a, 12, 13);
  ASSERT_EQ(f.graph.observation_count(), 4);
  const int third = f.add_keyframe();
  EXPECT_EQ(third, first) << "the slot is reused";
  ASSERT_EQ(f.graph.observation_count(), 2);
  EXPECT_EQ(f.graph.observation_landmarks[0], b);
  EXPECT_EQ(f.graph.observation_u[0], 22);
  EXPECT_EQ(f.graph.observation_landmarks[1], a);
  EXPECT_EQ(f.graph.observation_v[1], 13);
  for (int o = 0; o < 2; ++o) EXPECT_EQ(f.graph.observation_keyframes[o], second);
}

TEST(PoseGraph, FillsUnusedSlotsFirst) {
  GraphFixture<Native> f(small(4, 5, 20));
  f.add_keyframe();
  EXPECT_EQ(f.graph.landmark_count(), 0);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(f.add_landmark(static_cast<float>(i)), i);
  for (int i = 0; i < 10; ++i) f.add_keyframe();
  EXPECT_EQ(f.graph.landmark_count(), 3);
  EXPECT_EQ(f.add_landmark(3), 3) << "although others are old";
  EXPECT_EQ(f.add_landmark(4), 4);
  EXPECT_EQ(f.graph.landmark_count(), 5);
}

TEST(PoseGraph, ReusesTheSlotSeenLeastRecently) {
  GraphFixture<Native> f(small(4, 4, 20));
  f.add_keyframe();
  for (int i = 0; i < 4; ++i) f.add_landmark(static_cast<float>(i));
  const int order[] = {2, 0, 3, 1};  // seen one keyframe after the other
  for (const int seen : order) f.observe(f.add_keyframe(), seen);
  const int newest = f.add_keyframe();
  f.observe(newest, 0);
  EXPECT_EQ(f.add_landmark(12), 2);
  EXPECT_EQ(f.add_landmark(13), 3) << "0 was seen again";
  EXPECT_EQ(f.add_landmark(11), 1);
  EXPECT_EQ(f.add_landmark(99), -1) << "all others belong to this keyframe";
  EXPECT_EQ(f.point_x(0), 0);
  EXPECT_EQ(f.point_x(2), 12);
  EXPECT_EQ(f.age(2), 0);
}

/// Against the plain rule: of all landmarks not seen by this keyframe the oldest, lowest slot
/// first.
TEST(PoseGraph, ReuseFollowsTheRuleOverALongRun) {
  constexpr int kLandmarks = 40;
  GraphFixture<Native> f(small(4, kLandmarks, 1000));
  std::vector<int> age(kLandmarks, kUnusedAge);
  TestRandom random(7);
  for (int keyframe = 0; keyframe < 300; ++keyframe) {
    const int slot = f.add_keyframe();
    for (int& a : age) a = std::min(a + 1, a == kUnusedAge ? kUnusedAge : kOldestAge);
    for (int i = 0; i < 6; ++i) {
      const int seen = static_cast<int>(random.uniform(0, kLandmarks));
      if (age[static_cast<std::size_t>(seen)] == kUnusedAge) continue;
      f.observe(slot, seen);
      age[static_cast<std::size_t>(seen)] = 0;
    }
    const int created = static_cast<int>(random.uniform(0, keyframe % 50 == 49 ? 60 : 8));
    for (int i = 0; i < created; ++i) {
      const auto oldest = std::max_element(age.begin(), age.end());
      const int expected = *oldest == 0 ? -1 : static_cast<int>(oldest - age.begin());
      ASSERT_EQ(f.add_landmark(1), expected) << "keyframe " << keyframe << ", landmark " << i;
      *oldest = 0;
    }
    for (int l = 0; l < kLandmarks; ++l) ASSERT_EQ(f.age(l), age[static_cast<std::size_t>(l)]);
  }
}

TEST(PoseGraph, AgesStopAtTheirLimit) {
  GraphFixture<Native> f(small(2, 3, 4));
  f.add_keyframe();
  const int landmark = f.add_landmark(1);
  for (int i = 0; i < 300; ++i) f.add_keyframe();
  EXPECT_EQ(f.age(landmark), kOldestAge);
  EXPECT_EQ(f.age(2), kUnusedAge);
}

TEST(PoseGraph, ObservationsOfAReusedSlotVanishWithTheNextCompaction) {
  GraphFixture<Native> f(small(3, 1, 10));
  const int first = f.add_keyframe();
  const int landmark = f.add_landmark(1);
  f.observe(first, landmark, 1, 1);
  const int second = f.add_keyframe();
  ASSERT_EQ(f.add_landmark(2), landmark);
  f.observe(second, landmark, 2, 2);
  f.add_keyframe();
  f.add_keyframe();  // the first one leaves
  ASSERT_EQ(f.graph.observation_count(), 1);
  EXPECT_EQ(f.graph.observation_u[0], 2);
}

TEST(PoseGraph, RefusesObservationsBeyondItsCapacity) {
  GraphFixture<Native> f(small(2, 4, 3));
  const int keyframe = f.add_keyframe();
  for (int i = 0; i < 3; ++i) {
    f.add_landmark(static_cast<float>(i));
    EXPECT_TRUE(f.observe(keyframe, i));
  }
  EXPECT_FALSE(f.observe(keyframe, 3));
  EXPECT_EQ(f.graph.observation_count(), 3);
}

TEST(PoseGraph, StoresTheNewestDescriptor) {
  GraphFixture<Native> f(small(2, 4, 3));
  f.add_keyframe();
  f.add_landmark(0);
  f.add_landmark(1);
  const auto newer = f.descriptor(77);
  f.graph.update_descriptor(1, newer);
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(f.graph.descriptors[i], f.descriptor(0)[static_cast<std::size_t>(i)]);
    EXPECT_EQ(f.graph.descriptors[8 + i], newer[static_cast<std::size_t>(i)]);
  }
}

/// A scripted life of a graph, on any view of it.
template <class P, class Graph>
void live(const Graph& graph, const OwnedInterval<P>& interval) {
  TestRandom random(3);
  for (int keyframe = 0; keyframe < 12; ++keyframe) {
    const auto x = static_cast<float>(keyframe);
    const auto slot = graph.add_keyframe({Pose<P>::identity(), {x, 0.0f, 0.0f}}, interval.record());
    graph.age_landmarks();
    for (int i = 0; i < 10; ++i) {
      const int landmark = static_cast<int>(random.uniform(0, 60));
      if (landmark < plain(graph.landmark_count()))
        graph.add_observation(slot, landmark, 3 * i, keyframe);
    }
    for (int i = 0; i < 9; ++i) {
      const auto words = GraphFixture<P>::descriptor(i);
      const auto landmark = graph.add_landmark({x, 1.0f, 2.0f}, words);
      graph.add_observation(slot, landmark, i, i);
    }
  }
}

template <class A, class B>
void expect_same_bytes(A a, B b) {
  for_each_block_pair(a, b, [](auto& x, auto& y) {
    ASSERT_EQ(x.size(), y.size());
    EXPECT_EQ(0, std::memcmp(static_cast<const void*>(x.data()), y.data(),
                             sizeof(*x.data()) * static_cast<std::size_t>(x.size())));
  });
}

/// The header, ages and so on are written by clear(); the rest must be equal from the start.
template <class P>
void zero(PoseGraph<P> graph) {
  std::apply(
      [](auto&... span) {
        (std::memset(static_cast<void*>(span.data()), 0,
                     sizeof(*span.data()) * static_cast<std::size_t>(span.size())),
         ...);
      },
      graph.blocks());
  graph.clear(ImuBias<P>::zero(), to_vec3<P>({0, 9.81, 0}));
}

TEST(PoseGraph, CountsWhatItComputesNatively) {
  GraphFixture<Native> native(small(4, 50, 60));
  GraphFixture<Counting> counting(small(4, 50, 60));
  zero(native.graph);
  zero(counting.graph);
  live<Native>(native.graph, native.no_motion);
  live<Counting>(counting.graph, counting.no_motion);
  expect_same_bytes(native.graph, counting.graph);
}

TEST(PoseGraph, AClusterCoreCountsL2AccessesForTheSameWork) {
  GraphFixture<Counting> local(small(4, 50, 60)), remote(small(4, 50, 60));
  zero(local.graph);
  zero(remote.graph);
  work::take_tally();
  live<Counting>(local.graph, local.no_motion);
  const work::Counts by_controller = work::take_tally();
  const PoseGraph<Counting, L2FromCluster> seen(seen_from_cluster<Counting>(remote.graph));
  live<Counting>(seen, remote.no_motion);
  const work::Counts by_cluster = work::take_tally();
  expect_same_bytes(local.graph, remote.graph);
  using work::Op;
  EXPECT_EQ(by_controller[Op::LoadL2], 0u);
  EXPECT_EQ(by_controller[Op::LoadStream] + by_controller[Op::LoadIndexed],
            by_cluster[Op::LoadL2] + by_cluster[Op::LoadStream] + by_cluster[Op::LoadIndexed]);
  EXPECT_EQ(by_controller[Op::StoreStream] + by_controller[Op::StoreIndexed],
            by_cluster[Op::StoreL2]);
}

TEST(PoseGraph, TravelsToLocalMemoryAndBackByDma) {
  GraphFixture<Counting> l2(small(4, 50, 60));
  zero(l2.graph);
  live<Counting>(l2.graph, l2.no_motion);
  work::MachineConfig config;
  config.record = true;
  work::Machine machine(config);
  GraphFixture<Counting> back(small(4, 50, 60));
  {
    const auto stage = machine.stage("copy");
    const work::Arena::Frame frame(machine.local());
    const PoseGraph<Counting> local(machine.local(), small(4, 50, 60));
    copy_graph_in<Counting>(machine, local, l2.graph);
    copy_graph_out<Counting>(machine, back.graph, local);
  }
  expect_same_bytes(l2.graph, back.graph);
  std::int64_t bytes[2] = {0, 0};
  const work::Job job = machine.take_job();
  for (const work::Step& step : job.stages[0].steps)
    if (const auto* t = std::get_if<work::Transfer>(&step))
      bytes[t->direction == work::Direction::L2ToL1 ? 0 : 1] += t->bytes.count();
  std::int64_t expected = 0;
  for (const work::Block& block : l2.memory.live()) expected += block.size.count();
  EXPECT_EQ(bytes[0], expected);
  EXPECT_EQ(bytes[1], expected);
}

}  // namespace
}  // namespace leviosim::vio::test
