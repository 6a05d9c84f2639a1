// A pose graph in a memory of its own, with little helpers to fill and read it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tests/workload/inertial/preintegration_motion.h"
#include "workload/graph/pose_graph.h"

namespace leviosim::vio::test {

/// Plain integers of either policy.
inline int plain(std::int32_t x) { return x; }
inline int plain(work::I32 x) { return x.v; }

template <class P>
struct GraphFixture {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U32 = typename P::U32;

  explicit GraphFixture(const GraphCapacity& capacity = {})
      : memory("L2", Bytes(1'600'000)), graph(memory, capacity) {
    graph.clear(ImuBias<P>::zero(), to_vec3<P>({0, 9.81, 0}));
    no_motion.reset(ImuBias<P>::zero());
  }

  static std::array<U32, 8> descriptor(int seed) {
    std::array<U32, 8> words;
    for (std::size_t i = 0; i < 8; ++i)
      words[i] =
          U32(static_cast<std::uint32_t>(seed) * 0x01000193u + static_cast<std::uint32_t>(i));
    return words;
  }
  /// A keyframe at x, with all landmarks aged.
  int add_keyframe(float x = 0) {
    KeyframeState<P> state{Pose<P>::identity(), {0.0f, 0.0f, 0.0f}};
    state.T_world_camera.t.x = x;
    const int slot = plain(graph.add_keyframe(state, no_motion.record()));
    graph.age_landmarks();
    return slot;
  }
  int add_landmark(float x) {
    return plain(graph.add_landmark({x, 0.0f, 1.0f}, descriptor(static_cast<int>(x))));
  }
  bool observe(int keyframe, int landmark, int u = 0, int v = 0) {
    return graph.add_observation(keyframe, landmark, u, v);
  }
  float point_x(int landmark) { return static_cast<float>(work::value(graph.point(landmark).x)); }
  int age(int landmark) { return plain(I32(graph.ages[landmark])); }

  work::Arena memory;
  PoseGraph<P> graph;
  OwnedInterval<P> no_motion;
};

}  // namespace leviosim::vio::test
