// Pose graph of four degrees of freedom: x, y, z and the yaw that corrects, for every place
// (yaw_transform.h). Odometry binds each place to the one before it, closures bind places that were
// recognised; the first place is held.
//
// An edge from i to j says r = p_j − p_i − Rz(ψ_i) z = 0 and ψ_j − ψ_i − ζ = 0, where z and ζ are
// what was measured; ζ is 0 for odometry. Its standard deviation grows with the root of the path.
//
// A step is one of Gauss–Newton, solved by conjugate gradients. The normal matrix is never formed:
// it is applied edge by edge. The preconditioner is the chain of odometry edges, which is solved
// exactly by one pass back and one forth, since their Jacobian is bidiagonal; with m closures the
// rest has rank 4 m, so 4 m iterations would solve it, and fewer do.
#pragma once

#include "workload/next/loop/place_store.h"

namespace leviosim::vio {

/// Moves the nodes by one Gauss–Newton step; works serially, inside a stage.
/// Local memory: 24 floats per place and 12 per closure.
/// @param places  in local memory
/// @return the largest move of a place [m]
template <class P>
typename P::F32 improve_nodes(work::Arena& local, PlaceList<P>& places,
                              const LoopGraphOptions& options);

/// Adds a closure. If all are taken, the one goes that follows most closely on the one before it.
template <class P>
void add_closure(PlaceList<P>& places, const Closure<P>& closure);

}  // namespace leviosim::vio
