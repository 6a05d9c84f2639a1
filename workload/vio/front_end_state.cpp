#include "workload/vio/front_end_state.h"

#include <algorithm>

#include "sim/base/check.h"
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
/// Of each feature, in lists: matches with landmarks and those of one way, what EPnP takes of them;
/// or matches with the keyframe, those of one way, and both views.
constexpr std::int64_t kListedBehind = 2 * 6 + 5 * 4;

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
  residence.whole_lists = residence.descriptors || Bytes(kListed * capacity) + kBesideLists <= room;
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
      graph_in_l2(seen_from_cluster<P>(in_l2)) {
  if (residence.whole_lists) return;
  using Bytes8 = typename P::template Span<typename P::Byte>;
  const Bytes lists(kListedBehind * keyframe.features.list.capacity);
  keyframe_memory.alloc<Bytes8>("lists of the frame", static_cast<int>(lists.count()));
  machine.set_behind(work::Arena("L2", lists), kBesideLists);
}

namespace {

/// Room for keypoints, and the place of their descriptors.
template <class P>
FeatureList<P> alloc_list(const FrontEndState<P>& state, int capacity) {
  work::Arena& local = state.machine.local();
  if (state.residence.descriptors) return alloc_features<P>(local, capacity);
  FeatureList<P> list = alloc_keypoints<P>(local, capacity);
  list.descriptors = state.keyframe.fresh.list.descriptors;
  list.descriptors_in_l2 = true;
  return list;
}

/// A list of so many features whose columns move together to where it begins.
template <class P>
FeatureList<P> shortened(const FrontEndState<P>& state, const FeatureList<P>& from, int capacity) {
  using I32 = typename P::I32;
  FeatureList<P> list = alloc_list(state, capacity);
  list.count = from.count;
  // uncounted: the host's own check
  check(list.x.data() == from.x.data(), "the shorter list begins where the long one did");
  for (int i : P::range(0, from.count)) list.y[i] = work::narrow<typename P::U16>(I32(from.y[i]));
  return list;
}

}  // namespace

template <class P>
ObservedFeatures<P> features_of_frame(const FrontEndState<P>& state,
                                      const std::function<void(FeatureList<P>&)>& extract) {
  work::Arena& local = state.machine.local();
  const int most = state.keyframe.features.list.capacity;
  const auto with_landmarks = [&](const FeatureList<P>& list) {
    return ObservedFeatures<P>{list, local.alloc<typename P::template Span<typename P::U16>>(
                                         "landmarks of features", list.capacity)};
  };
  if (state.residence.whole_lists) {
    ObservedFeatures<P> features = with_landmarks(alloc_list(state, most));
    extract(features.list);
    return features;
  }
  ObservedFeatures<P> in_l2 = state.keyframe.fresh;
  in_l2.list.descriptors_in_l2 = true;
  FeatureList<P> all = in_l2.list;
  const bool local_first = state.machine.has_room(Bytes(2LL * sizeof(typename P::U16) * most));
  {
    const work::Arena::Frame room(local);
    if (local_first) all = alloc_list(state, most);
    extract(all);
  }
  const int capacity = std::min(most, all.count + most_found_by_patches(state));
  if (local_first) {
    if (state.machine.has_room(observed_features_size<P>(capacity, false)))
      return with_landmarks(shortened(state, all, capacity));
    state.machine.copy_out(in_l2.list.x, all.x.subspan(0, all.count));
    state.machine.copy_out(in_l2.list.y, all.y.subspan(0, all.count));
  }
  in_l2.list.count = all.count;
  in_l2.list.capacity = capacity;
  return in_l2;
}

template ObservedFeatures<work::Native> features_of_frame(
    const FrontEndState<work::Native>&, const std::function<void(FeatureList<work::Native>&)>&);
template ObservedFeatures<work::Counting> features_of_frame(
    const FrontEndState<work::Counting>&, const std::function<void(FeatureList<work::Counting>&)>&);
template struct FrontEndState<work::Native>;
template struct FrontEndState<work::Counting>;

}  // namespace leviosim::vio
