#include "workload/vio/odometry/odometry.h"

#include <limits>

#include "workload/levio/levio_front_end.h"
#include "workload/next/loop/loop_closer.h"
#include "workload/next/next_front_end.h"
#include "workload/vio/odometry/back_end.h"
#include "workload/vio/odometry/map_health.h"
#include "workload/vio/stages.h"

namespace leviosim::vio {
namespace {

/// Takes from the controller's memory, which is L2, what the persistent data occupy in it, so that
/// what does not fit is refused.
struct Reservation {
  Reservation(work::Arena& l2, Bytes bytes) {
    l2.alloc<work::Native::Span<std::uint8_t>>(kPersistentBlock, static_cast<int>(bytes.count()));
  }
};

/// Of a length in metres; the largest number of what is larger, or no number.
int in_mm(float length) {
  constexpr float kMost = 2e6f;
  return length < kMost ? static_cast<int>(1e3f * length + 0.5f) : std::numeric_limits<int>::max();
}

/// To hundredths of a pixel, as the release states the camera of its optimiser
/// (PARAMETERS.md#input); the other stages take the calibration as it is. Not by a function of the
/// C library, which the target's program (tools/rv32) does not have.
float in_hundredths(float pixels) {
  return static_cast<float>(static_cast<int>(static_cast<double>(pixels) * 100 + 0.5) / 100.0);
}

}  // namespace

Profile fitted_to(const Rig& rig, Profile profile) {
  ReprojectionOptions& visual = profile.optimiser.visual;
  const PinholeCamera& c = rig.camera;
  visual.lost_px *= static_cast<float>(rig.width) / ReprojectionOptions::kImageWidth;
  visual.camera = {in_hundredths(c.fx), in_hundredths(c.fy), in_hundredths(c.cx),
                   in_hundredths(c.cy)};
  if (!profile.optimiser.joint) return profile;
  // Observations come in units of 1 / subpixel_steps px.
  const auto steps = static_cast<float>(profile.extractor.subpixel_steps);
  visual.camera = {steps * c.fx, steps * c.fy, steps * c.cx, steps * c.cy};
  visual.sigma_px *= steps;
  visual.huber_px *= steps;
  visual.lost_px *= steps;
  return profile;
}

namespace {

/// The one of the two that the profile asks for.
template <class P>
std::unique_ptr<FrontEnd<P>> make_front_end(const Profile& profile, const Rig& rig,
                                            work::Machine& cluster, work::Arena& keyframe_memory,
                                            work::Arena& loop_memory, const PoseGraph<P>& graph,
                                            MapStatus& map) {
  if (profile.guided.enabled)
    return std::make_unique<NextFrontEnd<P>>(profile, rig, cluster, keyframe_memory, loop_memory,
                                             graph, map);
  return std::make_unique<LevioFrontEnd<P>>(profile, rig, cluster, keyframe_memory, graph);
}

template <class P>
class OdometryOf : public Odometry {
 public:
  OdometryOf(const Profile& profile, const Rig& rig, work::Machine& cluster,
             work::Machine& controller)
      : profile_(fitted_to(rig, profile)),
        keyframe_memory_("L2", controller.local().capacity()),
        graph_memory_("L2", controller.local().capacity()),
        loop_memory_("L2", controller.local().capacity()),
        graph_(graph_memory_, keyframe_memory_,
               {profile.optimiser_keyframes, profile.max_landmarks, profile.max_observations}),
        front_end_(
            make_front_end(profile_, rig, cluster, keyframe_memory_, loop_memory_, graph_, map_)),
        reserved_(controller.local(),
                  keyframe_memory_.used() + graph_memory_.used() + loop_memory_.used()),
        back_end_(profile_, rig, controller, graph_, map_) {
    graph_.clear(ImuBias<P>::zero(), {0.0f, 0.0f, 0.0f});
  }

  FrameReport process_frame(const FrameInput& input) override {
    FrameReport report = front_end_->process(input);
    report.health = static_cast<int>(health_.after_frame(report, input.dt));
    report.health_reasons = health_.reasons();
    report.path_mm = in_mm(health_.path());
    report.path_deviation_mm = in_mm(health_.path_deviation());
    return report;
  }
  bool begin_optimisation() override { return back_end_.begin(); }
  OptimiserReport optimise() override { return back_end_.optimise(); }
  void publish() override {
    back_end_.publish();
    health_.take_window();
  }
  const work::Arena& last_keyframe_memory() const override { return keyframe_memory_; }
  const work::Arena& pose_graph_memory() const override { return graph_memory_; }
  const work::Arena& loop_memory() const override { return loop_memory_; }

 private:
  Profile profile_;
  work::Arena keyframe_memory_;
  work::Arena graph_memory_;
  work::Arena loop_memory_;
  PoseGraph<P> graph_;
  MapStatus map_;
  std::unique_ptr<FrontEnd<P>> front_end_;
  Reservation reserved_;
  BackEnd<P> back_end_;
  MapHealth health_{profile_, map_};
};

struct StageRow {
  StageName stage;
  bool (*runs)(const Profile&);
};

bool always(const Profile&) { return true; }
bool in_next(const Profile& p) { return p.guided.enabled; }
bool with_patches(const Profile& p) { return in_next(p) && p.patches.enabled; }
bool with_alignment(const Profile& p) { return in_next(p) && p.alignment.enabled; }
bool with_loops(const Profile& p) { return in_next(p) && p.loop.enabled; }

/// In the order in which a frame passes them; the last ones run on the controller.
constexpr StageRow kStages[] = {{{stages::kImu, "sample", false}, always},
                                {{stages::kExtraction, "frame", false}, always},
                                {{stages::kGuided, "frame", false}, in_next},
                                {{stages::kWorldMatching, "frame", false}, always},
                                {{stages::kEpnp, "frame", false}, always},
                                {{stages::kRefinement, "frame", false}, in_next},
                                {{stages::kFrameMatching, "frame", false}, always},
                                {{stages::kPatches, "frame", false}, with_patches},
                                {{stages::kEightPoint, "frame", false}, always},
                                {{stages::kKeyframeSelection, "frame", false}, always},
                                {{stages::kTriangulation, "keyframe", false}, always},
                                {{stages::kPlaceRecognition, "keyframe", false}, with_loops},
                                {{stages::kLoopVerification, "keyframe", false}, with_loops},
                                {{stages::kLoopCorrection, "frame", false}, with_loops},
                                {{stages::kInitialisation, "iteration", true}, with_alignment},
                                {{stages::kOptimiserUpdate, "update", true}, always},
                                {{stages::kOptimiser, "iteration", true}, always}};

}  // namespace

std::vector<StageName> stage_names(const Profile& profile) {
  std::vector<StageName> names;
  for (const StageRow& row : kStages)
    if (row.runs(profile)) names.push_back(row.stage);
  return names;
}

std::unique_ptr<Odometry> make_odometry(bool counting, const Profile& profile, const Rig& rig,
                                        work::Machine& cluster, work::Machine& controller) {
  if (counting)
    return std::make_unique<OdometryOf<work::Counting>>(profile, rig, cluster, controller);
  return std::make_unique<OdometryOf<work::Native>>(profile, rig, cluster, controller);
}

}  // namespace leviosim::vio
