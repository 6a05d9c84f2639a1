#include "workload/next/fixed_in_view.h"

#include <algorithm>

#include "workload/vio/stages.h"

namespace leviosim::vio {
namespace {

int cells(int side, int cell) { return (side + cell - 1) / cell; }

}  // namespace

template <class P>
FixedInView<P>::FixedInView(const FrontEndState<P>& state, const InertialPart<P>& inertial,
                            work::Arena& memory)
    : state_(state),
      inertial_(inertial),
      columns_(cells(state.rig.width, state.profile.fixed.cell)) {
  const int n = columns_ * cells(state.rig.height, state.profile.fixed.cell);
  evidence_ = Bytes(
      memory.alloc<typename P::template Span<typename P::Byte>>("evidence of fixed parts", n)
          .data(),
      n);
  for (int i = 0; i < n; ++i) evidence_[i] = work::narrow<typename P::Byte>(I32(0));
}

template <class P>
typename P::I32 FixedInView<P>::cell_of(const Frame<P>& frame, I32 feature) const {
  const int size = state_.profile.fixed.cell * state_.profile.extractor.subpixel_steps;
  const I32 x = frame.features.list.x[feature], y = frame.features.list.y[feature];
  return y / I32(size) * I32(columns_) + x / I32(size);
}

/// Whether the match stayed on its pixel, if the rotation would have moved it far enough.
template <class P>
typename FixedInView<P>::Verdict FixedInView<P>::verdict_on(const Frame<P>& frame, int match,
                                                            const Mat3<P>& R) const {
  const FixedPartOptions& limits = state_.profile.fixed;
  const auto& matches = frame.matches;
  const I32 feature = matches.list.query[match], old = matches.list.reference[match];
  const Vec2<P> before = state_.camera.normalised(matches.u(old), matches.v(old));
  const Vec2<P> now = state_.camera.normalised(I32(frame.features.list.x[feature]),
                                               I32(frame.features.list.y[feature]));
  const Vec3<P> turned = R * Vec3<P>{before.x, before.y, 1.0f};
  const F scale = F(1.0f) / turned.z;
  const F tx = turned.x * scale - before.x, ty = turned.y * scale - before.y;
  const float per_px = 1 / state_.rig.camera.fx;
  const float least = limits.turned_px * per_px, most = limits.stayed_px * per_px;
  if (tx * tx + ty * ty < F(least * least)) return Verdict::Nothing;
  const F dx = now.x - before.x, dy = now.y - before.y;
  return dx * dx + dy * dy < F(most * most) ? Verdict::Stayed : Verdict::Moved;
}

template <class P>
void FixedInView<P>::take_evidence(const Frame<P>& frame) {
  using Byte = typename P::Byte;
  const typename P::Function function("take_evidence");
  const FixedPartOptions& limits = state_.profile.fixed;
  const Mat3<P> R = transpose(inertial_.motion_since_keyframe().R);
  I32 moved = 0;
  for (int i : P::range(0, frame.matches.list.count))
    if (verdict_on(frame, i, R) == Verdict::Moved) ++moved;
  if (moved < I32(state_.profile.min_frame_matches)) return;
  for (int i : P::range(0, frame.matches.list.count)) {
    const Verdict verdict = verdict_on(frame, i, R);
    if (verdict == Verdict::Nothing) continue;
    const I32 cell = cell_of(frame, I32(frame.matches.list.query[i]));
    const I32 before = evidence_[cell];
    const I32 now = verdict == Verdict::Stayed ? before + I32(1) : before - I32(1);
    if (now < I32(0) || now > I32(2 * limits.evidence)) continue;
    evidence_[cell] = work::narrow<Byte>(now);
    if (now == I32(limits.evidence) && now > before) ++fixed_;
    if (before == I32(limits.evidence) && now < before) fixed_ -= I32(1);
  }
}

template <class P>
void FixedInView<P>::drop_from(Frame<P>& frame) {
  using U16 = typename P::U16;
  if (!state_.profile.use_imu) return;
  const auto stage = state_.machine.stage(stages::kGuided);
  const typename P::Function function("drop_fixed");
  take_evidence(frame);
  if (fixed_ == I32(0)) return;
  MatchList<P>& matches = frame.matches.list;
  int kept = 0;
  for (int i : P::range(0, matches.count)) {
    const I32 feature = matches.query[i], old = matches.reference[i];
    if (I32(evidence_[cell_of(frame, feature)]) >= I32(state_.profile.fixed.evidence)) {
      const I32 landmark = frame.matches.landmarks[old];
      if (landmark != I32(kNoLandmark)) state_.graph_in_l2.retire_landmark(landmark);
      continue;
    }
    matches.query[kept] = work::narrow<U16>(feature);
    matches.reference[kept] = work::narrow<U16>(old);
    matches.distance[kept] = work::narrow<U16>(I32(matches.distance[i]));
    ++kept;
  }
  matches.count = kept;
}

template class FixedInView<work::Native>;
template class FixedInView<work::Counting>;

}  // namespace leviosim::vio
