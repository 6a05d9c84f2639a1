#include "workload/next/own_motion.h"

#include <utility>

#include "sim/work/either.h"
#include "workload/vio/parallax.h"
#include "workload/vio/stages.h"

namespace leviosim::vio {
/// How far the matches moved, the rotation undone; x and y of each, normalised.
template <class P>
struct OwnMotion<P>::Flow {
  using Floats = typename P::template EitherSpan<F>;

  /// The square of the distance of match i from where a translation along `t` may lead.
  F distance_sq(int i, const Vec3<P>& t) const {
    const F x = from[2 * i], y = from[2 * i + 1], u = moved[2 * i], v = moved[2 * i + 1];
    const F along_x = x * t.z - t.x, along_y = y * t.z - t.y;
    const F across = u * along_y - v * along_x;
    const F length_sq = along_x * along_x + along_y * along_y;
    if (u * along_x + v * along_y < F(0.0f) || !(length_sq > F(0.0f))) return u * u + v * v;
    return across * across / length_sq;
  }

  /// What a translation that explains match i is normal to.
  Vec3<P> normal(int i) const {
    const F x = from[2 * i], y = from[2 * i + 1], u = moved[2 * i], v = moved[2 * i + 1];
    return {F(0.0f) - v, u, x * v - y * u};
  }

