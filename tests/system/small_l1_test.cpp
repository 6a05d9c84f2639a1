// An L1 that cannot hold what the stages work on, and an L2 that cannot hold the optimiser's
// records: the same poses, to the bit, from what passes through them in tiles.
#include <gtest/gtest.h>

#include <map>
#include <ostream>
#include <set>
#include <string>
#include <tuple>

#include "tests/workload/short_flight.h"

namespace leviosim::vio::test {
namespace {

const ShortFlight& flight_of(int width) {
  static const ShortFlight paper = draw_flight(PacedFlight(3, at_pace(1)), 5);
  static const ShortFlight small = draw_flight(PacedFlight(3, at_pace(1)), 4, 96, 72);
  static const ShortFlight large = draw_flight(PacedFlight(3, at_pace(1)), 3.5, 320, 240);
  return width == 160 ? paper : width == 96 ? small : large;
}

/// Poses, where they come from, and numbers of features, matches and inliers, to the bit.
void expect_same(const Flown& a, const Flown& b, const std::string& what) {
  ASSERT_EQ(a.trajectory.size(), b.trajectory.size()) << what;
  for (std::size_t i = 0; i < a.trajectory.size(); ++i)
    ASSERT_TRUE(a.trajectory[i].T_world_body.matrix() == b.trajectory[i].T_world_body.matrix())
        << what << ", frame " << i;
  EXPECT_EQ(a.sources, b.sources) << what;
  EXPECT_EQ(a.facts, b.facts) << what;
}

/// The same with all the memory that it may want.
const Flown& in_a_large_one(const std::string& profile, int cores, int width) {
  static std::map<std::tuple<std::string, int, int>, Flown> flown;
  const auto [at, is_new] = flown.try_emplace({profile, cores, width});
  if (is_new) at->second = fly(flight_of(width), profile_named(profile, 1), cores);
  return at->second;
}

struct L1Case {
  const char* profile;
  int l1_kib, cores, width;
};

std::ostream& operator<<(std::ostream& out, const L1Case& c) {
  return out << c.profile << " in " << c.l1_kib << " KiB, " << c.cores << " cores, " << c.width;
}

class InAnL1Of : public testing::TestWithParam<L1Case> {};

TEST_P(InAnL1Of, FlightsAreThoseOfALargeOne) {
  const L1Case c = GetParam();
  const Flown& large = in_a_large_one(c.profile, c.cores, c.width);
  expect_same(
      fly(flight_of(c.width), profile_named(c.profile, 1), c.cores, Bytes(1024LL * c.l1_kib)),
      large, c.profile);
  EXPECT_GT(large.count(PoseSource::Tracked) + large.count(PoseSource::Epnp) +
                large.count(PoseSource::EightPoint),
            10);
  EXPECT_TRUE(large.passages.empty());
}

/// Blocks that pass in tiles, by stage.
std::set<std::string> passing(const char* profile, int l1_kib) {
  std::set<std::string> blocks;
  for (const work::Passage& passage :
       fly(flight_of(160), profile_named(profile, 1), 8, Bytes(1024LL * l1_kib)).passages)
    blocks.insert(std::string(passage.stage) + ": " + std::string(passage.block));
  return blocks;
}

TEST(SmallL1, PassesInTilesWhatHasNoRoom) {
  for (const char* profile : {"levio", "next"}) {
    EXPECT_EQ(passing(profile, 128), std::set<std::string>{}) << profile;
    const std::set<std::string> half = passing(profile, 64), quarter = passing(profile, 32);
    EXPECT_TRUE(half.contains("triangulation: observed landmarks")) << profile;
    EXPECT_FALSE(half.contains("feature extraction: image strip")) << profile;
    EXPECT_TRUE(quarter.contains("feature extraction: image strip")) << profile;
    EXPECT_TRUE(quarter.contains("frame matching: tile of the keyframe's descriptors")) << profile;
    EXPECT_TRUE(quarter.contains("triangulation: observed landmarks")) << profile;
  }
}

/// Descriptors that stay would leave no room for a hypothesis of EPnP on each core.
TEST(SmallL1, EpnpKeepsAllItsCores) {
  EXPECT_TRUE(passing("levio", 56).contains("frame matching: tile of descriptors"));
  EXPECT_FALSE(passing("next", 56).contains("frame matching: tile of descriptors"));
}

/// A chip with external memory keeps there what L2 has no room for.
TEST(SmallL2, HasTheSamePosesFromRecordsInExternalMemory) {
  for (const char* name : {"levio", "next"}) {
    const Profile profile = profile_named(name, 1);
    const Flown large = fly(flight_of(160), profile);
    // Room for some 200 records, for 20, and for hardly any.
    for (const int l2_kib : {450, 370, 330}) {
      if (name == std::string("levio") && l2_kib == 330) continue;  // all of them have room
      const Bytes l2(1024LL * (name == std::string("levio") ? l2_kib - 150 : l2_kib));
      const Flown small = fly(flight_of(160), profile, 8, Bytes(1 << 24), l2, Bytes(1 << 22));
      for (std::size_t i = 0; i < large.trajectory.size(); ++i)
        ASSERT_TRUE(small.trajectory[i].T_world_body.matrix() ==
                    large.trajectory[i].T_world_body.matrix())
            << name << ", " << l2_kib << " KiB, frame " << i;
      EXPECT_FALSE(small.l2_passages.empty()) << name << ", " << l2_kib << " KiB";
    }
    EXPECT_TRUE(large.l2_passages.empty());
  }
}

/// Twice as large an image, with as many features.
TEST(SmallL1, HasTheSamePosesOfLargerImages) {
  static const ShortFlight flight = draw_flight(PacedFlight(3, at_pace(1)), 3, 320, 240);
  for (const char* name : {"levio", "next"}) {
    Profile profile = profile_named(name, 1);
    profile.extractor.cell = 16;
    profile.extractor.per_cell = name == std::string("levio") ? 4 : 3;
    const Flown large = fly(flight, profile);
    for (const auto& [l1_kib, cores] : {std::pair{32, 8}, {48, 4}, {64, 16}, {96, 1}}) {
      const Flown small = fly(flight, profile, cores, Bytes(1024LL * l1_kib));
      for (std::size_t i = 0; i < large.trajectory.size(); ++i)
        ASSERT_TRUE(small.trajectory[i].T_world_body.matrix() ==
                    large.trajectory[i].T_world_body.matrix())
            << name << " in " << l1_kib << " KiB, frame " << i;
    }
  }
}

/// A profile that finds features in nearly every cell, as images full of texture have them.
Profile dense(const char* name) {
  Profile profile = profile_named(name, 1);
  profile.extractor.fast_threshold = 4;
  profile.extractor.harris_threshold = 10;
  return profile;
}

/// Lists that have no room are read in L2, features and matches of both views among them.
TEST(SmallL1, HasTheSamePosesOfAsManyFeaturesAsAnImageCanHave) {
  for (const char* name : {"levio", "next"}) {
    const Profile profile = dense(name);
    const Flown large = fly(flight_of(320), profile);
    int most = 0;
    for (const auto& facts : large.facts) most = std::max(most, facts[0]);
    EXPECT_GT(most, 3200) << name;
    for (const auto& [l1_kib, cores] : {std::pair{32, 8}, {32, 16}, {40, 1}, {64, 4}})
      expect_same(fly(flight_of(320), profile, cores, Bytes(1024LL * l1_kib)), large,
                  std::string(name) + " in " + std::to_string(l1_kib) + " KiB");
  }
}

/// Of so many cells that L1 has no room for a list of what they may hold, beside strips.
TEST(SmallL1, HasTheSamePosesOfSmallCells) {
  for (const char* name : {"levio", "next"}) {
    Profile profile = profile_named(name, 1);
    profile.extractor.cell = 6;
    expect_same(fly(flight_of(320), profile, 8, Bytes(32 * 1024)), fly(flight_of(320), profile),
                name);
  }
}

// A stack of memory that what a stage needs at random does not fit into says what is missing.
TEST(SmallL1, OfWhichNothingFitsIsRefusedWithStageAndBlock) {
  try {
    fly(flight_of(160), profile_named("levio", 1), 8, Bytes(4 * 1024));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("feature extraction"), std::string::npos)
        << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Odometry, InAnL1Of,
    testing::Values(
        L1Case{"levio", 32, 8, 160}, L1Case{"levio", 32, 16, 160}, L1Case{"levio", 48, 1, 160},
        L1Case{"levio", 64, 16, 160}, L1Case{"levio", 96, 4, 160}, L1Case{"levio", 128, 16, 160},
        L1Case{"levio", 256, 1, 160}, L1Case{"levio", 32, 4, 96}, L1Case{"next", 32, 8, 160},
        L1Case{"next", 32, 16, 160}, L1Case{"next", 48, 4, 160}, L1Case{"next", 64, 8, 160},
        L1Case{"next", 96, 1, 160}, L1Case{"next", 128, 16, 160}, L1Case{"next", 256, 4, 160},
        L1Case{"next", 48, 16, 96}, L1Case{"levio", 32, 1, 320}, L1Case{"levio", 32, 4, 320},
        L1Case{"levio", 32, 8, 320}, L1Case{"levio", 32, 16, 320}, L1Case{"levio", 48, 8, 320},
        L1Case{"next", 32, 1, 320}, L1Case{"next", 32, 4, 320}, L1Case{"next", 32, 8, 320},
        L1Case{"next", 32, 16, 320}, L1Case{"next", 40, 8, 320}, L1Case{"next", 56, 4, 320},
        L1Case{"next", 48, 8, 320}, L1Case{"levio", 64, 8, 320}, L1Case{"levio", 64, 16, 320},
        L1Case{"levio", 96, 1, 320}, L1Case{"levio", 128, 4, 320}, L1Case{"levio", 256, 16, 320},
        L1Case{"next", 64, 8, 320}, L1Case{"next", 64, 16, 320}, L1Case{"next", 96, 4, 320},
        L1Case{"next", 128, 1, 320}, L1Case{"next", 256, 16, 320}));

}  // namespace
}  // namespace leviosim::vio::test
