// The blocks of memory that the pose graph consists of (pose_graph.h tells what they mean).
#pragma once

#include <array>
#include <string_view>
#include <tuple>

#include "sim/base/check.h"
#include "sim/work/machine.h"
#include "workload/inertial/preintegration.h"

namespace leviosim::vio {

struct GraphCapacity {
  int keyframes = 8;        ///< at most 255
  int landmarks = 1000;     ///< at most 65536
  int observations = 2400;  ///< at most 65535
};

inline constexpr int kGraphDescriptorWords = 8;
inline constexpr int kLog2DescriptorWords = 3;
inline constexpr int kGraphHeaderWords = 7;

/// Ages count keyframes since a landmark was seen last.
inline constexpr int kOldestAge = 254;  ///< and older
inline constexpr int kUnusedAge = 255;  ///< of a slot that never held a landmark

/// Memory that the core at work reaches as its own.
struct LocalMemory {
  template <class P, class T>
  using Span = typename P::template Span<T>;
  template <class P, class T>
  using LongSpan = Span<P, T>;
};
/// L2 as a cluster core reaches it.
struct L2FromCluster {
  template <class P, class T>
  using Span = typename P::template L2Span<T>;
  template <class P, class T>
  using LongSpan = Span<P, T>;
};
/// Local memory that has no room for the long blocks: a cluster core reaches those in L2.
struct LongBlocksInL2 {
  template <class P, class T>
  using Span = typename P::template Span<T>;
  template <class P, class T>
  using LongSpan = typename P::template L2Span<T>;
};

/// Name and size of a block: `each` elements for every one of what `of` counts, or `each` in all.
struct GraphBlock {
  std::string_view name;
  int each;
  int GraphCapacity::*of;
  bool is_long;  ///< and hardly touched by a keyframe that comes, but for the observations
  bool inertial = false;

  int elements(const GraphCapacity& capacity) const {
    return of == nullptr ? each : each * (capacity.*of);
  }
};

/// In the order of GraphMemory::blocks(): words, then half-words, then bytes, so that nothing
/// straddles in a packed memory.
inline constexpr std::array kGraphBlocks = {
    GraphBlock{"landmark points", 3, &GraphCapacity::landmarks, true},
    GraphBlock{"landmark descriptors", kGraphDescriptorWords, &GraphCapacity::landmarks, true},
    GraphBlock{"keyframe poses", kPoseFloats, &GraphCapacity::keyframes, false},
    GraphBlock{"keyframe velocities", 3, &GraphCapacity::keyframes, false},
    GraphBlock{"IMU intervals", Preintegration<work::Native>::kFloats, &GraphCapacity::keyframes,
               true, true},
    GraphBlock{"keyframe numbers", 1, &GraphCapacity::keyframes, false},
    GraphBlock{"biases and gravity", 17, nullptr, false},
    GraphBlock{"graph header", kGraphHeaderWords, nullptr, false},
    GraphBlock{"observed landmarks", 1, &GraphCapacity::observations, true},
    GraphBlock{"observed u", 1, &GraphCapacity::observations, true},
    GraphBlock{"observed v", 1, &GraphCapacity::observations, true},
    GraphBlock{"observing keyframes", 1, &GraphCapacity::observations, true},
    GraphBlock{"observed generations", 1, &GraphCapacity::observations, true},
    GraphBlock{"landmark ages", 1, &GraphCapacity::landmarks, false},
    GraphBlock{"landmark generations", 1, &GraphCapacity::landmarks, false},
};

template <class P, class Where>
struct GraphMemory {
  template <class T>
  using Span = typename Where::template Span<P, T>;
  template <class T>
  using LongSpan = typename Where::template LongSpan<P, T>;
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  using Byte = typename P::Byte;

  GraphMemory() = default;
  /// Views of new, uninitialised memory in `arena`.
  GraphMemory(work::Arena& arena, const GraphCapacity& size) : GraphMemory(arena, arena, size) {}
  /// Memory of a graph with the intervals in `inertial`, beside the one that is under way. The
  /// paper's graph of 64.2 kB has no room for them: to the byte it is 1000 landmarks of 45 bytes
  /// and 2400 observations of 8.
  GraphMemory(work::Arena& arena, work::Arena& inertial, const GraphCapacity& size)
      : capacity(size) {
    check(size.keyframes <= 255 && size.landmarks <= 65536 && size.observations <= 65535,
          "a pose graph indexes its contents with 8 and 16 bits");
    const GraphBlock* block = kGraphBlocks.data();
    const auto allocate = [&](auto& span) {
      work::Arena& where = block->inertial ? inertial : arena;
      span =
          where.alloc<std::remove_reference_t<decltype(span)>>(block->name, block->elements(size));
      ++block;
    };
    std::apply([&](auto&... spans) { (allocate(spans), ...); }, blocks());
  }

  /// All blocks, in the order of kGraphBlocks.
  auto blocks() {
    return std::tie(points, descriptors, keyframe_poses, keyframe_velocities, keyframe_intervals,
                    keyframe_ids, environment, header, observation_landmarks, observation_u,
                    observation_v, observation_keyframes, observation_generations, ages,
                    generations);
  }

  /// Floats of the interval before keyframe `slot`.
  LongSpan<F> interval_record(I32 slot) const {
    const I32 at = slot * I32(Preintegration<P>::kFloats);
    return keyframe_intervals.subspan(at, Preintegration<P>::kFloats);
  }

