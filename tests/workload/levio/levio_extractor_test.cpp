// Extraction with the released program's work: the corners of the shared extraction, which is
// tested against OpenCV, and descriptors that hardly differ from those of the shared extraction
// with the same pattern of pairs; its work beside that of the release. Facts:
// workload/PARAMETERS.md#feature-extraction.
#include "workload/levio/vision/levio_extractor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "platform_models/loader/compiled_code.h"
#include "platform_models/loader/loader.h"
#include "sim/chip/cost.h"
#include "sim/work/machine.h"
#include "tests/workload/vision/runs.h"
#include "workload/levio/vision/corner_tests.h"
#include "workload/levio/vision/learned_pairs.h"
#include "workload/levio/vision/levio_blur.h"
#include "workload/levio/vision/levio_descriptor.h"
#include "workload/levio/vision/offset_tables.h"
#include "workload/vision/extraction_steps.h"

namespace leviosim::vio::levio {
namespace {

using vision_test::Feature;
using vision_test::Features;
using vision_test::PolicyImage;
using work::Op;
using C = work::Counting;

const cv::Mat& picture() {
  static const cv::Mat image = vision_test::rectangle_image(160, 120, 3);
  return image;
}

template <class P>
Features extract_picture(int cores, DescriptorKind kind = DescriptorKind::Exact) {
  return vision_test::extract_as_levio<P>(picture(), cores, {}, kind);
}

/// How many bits descriptors of the same features differ in, on average.
double mean_bits_at_same_places(const Features& some, const Features& others) {
  double bits = 0;
  for (std::size_t i = 0; i < some.size(); ++i) {
    EXPECT_EQ(some[i].x, others[i].x);
    EXPECT_EQ(some[i].y, others[i].y);
    bits += vision_test::distance_between(some[i], others[i]);
  }
  return bits / static_cast<double>(some.size());
}

/// The shared extraction with the pattern of `levio`.
Features extract_shared_with_learned_pairs() {
  using N = work::Native;
  const auto extract = [](work::Machine& machine, ImageView<N> image,
                          const ExtractorOptions& options, FeatureList<N>& list) {
    vio::extract_features<N>(machine, image, options, list);
    ExtractionTables<N> tables(machine.local(), machine.cores());
    load_tables<N>(machine, image.width, tables);
    std::vector<std::uint8_t> pixels(160 * 120);
    const ImageView<N> blurred{{pixels.data(), 160 * 120}, 160, 120};
    vio::blur_rows<N>(image, blurred, 0, 120, tables.blur_kernel);
    vio::describe_all<N>(machine, blurred, tables, in_l2<N>(levio::kLearnedPattern<N>),
                         {0, list.count}, list, list.descriptors);
  };
  work::Machine machine = vision_test::make_machine<N>(8);
  return vision_test::extract_by<N>(extract, machine, picture(), {});
}

TEST(LevioExtractor, FindsTheFeaturesOfTheSharedExtraction) {
  const Features shared = extract_shared_with_learned_pairs();
  const Features released = extract_picture<work::Native>(8);
  ASSERT_GT(released.size(), 100u);
  ASSERT_EQ(released.size(), shared.size());
  EXPECT_LT(mean_bits_at_same_places(released, shared), 8);
}

TEST(LevioExtractor, HasAPatternOfItsOwn) {
  const Features shared = vision_test::extract<work::Native>(picture());
  const Features released = extract_picture<work::Native>(8);
  ASSERT_EQ(released.size(), shared.size());
  // Bits of unrelated pairs agree half of the time.
  EXPECT_NEAR(mean_bits_at_same_places(released, shared), 128, 16);
}

TEST(LevioExtractor, DescriptorsOfTheReleaseHaveAPatternOfTheirOwn) {
  const Features exact = extract_picture<work::Native>(8);
  const Features released = extract_picture<work::Native>(8, DescriptorKind::Released);
  ASSERT_EQ(released.size(), exact.size());
  EXPECT_NEAR(mean_bits_at_same_places(released, exact), 128, 16);
}

TEST(LevioExtractor, DoesNotDependOnTheNumberOfCoresOrThePolicy) {
  const Features eight = extract_picture<work::Native>(8);
  EXPECT_EQ(extract_picture<work::Native>(1), eight);
  EXPECT_EQ(extract_picture<C>(3), eight);
}

TEST(LevioExtractor, ACornerTestTakes48ProductsAndAReadOfL2Everywhere) {
  work::Arena arena("L1", Bytes(4096));
  const OffsetTables<C> tables(arena, 160);
  PolicyImage<C> copy(picture());
  work::take_tally();
  int tests = 0;
  for (int y = 20; y < 100; ++y)
    for (int x = 20; x < 140; ++x, ++tests)
      is_corner<C>(copy.view().pixels, y * 160 + x, tables, 20);
  const work::Counts counts = work::take_tally();
  const auto n = static_cast<unsigned>(tests);
  EXPECT_EQ(counts[Op::IntMul], 48 * n);
  EXPECT_EQ(counts[Op::LoadL2], n);
  EXPECT_EQ(counts[Op::StoreStream], 32 * n);
}

TEST(LevioExtractor, ACornersResponseReads8PixelsAt49Positions) {
  work::Arena arena("L1", Bytes(4096));
  const OffsetTables<C> tables(arena, 160);
  PolicyImage<C> copy(picture());
  work::take_tally();
  corner_response<C>(copy.view().pixels, 160, 60 * 160 + 80, tables);
  const work::Counts counts = work::take_tally();
  EXPECT_EQ(counts[Op::LoadStream], 49u * 9);
  EXPECT_EQ(counts[Op::LoadL2], 1u);
  EXPECT_NEAR(static_cast<double>(counts[Op::IntMac] + counts[Op::IntMul]), 3 * 49, 5);
}

TEST(LevioExtractor, TheBlurIsThatOfTheSharedExtraction) {
  using N = work::Native;
  PolicyImage<N> copy(picture());
  std::vector<std::uint8_t> a(160 * 120), b(160 * 120);
  const auto image = copy.view();
  std::vector<int> kernel(kBlurKernel<N>.begin(), kBlurKernel<N>.end());
  vio::blur_rows<N>(image, {{a.data(), 160 * 120}, 160, 120}, 0, 120, {kernel.data(), kBlurTaps});
  levio::blur_rows<N>(image, {{b.data(), 160 * 120}, 160, 120}, 0, 120);
  EXPECT_EQ(a, b);
}

/// Compiled code takes about as long for a pixel at the edge as for one inside, though more is
/// counted. So the first and the last core are not later than others.
TEST(LevioExtractor, CoresWithMoreEdgePixelsBlurAsFastAsOthers) {
  PolicyImage<C> from(picture());
  PolicyImage<C> to(160, 120);
  work::Machine machine({.record = true, .code = &platform::compiled_code()});
  {
    const auto stage = machine.stage("s");
    machine.fork("blur", [&](work::Core& core) {
      const auto [begin, end] = core.share(120);
      levio::blur_rows<C>(from.view(), to.view(), begin, end);
    });
  }
  const sim::CoreCosts core(platform::load_platform("gap9").cluster.core);
  const work::Job job = machine.take_job();
  std::vector<double> slots;
  for (const work::Segment& share : std::get<work::Fork>(job.stages.at(0).steps.at(0)).shares)
    slots.push_back(sim::demand_of(share, core).alone[sim::Mechanism::Issue]);
  ASSERT_EQ(slots.size(), 8u);
  const auto [least, most] = std::minmax_element(slots.begin(), slots.end());
  EXPECT_LT(*most, 1.05 * *least);
}

/// By the words of PARAMETERS.md#defects-of-the-release.
TEST(LevioExtractor, TheSlipChangesNegativeCoordinatesOnly) {
  using N = work::Native;
  for (int first = -4000; first <= 4000; first += 37)
    for (int second = -4000; second <= 4000; second += 41) {
      const int sum = first + second;
      const int pixel = ReleasedDescriptor::whole<N>(first, sum);
      if (sum >= 0) {
        EXPECT_EQ(pixel, ExactDescriptor::whole<N>(first, sum));
      } else {
        EXPECT_EQ(pixel, -((-first + second + 128) / 256)) << first << ' ' << second;
        EXPECT_EQ(ExactDescriptor::whole<N>(first, sum), -((-first - second + 128) / 256));
      }
    }
}

TEST(LevioExtractor, ADescriptorHasTheProductsOfTheRelease) {
  PolicyImage<C> copy(picture());
  const C::Span<const work::U32> pattern(kLearnedPattern<C>.data(), kPairs);
  std::vector<work::U32> words(kDescriptorWords);
  work::take_tally();
  const Moments<C> moments = levio::disc_moments<C>(copy.view().pixels, 160, 60 * 160 + 80);
  EXPECT_EQ(work::take_tally()[Op::LoadStream], 697u);
  levio::disc_moments<C>(copy.view().pixels, 160, 60 * 160 + 80);
  describe<C, levio::ExactDescriptor>(copy.view().pixels, 160, 60 * 160 + 80,
                                      direction_of<C>(moments), pattern,
                                      {words.data(), kDescriptorWords});
  const work::Counts counts = work::take_tally();
  // About 4 800, without those of an address of a pixel.
  const double products = static_cast<double>(counts[Op::IntMul] + counts[Op::IntMac]) - 512;
  EXPECT_NEAR(products, 4800, 0.1 * 4800);
}

}  // namespace
}  // namespace leviosim::vio::levio
