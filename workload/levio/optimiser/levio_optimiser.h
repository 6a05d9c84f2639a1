// An iteration of the sliding-window optimiser with the released program's work
// (PARAMETERS.md#optimiser): workload/graph/optimiser.h says what it is and what it minimises. In
// addition a kinematic prior ties each velocity to the way between two keyframes. λ is added to the
// diagonals of landmarks and poses, and the step is evaluated even if the system could not be
// solved, in which case the keyframes stay.
#pragma once

#include "workload/graph/optimiser.h"

namespace leviosim::vio::levio {

/// Weight of the kinematic prior, s²/m².
inline constexpr float kKinematicWeight = 10.0f;

/// One iteration; changes `window.state`. Must run in a stage of `machine`, whose local memory it
/// uses for its work memory, freed on return. A window of fewer than two keyframes is left as it
/// is.
template <class P>
IterationReport optimise_once(work::Machine& machine, Window<P>& window, LmState<P>& lm,
                              const OptimiserOptions& options);

}  // namespace leviosim::vio::levio
