#include "workload/vio/next/feature_alignment.h"

#include <algorithm>

#include "workload/vio/stages.h"
#include "workload/vision/patch_alignment.h"

namespace leviosim::vio {
namespace {

template <class P>
using Numbers = typename P::template Span<typename P::U16>;
template <class P>
using Flags = typename P::template Span<typename P::Byte>;

/// A copy of an image in local memory.
template <class P>
ImageView<P> copy_image(work::Machine& machine, std::string_view name, const ImageView<P>& from) {
  const ImageView<P> to{machine.local().alloc<Flags<P>>(name, from.width * from.height), from.width,
                        from.height};
  machine.copy_in(to.pixels, from.pixels);
  return to;
}

/// Places in the present image where features of the keyframe should be.
template <class P>
struct Predictions {
  Predictions(work::Arena& arena, int capacity)
      : x(arena.alloc<Numbers<P>>("predicted features", 2 * capacity)),
        y(x.subspan(capacity, capacity)),
        pairs(alloc_matches<P>(arena, capacity, "predicted matches")) {}

  Numbers<P> x, y;
  MatchList<P> pairs;  ///< place → feature of the keyframe
};

/// Marks the features of the keyframe that have a match.
template <class P>
void mark_matched(const MatchList<P>& matches, int features, Flags<P> matched) {
  using I32 = typename P::I32;
  using Byte = typename P::Byte;
  for (int i : P::range(0, features)) matched[i] = work::narrow<Byte>(I32(0));
  for (int i : P::range(0, matches.count))
    matched[I32(matches.reference[i])] = work::narrow<Byte>(I32(1));
}

/// Where the keyframe's landmarks that have no match should be.
template <class P>
void predict_landmarks(const FrontEndState<P>& state, const Frame<P>& frame,
                       const Pose<P>& T_camera_world, Flags<P> matched, Predictions<P>& to) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  const typename P::Function function("predict_landmarks");
  const PinholeCamera& c = state.rig.camera;
  const F steps = static_cast<float>(state.profile.extractor.subpixel_steps);
  const F border = static_cast<float>(state.profile.extractor.border);
  const F right = static_cast<float>(state.rig.width) - border;
  const F bottom = static_cast<float>(state.rig.height) - border;
  const int room =
      std::min(to.pairs.capacity, frame.features.list.capacity - frame.features.list.count);
  int n = 0;
  for (int i : P::range(0, state.keyframe.features.list.count)) {
    if (n == room) break;
    const I32 landmark = frame.matches.landmarks[i];
    if (landmark == I32(kNoLandmark) || I32(matched[i]) != I32(0)) continue;
    if (I32(state.graph_in_l2.ages[landmark]) > I32(state.profile.max_landmark_age)) continue;
    const Vec3<P> x = T_camera_world * state.graph_in_l2.point(landmark);
    if (!(x.z > F(state.profile.optimiser.visual.min_depth))) continue;
    const F inverse = F(1.0f) / x.z;
    const F u = F(c.fx) * (x.x * inverse) + F(c.cx), v = F(c.fy) * (x.y * inverse) + F(c.cy);
    if (!(u > border) || !(v > border) || !(u < right) || !(v < bottom)) continue;
    to.x[n] = work::narrow<U16>(work::to_i32(F(u * steps)));
    to.y[n] = work::narrow<U16>(work::to_i32(F(v * steps)));
    to.pairs.query[n] = work::narrow<U16>(I32(n));
    to.pairs.reference[n] = work::narrow<U16>(I32(i));
    ++n;
  }
  to.pairs.count = n;
}

/// Takes the matches off the list whose patches disagree: corners that slid along an edge, or were
/// taken for others. What is left keeps its order.
template <class P>
void drop_disagreeing(Flags<P> verdicts, MatchList<P>& matches) {
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  const typename P::Function function("drop_disagreeing");
  int kept = 0;
  for (int i : P::range(0, matches.count)) {
    if (I32(verdicts[i]) == I32(static_cast<int>(PatchVerdict::Disagrees))) continue;
    matches.query[kept] = work::narrow<U16>(I32(matches.query[i]));
    matches.reference[kept] = work::narrow<U16>(I32(matches.reference[i]));
    matches.distance[kept] = work::narrow<U16>(I32(matches.distance[i]));
    ++kept;
  }
  matches.count = kept;
}

/// Those that were found become features and matches.
template <class P>
void adopt_found(const FrontEndState<P>& state, const Predictions<P>& predictions, Flags<P> found,
                 Frame<P>& frame) {
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  const typename P::Function function("adopt_found");
  FeatureList<P>& features = frame.features.list;
  MatchList<P>& matches = frame.matches.list;
  for (int i : P::range(0, predictions.pairs.count)) {
    if (I32(found[i]) != I32(static_cast<int>(PatchVerdict::Agrees)) ||
        matches.count == matches.capacity)
      continue;
    const int at = features.count++;
    const I32 old = predictions.pairs.reference[i];
    features.x[at] = work::narrow<U16>(I32(predictions.x[i]));
    features.y[at] = work::narrow<U16>(I32(predictions.y[i]));
    frame.features.landmarks[at] = work::narrow<U16>(I32(kNoLandmark));
    state.machine.copy_in(features.descriptors.subspan(kDescriptorWords * at, kDescriptorWords),
                          state.keyframe.features.list.descriptors.subspan(
                              kDescriptorWords * work::value(old), kDescriptorWords));
    const int match = matches.count++;
    matches.query[match] = work::narrow<U16>(I32(at));
    matches.reference[match] = work::narrow<U16>(old);
    matches.distance[match] = work::narrow<U16>(I32(0));
  }
}

}  // namespace

