// sensor.yaml of a camera (first byte 'c') and of an IMU.
#include "traces/datasets/sensor_yaml.h"

#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim;
  static fuzz::MemoryFile file("-sensor.yaml");
  if (size == 0) return 0;
  return fuzz::only_input_errors([&] {
    const auto& path = file.holding(fuzz::text_of(data + 1, size - 1));
    if (data[0] == 'c')
      traces::read_camera_model(path);
    else
      traces::read_imu_model(path);
  });
}
