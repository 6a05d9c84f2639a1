// Feature extraction from strips of rows: the features of the whole image, within the local memory.

#include <gtest/gtest.h>

#include "sim/base/error.h"
#include "sim/work/machine.h"
#include "tests/workload/vision/runs.h"
#include "workload/vision/strip_extractor.h"

namespace leviosim::vio::vision_test {
namespace {

/// A machine whose local memory is just so large.
template <class P>
work::Machine small_machine(int cores, Bytes memory) {
  return work::Machine({cores, "L1", memory, 1, P::kCounting});
}

template <class P>
Features extract_in_strips(work::Machine& machine, const cv::Mat& image,
                           const ExtractorOptions& options) {
  PolicyImage<P> copy(image), blurred(cv::Mat::zeros(image.size(), CV_8U));
  const auto stage = machine.stage("feature extraction");
  const work::Arena::Frame frame(machine.local());
  FeatureList<P> list =
      alloc_features<P>(machine.local(), options.max_features(image.cols, image.rows));
  extract_features_in_strips<P>(machine, copy.view(), blurred.view(), options, list);
  return plain<P>(list);
}

struct Case {
  int width, height, cell, cores, subpixel;
  std::int64_t memory;
};

class StripsOf : public testing::TestWithParam<Case> {};

TEST_P(StripsOf, AnImageGiveItsFeatures) {
  const Case c = GetParam();
  const cv::Mat image = rectangle_image(c.width, c.height, 7);
  ExtractorOptions options;
  options.cell = c.cell;
  options.subpixel_steps = c.subpixel;
  const Features whole = extract<work::Native>(image, c.cores, options);
  ASSERT_GT(whole.size(), 100u);
  auto native = small_machine<work::Native>(c.cores, Bytes(c.memory));
  EXPECT_EQ(extract_in_strips<work::Native>(native, image, options), whole);
  auto counting = small_machine<work::Counting>(c.cores, Bytes(c.memory));
  EXPECT_EQ(extract_in_strips<work::Counting>(counting, image, options), whole);
}

INSTANTIATE_TEST_SUITE_P(
    Vision, StripsOf,
    testing::Values(Case{160, 120, 8, 8, 1, 60'000}, Case{160, 120, 8, 3, 16, 40'000},
                    Case{161, 119, 8, 8, 1, 45'000}, Case{320, 240, 16, 8, 16, 131'072},
                    Case{640, 480, 32, 8, 1, 131'072}, Case{640, 480, 32, 1, 16, 200'000},
                    Case{320, 240, 16, 8, 1, 4'000'000},
                    // One row of cells fits once, but not twice.
                    Case{320, 240, 16, 8, 1, 56'000}, Case{320, 240, 16, 3, 16, 56'000}));

TEST(Strips, MoveEveryRowOncePerPassAndThoseAroundAgain) {
  const cv::Mat image = rectangle_image(320, 240, 7);
  ExtractorOptions options;
  options.cell = 16;
  auto machine = small_machine<work::Counting>(8, Bytes(131'072));
  extract_in_strips<work::Counting>(machine, image, options);
  const work::Job job = machine.take_job();
  Bytes in{0}, out{0};
  for (const work::Step& step : job.stages.at(0).steps)
    if (const auto* transfer = std::get_if<work::Transfer>(&step))
      (transfer->direction == work::Direction::L2ToL1 ? in : out) += transfer->bytes;
  EXPECT_EQ(out, Bytes(320 * 240));
  EXPECT_GE(in, Bytes(3 * 320 * (240 - 2 * 16)));
  EXPECT_LE(in, Bytes(3 * 320 * 240 * 6 / 5));
}

TEST(Strips, OfARowOfCellsThatDoNotFitAreRefused) {
  const cv::Mat image = rectangle_image(640, 480, 7);
  ExtractorOptions options;
  options.cell = 64;
  auto machine = small_machine<work::Native>(8, Bytes(65'536));
  try {
    extract_in_strips<work::Native>(machine, image, options);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("one row of cells of 64 px"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace leviosim::vio::vision_test