template <class P>
void align_features(const FrontEndState<P>& state, Frame<P>& frame,
                    const std::optional<Pose<P>>& T_predicted) {
  const PatchAlignmentOptions& options = state.profile.patches;
  if (state.keyframe.seen.width == 0) return;
  work::Machine& machine = state.machine;
  work::Arena& local = machine.local();
  const auto stage = machine.stage(stages::kPatches);
  const work::Arena::Frame memory(local);
  const int steps = state.profile.extractor.subpixel_steps;
  const KeyframeMatches<P>& matches = frame.matches;
  const int n = matches.first_v;
  const PatchView<P> before{copy_image<P>(machine, "image of the keyframe", state.keyframe.seen),
                            matches.pixels.subspan(0, n), matches.pixels.subspan(n, n)};
  const ImageView<P> image = copy_image<P>(machine, "image", state.keyframe.image);
  const auto aligned = local.alloc<Flags<P>>("aligned", n);
  align_patches<P>(machine, before, {image, frame.features.list.x, frame.features.list.y}, steps,
                   options.max_shift, options, matches.list, aligned);
  if (options.required) drop_disagreeing<P>(aligned, frame.matches.list);
  if (!T_predicted || !(options.reach > 0)) return;
  const auto matched = local.alloc<Flags<P>>("matched", n);
  mark_matched<P>(matches.list, state.keyframe.features.list.count, matched);
  Predictions<P> predictions(local, n);
  predict_landmarks<P>(state, frame, inverse(*T_predicted), matched, predictions);
  align_patches<P>(machine, before, {image, predictions.x, predictions.y}, steps, options.reach,
                   options, predictions.pairs, aligned);
  adopt_found<P>(state, predictions, aligned, frame);
}

template void align_features(const FrontEndState<work::Native>&, Frame<work::Native>&,
                             const std::optional<Pose<work::Native>>&);
template void align_features(const FrontEndState<work::Counting>&, Frame<work::Counting>&,
                             const std::optional<Pose<work::Counting>>&);

}  // namespace leviosim::vio
