#include "traces/recordings/recording.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "traces/datasets/asl_reader.h"
#include "traces/recordings/formats.h"

namespace leviosim::traces {
namespace {

namespace fs = std::filesystem;

constexpr std::array kFormats{
    RecordingFormat{"TUM-VI", "mav0/ with dso/camchain.yaml", is_tum_vi, read_tum_vi},
    RecordingFormat{"TUM RGB-D", "rgb.txt", is_tum_rgbd, read_tum_rgbd},
    RecordingFormat{"KITTI odometry", "calib.txt with times.txt", is_kitti_odometry,
                    read_kitti_odometry},
    RecordingFormat{"KITTI raw", "oxts/ with image_00/ or image_02/", is_kitti_raw, read_kitti_raw},
    RecordingFormat{"EuRoC (ASL)", "mav0/, or cam0/ with imu0/", is_asl, read_asl},
};

void refuse_bags(const fs::path& path) {
  const auto is_bag = [](const fs::path& file) {
    const fs::path kind = file.extension();
    return kind == ".bag" || kind == ".db3" || kind == ".mcap";
  };
  bool bag = base::is_file(path) && is_bag(path);
  if (base::is_folder(path))
    for (const fs::directory_entry& entry : fs::directory_iterator(path))
      bag = bag || is_bag(entry.path());
  if (bag)
    throw InputError(fmt::format(
        "{}: a ROS bag; leviosim-bag-to-asl (tools/rosbag_to_asl.py) makes an ASL folder of ROS 2 "
        "bags",
        path.string()));
}

}  // namespace

std::span<const RecordingFormat> recording_formats() { return kFormats; }

const RecordingFormat& format_of(const fs::path& folder) {
  if (!base::exists(folder)) throw InputError(fmt::format("{}: no such folder", folder.string()));
  std::vector<std::string> looked_for;
  for (const RecordingFormat& format : kFormats) {
    if (format.is(folder)) return format;
    looked_for.push_back(fmt::format("{} ({})", format.files, format.name));
  }
  refuse_bags(folder);
  throw InputError(fmt::format("{}: no recording of a known format; looked for {}", folder.string(),
                               fmt::join(looked_for, ", ")));
}

Dataset open_recording(const fs::path& folder, const OpenOptions& options) {
  return opened(format_of(folder).read(folder), options);
}

}  // namespace leviosim::traces
