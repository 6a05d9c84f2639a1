// Images of a camera of 64x48 pixels.
#include "tests/fuzz/fuzz_target.h"
#include "traces/datasets/image_source.h"

namespace {

leviosim::traces::Dataset dataset_of(const std::filesystem::path& image) {
  leviosim::traces::Dataset data;
  data.frames_csv = "data.csv";
  data.camera.fx = data.camera.fy = 40;
  data.camera.cx = 32;
  data.camera.cy = 24;
  data.camera.width = 64;
  data.camera.height = 48;
  data.camera.rate_hz = 20;
  data.frames = {{0, image, 1}};
  return data;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim;
  static fuzz::MemoryFile file("-image.png");
  static const traces::ImageSource source(dataset_of(file.path()), {32, 24});
  return fuzz::only_input_errors([&] {
    file.holding(fuzz::text_of(data, size));
    source.read(0);
  });
}
