// The readers of recordings that are no plain ASL folders, one file each; the table in
// recording.cpp names them. All throw InputError with file, line, column or key.
#pragma once

#include <filesystem>

#include "traces/datasets/dataset.h"

namespace leviosim::traces {

/// TUM-VI (Schubert et al. 2018) as exported for EuRoC's readers: a mav0 folder, whose calibration
/// lies beside it in the files of Kalibr, dso/camchain.yaml and dso/imu_config.yaml. A mav0 folder
/// with sensor.yaml files of its own is read as EuRoC's.
bool is_tum_vi(const std::filesystem::path& folder);
Dataset read_tum_vi(const std::filesystem::path& folder);

/// TUM RGB-D (Sturm et al. 2012): rgb.txt and, optionally, groundtruth.txt with the poses of the
/// camera. These folders hold no calibration: cam0/sensor.yaml, as ASL folders have it, is added by
/// the user. An accelerometer alone (accelerometer.txt) is no IMU, and left out; with a
/// gyroscope.txt of the same layout, "time x y z" in s, rad/s and m/s², and imu0/sensor.yaml it is.
/// Left out: depth.
bool is_tum_rgbd(const std::filesystem::path& folder);
Dataset read_tum_rgbd(const std::filesystem::path& folder);

/// A sequence of the KITTI odometry benchmark (Geiger et al. 2012): calib.txt, times.txt and
/// image_0/, else image_2/; the true poses lie two folders above in poses/NN.txt. No IMU.
bool is_kitti_odometry(const std::filesystem::path& folder);
Dataset read_kitti_odometry(const std::filesystem::path& folder);

/// A rectified drive of KITTI's raw data (Geiger et al. 2013): image_00/, else image_02/, oxts/,
/// and the three calib_*.txt in the folder above. The truth is the navigation system's, on a
/// Mercator plane that touches the first pose. Left out: unrectified drives, whose lens has a
/// sixth-order term.
bool is_kitti_raw(const std::filesystem::path& folder);
Dataset read_kitti_raw(const std::filesystem::path& folder);

}  // namespace leviosim::traces
