#include "traces/synthesis/rendered_flight.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "traces/datasets/asl_reader.h"
#include "traces/datasets/asl_writer.h"
#include "traces/datasets/image_file.h"
#include "traces/datasets/image_preparation.h"
#include "traces/datasets/rng.h"
#include "traces/synthesis/flight_images.h"
#include "traces/synthesis/frame_stamps.h"
#include "traces/synthesis/hall.h"
#include "traces/synthesis/illumination.h"
#include "traces/synthesis/imu_synthesis.h"
#include "traces/synthesis/recorded_motion.h"
#include "traces/synthesis/renderer.h"
#include "traces/synthesis/smoothing_spline.h"

namespace leviosim::traces {
namespace {

namespace fs = std::filesystem;

/// Parts of the flight that have a seed of their own.
enum RenderedPart : std::uint64_t { kPlaceSeed, kLightSeed, kSimulatedImuSeed, kPictureSeed };

// A small sensor and a wide lens, open in little light.
constexpr double kWorkshopShotNoise = 8;  // at 128 [grey levels]
constexpr double kWorkshopVignetting = 0.45;
constexpr double kWorkshopMeanGrey = 130;
constexpr double kWorkshopSpotPx =
    1.4;  // standard deviation of the lens's blur, also at silhouettes

/// Everything about the flight but its pictures.
struct Plan {
  MotionRecord record;
  bool simulate_imu;
  std::int64_t origin_ns;  ///< time 0 of the motion
  RecordedMotion motion;
  std::vector<std::int64_t> imu_stamps;
  std::vector<std::int64_t> frames;
  std::vector<std::size_t> numbers;  ///< of the frames in the whole flight, which select noise
};

void check_options(const RenderedFlightOptions& options) {
  const auto check_range = [](const char* what, double value, double low, double high) {
    if (!(value >= low && value <= high))
      throw InputError(
          fmt::format("rendered flight: {} {}; expected {} to {}", what, value, low, high));
  };
  check_range("exposure [s]", options.exposure_s, 0, 0.05);
  check_range("image noise [grey levels]", options.image_noise, 0, 255);
  check_range("lens spot [px]", options.spot_px, 0.1, 100);
  check_range("texel width [px]", options.texels, 0.25, 20);
}

bool simulates_imu(const MotionRecord& record, ImuSource source) {
  if (source == ImuSource::recorded && record.imu.empty())
    throw InputError(fmt::format(
        "{}: there is no data.csv with recorded IMU samples; record them or simulate the IMU",
        (record.mav0 / "imu0").string()));
  return source == ImuSource::simulated || record.imu.empty();
}

/// Of the IMU that the flight will have: those recorded, within the ground truth if simulated.
std::vector<std::int64_t> make_imu_stamps(const MotionRecord& record, bool simulate) {
  const std::int64_t begin = record.ground_truth.front().t_ns;
  const std::int64_t end = record.ground_truth.back().t_ns;
  if (record.imu.empty()) return regular_stamps(begin, end, record.imu_model.rate_hz);
  std::vector<std::int64_t> stamps;
  for (const ImuSample& sample : record.imu)
    if (!simulate || (sample.t_ns >= begin && sample.t_ns <= end)) stamps.push_back(sample.t_ns);
  return stamps;
}

std::vector<std::int64_t> make_frame_stamps(const MotionRecord& record,
                                            const std::vector<std::int64_t>& imu_stamps,
                                            double exposure_s) {
  const std::int64_t half_ns = std::llround(0.5e9 * exposure_s);
  const std::int64_t period_ns = std::llround(1e9 / record.camera.rate_hz);
  TimeSpan span{record.ground_truth.front().t_ns + half_ns,
                record.ground_truth.back().t_ns - half_ns};
  if (!imu_stamps.empty()) {
    span.begin_ns = std::max(span.begin_ns, imu_stamps.front() + period_ns);
    span.end_ns = std::min(span.end_ns, imu_stamps.back());
  }
  std::vector<std::int64_t> frames = record.frame_stamps.empty()
                                         ? stamps_nearest_to_period(imu_stamps, span, period_ns)
                                         : stamps_within(record.frame_stamps, span);
  if (frames.empty())
    throw InputError(fmt::format("{}: no frame lies within both ground truth ({} to {} ns) and IMU",
                                 record.mav0.string(), record.ground_truth.front().t_ns,
                                 record.ground_truth.back().t_ns));
  return frames;
}

/// Numbers of the frames that are drawn, of `count`.
std::vector<std::size_t> frame_numbers(const std::vector<FrameRange>& ranges, std::size_t count,
                                       const std::string& what) {
  std::vector<std::size_t> numbers;
  for (const FrameRange& range : ranges.empty() ? std::vector{FrameRange{0, count}} : ranges) {
    check_frame_range(range, count, what);
    if (!numbers.empty() && range.begin <= numbers.back())
      throw InputError(fmt::format("frame range {}:{}: does not lie behind the one before it",
                                   range.begin, range.end));
    for (std::size_t i = range.begin; i < range.end; ++i) numbers.push_back(i);
  }
  return numbers;
}

Plan make_plan(const fs::path& motion_dir, const RenderedFlightOptions& options) {
  MotionRecord record = open_motion(motion_dir);
  const bool simulate = simulates_imu(record, options.imu);
  const std::int64_t origin_ns = record.ground_truth.front().t_ns;
  RecordedMotion motion(record.ground_truth, origin_ns,
                        simulate ? RecordedMotion::kSmoothHz : SmoothingSpline::kInterpolate);
  std::vector<std::int64_t> imu_stamps = make_imu_stamps(record, simulate);
  const std::vector<std::int64_t> all = make_frame_stamps(record, imu_stamps, options.exposure_s);
  std::vector<std::size_t> numbers =
      frame_numbers(options.frames, all.size(), record.mav0.string());
  std::vector<std::int64_t> frames;
  for (const std::size_t number : numbers) frames.push_back(all[number]);
  return {std::move(record),     simulate,          origin_ns,         std::move(motion),
          std::move(imu_stamps), std::move(frames), std::move(numbers)};
}

double seconds_of_motion(const Plan& plan, std::int64_t t_ns) {
  return static_cast<double>(t_ns - plan.origin_ns) * 1e-9;
}

void write_streams(outputs::OutputFolder& out, const Plan& plan,
                   const RenderedFlightOptions& options) {
  const auto write = [&](const fs::path& name, const std::string& text) {
    out.write("mav0/" + name.string(), text);
  };
  const auto copy = [&](const fs::path& name) {
    write(name, base::read_text_file(plan.record.mav0 / name));
  };
  const fs::path truth = "state_groundtruth_estimate0";
  const std::string comment =
      fmt::format("leviosim rendered flight, {} {}",
                  options.place.kind == PlaceKind::hall ? "seed" : "world", options.place.text());
  if (options.prepared)
    write("cam0/sensor.yaml",
          format_camera_yaml(
              ImagePreparation(plan.record.camera, *options.prepared).prepared_camera(), comment));
  else
    copy("cam0/sensor.yaml");
  write("cam0/data.csv", format_frames_csv(plan.frames));
  copy("imu0/sensor.yaml");
  if (fs::exists(plan.record.mav0 / truth / "sensor.yaml")) copy(truth / "sensor.yaml");
  if (!plan.simulate_imu) {
    copy("imu0/data.csv");
    copy(truth / "data.csv");
    return;
  }
  ImuSynthesizer imu(plan.record.imu_model, derive_seed(options.place.seed, kSimulatedImuSeed));
  const ImuTrack track = record_imu(plan.motion, &imu, plan.origin_ns, plan.imu_stamps);
  write("imu0/data.csv", format_imu_csv(track.samples));
  write(truth / "data.csv", format_ground_truth_csv(track.truth));
}

/// Each pose turned up, down, left and right by an angle: a lens that blurs silhouettes, too.
std::vector<Eigen::Isometry3d> blurred(const std::vector<Eigen::Isometry3d>& poses, double angle) {
  std::vector<Eigen::Isometry3d> all;
  for (const Eigen::Isometry3d& pose : poses)
    for (const double x : {-angle, angle})
      for (const double y : {-angle, angle})
        all.push_back(pose * Eigen::AngleAxisd(x, Eigen::Vector3d::UnitX()) *
                      Eigen::AngleAxisd(y, Eigen::Vector3d::UnitY()));
  return all;
}

/// Camera poses over which the picture at a time is averaged: so many that the scene moves by about
/// a pixel between two of them.
std::vector<Eigen::Isometry3d> exposure_poses(const Plan& plan, std::int64_t t_ns,
                                              const RenderedFlightOptions& options) {
  const double exposure_s = options.exposure_s;
  constexpr double kTypicalDepthM = 3;
  constexpr double kMostPoses = 16;
  const CameraModel& camera = plan.record.camera;
  const double middle = seconds_of_motion(plan, t_ns);
  const auto pose = [&](double offset_s) -> Eigen::Isometry3d {
    return plan.motion.at(middle + offset_s).T_world_body * camera.T_body_camera;
  };
  const Eigen::Isometry3d moved = pose(-0.5 * exposure_s).inverse() * pose(0.5 * exposure_s);
  const double shift_px = camera.fx * (Eigen::AngleAxisd(moved.linear()).angle() +
                                       moved.translation().norm() / kTypicalDepthM);
  const double count = std::clamp(std::ceil(shift_px), 1.0, kMostPoses);
  std::vector<Eigen::Isometry3d> poses;
  for (double k = 0; k < count; ++k) poses.push_back(pose(exposure_s * ((k + 0.5) / count - 0.5)));
  if (options.place.kind == PlaceKind::workshop)
    poses = blurred(poses, kWorkshopSpotPx / camera.fx);
  return poses;
}

World make_world(const Plan& plan, const RenderedFlightOptions& options) {
  std::vector<Eigen::Vector3d> path;
  for (const GroundTruthPose& pose : plan.record.ground_truth)
    path.push_back((pose.T_world_body * plan.record.camera.T_body_camera).translation());
  HallOptions hall;
  hall.seed = derive_seed(options.place.seed, kPlaceSeed);
  hall.texels = options.texels;
  hall.threads = options.threads;
  hall.kind = options.place.kind;
  if (hall.kind == PlaceKind::surround) hall.clearance_m = options.place.distance_m;
  return make_hall(path, plan.record.camera, hall);
}

void write_pictures(outputs::OutputFolder& out, const Plan& plan,
                    const RenderedFlightOptions& options, const FlightProgress& progress) {
  const CameraModel& camera = plan.record.camera;
  const ImagePreparation preparation(
      camera, options.prepared.value_or(ImageSize{camera.width, camera.height}));
  RenderOptions render_options;
  render_options.noise = options.image_noise;
  render_options.spot_px = options.spot_px;
  if (options.place.kind == PlaceKind::workshop) {
    render_options.shot_noise = kWorkshopShotNoise;
    render_options.vignetting = kWorkshopVignetting;
    render_options.exposed_to = kWorkshopMeanGrey;
  }
  render_options.seed = derive_seed(options.place.seed, kPictureSeed);
  if (options.prepared) render_options.wanted = preparation.pixels_read();
  const World world = make_world(plan, options);
  const Renderer renderer(world, camera, render_options);
  const Illumination light(derive_seed(options.place.seed, kLightSeed));
  const auto draw = [&](std::size_t i) {
    const auto poses = exposure_poses(plan, plan.frames[i], options);
    const double gain =
        options.illumination ? light.gain(seconds_of_motion(plan, plan.frames[i])) : 1;
    std::vector<std::uint8_t> pixels =
        renderer.render({poses, static_cast<float>(gain), plan.numbers[i]});
    return options.prepared ? preparation.apply(pixels) : pixels;
  };
  const PinholeIntrinsics& size = preparation.intrinsics();
  write_flight_images(out, plan.frames, {size.width, size.height}, draw, options.threads, progress);
}

}  // namespace

std::vector<std::int64_t> rendered_frame_stamps(const MotionRecord& record,
                                                const RenderedFlightOptions& options) {
  return make_frame_stamps(record, make_imu_stamps(record, simulates_imu(record, options.imu)),
                           options.exposure_s);
}

void write_rendered_flight(const fs::path& motion_dir, const fs::path& out_dir,
                           const RenderedFlightOptions& options, const FlightProgress& progress) {
  check_options(options);
  outputs::OutputFolder out({.option = {},
                             .path = out_dir.string(),
                             .replace = options.overwrite || options.repair,
                             .inputs = {motion_dir, motion_dir / "mav0"},
                             .repair = options.repair});
  const Plan plan = make_plan(motion_dir, options);
  const CameraModel& camera = plan.record.camera;
  const ImageSize size = options.prepared.value_or(ImageSize{camera.width, camera.height});
  const auto pixels =
      static_cast<std::uint64_t>(size.width) * static_cast<std::uint64_t>(size.height);
  out.reserve(plan.frames.size() * pixels / 2);  // rather less: pictures with noise
  write_streams(out, plan, options);
  write_pictures(out, plan, options, progress);
  commit_flight(out);
}

}  // namespace leviosim::traces