  GraphCapacity capacity;
  LongSpan<F> points;                          ///< x, y, z per landmark, world frame, m
  LongSpan<typename P::U32> descriptors;       ///< 8 words per landmark
  Span<F> keyframe_poses;                      ///< T_world_camera, kPoseFloats each
  Span<F> keyframe_velocities;                 ///< world frame, m/s
  LongSpan<F> keyframe_intervals;              ///< motion since the keyframe before
  Span<I32> keyframe_ids;                      ///< serial number; -1 for an empty slot
  Span<F> environment;                         ///< biases, gravity, prior of the biases
  Span<I32> header;                            ///< counters, see PoseGraph
  LongSpan<U16> observation_landmarks;         ///< slot
  LongSpan<U16> observation_u, observation_v;  ///< pixel, in the unit of the camera's intrinsics
  LongSpan<Byte> observation_keyframes;        ///< slot
  LongSpan<Byte> observation_generations;      ///< of the landmark that was meant
  Span<Byte> ages;                             ///< keyframes since last seen, or kUnusedAge
  Span<Byte> generations;                      ///< of each slot, modulo 256
};

/// Calls visit(block of a, block of b) for all blocks of two graphs of one capacity.
template <class A, class B, class Visitor>
void for_each_block_pair(A a, B b, const Visitor& visit) {
  std::apply(
      [&](auto&... of_a) {
        std::apply([&](auto&... of_b) { (visit(of_a, of_b), ...); }, b.blocks());
      },
      a.blocks());
}

/// Memory of a graph as a cluster core sees it.
template <class P>
GraphMemory<P, L2FromCluster> seen_from_cluster(const GraphMemory<P, LocalMemory>& graph) {
  GraphMemory<P, L2FromCluster> seen;
  seen.capacity = graph.capacity;
  std::apply(
      [&](auto&... to) {
        GraphMemory<P, LocalMemory> source = graph;
        std::apply(
            [&](auto&... from) {
              ((to = {from.data(), from.size()}), ...);
            },
            source.blocks());
      },
      seen.blocks());
  return seen;
}

/// What a graph takes in a memory whose blocks begin at words.
template <class P>
Bytes graph_size(const GraphCapacity& capacity) {
  std::int64_t size = 0;
  const GraphBlock* block = kGraphBlocks.data();
  const auto add = [&](auto& span) {
    const auto element = static_cast<std::int64_t>(sizeof(*span.data()));
    size += (element * (block++)->elements(capacity) + 3) / 4 * 4;
  };
  GraphMemory<P, LocalMemory> graph;
  std::apply([&](auto&... spans) { (add(spans), ...); }, graph.blocks());
  return Bytes(size);
}

/// The graph with new memory in `arena` for its short blocks, and the long ones where they are.
template <class P>
GraphMemory<P, LongBlocksInL2> alloc_short_blocks(work::Arena& arena,
                                                  const GraphMemory<P, LocalMemory>& in_l2) {
  GraphMemory<P, LongBlocksInL2> graph;
  graph.capacity = in_l2.capacity;
  const GraphBlock* block = kGraphBlocks.data();
  const auto place = [&](auto& to, auto& from) {
    using Span = std::remove_reference_t<decltype(to)>;
    to = block->is_long ? Span(from.data(), from.size())
                        : arena.alloc<Span>(block->name, from.size());
    ++block;
  };
  GraphMemory<P, LocalMemory> source = in_l2;
  std::apply(
      [&](auto&... to) {
        std::apply([&](auto&... from) { (place(to, from), ...); }, source.blocks());
      },
      graph.blocks());
  return graph;
}

/// DMA of the whole graph from L2 into a copy in local memory.
template <class P>
void copy_graph_in(work::Machine& machine, const GraphMemory<P, LocalMemory>& local,
                   const GraphMemory<P, LocalMemory>& in_l2) {
  for_each_block_pair(local, in_l2, [&](auto& to, auto& from) { machine.copy_in(to, from); });
}
/// DMA of a copy in local memory back to L2.
template <class P>
void copy_graph_out(work::Machine& machine, const GraphMemory<P, LocalMemory>& in_l2,
                    const GraphMemory<P, LocalMemory>& local) {
  for_each_block_pair(in_l2, local, [&](auto& to, auto& from) { machine.copy_out(to, from); });
}

/// The same of the short blocks only.
template <class P>
void copy_short_blocks_in(work::Machine& machine, const GraphMemory<P, LongBlocksInL2>& graph,
                          const GraphMemory<P, LocalMemory>& in_l2) {
  const GraphBlock* block = kGraphBlocks.data();
  for_each_block_pair(graph, in_l2, [&](auto& to, auto& from) {
    if (!(block++)->is_long) machine.copy_in(to, from);
  });
}
template <class P>
void copy_short_blocks_out(work::Machine& machine, const GraphMemory<P, LocalMemory>& in_l2,
                           const GraphMemory<P, LongBlocksInL2>& graph) {
  const GraphBlock* block = kGraphBlocks.data();
  for_each_block_pair(in_l2, graph, [&](auto& to, auto& from) {
    if (!(block++)->is_long) machine.copy_out(to, from);
  });
}

}  // namespace leviosim::vio
