// The whole extraction stage: which corners it keeps, what it records, and what it must not depend
// on.
#include "workload/vision/extractor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "sim/work/machine.h"
#include "tests/workload/vision/runs.h"
#include "workload/vision/fast.h"
#include "workload/vision/harris.h"

namespace leviosim::vio::vision_test {
namespace {

using Cell = std::pair<int, int>;

Cell cell_of(int x, int y, const ExtractorOptions& options = {}) {
  return {(y - options.border) / options.cell, (x - options.border) / options.cell};
}

/// Scores of all corners of an image, by cell, best first.
std::map<Cell, std::vector<int>> scores_by_cell(const cv::Mat& image,
                                                const ExtractorOptions& options) {
  using P = work::Native;
  PolicyImage<P> copy(image);
  std::vector<int> offsets(kRingSize);
  fill_ring_offsets<P>(image.cols, span_of<P>(offsets));
  std::map<Cell, std::vector<int>> scores;
  for (int y = options.border; y < image.rows - options.border; ++y)
    for (int x = options.border; x < image.cols - options.border; ++x) {
      if (!is_fast_corner<P>(copy.view().pixels, y * image.cols + x, span_of<P>(offsets),
                             options.fast_threshold))
        continue;
      const int score = harris_response<P>(copy.view().pixels, image.cols, x, y);
      if (score > options.harris_threshold) scores[cell_of(x, y, options)].push_back(score);
    }
  for (auto& [cell, list] : scores) std::sort(list.rbegin(), list.rend());
  return scores;
}

void expect_best_of_every_cell(const cv::Mat& image, const ExtractorOptions& options) {
  PolicyImage<work::Native> copy(image);
  std::map<Cell, std::vector<int>> kept;
  for (const Feature& f : extract<work::Native>(image, 3, options)) {
    EXPECT_TRUE(f.x >= options.border && f.x < image.cols - options.border);
    EXPECT_TRUE(f.y >= options.border && f.y < image.rows - options.border);
    kept[cell_of(f.x, f.y, options)].push_back(
        harris_response<work::Native>(copy.view().pixels, image.cols, f.x, f.y));
  }
  auto expected = scores_by_cell(image, options);
  ASSERT_FALSE(expected.empty());
  for (auto& [cell, list] : expected)
    list.resize(std::min(list.size(), static_cast<std::size_t>(options.per_cell)));
  for (auto& [cell, list] : kept) std::sort(list.rbegin(), list.rend());
  EXPECT_EQ(kept, expected);
}

TEST(VisionExtractor, KeepsTheBestCornersOfEveryCell) {
  expect_best_of_every_cell(rectangle_image(160, 120, 30), {});
  expect_best_of_every_cell(noise_image(160, 120, 31), {});
  ExtractorOptions options;
  options.border = 20;
  options.cell = 13;
  options.per_cell = 7;
  expect_best_of_every_cell(rectangle_image(97, 75, 32), options);
}

TEST(VisionExtractor, NumbersFeaturesByCell) {
  const Features features = extract<work::Native>(rectangle_image(160, 120, 33));
  EXPECT_TRUE(std::is_sorted(features.begin(), features.end(), [](const auto& a, const auto& b) {
    return cell_of(a.x, a.y) < cell_of(b.x, b.y);
  }));
}

TEST(VisionExtractor, HasRoomForFourInEachOf176Cells) {
  const ExtractorOptions options;
  EXPECT_EQ(options.max_features(160, 120), 704);
  EXPECT_EQ(options.max_features(752, 480), 90 * 56 * 4);
  EXPECT_EQ(options.max_features(41, 33), 2 * 1 * 4);
  // Noise fills every cell.
  ExtractorOptions eager;
  eager.fast_threshold = 1;
  eager.harris_threshold = 0;
  EXPECT_EQ(extract<work::Native>(noise_image(160, 120, 34), 8, eager).size(), 704u);
}

TEST(VisionExtractor, DoesNotDependOnPolicyOrCores) {
  for (const cv::Mat& image :
       {rectangle_image(160, 120, 35), noise_image(97, 75, 36), rectangle_image(330, 41, 37)}) {
    const Features expected = extract<work::Native>(image, 1);
    EXPECT_FALSE(expected.empty()) << image.size();
    for (const int cores : {1, 3, 8}) {
      EXPECT_EQ(extract<work::Native>(image, cores), expected) << image.size() << " " << cores;
      EXPECT_EQ(extract<work::Counting>(image, cores), expected) << image.size() << " " << cores;
    }
  }
}

TEST(VisionExtractor, FindsNothingInImagesWithoutDetectionArea) {
  for (const cv::Size size : {cv::Size(32, 32), cv::Size(160, 20), cv::Size(1, 1)}) {
    const cv::Mat image = noise_image(size.width, size.height, 39);
    EXPECT_EQ(ExtractorOptions().max_features(size.width, size.height), 0);
    EXPECT_TRUE(extract<work::Native>(image).empty());
    EXPECT_TRUE(extract<work::Counting>(image).empty());
  }
  EXPECT_TRUE(extract<work::Native>(cv::Mat(120, 160, CV_8U, cv::Scalar(99))).empty());
}

std::vector<std::string_view> step_names(const work::StageRun& run) {
  std::vector<std::string_view> names;
  for (const work::Step& step : run.steps) {
    if (std::holds_alternative<work::Fork>(step)) {
      names.push_back(std::get<work::Fork>(step).name);
    } else {
      names.push_back(std::holds_alternative<work::Serial>(step) ? "serial" : "transfer");
    }
  }
  return names;
}

TEST(VisionExtractor, RecordsThreeForksAndTheCompactionBetween) {
  work::Machine machine = make_machine<work::Counting>(8);
  extract<work::Counting>(machine, rectangle_image(160, 120, 40));
  const work::Job job = machine.take_job();
  ASSERT_EQ(job.stages.size(), 1u);
  const std::vector<std::string_view> expected = {"transfer", "transfer", "transfer", "serial",
                                                  "detect",   "serial",   "blur",     "describe"};
  EXPECT_EQ(step_names(job.stages[0]), expected);
  EXPECT_EQ(std::get<work::Transfer>(job.stages[0].steps[0]).bytes, Bytes(19200));
}

TEST(VisionExtractor, WorkAddsUpToTheSameForAnyNumberOfCores) {
  const auto forked_work = [](int cores) {
    work::Machine machine = make_machine<work::Counting>(cores);
    extract<work::Counting>(machine, rectangle_image(160, 120, 41));
    const work::Job job = machine.take_job();
    work::Counts sum;
    for (const work::Step& step : job.stages[0].steps)
      if (const auto* fork = std::get_if<work::Fork>(&step))
        for (const work::Counts& share : fork->shares) sum += share;
    // Every core enters the loop over its share in each fork, and stores how much it found once.
    sum[work::Op::LoopEntry] -= static_cast<std::uint64_t>(3 * cores);
    sum[work::Op::StoreStream] -= static_cast<std::uint64_t>(cores);
    return sum;
  };
  const work::Counts one = forked_work(1), eight = forked_work(8);
  for (const work::OpInfo& op : work::kOps) EXPECT_EQ(one[op.op], eight[op.op]) << op.name;
}

TEST(VisionExtractor, OccupiesThePublishedLocalMemory) {
  // Paper, memory table: 64.0 kB; kB = 1000 B.
  work::Machine machine = make_machine<work::Counting>(8);
  extract<work::Counting>(machine, rectangle_image(160, 120, 42));
  const work::MemoryPeak memory = machine.take_job().stages[0].memory;
  EXPECT_NEAR(static_cast<double>(memory.parallel.count()), 64000, 100);
  EXPECT_EQ(memory.parallel, memory.single);
  std::int64_t sum = 0;
  for (const work::Block& block : memory.blocks) sum += block.size.count();
  EXPECT_EQ(sum, memory.parallel.count());
}

TEST(VisionExtractor, ReadsThePatternWhereTheOptionSays) {
  const cv::Mat image = rectangle_image(160, 120, 43);
  const auto run = [&](bool in_local_memory) {
    work::Machine machine = make_machine<work::Counting>(8);
    ExtractorOptions options;
    options.pattern_in_local_memory = in_local_memory;
    const Features features = extract<work::Counting>(machine, image, options);
    const work::StageRun stage = machine.take_job().stages[0];
    std::uint64_t l2_loads = 0;
    for (const work::Step& step : stage.steps)
      if (const auto* fork = std::get_if<work::Fork>(&step))
        for (const work::Counts& share : fork->shares) l2_loads += share[work::Op::LoadL2];
    return std::tuple(features, stage.memory.parallel, l2_loads);
  };
  const auto [from_l2, l2_peak, l2_loads] = run(false);
  const auto [from_l1, l1_peak, no_loads] = run(true);
  EXPECT_EQ(from_l1, from_l2);
  EXPECT_EQ(l1_peak, l2_peak + Bytes(1024));
  EXPECT_EQ(l2_loads, 256 * from_l2.size());
  EXPECT_EQ(no_loads, 0u);
}

TEST(VisionExtractor, RefusesOptionsThatCannotWork) {
  using traces::testing::expect_input_error;
  const auto run = [](auto change) {
    return [change] {
      ExtractorOptions options;
      change(options);
      extract<work::Native>(noise_image(64, 64, 44), 1, options);
    };
  };
  expect_input_error(run([](ExtractorOptions& o) { o.border = 14; }), {"border is 14", "15 px"});
  expect_input_error(run([](ExtractorOptions& o) { o.per_cell = 17; }), {"per_cell is 17", "16"});
  expect_input_error([] { ExtractorOptions{.cell = 0}.validate(); }, {"cell is 0", "at least 1"});
  expect_input_error(run([](ExtractorOptions& o) { o.fast_threshold = 256; }),
                     {"fast_threshold is 256", "0 to 255"});
}

TEST(VisionExtractor, NamesTheBlockThatDoesNotFit) {
  PolicyImage<work::Native> image(noise_image(160, 120, 45));
  work::Machine machine({8, "L1", Bytes(50000), 4, false});
  const auto stage = machine.stage("feature extraction");
  FeatureList<work::Native> list = alloc_features<work::Native>(machine.local(), 704);
  traces::testing::expect_input_error(
      [&] { extract_features<work::Native>(machine, image.view(), {}, list); },
      {"feature extraction", "blurred image", "L1"});
}

TEST(VisionExtractor, GivesTheSameBitsOnEveryHost) {
  // FNV-1a over coordinates and descriptors of a drawn image: the same for every compiler. It
  // changes with the pattern of pairs, the trigonometry and every rule of the extraction.
  std::uint32_t hash = 2166136261u;
  const auto add = [&](std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) {
      hash ^= value >> shift & 0xffu;
      hash *= 16777619u;
    }
  };
  for (const Feature& f : extract<work::Native>(rectangle_image(160, 120, 46))) {
    add(static_cast<std::uint32_t>(f.x));
    add(static_cast<std::uint32_t>(f.y));
    for (const std::uint32_t word : f.words) add(word);
  }
  EXPECT_EQ(hash, 4201253175u);
}

TEST(VisionExtractor, FindsAbout360FeaturesInRecordedFrames) {
  // Released embedded code on MH_01 (PARAMETERS.md#counts-per-stage): about 360 on average.
  const std::vector<cv::Mat> frames = recorded_frames(0, 300, 6);
  if (frames.empty()) GTEST_SKIP() << kNoRecordedData;
  double sum = 0;
  for (const cv::Mat& frame : frames)
    sum += static_cast<double>(extract<work::Native>(frame).size());
  EXPECT_NEAR(sum / static_cast<double>(frames.size()), 360, 10);
}

}  // namespace
}  // namespace leviosim::vio::vision_test
