// `leviosim recording` as users meet it: what is wrong is named with what to set, and is well then.
#include <gtest/gtest.h>

#include "tests/support/run_program.h"
#include "tools/app/table/json.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/image_source.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using testing::expect_refused;
using testing::ProgramResult;
using testing::run_program;
using traces::testing::TempFolder;

class RecordingCommand : public ::testing::Test {
 protected:
  RecordingCommand() {
    traces::write_synthetic_flight(folder_ / "flight", {.duration_s = 8, .texel_m = 0.01});
  }
  ProgramResult check() const {
    return run_program(folder_.path(), {"recording", (folder_ / "flight").string(), "--quiet"});
  }
  void append(const std::string& file, const std::string& line) const {
    const fs::path path = folder_ / "flight/mav0" / file;
    outputs::write_file_atomically(path, base::read_text_file(path) + line + '\n');
  }

  TempFolder folder_;
};

TEST_F(RecordingCommand, FindsNothingAgainstAFlightThatIsWell) {
  const ProgramResult result = check();
  EXPECT_EQ(result.status, 0) << result.out << result.err;
  for (const char* part : {"verdict: nothing speaks against it", "160, one every 50.00 ms",
                           "the accelerometer reads 9.8"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part << '\n' << result.out;
  const ProgramResult json = run_program(
      folder_.path(), {"recording", (folder_ / "flight").string(), "--quiet", "--json"});
  EXPECT_EQ(Json::parse(json.out).at("rows").size(), 5u) << json.out;
}

TEST_F(RecordingCommand, SaysWhatAnAccelerometerReadsAtRestAndWhatToSet) {
  append("imu0/sensor.yaml", "accelerometer_scale: 1.03");
  const ProgramResult wrong = check();
  EXPECT_EQ(wrong.status, 1) << wrong.err;
  const std::string advice = "imu0/sensor.yaml: accelerometer_scale: 0.999";
  EXPECT_NE(wrong.out.find("the accelerometer reads 10.1"), std::string::npos) << wrong.out;
  EXPECT_NE(wrong.out.find(advice), std::string::npos) << wrong.out;
}

/// The mask that it writes is what it asks for.
TEST_F(RecordingCommand, FindsPixelsThatNeverChangeAndWritesTheirMask) {
  const traces::Dataset data = traces::open_asl(folder_ / "flight");
  const traces::ImageSize size{data.camera.width, data.camera.height};
  const traces::ImageSource images(data, size);
  for (std::size_t i = 0; i < images.size(); ++i) {
    std::vector<std::uint8_t> picture = images.read_full(i);
    for (int y = 0; y < size.height; ++y)
      picture[static_cast<std::size_t>(y * size.width + size.width / 3)] = 255;
    outputs::write_file_atomically(data.frames[i].path, traces::encode_png(size, picture));
  }
  const std::string mask = (folder_ / "flight/mav0/cam0/mask.png").string();
  const ProgramResult found = run_program(
      folder_.path(), {"recording", (folder_ / "flight").string(), "--quiet", "--mask", mask});
  EXPECT_EQ(found.status, 1) << found.err;
  EXPECT_NE(found.out.find(fmt::format("{} never change", size.height)), std::string::npos)
      << found.out;
  append("cam0/sensor.yaml", "faulty_pixels: mask.png");
  EXPECT_EQ(check().status, 0) << check().out;
}

TEST_F(RecordingCommand, RefusesWhatIsNone) {
  expect_refused(run_program(folder_.path(), {"recording"}), {"DIR is missing"});
  expect_refused(run_program(folder_.path(), {"recording", folder_.path().string()}),
                 {"no recording of a known format"});
}

}  // namespace
}  // namespace leviosim::tools
