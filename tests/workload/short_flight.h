// A short flight for tests, drawn and measured in memory: what the odometry is fed, the truth, and
// what can go wrong on the way. A plain camera of 160x120 in the synthetic flight's room, EuRoC's
// IMU.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "sim/work/machine.h"
#include "traces/datasets/camera_model.h"
#include "traces/datasets/disturbance.h"
#include "traces/datasets/euroc_sensors.h"
#include "traces/datasets/image_preparation.h"
#include "traces/synthesis/imu_synthesis.h"
#include "traces/synthesis/motion.h"
#include "traces/synthesis/renderer.h"
#include "traces/synthesis/world.h"
#include "traces/trajectories/evaluation.h"
#include "workload/vio/odometry/odometry.h"
#include "workload/vio/profile.h"

namespace leviosim::vio::test {

/// Time along a path, with its first two derivatives by real time.
using Pace = std::function<traces::Derivatives(double t_s)>;

/// HandHeldFlight at another pace.
class PacedFlight : public traces::Motion {
 public:
  PacedFlight(std::uint64_t seed, Pace pace) : path_(seed), pace_(std::move(pace)) {}

  traces::MotionState at(double t_s) const override {
    const traces::Derivatives p = pace_(t_s);
    traces::MotionState state = path_.at(p.value);
    state.acceleration = state.acceleration * p.first * p.first + state.velocity * p.second;
    state.velocity *= p.first;
    state.angular_velocity *= p.first;
    return state;
  }

 private:
  traces::HandHeldFlight path_;
  Pace pace_;
};

/// Constant pace from `begin_s` of the path on.
inline Pace at_pace(double pace, double begin_s = 0) {
  return [=](double t) { return traces::Derivatives{begin_s + pace * t, pace, 0}; };
}

/// Comes to rest at stop_s within a second, and goes on at resume_s likewise.
inline Pace with_standstill(double stop_s, double resume_s) {
  // The pace falls from 1 to 0 as 1 - 3 u² + 2 u³; its integral is u - u³ + u⁴ / 2.
  return [=](double t) -> traces::Derivatives {
    const double u = std::clamp(t - stop_s, 0.0, 1.0), w = std::clamp(t - resume_s, 0.0, 1.0);
    const auto way = [](double x) { return x - x * x * x + x * x * x * x / 2; };
    const auto pace = [](double x) { return 1 - 3 * x * x + 2 * x * x * x; };
    const auto change = [](double x) { return -6 * x + 6 * x * x; };
    if (t < resume_s) return {std::min(t, stop_s) + way(u), pace(u), change(u)};
    return {stop_s + 0.5 + 0.5 - way(1 - w) + std::max(0.0, t - resume_s - 1), pace(1 - w),
            -change(1 - w)};
  };
}

/// PacedFlight that goes straight on from `from_s` to `to_s`, neither turning nor changing its
/// speed, which an IMU cannot tell from rest; then it flies what it has put off.
class GlidingFlight : public traces::Motion {
 public:
  GlidingFlight(std::uint64_t seed, Pace pace, double from_s, double to_s)
      : flight_(seed, std::move(pace)), from_s_(from_s), to_s_(to_s) {}

  traces::MotionState at(double t_s) const override {
    const double glided_s = std::clamp(t_s, from_s_, to_s_) - from_s_;
    traces::MotionState state = flight_.at(t_s - glided_s);
    state.T_world_body.translation() += flight_.at(from_s_).velocity * glided_s;
    if (t_s > from_s_ && t_s < to_s_) {
      state.acceleration.setZero();
      state.angular_velocity.setZero();
    }
    return state;
  }

 private:
  PacedFlight flight_;
  double from_s_, to_s_;
};

struct ShortFlight {
  struct Frame {
    std::int64_t t_ns;
    std::vector<std::uint8_t> pixels;
    std::vector<ImuInput> imu;
  };

  Rig rig;
  Eigen::Isometry3d T_body_camera;
  std::vector<Frame> frames;
  traces::Trajectory truth;
};

inline Rig rig_of(const traces::CameraModel& camera) {
  Rig rig{};
  rig.camera = {static_cast<float>(camera.fx), static_cast<float>(camera.fy),
                static_cast<float>(camera.cx), static_cast<float>(camera.cy)};
  rig.width = camera.width;
  rig.height = camera.height;
  const Eigen::Isometry3d T = camera.T_body_camera.inverse();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c)
      rig.R_camera_body[static_cast<std::size_t>(3 * r + c)] = static_cast<float>(T.linear()(r, c));
    rig.p_camera_body[static_cast<std::size_t>(r)] = static_cast<float>(T.translation()[r]);
  }
  return rig;
}

