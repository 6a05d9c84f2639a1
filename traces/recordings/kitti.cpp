#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <numbers>
#include <string>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/text.h"
#include "traces/datasets/image_file.h"
#include "traces/datasets/row_values.h"
#include "traces/recordings/formats.h"
#include "traces/trajectories/kitti_files.h"

namespace leviosim::traces {
namespace {

namespace fs = std::filesystem;

/// The numbers of the line "KEY: 1 2 3" of a calibration. @throws InputError without such a line
std::vector<double> numbers_of(const fs::path& file, const std::string& key, std::size_t count) {
  std::size_t line = 0;
  for (const std::string& text : base::split(base::read_text_file(file), '\n')) {
    ++line;
    if (!text.starts_with(key + ':')) continue;
    std::vector<double> numbers;
    for (const std::string& word : base::split(text.substr(key.size() + 1), ' ')) {
      if (word.empty() || word == "\r") continue;
      if (!base::parse_number(word, numbers.emplace_back()))
        throw InputError(fmt::format("{}, key '{}': '{}' is not a finite number",
                                     base::at_line(file, line), key, word));
    }
    if (numbers.size() == count) return numbers;
    throw InputError(fmt::format("{}, key '{}': {} numbers; expected {}", base::at_line(file, line),
                                 key, numbers.size(), count));
  }
  throw InputError(fmt::format("{}: no line '{}:' with {} numbers", file.string(), key, count));
}

Eigen::Matrix3d rotation_of(const fs::path& file, const std::string& key) {
  constexpr double kTolerance = 1e-3;
  const std::vector<double> numbers = numbers_of(file, key, 9);
  const Eigen::Matrix3d R =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
  const double off = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kTolerance) || R.determinant() < 0)
    throw InputError(fmt::format("{}, key '{}': no rotation", file.string(), key));
  return Eigen::Quaterniond(R).normalized().toRotationMatrix();
}

/// What "R:" and "T:" of a file say.
Eigen::Isometry3d transform_of(const fs::path& file) {
  const std::vector<double> t = numbers_of(file, "T", 3);
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  transform.linear() = rotation_of(file, "R");
  transform.translation() = Eigen::Vector3d(t[0], t[1], t[2]);
  return transform;
}

/// Of two rectified cameras, grey and colour, the first that there is.
struct Rectified {
  std::string folder;                               ///< "image_0"
  std::string key;                                  ///< of its projection
  Eigen::Vector3d offset{Eigen::Vector3d::Zero()};  ///< of camera 0 in this camera's frame [m]
};

/// Fills in what the projection and the first picture say.
void read_projection(const fs::path& file, Rectified& rectified, Dataset& data) {
  const std::vector<double> p = numbers_of(file, rectified.key, 12);
  if (!(p[0] > 0) || !(p[5] > 0))
    throw InputError(fmt::format("{}, key '{}': the focal lengths must be above 0", file.string(),
                                 rectified.key));
  data.camera.fx = p[0];
  data.camera.fy = p[5];
  data.camera.cx = p[2];
  data.camera.cy = p[6];
  rectified.offset = {(p[3] - p[2] * p[11]) / p[0], (p[7] - p[6] * p[11]) / p[5], p[11]};
  const fs::path& picture = data.frames.front().path;
  try {
    const ImageSize size = image_size(base::read_file(picture, base::InputKind::image));
    data.camera.width = size.width;
    data.camera.height = size.height;
  } catch (const InputError& error) {
    throw InputError(fmt::format("image {}: {}", picture.string(), error.what()));
  }
  data.camera.rate_hz = rate_of(stamps_of(data.frames), data.frames_csv);
}

Rectified choose(const fs::path& folder, const Rectified& grey, const Rectified& colour) {
  return base::is_folder(folder / grey.folder) || !base::is_folder(folder / colour.folder) ? grey
                                                                                           : colour;
}

void number_frames(const std::vector<std::int64_t>& times, const fs::path& folder, int digits,
                   std::vector<FrameRef>& frames) {
  for (const std::int64_t t_ns : times)
    frames.push_back(
        {t_ns, folder / fmt::format("{:0{}}.png", frames.size(), digits), frames.size() + 1});
}

