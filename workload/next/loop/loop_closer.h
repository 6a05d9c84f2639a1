// Loop closure beside an odometry that it does not change: some views are kept as places, later
// views are recognised there, and the drift between the two poses corrects the estimate.
//
// A view does all of its recognition in its own frame; the frames after one that closed a loop take
// a step of the pose graph each. A closure needs several views that are recognised, by places
// within the estimate's drift, with gravity where it has to be, and that agree on the correction,
// while few of those in between contradict. A view that is recognised at two places that contradict
// each other contradicts all others.
//
// The correction is a transform of the odometry's world, T_world_odometry, of four degrees of
// freedom. It is applied over a while, so that poses do not jump.
#pragma once

#include <array>
#include <optional>

#include "workload/levio/geometry/sampling.h"
#include "workload/next/loop/loop_graph.h"
#include "workload/next/loop/place_search.h"
#include "workload/next/loop/verification.h"

namespace leviosim::vio {

namespace stages {
inline constexpr std::string_view kPlaceRecognition = "place recognition";
inline constexpr std::string_view kLoopVerification = "loop verification";
inline constexpr std::string_view kLoopCorrection = "loop correction";
}  // namespace stages

/// A view as place recognition sees it, in local memory. The world of its pose has its z axis
/// up.
template <class P>
struct LoopView {
  FeatureList<P> features;
  typename P::template Span<typename P::U16> tracked;  ///< features whose point is known
  typename P::template Span<typename P::F32> points;   ///< theirs, 3 each, in the camera frame;
                                                       ///< coordinates within kFarthestPoint
  int tracked_count = 0;
  Pose<P> T_odometry_camera;
};

/// The result of a view.
struct LoopOutcome {
  int places = 0;    ///< places that are kept
  int removed = 0;   ///< 1 if a place was removed for this one
  int closures = 0;  ///< 1 if a loop was closed
};

template <class P>
class LoopCloser {
 public:
  using F = typename P::F32;
  using I32 = typename P::I32;

  /// @param machine  where it runs; its memory is L1
  /// @param memory   in L2; all of it is taken here
  LoopCloser(const LoopOptions& options, const LoopCamera& camera, work::Machine& machine,
             work::Arena& memory);

  /// Whether the camera has moved far enough for another view.
  bool is_due(const Pose<P>& T_odometry_camera) const;
  LoopOutcome visit(const LoopView<P>& view);
  /// Whether a step of the pose graph is due.
  bool has_to_improve() const { return steps_left_ > 0; }
  void improve();
  /// The odometry began another map: the path since then is uncertain.
  void expect_another_map();

  /// Whether a loop was ever closed; until then there is no correction.
  bool has_closed() const { return closed_; }
  /// T_world_camera, dt [s] after the last call.
  Pose<P> corrected(const Pose<P>& T_odometry_camera, float dt);

 private:
  using Words = typename P::template Span<typename P::U32>;
  using Numbers = typename P::template Span<typename P::U16>;

  /// Views that are remembered to confirm what later ones say.
  static constexpr int kRecent = 8;

  /// The correction that a recognised place suggests.
  struct Hypothesis {
    YawTransform<P> T_world_odometry;
    Closure<P> closure;
    F place_travelled;  ///< path at the place [m]
    F travelled;        ///< path at the view [m]
    bool ambiguous;     ///< another place suggests another correction
  };

  void follow_path(const Pose<P>& T_odometry_camera);
  PlaceQuery<P> query_of(const LoopView<P>& view, Words signature) const;
  bool is_new_place(const PlaceList<P>& places, const LoopView<P>& view) const;
  bool remember(PlaceList<P>& places, const LoopView<P>& view, Numbers chosen, Words signature);
  std::optional<Hypothesis> recognise_at(const PlaceList<P>& places, int place,
                                         const LoopView<P>& view, const PlaceQuery<P>& query);
  std::optional<Hypothesis> only_hypothesis(const PlaceList<P>& places, const LoopView<P>& view,
                                            const PlaceQuery<P>& query,
                                            const PlaceCandidates& candidates);
  bool confirms(const Hypothesis& hypothesis, const Vec3<P>& position);
  bool agree(const Hypothesis& a, const Hypothesis& b, const Vec3<P>& position) const;

  const LoopOptions options_;
  const LoopCamera camera_;
  work::Machine& machine_;
  PlaceList<P> places_;
  PlaceFeatures<P> features_;
  F travelled_ = 0.0f;                ///< path so far [m]
  F confirmed_at_ = 0.0f;             ///< path at the last confirmed recognition [m] …
  F confirmed_place_ = 0.0f;          ///< … and at the place recognised there [m]
  std::optional<Pose<P>> last_view_;  ///< T_odometry_camera
  // Of the views that were recognised last.
  std::array<Hypothesis, kRecent> recent_{};
  int recent_count_ = 0;  ///< ever; the newest is at (recent_count_ − 1) mod kRecent
  levio::ShiftRegister<P> random_{0x2545f491u};  ///< of RANSAC
  int steps_left_ = 0;                           ///< steps of the pose graph that are due
  bool closed_ = false;                          ///< a loop was closed
  float time_left_ = 0;  ///< time until the correction is applied in full [s]
  YawTransform<P> T_world_odometry_ = YawTransform<P>::identity();  ///< correction by the graph
  YawTransform<P> applied_ = YawTransform<P>::identity();           ///< part of it that is applied
};

}  // namespace leviosim::vio