/// 20 frames/s, with the ten IMU samples before each.
inline ShortFlight draw_flight(const traces::Motion& motion, double seconds, int width = 160,
                               int height = 120) {
  using traces::CameraModel;
  const CameraModel camera =
      traces::ImagePreparation(traces::euroc_cam0(), {width, height}).prepared_camera();
  const traces::World room = traces::make_room(5, 0.016, 0);
  const traces::Renderer renderer(room, camera, {.noise = 1.2, .seed = 7});
  traces::ImuSynthesizer imu(traces::euroc_imu0(), 11);
  ShortFlight flight{rig_of(camera), camera.T_body_camera, {}, {}};
  constexpr std::int64_t kImuStep = 5'000'000;
  constexpr int kSamples = 10;
  for (int i = 0; i < static_cast<int>(seconds * 20); ++i) {
    ShortFlight::Frame frame{i * kImuStep * kSamples, {}, {}};
    for (int k = kSamples - 1; k >= 0; --k) {
      const std::int64_t t_ns = frame.t_ns - k * kImuStep;
      const traces::ImuSample s = imu.measure(motion.at(static_cast<double>(t_ns) * 1e-9), t_ns);
      ImuInput input{};
      input.dt = 0.005f;
      for (int a = 0; a < 3; ++a) {
        input.gyro[a] = static_cast<float>(s.gyro[a]);
        input.accel[a] = static_cast<float>(s.accel[a]);
      }
      frame.imu.push_back(input);
    }
    const Eigen::Isometry3d T = motion.at(static_cast<double>(frame.t_ns) * 1e-9).T_world_body;
    frame.pixels = renderer.render(T * camera.T_body_camera, static_cast<std::uint64_t>(i));
    flight.truth.push_back({frame.t_ns, T});
    flight.frames.push_back(std::move(frame));
  }
  return flight;
}

// What can go wrong, from frame `first` to `last` (excluded).

/// The frames never arrive; their IMU samples do, with the next one.
inline void drop_frames(ShortFlight& flight, const std::function<bool(int)>& is_dropped) {
  std::vector<ShortFlight::Frame> kept;
  std::vector<ImuInput> pending;
  for (int i = 0; i < static_cast<int>(flight.frames.size()); ++i) {
    ShortFlight::Frame& frame = flight.frames[static_cast<std::size_t>(i)];
    pending.insert(pending.end(), frame.imu.begin(), frame.imu.end());
    if (is_dropped(i)) continue;
    frame.imu.swap(pending);
    pending.clear();
    kept.push_back(std::move(frame));
  }
  flight.frames = std::move(kept);
}

inline void darken(ShortFlight& flight, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i)
    for (std::uint8_t& pixel : flight.frames[i].pixels)
      pixel = static_cast<std::uint8_t>(pixel / 40);
}

/// As disturbance.h has it.
inline void disturb_pictures(ShortFlight& flight, std::string_view disturbance) {
  const traces::Disturbance parsed = traces::parse_disturbance(disturbance);
  for (ShortFlight::Frame& frame : flight.frames)
    traces::disturb_picture(parsed,
                            {frame.t_ns, flight.frames.front().t_ns, flight.frames.back().t_ns},
                            flight.rig.width, frame.pixels);
}

/// The camera delivers its last picture again and again.
inline void freeze(ShortFlight& flight, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i)
    flight.frames[i].pixels = flight.frames[first - 1].pixels;
}

/// Mean over 15 pixels of a row, as a fast turn blurs.
inline void blur(ShortFlight& flight, std::size_t first, std::size_t last) {
  constexpr int kHalf = 7;
  for (std::size_t i = first; i < last; ++i) {
    const std::vector<std::uint8_t> sharp = flight.frames[i].pixels;
    for (int y = 0; y < flight.rig.height; ++y)
      for (int x = 0; x < flight.rig.width; ++x) {
        int sum = 0;
        for (int k = -kHalf; k <= kHalf; ++k)
          sum += sharp[static_cast<std::size_t>(y * flight.rig.width +
                                                std::clamp(x + k, 0, flight.rig.width - 1))];
        flight.frames[i].pixels[static_cast<std::size_t>(y * flight.rig.width + x)] =
            static_cast<std::uint8_t>(sum / (2 * kHalf + 1));
      }
  }
}

/// Rows are read out of step: those of the upper half lie too far left, those of the lower half as
/// far right. Each half is in itself what the camera saw, and no pose explains both.
inline void tear(ShortFlight& flight, std::size_t first, std::size_t last) {
  constexpr int kShift = 32;
  const int width = flight.rig.width, height = flight.rig.height;
  for (std::size_t i = first; i < last; ++i) {
    const std::vector<std::uint8_t> whole = flight.frames[i].pixels;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const int from = x + (y < height / 2 ? kShift : width - kShift);
        flight.frames[i].pixels[static_cast<std::size_t>(y * width + x)] =
            whole[static_cast<std::size_t>(y * width + from % width)];
      }
  }
}

