#include "workload/vio/front_end_state.h"

#include <algorithm>

#include "workload/levio/geometry/epnp_ransac.h"
#include "workload/vio/keyframe_record.h"

namespace leviosim::vio {
namespace {

/// What EPnP takes with a hypothesis on each core, if all features of a frame match.
Bytes memory_of_epnp(const Profile& profile, int matches, int cores) {
  constexpr std::int64_t kMatch = 3 * 2 + 4 * 5;  // in the list, and side by side
  if (!profile.runs_epnp()) return Bytes(0);
  return Bytes(kMatch * matches) + levio::epnp_memory(matches, cores);
}

/// For tiles and for the scratch of a core.
constexpr Bytes kBesideLists{12 * 1024};

/// Descriptors stay where those of two frames have room, as matching needs them, and where they
/// leave room for EPnP on all cores. Places take theirs from local memory (next/loop).
template <class P>
Residence residence_in(const work::Machine& machine, const Profile& profile, const Rig& rig) {
  const ExtractorOptions& options = profile.extractor;
  const int capacity = options.max_features(rig.width, rig.height);
  const Bytes room = machine.local().capacity();
  Residence residence;
  const Bytes features = observed_features_size<P>(capacity, true);
  const Bytes beside = std::max(features, memory_of_epnp(profile, capacity, machine.cores()));
  residence.descriptors = profile.loop.enabled || features + beside <= room;
  // Features, their matches, those of one way, and what is known of the keyframe's features.
  constexpr std::int64_t kListed = 4 * 6;
  residence.whole_lists = Bytes(kListed * capacity) + kBesideLists <= room;
  residence.image = observed_features_size<P>(capacity, residence.descriptors) +
                        options.memory_of_whole_image(rig.width, rig.height, machine.cores()) <=
                    room;
  return residence;
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
      residence(residence_in<P>(cluster, profile, rig)),
      keyframe(keyframe_memory, profile.extractor.max_features(rig.width, rig.height), rig.width,
               rig.height, residence, profile.patches.enabled, profile.stillness),
      graph(in_l2),
      graph_in_l2(seen_from_cluster<P>(in_l2)) {}

template <class P>
ObservedFeatures<P> alloc_frame_features(const FrontEndState<P>& state) {
  work::Arena& local = state.machine.local();
  const int capacity = state.keyframe.features.list.capacity;
  ObservedFeatures<P> features;
  if (state.residence.descriptors) {
    features.list = alloc_features<P>(local, capacity);
  } else {
    features.list = alloc_keypoints<P>(local, capacity);
    features.list.descriptors = state.keyframe.fresh;
    features.list.descriptors_in_l2 = true;
  }
  features.landmarks =
      local.alloc<typename P::template Span<typename P::U16>>("landmarks of features", capacity);
  return features;
}

template ObservedFeatures<work::Native> alloc_frame_features(const FrontEndState<work::Native>&);
template ObservedFeatures<work::Counting> alloc_frame_features(
    const FrontEndState<work::Counting>&);
template struct FrontEndState<work::Native>;
template struct FrontEndState<work::Counting>;

}  // namespace leviosim::vio
