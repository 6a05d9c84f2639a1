#include "tools/app/run/live_source.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "platform_models/loader/compiled_code.h"
#include "sim/base/error.h"
#include "sim/chip/accelerator.h"
#include "tools/app/film/film.h"
#include "tools/app/result/summary.h"
#include "tools/app/run/clock_offset.h"
#include "tools/app/run/feed.h"
#include "traces/datasets/dataset.h"
#include "traces/trajectories/evaluation.h"

namespace leviosim::tools {
namespace {

std::vector<std::int64_t> stamps_of(const Feed& feed) {
  std::vector<std::int64_t> stamps_ns;
  for (int i = 0; i < feed.size(); ++i) stamps_ns.push_back(feed.time_ns(i));
  return stamps_ns;
}

/// Room for a native run at this resolution: pages that are not touched cost nothing but addresses,
/// of which `ulimit -v` leaves few. An image takes some 4 bytes a pixel in all, on top of 1 MB.
Bytes native_room(const RunRequest& request) {
  constexpr std::int64_t kOfAny = std::int64_t{1} << 26;
  constexpr std::int64_t kOfPixel = 64;
  return Bytes(kOfAny + kOfPixel * static_cast<std::int64_t>(request.image_size.pixels()));
}

/// Only an accelerator, of this chip or of one that replays the run, asks for offload regions.
bool follows_offload(const RunRequest& request) {
  return request.recording || sim::has_accelerators(request.platform.config);
}

/// Of which nothing is used where L2 has room.
Bytes external_of(const RunRequest& request) {
  const sim::ExternalMemoryConfig& memory = request.platform.config.controller.external;
  return request.native || memory.bytes_per_second <= 0 ? Bytes(0) : memory.size;
}

/// The pose that the workload reports for the camera, of the body and in double precision.
traces::StampedPose body_pose(const vio::CameraPose& report, const traces::CameraModel& camera,
                              std::int64_t t_ns) {
  Eigen::Matrix3d R;
  Eigen::Vector3d p;
  for (int r = 0; r < 3; ++r) {
    p[r] = static_cast<double>(report.p_world_camera[static_cast<std::size_t>(r)]);
    for (int c = 0; c < 3; ++c)
      R(r, c) = static_cast<double>(report.R_world_camera[static_cast<std::size_t>(3 * r + c)]);
  }
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  // Single-precision products drift from orthogonality; the quaternion of a pose must not.
  T_world_camera.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  T_world_camera.translation() = p;
  return {t_ns, T_world_camera * camera.T_body_camera.inverse()};
}

}  // namespace

Bytes l1_of(const RunRequest& request, const vio::Profile& profile) {
  const Bytes all = request.platform.config.cluster.l1.size;
  return profile.l1_kib > 0 ? std::min(all, Bytes(1024LL * profile.l1_kib)) : all;
}

work::MachineConfig cluster_machine(const RunRequest& request, int alignment) {
  return cluster_machine(request, alignment, request.platform.config.cluster.l1.size);
}

work::MachineConfig cluster_machine(const RunRequest& request, int alignment, Bytes l1) {
  return {.cores = request.cores,
          .memory = "L1",
          .capacity = request.native ? native_room(request) : l1,
          .alignment = alignment,
          .record = !request.native,
          .offload = follows_offload(request),
          .code = &platform::compiled_code()};
}

work::MachineConfig controller_machine(const RunRequest& request, Bytes l2) {
  if (request.camera) l2 -= soc::second_buffer(request.image_size.width, request.image_size.height);
  return {.cores = 1,
          .memory = "L2",
          .capacity = request.native ? native_room(request) : l2,
          .alignment = 4,
          .record = !request.native,
          .offload = follows_offload(request),
          .code = &platform::compiled_code(),
          .external = external_of(request)};
}

std::vector<StageResult> named_stages(const std::vector<vio::StageName>& names) {
  std::vector<StageResult> stages;
  for (const vio::StageName& name : names) {
    StageResult stage;
    stage.name = name.name;
    stage.unit = name.per;
    stage.on_controller = name.on_controller;
    stages.push_back(std::move(stage));
  }
  return stages;
}

LiveSource::LiveSource(const RunRequest& request)
    : profile_(profile_of(request)),
      evaluate_(request.evaluate),
      film_(request.film),
      feed_(request),
      cluster_(cluster_machine(request, profile_.l1_alignment, l1_of(request, profile_))),
      controller_(controller_machine(request, request.platform.config.l2.size)),
      odometry_(vio::make_odometry(!request.native, profile_, feed_.rig(), cluster_, controller_)) {
  if (profile_.use_imu && feed_.data().imu.empty())
    throw InputError(fmt::format(
        "--data {}: the recording has no gyroscope, and profile '{}' needs one; expected --profile "
        "levio-no-imu",
        request.data, profile_.name));
  if (evaluate_) traces::require_truth_at(feed_.truth(), feed_.data().truth_csv, stamps_of(feed_));
}

bool LiveSource::begin_frame(const soc::FrameStart& start) {
  frame_ = start.frame;
  return !start.optimiser_busy && odometry_->begin_optimisation();
}

const work::Job& LiveSource::process(FrameResult& result) {
  const vio::FrameInput& input = feed_.frame(frame_);
  const vio::FrameReport report = odometry_->process_frame(input);
  if (film_ != nullptr) film_->add(input, report);
  front_end_job_ = cluster_.take_job();
  result.index = frame_;
  result.t_ns = feed_.time_ns(frame_);
  static_cast<vio::FrameFacts&>(result) = report;
  result.pose = body_pose(report, feed_.data().camera, result.t_ns);
  processed_ns_.push_back(result.t_ns);
  for (const vio::EarlierPose& earlier : report.earlier)
    result.earlier.emplace_back(
        earlier.frames_ago, body_pose(earlier, feed_.data().camera,
                                      processed_ns_[processed_ns_.size() - 1 -
                                                    static_cast<std::size_t>(earlier.frames_ago)]));
  return front_end_job_;
}

const work::Job& LiveSource::optimise() {
  odometry_->optimise();
  optimiser_job_ = controller_.take_job();
  return optimiser_job_;
}

void LiveSource::publish() {
  odometry_->publish();
  controller_.take_job();
}

int LiveSource::frames_that_wait() const {
  return profile_.frames_that_wait(feed_.rig().frame_rate);
}

std::vector<StageResult> LiveSource::empty_stages() const {
  return named_stages(vio::stage_names(profile_));
}

/// Of what was mended of the data, and of cores that were left without work.
std::vector<std::string> LiveSource::notes() const {
  std::vector<std::string> notes;
  for (const std::string& mended : feed_.data().notes) notes.push_back("data: " + mended);
  const int batch = profile_.epnp.batch, cores = cluster_.cores();
  if (cluster_.recording() && batch > 0 && batch < cores)
    notes.push_back(
        fmt::format("idle: {} of {} cores have no hypothesis of EPnP and of the 8-point algorithm, "
                    "since workload.ransac_batch={}",
                    cores - batch, cores, batch));
  return notes;
}

void LiveSource::describe(RunResult& result) const {
  result.notes = notes();
  if (profile_.optimiser.joint)
    if (const auto offset = find_clock_offset(feed_.data().imu, result.frames))
      if (offset->is_certain()) result.notes.push_back("data: " + offset->text());
  if (result.camera) result.camera->fps = feed_.rate_hz();
  for (const auto& [name, arena] : {std::pair<const char*, const work::Arena&>{
                                        "last keyframe", odometry_->last_keyframe_memory()},
                                    {"pose graph", odometry_->pose_graph_memory()},
                                    {"loop closure", odometry_->loop_memory()}})
    if (arena.used() > Bytes(0)) result.l2.push_back({name, arena.used(), arena.live()});
  if (const work::Arena& external = controller_.behind(); external.peak() > Bytes(0))
    result.external.push_back({kOptimiserExternal, external.peak(), external.blocks_at_peak()});
  if (evaluate_ && !feed_.truth().empty() && result.trajectory.size() >= kFewestPoses &&
      why_incomparable(result).empty())
    evaluate(result);
}

/// A run that has diverged, or dropped the frames that the truth covers, is still a run.
void LiveSource::evaluate(RunResult& result) const {
  try {
    const traces::Trajectory& truth = feed_.truth();
    result.ate =
        traces::evaluate(result.trajectory, truth, {.expected_poses = expected_poses(result)});
    if (const std::optional<traces::Trajectory> located = located_poses(result)) {
      const traces::Evaluation without_guesses = traces::evaluate(*located, truth);
      result.ate->located_rmse_m = without_guesses.translation.rmse;
      result.ate->size_ratio = without_guesses.size_ratio;
    }
  } catch (const InputError& failure) {
    if (!result.ate) result.not_comparable = failure.what();
  }
}

}  // namespace leviosim::tools