/// "2011-09-26 13:02:25.964389445" as nanoseconds since 1970, whatever the zone.
std::int64_t parse_date(const base::CsvRow& row) {
  const std::string text = fmt::format("{} {}", row.text(0), row.text(1));
  const auto number = [&](std::size_t at, std::size_t length) {
    int value = -1;
    const char* const from = text.data() + at;
    const auto [end, error] = std::from_chars(from, from + length, value);
    return error == std::errc() && end == from + length ? value : -1;
  };
  constexpr std::size_t kLength = 29;
  if (text.size() != kLength) row.fail("not a time; expected as 2011-09-26 13:02:25.964389445");
  const std::array<int, 7> n{number(0, 4),  number(5, 2),  number(8, 2), number(11, 2),
                             number(14, 2), number(17, 2), number(20, 9)};
  using namespace std::chrono;
  const year_month_day day{year(n[0]), month(static_cast<unsigned>(n[1])),
                           std::chrono::day(static_cast<unsigned>(n[2]))};
  if (std::any_of(n.begin(), n.end(), [](int part) { return part < 0; }) || !day.ok() ||
      n[0] < 1970 || n[0] > 2200 || n[3] > 23 || n[4] > 59 || n[5] > 59)
    row.fail("not a time; expected as 2011-09-26 13:02:25.964389445");
  return (sys_days(day).time_since_epoch() + hours(n[3]) + minutes(n[4]) + seconds(n[5]) +
          nanoseconds(n[6]))
      .count();
}

std::vector<std::int64_t> read_dates(const fs::path& file) {
  base::CsvReader csv(file, base::Separator::blanks, {"date", "time"});
  base::RisingStamps stamps;
  std::vector<std::int64_t> times;
  while (const base::CsvRow* row = csv.next()) {
    times.push_back(parse_date(*row));
    stamps.add(*row, times.back());
  }
  require_rows(times.size(), file);
  return times;
}

constexpr std::size_t kOxtsColumns = 30;

/// What one file of the navigation system says. @param scale  of the Mercator plane: the cosine of
/// the first latitude; 0 where this is the first
void read_oxts(const fs::path& file, std::int64_t t_ns, double& scale, Dataset& data) {
  constexpr double kEarthM = 6378137;  // the equatorial radius of WGS 84
  constexpr double kRadians = std::numbers::pi / 180;
  base::CsvReader csv(file, base::Separator::blanks,
                      std::vector<std::string>(kOxtsColumns, "oxts"));
  const base::CsvRow* const row = csv.next();
  if (row == nullptr) throw InputError(fmt::format("{}: holds no row", file.string()));
  data.imu.push_back({t_ns, vector_at(*row, 17, kGyroBound), vector_at(*row, 11, kAccelBound)});
  constexpr double kMostLatitude = 85;  // where the plane of Mercator ends
  if (std::abs(row->number(0)) > kMostLatitude) row->fail(0, "no latitude from -85 to 85 degrees");
  const double latitude = row->number(0) * kRadians;
  if (scale == 0) scale = std::cos(latitude);
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  GroundTruthPose pose;
  pose.t_ns = t_ns;
  pose.T_world_body = Eigen::Translation3d(
                          scale * kEarthM * row->number(1) * kRadians,
                          scale * kEarthM * std::log(std::tan(std::numbers::pi / 4 + latitude / 2)),
                          row->number(2)) *
                      AngleAxisd(row->number(5), Vector3d::UnitZ()) *
                      AngleAxisd(row->number(4), Vector3d::UnitY()) *
                      AngleAxisd(row->number(3), Vector3d::UnitX());
  pose.velocity = {row->number(7), row->number(6), row->number(10)};
  data.ground_truth.push_back(pose);
}

/// The first pose becomes the origin: positions on the globe have lost digits.
void from_the_first(std::vector<GroundTruthPose>& poses) {
  const Eigen::Vector3d origin = poses.front().T_world_body.translation();
  for (GroundTruthPose& pose : poses) pose.T_world_body.pretranslate(-origin);
}

}  // namespace

