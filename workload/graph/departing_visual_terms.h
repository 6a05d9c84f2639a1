// What the landmarks that departing keyframes saw say of the keyframes that stay
// (marginalisation.h).
//
// Such a landmark is eliminated by a QR decomposition of its own derivatives:
// what is orthogonal to them does not depend on the landmark. Where the Schur complement of
// visual_terms.h subtracts, this adds squares, so that in single precision the result stays
// positive semidefinite, however badly the landmark is determined.
#pragma once

#include "workload/graph/landmark_records.h"
#include "workload/graph/reduced_system.h"
#include "workload/graph/reprojection.h"
#include "workload/graph/window.h"

namespace leviosim::vio {

/// Scratch for one landmark that is projected out: all rows of its derivatives.
template <class P>
struct ProjectionScratch {
  using Span = typename P::template Span<typename P::F32>;

  ProjectionScratch(work::Arena& arena, int keyframes)
      : rows(arena.alloc<Span>("projection rows", 2 * keyframes * (6 * keyframes + 4))) {}

  Span rows;
};

/// Whether landmark i of the window is marginalised with the `departed` oldest keyframes: one of
/// them saw it, and the newest keyframe does not, unless `tracked`.
template <class P>
bool departs(const Window<P>& window, int i, int departed, bool tracked);

/// Voids the observations of the landmarks that have been marginalised: the prior holds what they
/// said, and the window would count them again.
template <class P>
void forget_departed(const Window<P>& window, int departed, bool tracked,
                     const PoseGraph<P>& graph);

/// Adds, without damping and at `window.state`, the landmarks that the `departed` oldest keyframes
/// saw; of those that the newest keyframe sees as well only if `tracked`.
template <class P>
void add_departing_visual_terms(work::Machine& machine, const Window<P>& window,
                                const PixelModel<P>& model, int departed, bool tracked,
                                const LandmarkRecords<P>& records,
                                const ProjectionScratch<P>& scratch,
                                const ReducedSystem<P>& system);

}  // namespace leviosim::vio
