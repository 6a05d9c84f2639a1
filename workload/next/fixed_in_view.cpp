#include "workload/next/fixed_in_view.h"

#include "workload/vio/stages.h"

namespace leviosim::vio {

template <class P>
FixedInView<P>::FixedInView(const FrontEndState<P>& state, const InertialPart<P>& inertial,
                            work::Arena& memory)
    : state_(state), inertial_(inertial), cells_(state, state.profile.fixed.cell) {
  const int n = cells_.count();
  using Span = typename P::template Span<Byte>;
  evidence_ = Bytes(memory.alloc<Span>("evidence of fixed parts", n).data(), n);
  for (int i : P::range(0, n)) evidence_[i] = work::narrow<Byte>(I32(0));
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
    const I32 cell = cells_.of(frame.features.list, I32(frame.matches.list.query[i]));
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
  if (!state_.profile.use_imu) return;
  const auto stage = state_.machine.stage(stages::kGuided);
  const typename P::Function function("drop_fixed");
  take_evidence(frame);
  if (fixed_ == I32(0)) return;
  drop_foreign(state_, frame, [&](int i) {
    const I32 cell = cells_.of(frame.features.list, I32(frame.matches.list.query[i]));
    return bool(I32(evidence_[cell]) >= I32(state_.profile.fixed.evidence));
  });
}

template class FixedInView<work::Native>;
template class FixedInView<work::Counting>;

}  // namespace leviosim::vio
