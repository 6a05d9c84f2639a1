#include "workload/vision/patch_alignment.h"
#include "sim/work/machine.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>

namespace leviosim::vio::test {
namespace {

using work::Counting;
using work::Native;

constexpr int kSize = 48, kSteps = 16;

using Picture = std::function<double(double, double)>;

/// Smooth, and different everywhere.
double texture(double x, double y) {
  return 120 + 40 * std::sin(0.55 * x + 0.2 * y) + 35 * std::cos(0.7 * y - 0.3 * x) +
         20 * std::sin(0.9 * x) * std::cos(0.5 * y);
}

template <class P>
std::vector<typename P::Byte> drawn(const Picture& picture) {
  std::vector<typename P::Byte> pixels;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      pixels.push_back(work::narrow<typename P::Byte>(
          typename P::I32(static_cast<int>(std::lround(picture(x, y))))));
  return pixels;
}

/// Nine features on a grid, where the detector found them in both images.
struct Aligned {
  double x[9], y[9];  ///< px
  bool agrees[9];
};

template <class P>
Aligned align(const Picture& before, const Picture& now, int cores = 8) {
  using U16 = typename P::U16;
  using I32 = typename P::I32;
  work::Machine machine({cores, "L1", Bytes(64000), 4, P::kCounting});
  auto pixels_before = drawn<P>(before), pixels_now = drawn<P>(now);
  std::vector<U16> x, y;
  for (int i = 0; i < 9; ++i) {
    x.push_back(work::narrow<U16>(I32(kSteps * (14 + 9 * (i % 3)))));
    y.push_back(work::narrow<U16>(I32(kSteps * (14 + 9 * (i / 3)))));
  }
  auto moved_x = x, moved_y = y;
  const auto view = [](std::vector<typename P::Byte>& pixels, std::vector<U16>& u,
                       std::vector<U16>& v) {
    return PatchView<P>{
        {{pixels.data(), kSize * kSize}, kSize, kSize}, {u.data(), 9}, {v.data(), 9}};
  };
  MatchList<P> matches = alloc_matches<P>(machine.local(), 9);
  for (int i = 0; i < 9; ++i) {
    matches.query[i] = work::narrow<U16>(I32(i));
    matches.reference[i] = work::narrow<U16>(I32(i));
  }
  matches.count = 9;
  std::vector<typename P::Byte> agrees(9);
  const typename P::template Span<typename P::Byte> marks{agrees.data(), 9};
  const PatchView<P> moved = view(pixels_now, moved_x, moved_y);
  const PatchAlignmentOptions options;
  const auto stage = machine.stage("patch alignment");
  align_patches<P>(machine, view(pixels_before, x, y), moved, kSteps, options.max_shift, options,
                   matches, marks);
  Aligned result;
  for (int i = 0; i < 9; ++i) {
    result.x[i] = work::value(I32(moved.x[i])) / static_cast<double>(kSteps);
    result.y[i] = work::value(I32(moved.y[i])) / static_cast<double>(kSteps);
    result.agrees[i] = work::value(I32(marks[i])) == 1;
  }
  return result;
}

void expect_unmoved(const Aligned& aligned) {
  for (int i = 0; i < 9; ++i) {
    EXPECT_FALSE(aligned.agrees[i]);
    EXPECT_EQ(aligned.x[i], 14 + 9 * (i % 3));
    EXPECT_EQ(aligned.y[i], 14 + 9 * (i / 3));
  }
}

TEST(PatchAlignment, FindsAShiftBetweenPixelsWhateverTheBrightness) {
  for (const double brighter : {0.0, 25.0})
    for (const double dx : {-0.7, 0.0, 0.4, 1.2})
      for (const double dy : {-1.1, 0.25}) {
        const Aligned aligned = align<Native>(
            texture, [&](double x, double y) { return texture(x - dx, y - dy) + brighter; });
        for (int i = 0; i < 9; ++i) {
          EXPECT_TRUE(aligned.agrees[i]);
          EXPECT_NEAR(aligned.x[i], 14 + 9 * (i % 3) + dx, 0.07);
          EXPECT_NEAR(aligned.y[i], 14 + 9 * (i / 3) + dy, 0.07);
        }
      }
}

TEST(PatchAlignment, AFeatureStaysWhereThePatchDoesNotAgree) {
  // Too far.
  expect_unmoved(align<Native>(texture, [](double x, double y) { return texture(x - 2.5, y); }));
  // Another thing.
  expect_unmoved(
      align<Native>(texture, [](double x, double y) { return texture(1.3 * y + 40, 90 - x); }));
}

TEST(PatchAlignment, AnEdgeOrAFlatPatchTellsNoPlace) {
  const Picture flat = [](double, double) { return 90.0; };
  const Picture edges = [](double x, double) { return 120 + 60 * std::sin(0.6 * x); };
  expect_unmoved(align<Native>(flat, flat));
  expect_unmoved(align<Native>(edges, edges));
}

TEST(PatchAlignment, CoresAndCountingDoNotChangeTheBits) {
  const Picture moved = [](double x, double y) { return texture(x - 0.3, y + 0.6) + 5; };
  const Aligned one = align<Native>(texture, moved, 1), eight = align<Native>(texture, moved, 8);
  const Aligned counted = align<Counting>(texture, moved, 8);
  EXPECT_EQ(std::memcmp(one.x, eight.x, sizeof(one.x) + sizeof(one.y)), 0);
  EXPECT_EQ(std::memcmp(counted.x, eight.x, sizeof(one.x) + sizeof(one.y)), 0);
}

}  // namespace
}  // namespace leviosim::vio::test
