#include "tools/run/simulation.h"

#include <chrono>
#include <cmath>
#include <utility>

#include "platform_models/compiled_code.h"
#include "sim/check.h"
#include "traces/evaluation.h"

namespace leviosim::tools {
namespace {

/// Room for a native run at any resolution; untouched pages cost nothing.
constexpr Bytes kUnlimited{std::int64_t{1} << 30};

work::MachineConfig cluster_machine(const RunRequest& request, const vio::Profile& profile) {
  return {.cores = request.cores,
          .memory = "L1",
          .capacity = request.native ? kUnlimited : request.platform.config.cluster.l1.size,
          .alignment = profile.l1_alignment,
          .record = !request.native,
          .code = &platform::compiled_code()};
}

work::MachineConfig controller_machine(const RunRequest& request) {
  return {.cores = 1,
          .memory = "L2",
          .capacity = request.native ? kUnlimited : request.platform.config.l2.size,
          .alignment = 4,
          .record = !request.native,
          .code = &platform::compiled_code()};
}

std::vector<StageResult> empty_stages(const vio::Profile& profile) {
  std::vector<StageResult> stages;
  for (const vio::StageName& name : vio::stage_names(profile)) {
    StageResult stage;
    stage.name = name.name;
    stage.unit = name.per;
    stage.on_controller = name.on_controller;
    stages.push_back(std::move(stage));
  }
  return stages;
}

/// The pose that the workload reports for the camera, of the body and in double precision.
traces::StampedPose body_pose(const vio::FrameReport& report, const traces::CameraModel& camera,
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

FrameResult frame_result(int i, std::int64_t t_ns, const vio::FrameReport& report,
                         const traces::CameraModel& camera) {
  FrameResult f;
  f.index = i;
  f.t_ns = t_ns;
  f.source = report.source;
  f.keyframe = report.keyframe;
  f.features = report.features;
  f.world_matches = report.world_matches;
  f.frame_matches = report.frame_matches;
  f.inliers = report.inliers;
  f.landmarks = report.landmarks;
  f.pose = body_pose(report, camera, t_ns);
  return f;
}

/// Fills in what does not depend on timing.
void describe(RunResult& result, const RunRequest& request, const Feed& feed,
              const vio::Odometry& odometry) {
  const sim::ChipConfig& chip = request.platform.config;
  result.profile = request.profile;
  result.timed = !request.native;
  result.cores = request.cores;
  result.cluster_clock = chip.cluster.clock;
  result.controller_clock = chip.controller.clock;
  if (result.timed) result.chip = chip;
  result.l1_size = chip.cluster.l1.size;
  result.l2_size = chip.l2.size;
  result.frame_period_ns = std::llround(1e9 / feed.data().camera.rate_hz);
  result.image_width = feed.rig().width;
  result.image_height = feed.rig().height;
  for (const auto& [name, arena] : {std::pair<const char*, const work::Arena&>{
                                        "last keyframe", odometry.last_keyframe_memory()},
                                    {"pose graph", odometry.pose_graph_memory()}})
    result.l2.push_back({name, arena.used(), arena.live()});
  for (const FrameResult& frame : result.frames) result.trajectory.push_back(frame.pose);
  if (!feed.data().ground_truth.empty() && result.trajectory.size() >= 3)
    result.ate =
        traces::evaluate(result.trajectory, traces::to_trajectory(feed.data().ground_truth),
                         {.expected_poses = result.frames.size()});
}

/// The golden model: the same computation without a chip. The optimiser's result of a frame is
/// published before the next one, as on a chip that keeps up.
RunResult run_natively(const RunRequest& request, Feed& feed, const ProgressCallback& progress) {
  const vio::Profile profile = vio::profile_named(request.profile, request.seed);
  work::Machine cluster(cluster_machine(request, profile));
  work::Machine controller(controller_machine(request));
  const auto odometry = vio::make_odometry(false, profile, feed.rig(), cluster, controller);
  RunResult result;
  for (int i = 0; i < feed.size(); ++i) {
    const vio::FrameInput& input = feed.frame(i);
    const bool optimising = odometry->begin_optimisation();
    const vio::FrameReport report = odometry->process_frame(input);
    for (int k = 0; optimising && k < profile.optimiser_iterations; ++k) odometry->optimise();
    if (optimising) {
      odometry->publish();
      ++result.optimiser_published;
    }
    result.frames.push_back(frame_result(i, feed.time_ns(i), report, feed.data().camera));
    progress({i + 1, feed.size(), feed.time_ns(i) - feed.time_ns(0)});
  }
  describe(result, request, feed, *odometry);
  return result;
}

}  // namespace

Simulation::Simulation(const RunRequest& request, Feed& feed, ProgressCallback progress)
    : request_(request),
      feed_(feed),
      progress_(std::move(progress)),
      chip_(request.platform.config, request.cores),
      single_core_(request.platform.config, 1),
      cluster_(cluster_machine(request, vio::profile_named(request.profile, request.seed))),
      controller_(controller_machine(request)),
      odometry_(vio::make_odometry(true, vio::profile_named(request.profile, request.seed),
                                   feed.rig(), cluster_, controller_)),
      camera_frames_(chip_.kernel(), "camera frames", static_cast<std::size_t>(feed.size())),
      snapshot_taken_(chip_.kernel(), "snapshot"),
      book_(empty_stages(vio::profile_named(request.profile, request.seed))) {}

RunResult Simulation::run() {
  chip_.kernel().spawn("camera", camera());
  chip_.kernel().spawn("front end", front_end());
  chip_.kernel().spawn_server("optimiser", optimiser());
  const std::size_t blocked = chip_.kernel().run();
  check_equal(blocked, std::size_t{0}, "processes that wait for ever");
  return take_result();
}

std::int64_t Simulation::now_ns() const {
  return chip_.timebase().whole_nanoseconds(chip_.kernel().now() - sim::Time{});
}

sim::Process Simulation::camera() {
  for (int i = 0; i < feed_.size(); ++i) {
    const sim::Duration since_start =
        chip_.timebase().from_nanoseconds(feed_.time_ns(i) - feed_.time_ns(0));
    co_await chip_.kernel().at(sim::Time{} + since_start);
    co_await camera_frames_.push(i);
  }
}

sim::Process Simulation::front_end() {
  for (int done = 0; done < feed_.size(); ++done) {
    const int i = co_await camera_frames_.pop();
    const std::int64_t start_ns = now_ns();
    const bool late = optimiser_busy_;
    const bool begun = !late && odometry_->begin_optimisation();
    if (late) ++result_.optimiser_late;
    if (begun) {
      optimiser_busy_ = true;
      snapshot_frame_ = done;
      snapshot_taken_.notify();
    }
    const vio::FrameReport report = odometry_->process_frame(feed_.frame(i));
    const work::Job job = cluster_.take_job();
    book_.add_work(job);
    const sim::JobTiming timing = co_await chip_.offload(job);
    book_.add_parallel(timing);
    const sim::JobTiming single = single_core_.front_end(job);
    book_.add_single(single);

    FrameResult frame = frame_result(i, feed_.time_ns(i), report, feed_.data().camera);
    frame.arrival_ns = feed_.time_ns(i) - feed_.time_ns(0);
    frame.start_ns = start_ns;
    frame.end_ns = now_ns();
    frame.cycles = chip_.cluster().clock().whole_cycles(timing.end - timing.begin);
    frame.single_cycles = single_core_.front_end_cycles(single);
    result_.frames.push_back(frame);
    if (request_.observer != nullptr)
      request_.observer->on_front_end({done, begun, frame, job, timing, single});
    progress_({done + 1, feed_.size(), frame.end_ns});
  }
}

sim::Process Simulation::optimiser() {
  const int iterations = vio::profile_named(request_.profile, request_.seed).optimiser_iterations;
  for (;;) {
    co_await snapshot_taken_.wait();
    for (int k = 0; k < iterations; ++k) {
      odometry_->optimise();
      const work::Job job = controller_.take_job();
      book_.add_work(job);
      const sim::JobTiming timing = co_await chip_.controller().run(job);
      book_.add_parallel(timing);
      book_.add_single(timing);  // the controller is one core
      if (request_.observer != nullptr)
        request_.observer->on_optimiser({snapshot_frame_, k, k + 1 == iterations, job, timing});
    }
    odometry_->publish();
    controller_.take_job();
    ++result_.optimiser_published;
    optimiser_busy_ = false;
  }
}

RunResult Simulation::take_result() {
  result_.stages = book_.stages();
  describe(result_, request_, feed_, *odometry_);
  // What persists in L2 lies below whatever the controller allocates; it has rows of its own.
  const Bytes persistent =
      odometry_->last_keyframe_memory().used() + odometry_->pose_graph_memory().used();
  L2Row optimiser{"optimiser", Bytes(0), {}};
  for (const StageResult& stage : result_.stages) {
    if (!stage.on_controller || stage.memory.parallel <= optimiser.bytes + persistent) continue;
    optimiser = {"optimiser", stage.memory.parallel - persistent, stage.memory.blocks};
    std::erase_if(optimiser.blocks,
                  [](const work::Block& block) { return block.name == vio::kPersistentBlock; });
  }
  if (optimiser.bytes > Bytes(0)) result_.l2.push_back(optimiser);
  return std::move(result_);
}

RunResult simulate(const RunRequest& request, const ProgressCallback& progress) {
  const auto begin = std::chrono::steady_clock::now();
  Feed feed(request);
  RunResult result = request.native ? run_natively(request, feed, progress)
                                    : Simulation(request, feed, progress).run();
  result.host_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace leviosim::tools
