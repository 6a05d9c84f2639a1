// The tables of an ASL folder: frames (first byte 'f'), ground truth ('g'), IMU samples.
#include "tests/fuzz/fuzz_target.h"
#include "traces/datasets/asl_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim;
  static fuzz::MemoryFile file("-data.csv");
  if (size == 0) return 0;
  return fuzz::only_input_errors([&] {
    const auto& path = file.holding(fuzz::text_of(data + 1, size - 1));
    if (data[0] == 'f')
      traces::read_frames_csv(path);
    else if (data[0] == 'g')
      traces::read_ground_truth_csv(path);
    else
      traces::read_imu_csv(path);
  });
}