/// The sensors' range ends here.
inline void saturate(ShortFlight& flight, float gyro, float accel) {
  for (ShortFlight::Frame& frame : flight.frames)
    for (ImuInput& s : frame.imu)
      for (int a = 0; a < 3; ++a) {
        s.gyro[a] = std::clamp(s.gyro[a], -gyro, gyro);
        s.accel[a] = std::clamp(s.accel[a], -accel, accel);
      }
}

/// No samples; the first one after says how long that was.
inline void cut_imu(ShortFlight& flight, std::size_t first, std::size_t last) {
  float missing = 0;
  for (std::size_t i = first; i < last; ++i) {
    for (const ImuInput& s : flight.frames[i].imu) missing += s.dt;
    flight.frames[i].imu.clear();
  }
  flight.frames[last].imu.front().dt += missing;
}

/// Pushed and shaken, by less than a camera can see. @param share  of 0.4 rad/s and 3 m/s²
inline void nudge(ShortFlight& flight, std::size_t first, std::size_t last, float share = 1) {
  double t_s = 0;
  for (std::size_t i = first; i < last; ++i)
    for (ImuInput& s : flight.frames[i].imu) {
      const auto wave = static_cast<float>(std::sin(2 * M_PI * 10 * (t_s += 0.005)));
      for (int a = 0; a < 3; ++a) {
        s.gyro[a] += 0.4f * share * wave;
        s.accel[a] += 3.0f * share * wave;
      }
    }
}

/// What the odometry made of a flight.
struct Flown {
  traces::Trajectory trajectory;  ///< of the body
  std::vector<PoseSource> sources;
  std::vector<Health> health;
  std::vector<std::array<int, 4>> facts;  ///< features, matches of both kinds, inliers
  double ate = 0;                         ///< SE3-aligned [m]
  bool finite = true;                     ///< all poses
  int map_restarts = 0;
  std::vector<work::Passage> passages;     ///< what passed through L1 in tiles
  std::vector<work::Passage> l2_passages;  ///< … and through L2
  double skew = 0;  ///< how far a rotation is from being one: largest element of RᵀR − I

  int count(PoseSource source) const {
    return static_cast<int>(std::count(sources.begin(), sources.end(), source));
  }
};

/// Of the body.
inline Eigen::Isometry3d body_pose(const CameraPose& pose, const Eigen::Isometry3d& T_body_camera) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c)
      T.linear()(r, c) =
          static_cast<double>(pose.R_world_camera[static_cast<std::size_t>(3 * r + c)]);
    T.translation()[r] = static_cast<double>(pose.p_world_camera[static_cast<std::size_t>(r)]);
  }
  T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  return T * T_body_camera.inverse();
}

inline Flown fly(const ShortFlight& flight, const Profile& profile, int cores = 8,
                 Bytes l1 = Bytes(1 << 24), Bytes l2 = Bytes(1 << 24), Bytes external = Bytes(0)) {
  work::Machine cluster({cores, "L1", l1, 1, false});
  work::Machine controller({.cores = 1, .memory = "L2", .capacity = l2, .external = external});
  const auto odometry = make_odometry(false, profile, flight.rig, cluster, controller);
  Flown flown;
  std::int64_t before_ns = flight.frames.front().t_ns;
  for (const ShortFlight::Frame& frame : flight.frames) {
    const auto dt = static_cast<float>(static_cast<double>(frame.t_ns - before_ns) * 1e-9);
    before_ns = frame.t_ns;
    const bool optimises = odometry->begin_optimisation();
    const FrameReport report = odometry->process_frame(
        {frame.pixels.data(), flight.rig.width, flight.rig.height, dt, frame.imu});
    for (int k = 0; optimises && k < profile.optimiser_iterations; ++k) odometry->optimise();
    if (optimises) odometry->publish();
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c)
        T.linear()(r, c) =
            static_cast<double>(report.R_world_camera[static_cast<std::size_t>(3 * r + c)]);
      T.translation()[r] = static_cast<double>(report.p_world_camera[static_cast<std::size_t>(r)]);
    }
    flown.finite = flown.finite && T.matrix().allFinite();
    const Eigen::Matrix3d square = T.linear().transpose() * T.linear();
    flown.skew = std::max(flown.skew, (square - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff());
    flown.trajectory.push_back({frame.t_ns, body_pose(report, flight.T_body_camera)});
    for (const EarlierPose& earlier : report.earlier)
      flown.trajectory[flown.trajectory.size() - 1 - static_cast<std::size_t>(earlier.frames_ago)]
          .T_world_body = body_pose(earlier, flight.T_body_camera);
    flown.sources.push_back(report.source);
    flown.health.push_back(static_cast<Health>(report.health));
    flown.facts.push_back(
        {report.features, report.world_matches, report.frame_matches, report.inliers});
    flown.map_restarts += report.map_restarts;
  }
  flown.passages = cluster.passages();
  flown.l2_passages = controller.passages();
  if (flown.finite) flown.ate = traces::evaluate(flown.trajectory, flight.truth).translation.rmse;
  return flown;
}

}  // namespace leviosim::vio::test