  Floats from, moved;
  int n = 0;
};

template <class P>
OwnMotion<P>::OwnMotion(const FrontEndState<P>& state, const InertialPart<P>& inertial,
                        work::Arena& memory)
    : state_(state), inertial_(inertial), cells_(state, state.profile.own_motion.cell) {
  const int n = state.keyframe.features.list.capacity;
  known_ = Bytes(memory.alloc<Flags>("features that move by themselves", n).data(), n);
  next_ = Bytes(memory.alloc<Flags>("the same of the frame", n).data(), n);
  for (int i : P::range(0, n)) known_[i] = work::narrow<Byte>(I32(0));
}

template <class P>
typename OwnMotion<P>::Flow OwnMotion<P>::flow_of(const Frame<P>& frame) const {
  const int n = frame.matches.list.count;
  const Flow flow{work::alloc_either<P, F>(state_.machine, "matches before", 2 * n),
                  work::alloc_either<P, F>(state_.machine, "motion of matches", 2 * n), n};
  const Mat3<P> R = transpose(inertial_.motion_since_keyframe().R);
  state_.machine.fork("motion of matches", [&](work::Core& core) {
    const auto [begin, end] = core.share(n);
    for (int i : P::range(begin, end)) {
      const auto [seen, moved] = parallax_of(state_, frame, i, R);
      flow.from[2 * i] = seen.x - moved.x;
      flow.from[2 * i + 1] = seen.y - moved.y;
      flow.moved[2 * i] = moved.x;
      flow.moved[2 * i + 1] = moved.y;
    }
  });
  return flow;
}

/// Pairs are spread over the list, whose order is that of the picture: each has a match of the
/// upper half and one of the lower.
template <class P>
Vec3<P> OwnMotion<P>::most_agreed(const Flow& flow) const {
  work::Machine& machine = state_.machine;
  const OwnMotionOptions& options = state_.profile.own_motion;
  const int pairs = options.pairs, half = flow.n / 2;
  const work::Arena::Frame memory(machine.local());
  const auto agree =
      machine.local().alloc<typename P::template Span<I32>>("agreeing matches", 2 * pairs);
  const auto translation = [&](int pair) {
    const int a = pair * half / pairs;
    const int b = half + pair * options.stride % pairs * (flow.n - half) / pairs;
    return cross(flow.normal(a), flow.normal(b));
  };
  const float limit = options.agrees_px / state_.rig.camera.fx;
  machine.fork("translations", [&](work::Core& core) {
    const auto [begin, end] = core.share(pairs);
    for (int pair : P::range(begin, end)) {
      const Vec3<P> t = translation(pair), back = t * F(-1.0f);
      I32 forth = 0, away = 0;
      for (int i : P::range(0, flow.n)) {
        if (flow.distance_sq(i, t) < F(limit * limit)) ++forth;
        if (flow.distance_sq(i, back) < F(limit * limit)) ++away;
      }
      agree[2 * pair] = forth;
      agree[2 * pair + 1] = away;
    }
  });
  int best = 0;
  for (int i : P::range(1, 2 * pairs))
    if (I32(agree[i]) > I32(agree[best])) best = i;
  return translation(best / 2) * F(best % 2 == 0 ? 1.0f : -1.0f);
}

/// Marks the matches that move by themselves, and remembers the features of the frame that do.
template <class P>
void OwnMotion<P>::judge(const Flow& flow, const Frame<P>& frame, Marks moves) {
  work::Arena& local = state_.machine.local();
  const work::Arena::Frame memory(local);
  const OwnMotionOptions& options = state_.profile.own_motion;
  const MatchList<P>& matches = frame.matches.list;
  const auto zero = work::narrow<Byte>(I32(0));
  const auto most =
      local.alloc<typename P::template Span<I32>>("moving less still", cells_.count());
  const auto longest = local.alloc<Flags>("for how many keyframes", cells_.count());
  for (int c : P::range(0, cells_.count())) {
    most[c] = I32(0);
    longest[c] = zero;
  }
  const auto cell_of = [&](I32 feature) { return cells_.of(frame.features.list, feature); };
  const float limit = options.disagrees_px / state_.rig.camera.fx;
  const Vec3<P> t = most_agreed(flow);
  for (int i : P::range(0, flow.n)) {
    const I32 known = known_[I32(matches.reference[i])];
    const bool away = bool(!(flow.distance_sq(i, t) < F(limit * limit)));
    const I32 cell = cell_of(I32(matches.query[i]));
    const bool moving = away || bool(known > I32(0));
    most[cell] = I32(most[cell]) + I32(moving ? 1 : -1);
    const I32 left = away ? I32(options.keyframes) : known - I32(1);
    if (moving && left > I32(longest[cell])) longest[cell] = work::narrow<Byte>(left);
    moves[i] = work::narrow<Byte>(I32(moving ? 1 : 0));
  }
  for (int i : P::range(0, frame.features.list.count)) {
    const I32 cell = cell_of(I32(i));
    const bool moving = bool(I32(most[cell]) > I32(0));
    next_[i] = moving ? work::narrow<Byte>(I32(longest[cell])) : zero;
  }
  for (int i : P::range(0, flow.n))
    if (I32(most[cell_of(I32(matches.query[i]))]) > I32(0)) moves[i] = work::narrow<Byte>(I32(1));
}

template <class P>
void OwnMotion<P>::drop_from(Frame<P>& frame) {
  const int n = frame.matches.list.count;
  if (!state_.profile.use_imu || n < state_.profile.min_frame_matches) return;
  const work::EitherFrame memory(state_.machine);
  const auto stage = state_.machine.stage(stages::kGuided);
  const typename P::Function function("drop_own_motion");
  const auto moves =
      work::alloc_either<P, Byte>(state_.machine, "matches that move by themselves", n);
  judge(flow_of(frame), frame, moves);
  judged_ = true;
  drop_foreign(state_, frame, [&](int i) { return bool(I32(moves[i]) != I32(0)); });
}

template <class P>
void OwnMotion<P>::end_frame(bool keyframe) {
  const bool judged = std::exchange(judged_, false);
  if (!keyframe) return;
  if (judged) return std::swap(known_, next_);
  const auto stage = state_.machine.stage(stages::kGuided);
  for (int i : P::range(0, known_.size())) known_[i] = work::narrow<Byte>(I32(0));
}

template class OwnMotion<work::Native>;
template class OwnMotion<work::Counting>;

}  // namespace leviosim::vio
