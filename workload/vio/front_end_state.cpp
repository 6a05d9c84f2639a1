#include "workload/vio/front_end_state.h"

namespace leviosim::vio {
namespace {

/// Whether the image, its blurred copy and the features exceed the local memory.
template <class P>
bool needs_strips(const ExtractorOptions& options, const Rig& rig, const work::Machine& machine) {
  const Bytes features = observed_features_size<P>(options.max_features(rig.width, rig.height));
  return features + options.memory_of_whole_image(rig.width, rig.height, machine.cores()) >
         machine.local().capacity();
}

}  // namespace

template <class P>
FrontEndState<P>::FrontEndState(const Profile& parameters, const Rig& camera_rig,
                                work::Machine& cluster, work::Arena& keyframe_memory,
                                const PoseGraph<P>& in_l2)
    : profile(parameters),
      rig(camera_rig),
      machine(cluster),
      camera(rig.camera, profile.extractor.subpixel_steps),
      strips(needs_strips<P>(profile.extractor, rig, cluster)),
      keyframe(keyframe_memory, profile.extractor.max_features(rig.width, rig.height), rig.width,
               rig.height, strips, profile.patches.enabled && !strips, profile.stillness),
      graph(in_l2),
      graph_in_l2(seen_from_cluster<P>(in_l2)) {}

template struct FrontEndState<work::Native>;
template struct FrontEndState<work::Counting>;

}  // namespace leviosim::vio
