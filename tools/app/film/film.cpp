#include "tools/app/film/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "traces/datasets/jpeg_encoder.h"
#include "traces/datasets/jpeg_file.h"
#include "traces/work_traces/bytes.h"
#include "traces/work_traces/section_file.h"

namespace leviosim::tools {
namespace {

constexpr traces::FileKind kKind{"LEVIOFM\n", "a film", 1};
constexpr int kLevel = 9;        ///< of zstd
constexpr int kMostWidth = 160;  ///< of an image [px]
constexpr std::size_t kMostImage = 2000;
constexpr std::array kQualities{80, 65, 50, 40, 30, 20, 10};
constexpr double kMostMetres = 1e6;  ///< farther points are left out
constexpr std::uint64_t kLargestImage = std::uint64_t{1} << 20;

/// Means of squares of pixels where the image is wider than a film.
std::string small_image(const vio::FrameInput& input) {
  const int step = (input.width + kMostWidth - 1) / kMostWidth;
  const int width = input.width / step, height = std::max(1, input.height / step);
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      int sum = 0;
      for (int dy = 0; dy < step; ++dy)
        for (int dx = 0; dx < step; ++dx)
          sum +=
              input.pixels[std::min(step * y + dy, input.height - 1) * input.width + step * x + dx];
      pixels.push_back(static_cast<std::uint8_t>(sum / (step * step)));
    }
  std::string image;
  for (const int quality : kQualities) {
    image = traces::jpeg_bytes(pixels, width, height, quality);
    if (image.size() <= kMostImage) break;
  }
  return image;
}

std::uint8_t share(float at, int size) {
  return static_cast<std::uint8_t>(std::clamp(256 * at / static_cast<float>(size), 0.0f, 255.0f));
}

void add_points(traces::ByteWriter& out, const vio::FrameReport& report) {
  std::vector<std::array<float, 3>> points;
  for (const vio::SeenFeature& feature : *report.seen) {
    const bool shown =
        feature.state == vio::FeatureState::Agrees || feature.state == vio::FeatureState::New;
    const bool near = std::all_of(feature.p_world.begin(), feature.p_world.end(),
                                  [](float m) { return std::abs(m) < kMostMetres; });
    if (report.keyframe && shown && near) points.push_back(feature.p_world);
  }
  out.whole(points.size());
  for (const auto& point : points)
    for (const float metres : point) out.integer(std::lround(1000 * metres));
}

}  // namespace

FilmWriter::FilmWriter(outputs::Sink sink) : sink_(std::move(sink)) {
  write(traces::file_head(kKind));
}

void FilmWriter::write(const std::string& bytes) {
  sink_(bytes);
  size_ += Bytes(static_cast<std::int64_t>(bytes.size()));
}

void FilmWriter::add(const vio::FrameInput& input, const vio::FrameReport& report) {
  traces::ByteWriter out;
  out.text(small_image(input));
  std::array<std::string, kFeatureStates.size()> features;
  for (const vio::SeenFeature& feature : *report.seen) {
    std::string& to = features[static_cast<std::size_t>(feature.state)];
    to += static_cast<char>(share(feature.x, input.width));
    to += static_cast<char>(share(feature.y, input.height));
    if (feature.state == vio::FeatureState::Detected) continue;
    to += static_cast<char>(share(feature.x_before, input.width));
    to += static_cast<char>(share(feature.y_before, input.height));
  }
  for (const std::string& bytes : features) out.text(bytes);
  add_points(out, report);
  write(traces::packed_section(out.bytes(), kLevel));
}

std::vector<FilmFrame> film_of(const std::string& name, std::string_view bytes, Bytes memory) {
  traces::MemoryBudget budget(memory);
  std::vector<FilmFrame> film;
  for (const traces::Section& section : traces::sections_of(kKind, name, bytes)) {
    const std::string content = traces::unpacked(section, name, budget);
    const std::string place = fmt::format("{}, frame {}", name, film.size());
    traces::ByteReader in(content, place, &budget);
    FilmFrame& frame = film.emplace_back();
    frame.image = in.take(in.whole_below(kLargestImage, "bytes of an image"), "an image");
    try {
      traces::JpegFile(frame.image).header();
    } catch (const InputError& error) {
      in.fail(error.what());
    }
    for (std::string& features : frame.features) {
      features = in.text("features");
      const std::size_t each = &features == &frame.features.front() ? 2 : 4;
      if (features.size() % each != 0) in.fail("features end within one");
    }
    frame.points.resize(in.count("map points", sizeof(frame.points[0])));
    for (auto& point : frame.points)
      for (std::int64_t& coordinate : point) {
        coordinate = in.integer("a map point");
        if (std::abs(static_cast<double>(coordinate)) > 1000 * kMostMetres)
          in.fail("a map point is farther away than 1000 km");
      }
    in.expect_end();
  }
  return film;
}

std::vector<FilmFrame> read_film(const std::filesystem::path& file, Bytes memory) {
  return film_of(file.string(), base::read_file(file, base::InputKind::film), memory);
}

}  // namespace leviosim::tools
