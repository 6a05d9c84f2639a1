#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/sensor_yaml.h"
#include "traces/recordings/formats.h"

namespace leviosim::traces {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCameras = "dso/camchain.yaml";
constexpr const char* kImu = "dso/imu_config.yaml";

}  // namespace

double rate_of(const std::vector<std::int64_t>& stamps_ns, const fs::path& file) {
  if (stamps_ns.size() < 2)
    throw InputError(fmt::format("{}: one time stamp is no rate; expected at least 2 rows",
                                 file.string()));
  std::vector<std::int64_t> periods;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i)
    periods.push_back(stamps_ns[i] - stamps_ns[i - 1]);
  const auto middle = periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2);
  std::nth_element(periods.begin(), middle, periods.end());
  return 1e9 / static_cast<double>(*middle);
}

std::vector<std::int64_t> stamps_of(const std::vector<FrameRef>& frames) {
  std::vector<std::int64_t> stamps_ns;
  for (const FrameRef& frame : frames) stamps_ns.push_back(frame.t_ns);
  return stamps_ns;
}

bool is_tum_vi(const fs::path& folder) {
  return base::is_folder(folder / "mav0") && base::is_file(folder / kCameras) &&
         !base::exists(folder / "mav0/cam0/sensor.yaml");
}

Dataset read_tum_vi(const fs::path& folder) {
  if (!base::is_file(folder / kImu))
    throw InputError(fmt::format("{} not found in {}; TUM-VI has it beside {}", kImu,
                                 folder.string(), kCameras));
  Dataset data;
  double shift_s = 0;
  data.camera = read_kalibr_camera(folder / kCameras, shift_s);
  data.imu_model = read_kalibr_imu(folder / kImu);
  read_asl_streams(folder / "mav0", data);
  data.camera.rate_hz = rate_of(stamps_of(data.frames), data.frames_csv);
  for (FrameRef& frame : data.frames) frame.t_ns += std::llround(1e9 * shift_s);
  for (const char* name : {kCameras, kImu}) data.files.push_back({name, {folder / name}});
  return data;
}

}  // namespace leviosim::traces
