// The graph as a keyframe that comes changes it: a copy in local memory that goes back as a whole,
// if all of it has room there. Else only the short blocks are copied: points, descriptors and
// intervals are reached in L2, where a keyframe touches few of them, and the list of observations
// passes in tiles when a keyframe leaves.
#pragma once

#include "sim/work/tiles.h"
#include "workload/vio/front_end_state.h"

namespace leviosim::vio {

/// Takes the observations of a keyframe off the list in L2: tiles of it come in, and what is left
/// goes back to the front of the list.
template <class P>
void remove_observations_in_tiles(work::Machine& machine, const PoseGraph<P, LongBlocksInL2>& graph,
                                  const PoseGraph<P>& in_l2, typename P::I32 keyframe) {
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  using Byte = typename P::Byte;
  using Numbers = typename P::template Span<U16>;
  using Bytes8 = typename P::template Span<Byte>;
  using Columns = typename PoseGraph<P, LongBlocksInL2>::template Observations<Numbers, Bytes8>;
  constexpr int kObservation = 3 * sizeof(U16) + 2 * sizeof(Byte);
  const typename P::Function function("PoseGraph::remove_observations");
  work::Arena& local = machine.local();
  const work::Arena::Frame memory(local);
  const work::TilePlan plan = work::plan_tiles(
      local, "observed landmarks", work::value(graph.observation_count()), Bytes(2 * kObservation));
  work::TilesOut<P, U16> landmarks(machine, "kept landmarks", plan.most_items()),
      u(machine, "kept u", plan.most_items()), v(machine, "kept v", plan.most_items());
  work::TilesOut<P, Byte> keyframes(machine, "kept keyframes", plan.most_items()),
      generations(machine, "kept generations", plan.most_items());
  int total = 0;
  work::for_each_tile<P>(
      machine, plan,
      [&](int, const work::Tile& tile, Numbers seen, Numbers seen_u, Numbers seen_v, Bytes8 by,
          Bytes8 meant) {
        const Columns to{landmarks.next(machine), u.next(machine), v.next(machine),
                         keyframes.next(machine), generations.next(machine)};
        const int kept = work::value(graph.keep_observations(
            keyframe, tile.size(), Columns{seen, seen_u, seen_v, by, meant}, to));
        if (kept == 0) return;
        landmarks.send(machine, in_l2.observation_landmarks.subspan(total, kept));
        u.send(machine, in_l2.observation_u.subspan(total, kept));
        v.send(machine, in_l2.observation_v.subspan(total, kept));
        keyframes.send(machine, in_l2.observation_keyframes.subspan(total, kept));
        generations.send(machine, in_l2.observation_generations.subspan(total, kept));
        total += kept;
      },
      work::PassingBlock<P, U16>{"observed landmarks", in_l2.observation_landmarks},
      work::PassingBlock<P, U16>{"observed u", in_l2.observation_u},
      work::PassingBlock<P, U16>{"observed v", in_l2.observation_v},
      work::PassingBlock<P, Byte>{"observing keyframes", in_l2.observation_keyframes},
      work::PassingBlock<P, Byte>{"observed generations", in_l2.observation_generations});
  landmarks.finish(machine);
  u.finish(machine);
  v.finish(machine);
  keyframes.finish(machine);
  generations.finish(machine);
  graph.set_observation_count(I32(total));
}

/// Calls use(graph, interval, remove_observations) with the graph and the motion since the last
/// keyframe, which goes on from zero afterwards. Works inside a stage.
/// @param scratch  that `use` takes besides
template <class P, class Use>
void with_graph_at_hand(const FrontEndState<P>& state, Bytes scratch, Use&& use) {
  using I32 = typename P::I32;
  using Floats = typename P::template Span<typename P::F32>;
  work::Machine& machine = state.machine;
  work::Arena& local = machine.local();
  const auto change = [&](const auto& graph, Floats interval, const auto& remove) {
    machine.copy_in(interval, state.keyframe.interval);
    use(graph, interval, remove);
    Preintegration<P>(interval).reset(graph.bias());
    machine.copy_out(state.keyframe.interval, interval);
  };
  const auto alloc_interval = [&] {
    return local.alloc<Floats>("IMU interval", Preintegration<P>::kFloats);
  };
  const Bytes interval_size(4LL * Preintegration<P>::kFloats);
  if (graph_size<P>(state.graph.capacity) + interval_size + scratch <= local.free()) {
    const PoseGraph<P> graph(local, state.graph.capacity);
    const Floats interval = alloc_interval();
    copy_graph_in<P>(machine, graph, state.graph);
    change(graph, interval, [&](I32 keyframe) { graph.remove_observations(keyframe); });
    copy_graph_out<P>(machine, state.graph, graph);
    return;
  }
  const PoseGraph<P, LongBlocksInL2> graph(alloc_short_blocks<P>(local, state.graph));
  const Floats interval = alloc_interval();
  copy_short_blocks_in<P>(machine, graph, state.graph);
  change(graph, interval, [&](I32 keyframe) {
    remove_observations_in_tiles<P>(machine, graph, state.graph, keyframe);
  });
  copy_short_blocks_out<P>(machine, state.graph, graph);
}

}  // namespace leviosim::vio
