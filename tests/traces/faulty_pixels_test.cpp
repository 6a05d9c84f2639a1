// Pixels that show nothing: found, read from a mask, and mended.
#include "traces/datasets/faulty_pixels.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/traces/test_folder.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/image_source.h"

namespace leviosim::traces {
namespace {

using testing::AslFolder;
using testing::expect_input_error;
using Picture = std::vector<std::uint8_t>;

constexpr ImageSize kSize{12, 9};

std::size_t at(int x, int y) { return static_cast<std::size_t>(y * kSize.width + x); }

/// Stripes that move to the right, by a pixel a picture.
Picture stripes(int moved) {
  Picture picture(kSize.pixels());
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      picture[at(x, y)] = static_cast<std::uint8_t>(40 * ((x + y + 12 - moved) % 4));
  return picture;
}

PixelMask found_with(const PixelMask& stuck, bool moves = true) {
  FaultyPixelSearch search(kSize);
  for (int i = 0; i < 8; ++i) {
    Picture picture = stripes(moves ? i : 0);
    for (std::size_t p = 0; p < stuck.size(); ++p)
      if (stuck[p] != 0) picture[p] = stuck[p];
    search.add(picture);
  }
  return search.found();
}

PixelMask mask_of(std::initializer_list<std::size_t> pixels) {
  PixelMask mask(kSize.pixels(), 0);
  for (const std::size_t p : pixels) mask[p] = 255;
  return mask;
}

TEST(FaultyPixelSearch, FindsStuckPixelsAndColumnsWhereTheRestChanges) {
  EXPECT_EQ(found_with({}), PixelMask());
  EXPECT_EQ(found_with(mask_of({at(4, 4), at(9, 2)})), mask_of({at(4, 4), at(9, 2)}));
  PixelMask column(kSize.pixels(), 0);
  for (int y = 0; y < kSize.height; ++y) column[at(6, y)] = column[at(7, y)] = 255;
  EXPECT_EQ(found_with(column), column);
}

/// What covers the lens, and a camera that rests, are no faults of pixels.
TEST(FaultyPixelSearch, FindsNothingWhereNothingChangesAllAround) {
  EXPECT_EQ(found_with(mask_of({at(4, 4)}), false), PixelMask());
  PixelMask patch(kSize.pixels(), 0);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) patch[at(x, y)] = 200;
  EXPECT_EQ(found_with(patch), PixelMask());
}

TEST(PixelMending, TakesTheMeanOfTheNearestThatAreWell) {
  Picture picture = stripes(0);
  const PixelMask faulty = mask_of({at(5, 4), at(6, 4), at(0, 0)});
  const int expected =
      (picture[at(4, 4)] + picture[at(7, 4)] + picture[at(5, 3)] + picture[at(5, 5)] + 2) / 4;
  for (std::size_t p = 0; p < faulty.size(); ++p)
    if (faulty[p] != 0) picture[p] = 255;
  const Picture before = picture;
  PixelMending(faulty, kSize).apply(picture);
  EXPECT_EQ(picture[at(5, 4)], expected);
  EXPECT_EQ(picture[at(0, 0)], (picture[at(1, 0)] + picture[at(0, 1)] + 1) / 2);
  for (std::size_t p = 0; p < faulty.size(); ++p)
    if (faulty[p] == 0) {
      EXPECT_EQ(picture[p], before[p]);
    }
  Picture same = before;
  PixelMending({}, kSize).apply(same);
  EXPECT_EQ(same, before);
}

class MaskOfARecording : public ::testing::Test {
 protected:
  MaskOfARecording() { name("faulty.png"); }

  void name(const std::string& file) const {
    const auto path = folder_.mav0("cam0/sensor.yaml");
    outputs::write_file_atomically(path, sensor_ + "faulty_pixels: " + file + "\n");
  }
  void write(const PixelMask& mask, ImageSize size) const {
    outputs::write_file_atomically(folder_.mav0("cam0/faulty.png"), encode_png(size, mask));
  }

  const AslFolder folder_;
  const std::string sensor_ = base::read_text_file(folder_.mav0("cam0/sensor.yaml"));
  const ImageSize size_{folder_.camera().width, folder_.camera().height};
};

TEST_F(MaskOfARecording, ChangesThesePixelsOnly) {
  PixelMask mask(size_.pixels(), 0);
  const std::size_t middle = size_.pixels() / 2 + 5;
  mask[middle] = 1;
  write(mask, size_);
  const Dataset data = open_asl(folder_.root());
  EXPECT_EQ(data.files.back().files.front().filename(), "faulty.png");
  Dataset unmended = data;
  unmended.faulty_pixels.clear();
  Picture mended = ImageSource(data, size_).read_full(0);
  const Picture before = ImageSource(unmended, size_).read_full(0);
  EXPECT_NEAR(
      mended[middle],
      (before[middle - 1] + before[middle + 1] + before[middle - 32] + before[middle + 32]) / 4.0,
      0.5);
  mended[middle] = before[middle];
  EXPECT_EQ(mended, before);
}

TEST_F(MaskOfARecording, IsRefusedWithItsNameIfItIsNone) {
  const auto open = [&] { open_asl(folder_.root()); };
  expect_input_error(open, {"faulty.png"});  // not there
  write(PixelMask(12, 0), {4, 3});
  expect_input_error(open, {"mask of faulty pixels", "faulty.png"});
  write(PixelMask(size_.pixels(), 9), size_);
  expect_input_error(open, {"0 of 768 pixels are well"});
  name("../faulty.png");
  expect_input_error(open, {"sensor.yaml", "faulty_pixels", "in the same folder"});
}

}  // namespace
}  // namespace leviosim::traces