bool is_kitti_odometry(const fs::path& folder) {
  return base::is_file(folder / "calib.txt") && base::is_file(folder / "times.txt");
}

Dataset read_kitti_odometry(const fs::path& folder) {
  Dataset data;
  data.frames_csv = folder / "times.txt";
  Rectified camera = choose(folder, {"image_0", "P0"}, {"image_2", "P2"});
  data.pictures = camera.folder;
  const std::vector<std::int64_t> times = read_times(data.frames_csv);
  require_rows(times.size(), data.frames_csv);
  number_frames(times, folder / camera.folder, 6, data.frames);
  read_projection(folder / "calib.txt", camera, data);
  data.files = {{"calib.txt", {folder / "calib.txt"}}, {"times.txt", {data.frames_csv}}};

  const fs::path at = fs::absolute(folder).lexically_normal();
  const fs::path named = at.has_filename() ? at : at.parent_path();
  const fs::path truth =
      named.parent_path().parent_path() / "poses" / (named.filename().string() + ".txt");
  if (!base::exists(truth)) return data;
  data.truth_csv = truth;
  data.files.push_back({"poses", {truth}});
  const std::vector<Eigen::Isometry3d> poses = read_kitti_poses(truth);
  if (poses.size() != times.size())
    throw InputError(fmt::format("{}: holds {} poses; expected {}, the times of {}", truth.string(),
                                 poses.size(), times.size(), data.frames_csv.string()));
  Eigen::Matrix3d R_world_camera0;  // x right, y down, z forward to a world whose z is up
  R_world_camera0 << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    GroundTruthPose pose;
    pose.t_ns = times[i];
    pose.T_world_body = R_world_camera0 * poses[i] * Eigen::Translation3d(-camera.offset);
    data.ground_truth.push_back(pose);
  }
  return data;
}

bool is_kitti_raw(const fs::path& folder) {
  return base::is_folder(folder / "oxts") &&
         (base::is_folder(folder / "image_00") || base::is_folder(folder / "image_02"));
}

Dataset read_kitti_raw(const fs::path& folder) {
  const fs::path cameras = folder / "../calib_cam_to_cam.txt";
  const fs::path to_velo = folder / "../calib_imu_to_velo.txt";
  const fs::path to_camera = folder / "../calib_velo_to_cam.txt";
  Dataset data;
  Rectified camera = choose(folder, {"image_00", "P_rect_00"}, {"image_02", "P_rect_02"});
  data.pictures = camera.folder + "/data";
  data.frames_csv = folder / camera.folder / "timestamps.txt";
  number_frames(read_dates(data.frames_csv), folder / data.pictures, 10, data.frames);
  read_projection(cameras, camera, data);
  Eigen::Isometry3d rectify = Eigen::Isometry3d::Identity();
  rectify.linear() = rotation_of(cameras, "R_rect_00");
  data.camera.T_body_camera = (Eigen::Translation3d(camera.offset) * rectify *
                               transform_of(to_camera) * transform_of(to_velo))
                                  .inverse();

  data.imu_csv = data.truth_csv = folder / "oxts/timestamps.txt";
  const std::vector<std::int64_t> times = read_dates(data.imu_csv);
  InputFiles samples{fmt::format("oxts/data, {} files concatenated", times.size()), {}};
  double scale = 0;
  for (const std::int64_t t_ns : times) {
    samples.files.push_back(folder / fmt::format("oxts/data/{:010}.txt", samples.files.size()));
    read_oxts(samples.files.back(), t_ns, scale, data);
  }
  from_the_first(data.ground_truth);
  data.imu_model.rate_hz = rate_of(times, data.imu_csv);
  data.files = {{"calib_cam_to_cam.txt", {cameras}},
                {"calib_imu_to_velo.txt", {to_velo}},
                {"calib_velo_to_cam.txt", {to_camera}},
                {camera.folder + "/timestamps.txt", {data.frames_csv}},
                {"oxts/timestamps.txt", {data.imu_csv}},
                samples};
  return data;
}

}  // namespace leviosim::traces
