// The film of a run: what was seen comes back, within its size, and no other bytes are taken for
// one.
#include "tools/app/film/film.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/base/error.h"
#include "tests/support/scratch.h"
#include "tests/traces/test_folder.h"
#include "traces/datasets/jpeg_file.h"
#include "traces/work_traces/bytes.h"
#include "traces/work_traces/section_file.h"

namespace leviosim::tools {
namespace {

using traces::testing::expect_input_error;
constexpr Bytes kMemory{1 << 24};

/// The hardest to compress.
std::vector<std::uint8_t> noise(int pixels) {
  std::vector<std::uint8_t> image;
  std::uint32_t state = 1;
  for (int i = 0; i < pixels; ++i) {
    state = state * 1664525u + 1013904223u;
    image.push_back(static_cast<std::uint8_t>(state >> 24));
  }
  return image;
}

std::string film_of(int width, int height, const vio::FrameReport& report, int frames = 1) {
  const std::vector<std::uint8_t> pixels = noise(width * height);
  std::string bytes;
  FilmWriter film([&](std::string_view piece) { bytes += piece; });
  for (int i = 0; i < frames; ++i) film.add({pixels.data(), width, height, 0, {}}, report);
  EXPECT_EQ(film.size().count(), std::ssize(bytes));
  return bytes;
}

class Film : public ::testing::Test {
 protected:
  std::vector<FilmFrame> read(const std::string& bytes, Bytes memory = kMemory) {
    tests::write_text(file_, bytes);
    return read_film(file_, memory);
  }
  traces::testing::TempFolder folder_;
  std::filesystem::path file_ = folder_ / kFilmFile;
};

TEST_F(Film, HoldsWhatWasSeen) {
  using State = vio::FeatureState;
  vio::FrameReport report;
  report.keyframe = true;
  report.seen = {{State::Detected, 80, 60, 80, 60, {}},
                 {State::New, 40, 90, 45, 30, {1.25f, -2.5f, 30}},
                 {State::Rejected, 159.9f, 119.9f, 0, 0, {9, 9, 9}}};
  const std::vector<FilmFrame> film = read(film_of(160, 120, report, 2));
  ASSERT_EQ(film.size(), 2u);
  const FilmFrame& frame = film.back();
  EXPECT_EQ(frame.features[0], "\x80\x80");
  EXPECT_EQ(frame.features[4], "\x40\xc0\x48\x40");
  EXPECT_EQ(frame.features[3], std::string("\xff\xff\0\0", 4));
  EXPECT_EQ(frame.features[1] + frame.features[2], "");
  ASSERT_EQ(frame.points.size(), 1u) << "of landmarks that agree or are new";
  EXPECT_EQ(frame.points[0], (std::array<std::int64_t, 3>{1250, -2500, 30000}));
}

TEST_F(Film, OfOtherFramesThanKeyframesHasNoPoints) {
  vio::FrameReport report;
  report.seen = {{vio::FeatureState::Agrees, 40, 90, 45, 30, {1, 2, 3}}};
  EXPECT_TRUE(read(film_of(160, 120, report)).front().points.empty());
}

TEST_F(Film, PicturesAreSmallWhateverIsInThem) {
  vio::FrameReport report;
  report.seen.emplace();
  for (const auto& [width, height] : {std::pair{160, 120}, {96, 72}, {320, 240}, {752, 480}}) {
    const FilmFrame frame = read(film_of(width, height, report)).front();
    const traces::ImageHeader head = traces::JpegFile(frame.image).header();
    EXPECT_LE(head.width, 160u);
    EXPECT_NEAR(static_cast<double>(head.width) / head.height, 1.0 * width / height, 0.02);
    EXPECT_LT(frame.image.size(), 5000u) << "noise at the least quality";
  }
}

TEST_F(Film, RefusesWhatIsNoWholeFilm) {
  vio::FrameReport report;
  report.seen = {{vio::FeatureState::Agrees, 40, 90, 45, 30, {1, 2, 3}}};
  const std::string whole = film_of(160, 120, report, 2);
  expect_input_error([&] { read(whole.substr(0, whole.size() - 5)); }, {kFilmFile});
  expect_input_error([&] { read("LEVIOWT\n" + whole.substr(8)); }, {kFilmFile});
  expect_input_error([&] { read(whole, Bytes(100)); }, {kFilmFile});
  for (std::size_t i = 0; i < whole.size(); i += 37) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    EXPECT_THROW(read(damaged), InputError) << "byte " << i;
  }
}

/// Whole sections with sums that are right, and nonsense in them.
TEST_F(Film, RefusesFramesThatAreNone) {
  const auto film = [](const std::string& image, const std::string& features,
                       std::uint64_t points) {
    traces::ByteWriter out;
    out.text(image);
    for (std::size_t i = 0; i < kFeatureStates.size(); ++i) out.text(features);
    out.whole(points);
    return traces::file_head({"LEVIOFM\n", "a film", 1}) + traces::packed_section(out.bytes(), 1);
  };
  vio::FrameReport report;
  report.seen.emplace();
  const std::string image = read(film_of(8, 8, report)).front().image;
  EXPECT_EQ(read(film(image, "abcd", 0)).size(), 1u);
  expect_input_error([&] { read(film("no picture", "", 0)); }, {"frame 0", "JPEG"});
  expect_input_error([&] { read(film(image, "abc", 0)); }, {"frame 0", "features"});
  expect_input_error([&] { read(film(image, "", 1)); }, {"frame 0", "map point"});
  expect_input_error([&] { read(film(image, "", 1ull << 60)); }, {"frame 0", "map points"});
}

}  // namespace
}  // namespace leviosim::tools
