// What a front end keeps between frames, and where it works: the parts of both front ends take it
// and change it. Its data persist in L2; L1 is a scratchpad that is empty between frames.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>

#include "sim/work/machine.h"
#include "workload/graph/pose_graph.h"
#include "workload/vio/feature_camera.h"
#include "workload/vio/keyframe_record.h"
#include "workload/vio/profile.h"
#include "workload/vio/records.h"

namespace leviosim::vio {

template <class P>
struct FrontEndState {
  /// @param cluster          where the front end runs; its memory is L1
  /// @param keyframe_memory  in L2, for the last keyframe
  /// @param in_l2            the graph, shared with the back end
  FrontEndState(const Profile& parameters, const Rig& camera_rig, work::Machine& cluster,
                work::Arena& keyframe_memory, const PoseGraph<P>& in_l2);

  KeyframeState<P> newest_keyframe() const {
    return graph_in_l2.keyframe(graph_in_l2.newest_keyframe());
  }

  const Profile& profile;
  Rig rig;
  work::Machine& machine;
  FeatureCamera<P> camera;
  Residence residence;
  KeyframeRecord<P> keyframe;
  PoseGraph<P> graph;                       ///< the graph in L2, for transfers
  PoseGraph<P, L2FromCluster> graph_in_l2;  ///< the graph as a cluster core reaches it
  bool started = false;                     ///< there is a map
  std::uint32_t frame_number = 0;           ///< number of the present frame, from 1 on
  float time_since_keyframe = 0;            ///< time since the last keyframe [s]
};

/// For how many features, of which there are `number`, a list in local memory has room.
template <class P>
int list_capacity(const FrontEndState<P>& state, int number) {
  const int all = state.keyframe.features.list.capacity;
  return state.residence.whole_lists ? all : std::min(all, number);
}

/// How many features of the last keyframe its patches may find that have no match: such as show a
/// landmark, and no two show the same.
template <class P>
int most_found_by_patches(const FrontEndState<P>& state) {
  return state.profile.patches.enabled
             ? std::min(state.keyframe.features.list.count, state.graph.capacity.landmarks)
             : 0;
}

/// The features that extract(list) finds, and room for their landmarks, in local memory; their
/// descriptors may lie in L2. Where lists are not whole, there is room for as many as were found
/// and for those of the keyframe that patches may find.
template <class P>
ObservedFeatures<P> features_of_frame(const FrontEndState<P>& state,
                                      const std::function<void(FeatureList<P>&)>& extract);

}  // namespace leviosim::vio
