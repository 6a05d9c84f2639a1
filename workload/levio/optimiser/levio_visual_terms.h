// The visual part of the optimiser with the released program's work (PARAMETERS.md#optimiser): the
// record of every landmark slot is cleared byte by byte, each observation is projected once for its
// error and once for its derivatives, and every pair of observations of a landmark computes the
// products of both anew for each row of its 6×6 block, on both sides of the diagonal.
//
// What is minimised, and which landmarks take no part, is as in workload/graph/visual_terms.h;
// λ is added to the diagonal of a landmark's block.
#pragma once

#include "workload/graph/visual_terms.h"

namespace leviosim::vio::levio {

/// Linearises landmark after landmark at `window.state` and adds each to `system`.
/// @param machine  behind whose local memory records may lie
/// @param cleared  as many bytes as a record has
/// @return how much of the window took part; the cost is added to `cost`
template <class P>
VisualUse add_visual_terms(work::Machine& machine, const Window<P>& window,
                           const PixelModel<P>& model, typename P::F32 lambda,
                           const LandmarkRecords<P>& records,
                           typename P::template Span<typename P::Byte> cleared,
                           const ReducedSystem<P>& system, typename P::F32& cost);

/// Resets the points of `trial` that the step moved out of view, if their cost is lower unmoved.
/// @return the cost of all observations at `trial` then
template <class P>
typename P::F32 settle_points(const Window<P>& window, const WindowState<P>& trial,
                              const PixelModel<P>& model);

}  // namespace leviosim::vio::levio
