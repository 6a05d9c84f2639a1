// The front end: one frame, from pixels and IMU samples to a pose, on the cluster (paper Fig. 1,
// right side). Its data persist in L2; L1 is a scratchpad that is empty between frames.
#pragma once

#include <cstdint>
#include <optional>

#include "sim/work/machine.h"
#include "workload/geometry/camera_matrix.h"
#include "workload/graph/pose_graph.h"
#include "workload/vio/keyframe_record.h"
#include "workload/vio/motion_record.h"
#include "workload/vio/odometry.h"

namespace leviosim::vio {

template <class P>
class FrontEnd {
 public:
  using F = typename P::F32;

  /// @param graph  in L2; shared with the back end
  FrontEnd(const Profile& profile, const Rig& rig, work::Machine& cluster,
           work::Arena& keyframe_memory, const PoseGraph<P>& graph);

  FrameReport process(const FrameInput& input);

 private:
  template <class T>
  using Span = typename P::template Span<T>;
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  using Byte = typename P::Byte;

  /// A frame on its way through the pipeline.
  struct Frame {
    ObservedFeatures<P> features;   ///< in L1
    MatchList<P> keyframe_matches;  ///< current feature → feature of the last keyframe
    Span<U16> keyframe_pixels;      ///< u of all keyframe features, then v
    Span<U16> keyframe_landmarks;   ///< of the keyframe features
    Pose<P> T_world_camera;
    Pose<P> T_world_last;  ///< of the frame before; only for guided matching
    float dt = 0;          ///< since then, s
  };

  /// How far a predicted pose is trusted.
  struct LandmarkSearch {
    float radius_px;
    float rotation, position;  ///< standard deviation of each axis, rad and m
  };

  void integrate_imu(const FrameInput& input);
  ImuNoise noise_of(const ImuInput& sample) const;
  void detect_stillness(const Preintegration<P>& interval, float seconds);
  ImuDelta<P> motion_since_keyframe();
  Pose<P> predicted_pose();
  void extract(Frame& frame);
  void start(Frame& frame);
  void start_at_rest(Frame& frame);
  void start_anew(Frame& frame);
  void begin_world(const Frame& frame, Span<F> record, const ImuBias<P>& bias,
                   const Vec3<P>& gravity);
  std::optional<Pose<P>> pose_from_landmarks(Frame& frame, FrameReport& report);
  std::optional<Pose<P>> track(Frame& frame, FrameReport& report);
  std::optional<Pose<P>> search_landmarks(Frame& frame, const Pose<P>& T_predicted,
                                          const LandmarkSearch& search, FrameReport& report);
  Pose<P> last_pose() const;
  bool window_is_full() const;
  bool imu_predicts() const;
  bool agrees_with_gyro(const Mat3<P>& R_camera_keyframe);
  bool map_is_plausible();
  bool is_plausible(const Pose<P>& T_world_camera, float seconds) const;
  Pose<P> settled(const Pose<P>& T_world_camera);
  Pose<P> pose_by_motion(const Frame& frame);
  void remember_motion(const Frame& frame, bool keyframe, bool lost);
  int match_landmarks(Frame& frame, const MatchList<P>& matches);
  void alloc_keyframe_matches(Frame& frame);
  void match_keyframe(Frame& frame);
  std::optional<Pose<P>> pose_from_keyframe(const Frame& frame, FrameReport& report);
  bool is_keyframe(const Frame& frame, const FrameReport& report);
  void insert_keyframe(Frame& frame);
  void register_observations(const Frame& frame, const PoseGraph<P>& graph, I32 slot);
  bool is_in_use(const PoseGraph<P>& graph, I32 landmark) const;
  void triangulate_landmarks(const Frame& frame, const PoseGraph<P>& graph, I32 previous_slot,
                             I32 slot);
  void store_keyframe(const Frame& frame);
  Vec3<P> velocity_at(const Pose<P>& T_world_camera, const PoseGraph<P>& graph,
                      Span<F> interval) const;

  Vec2<P> normalised(I32 u, I32 v) const;
  F pixel(I32 coordinate) const;

  const Profile& profile_;
  Rig rig_;
  CameraMatrix<P> inverse_camera_matrix_;
  Mat3<P> R_camera_body_;
  work::Machine& machine_;
  bool strips_;  ///< the image does not fit in local memory as a whole
  KeyframeRecord<P> keyframe_;
  PoseGraph<P> graph_;                       ///< in L2, as the source and target of transfers
  PoseGraph<P, L2FromCluster> graph_in_l2_;  ///< the same, as a cluster core reaches it
  StillnessDetector<P> stillness_;
  MotionRecord<P> motion_;            ///< only for guided matching
  std::optional<Stillness<P>> rest_;  ///< if the vehicle stands still; only for the joint optimiser
  Vec3<P> recent_force_{0.0f, 0.0f, 0.0f};  ///< mean over a second, likewise
  bool started_ = false;
  bool velocity_known_ = false;  ///< the map began at rest
  std::uint32_t frame_number_ = 0;
  float time_since_keyframe_ = 0;
  bool lost_ = false;     ///< the last pose was predicted; only for guided matching
  bool may_rest_ = true;  ///< the images have not contradicted that the vehicle stands still
};

}  // namespace leviosim::vio
