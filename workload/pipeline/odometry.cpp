#include "workload/pipeline/odometry.h"

#include "workload/pipeline/back_end.h"
#include "workload/pipeline/front_end.h"
#include "workload/pipeline/stages.h"

namespace leviosim::vio {
namespace {

/// Host capacity of the arenas for what persists in L2; the chip's L2 is checked against their sum.
constexpr Bytes kPersistentCapacity{std::int64_t{1} << 26};

template <class P>
class OdometryOf : public Odometry {
 public:
  OdometryOf(const Profile& profile, const Rig& rig, work::Machine& cluster,
             work::Machine& controller)
      : profile_(profile),
        keyframe_memory_("L2", kPersistentCapacity),
        graph_memory_("L2", kPersistentCapacity),
        graph_(graph_memory_, {profile.optimiser_keyframes, profile.max_landmarks,
                               profile.max_observations}),
        front_end_(profile_, rig, cluster, keyframe_memory_, graph_),
        back_end_(profile_, controller, graph_) {
    graph_.clear(ImuBias<P>::zero(), {0.0f, 0.0f, 0.0f});
    work::take_tally();  // set-up happens before the first frame
  }

  FrameReport process_frame(const FrameInput& input) override { return front_end_.process(input); }
  bool begin_optimisation() override { return back_end_.begin(); }
  OptimiserReport optimise() override { return back_end_.optimise(); }
  void publish() override { back_end_.publish(); }
  const work::Arena& last_keyframe_memory() const override { return keyframe_memory_; }
  const work::Arena& pose_graph_memory() const override { return graph_memory_; }

 private:
  Profile profile_;
  work::Arena keyframe_memory_;
  work::Arena graph_memory_;
  PoseGraph<P> graph_;
  FrontEnd<P> front_end_;
  BackEnd<P> back_end_;
};

}  // namespace

std::vector<StageName> stage_names() {
  return {{stages::kImu, "sample", false},
          {stages::kExtraction, "frame", false},
          {stages::kWorldMatching, "frame", false},
          {stages::kEpnp, "frame", false},
          {stages::kFrameMatching, "frame", false},
          {stages::kEightPoint, "frame", false},
          {stages::kKeyframeSelection, "frame", false},
          {stages::kTriangulation, "keyframe", false},
          {stages::kOptimiserUpdate, "update", true},
          {stages::kOptimiser, "iteration", true}};
}

std::unique_ptr<Odometry> make_odometry(bool counting, const Profile& profile, const Rig& rig,
                                        work::Machine& cluster, work::Machine& controller) {
  if (counting)
    return std::make_unique<OdometryOf<work::Counting>>(profile, rig, cluster, controller);
  return std::make_unique<OdometryOf<work::Native>>(profile, rig, cluster, controller);
}

}  // namespace leviosim::vio
