// Reader of ASL/EuRoC folders (Burri et al., "The EuRoC micro aerial vehicle datasets", 2016):
//   mav0/cam0/{sensor.yaml,data.csv,data/*.png}, mav0/imu0/{sensor.yaml,data.csv} and, optionally,
//   mav0/state_groundtruth_estimate0/data.csv, or, as TUM-VI has it, mav0/mocap0/data.csv
// Everything but the pixels is read and checked at once, so that a run does not fail halfway for a
// reason that was visible at its start. Left out: cam1, the Leica and Vicon streams, colour,
// rosbag.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "traces/datasets/dataset.h"
#include "traces/datasets/imu_model.h"

namespace leviosim::traces {

/// Where ground truth lies in a mav0 folder, if there is any.
constexpr const char* kTruthCsv = "state_groundtruth_estimate0/data.csv";
/// The same in folders of TUM-VI: poses without velocity and biases.
constexpr const char* kMocapCsv = "mocap0/data.csv";

/// Opens `folder`, which is a mav0 folder or contains one. Throws InputError (with file, line,
/// column or key) for anything missing, broken, out of order, or not covered by the IMU; that the
/// images exist is checked here, what is in them when they are read.
Dataset open_asl(const std::filesystem::path& folder, const OpenOptions& options = {});

/// Whether a folder is a mav0 folder or contains one, complete or not.
bool is_asl(const std::filesystem::path& folder);
/// What open_asl() begins with: all that the folder holds.
Dataset read_asl(const std::filesystem::path& folder);
/// Frames, samples and ground truth of a mav0 folder, whose sensor.yaml files need not be there.
void read_asl_streams(const std::filesystem::path& mav0, Dataset& data);

/// The text files of a mav0 folder that readers look at.
std::vector<InputFiles> asl_files(const std::filesystem::path& mav0);

/// A flight without its pictures: how the body moved and where the camera sat on it.
struct MotionRecord {
  std::filesystem::path mav0;
  CameraModel camera;
  ImuModel imu_model;
  std::vector<std::int64_t> frame_stamps;  ///< of cam0/data.csv; empty without that file
  std::vector<ImuSample> imu;              ///< empty without imu0/data.csv
  std::vector<GroundTruthPose>
      ground_truth;  ///< at least two poses, no gap above kLongestTruthGapS
};

constexpr double kLongestTruthGapS = 0.1;

/// Reads the text files of an ASL folder, whose images need not be there: both sensor.yaml and the
/// ground truth must exist. Throws InputError as open_asl does.
MotionRecord open_motion(const std::filesystem::path& folder);

/// The single streams, for folders that lack the others. Throw InputError as open_asl does, also if
/// there is no row.
std::vector<FrameRef> read_frames_csv(const std::filesystem::path& data_csv);
std::vector<ImuSample> read_imu_csv(const std::filesystem::path& data_csv);
/// With 17 columns, or the first 8 of them: the rest is then 0.
std::vector<GroundTruthPose> read_ground_truth_csv(const std::filesystem::path& data_csv);

}  // namespace leviosim::traces
