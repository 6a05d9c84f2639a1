// Matching descriptors that pass through local memory in tiles: the same matches, and as much
// traffic as a closed formula says.
#include <gtest/gtest.h>

#include "tests/workload/vision/runs.h"
#include "workload/levio/vision/levio_matcher.h"

namespace leviosim::vio::vision_test {
namespace {

using work::Counting;

Features some_features(int n, std::uint64_t seed) {
  Random random(seed);
  Features features(static_cast<std::size_t>(n), Feature{0, 0, {}});
  for (Feature& f : features)
    for (std::uint32_t& word : f.words) word = random.bits() & 0x11111111u;
  return features;
}

struct Tiled {
  std::vector<PlainMatch> matches;
  Bytes in{0};
  int forks = 0;
};

constexpr int kCurrent = 90, kReference = 130;

/// With so many bytes free for tiles.
Tiled match_in_tiles(decltype(&match_sources<Counting>) matcher, int room, bool current_in_l2,
                     bool reference_in_l2) {
  constexpr int kCores = 4;
  // Both lists of matches, and a number for each core.
  constexpr int kLists = 2 * 6 * kCurrent + 4 * kCores;
  work::Machine machine({.cores = kCores, .capacity = Bytes(kLists + room), .record = true});
  auto current = words_of<Counting>(some_features(kCurrent, 1));
  auto reference = words_of<Counting>(some_features(kReference, 2));
  Tiled tiled;
  {
    const auto stage = machine.stage("matching");
    MatchList<Counting> list = alloc_matches<Counting>(machine.local(), kCurrent);
    MatcherOptions options;
    options.max_distance = 26;
    matcher(machine, {span_of<Counting>(current), kCurrent, current_in_l2},
            {span_of<Counting>(reference), kReference, reference_in_l2}, options, list);
    for (int i = 0; i < list.count; ++i)
      tiled.matches.push_back(
          {list.query.data()[i], list.reference.data()[i], list.distance.data()[i]});
  }
  const work::Job job = machine.take_job();
  for (const work::Step& step : job.stages.at(0).steps) {
    if (const auto* transfer = std::get_if<work::Transfer>(&step)) tiled.in += transfer->bytes;
    if (std::holds_alternative<work::Fork>(step)) ++tiled.forks;
  }
  return tiled;
}

/// How many tiles of descriptors pass, of which two fit in the room.
int tiles(int descriptors, int room) {
  const int most = room / 2 / 32;
  return (descriptors + most - 1) / most;
}

TEST(TiledMatching, FindsTheSameWithTheTrafficOfItsTiles) {
  for (const auto matcher : {match_sources<Counting>, levio::match_sources<Counting>}) {
    const Tiled resident = match_in_tiles(matcher, 0, false, false);
    ASSERT_GT(resident.matches.size(), 10u);
    EXPECT_EQ(resident.in, Bytes(0));
    EXPECT_EQ(resident.forks, 2);
    for (const int room : {128, 640, 2000, 4096, 20'000}) {
      const Tiled references = match_in_tiles(matcher, room, false, true);
      EXPECT_EQ(references.matches, resident.matches) << room;
      EXPECT_EQ(references.in, Bytes(32 * kReference)) << room;
      EXPECT_EQ(references.forks, tiles(kReference, room) + 1) << room;
      const Tiled both = match_in_tiles(matcher, room, true, true);
      const int of_current = tiles(kCurrent, room / 2);
      EXPECT_EQ(both.matches, resident.matches) << room;
      EXPECT_EQ(both.in, Bytes(32 * kCurrent + of_current * 32 * kReference)) << room;
      EXPECT_EQ(both.forks, of_current * tiles(kReference, room / 2) + 1) << room;
    }
  }
}

}  // namespace
}  // namespace leviosim::vio::vision_test
