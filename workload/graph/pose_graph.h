// The pose graph as it lies in L2: the most recent keyframes, the landmarks with their descriptors,
// and the observations that link them (paper section IV.B; PARAMETERS.md#memory). The front
// end changes it, the optimiser takes snapshots of it and publishes results (window.h).
//
// Sizes for 8 keyframes, 1000 landmarks, 2400 observations: landmarks 12 B point + 32 B descriptor
// + 1 B age, observations 8 B, together the paper's 64.2 kB; besides 1 B of generation per landmark
// and the keyframe records with their inertial intervals (5.4 kB).
//
// Observations are a list in the order of their making. When a keyframe leaves, the list is
// compacted in place, which also drops observations of landmarks whose slot was reused: a slot has
// a generation, and an observation remembers the generation it means.
//
// Slots are reused by age, the landmark seen least recently first. A search through all ages per
// new landmark would cost more than its triangulation, so one cursor per keyframe sweeps the slots,
// once for each age from the oldest down.
//
// A landmark leaves in two ways: one that is not seen again ages until its slot is reused, and one
// that the optimiser has lost retires: it is the oldest from then on, and its observations are
// void.
#pragma once

#include "workload/graph/graph_memory.h"
#include "workload/inertial/bias_estimation.h"

namespace leviosim::vio {

/// The graph, a bundle of views: copies share the memory.
/// @tparam Where  LocalMemory for the fabric controller and for copies in L1, L2FromCluster for a
///                cluster core that works on L2 directly, LongBlocksInL2 for one that has a copy of
///                the short blocks
template <class P, class Where = LocalMemory>
class PoseGraph : public GraphMemory<P, Where> {
 public:
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  using Byte = typename P::Byte;
  using Memory = GraphMemory<P, Where>;

  PoseGraph() = default;
  /// Views of the graph in `arena`, with uninitialised contents.
  PoseGraph(work::Arena& arena, const GraphCapacity& size) : Memory(arena, size) {}
  PoseGraph(work::Arena& arena, work::Arena& inertial, const GraphCapacity& size)
      : Memory(arena, inertial, size) {}
  explicit PoseGraph(const Memory& memory) : Memory(memory) {}

  /// Empties the graph; the prior of the biases knows nothing then.
  void clear(const ImuBias<P>& bias, const Vec3<P>& gravity) const;

  /// Empties the graph too, but serial numbers go on: a snapshot taken before is not published to
  /// the keyframes that follow.
  void restart(const ImuBias<P>& bias, const Vec3<P>& gravity) const {
    const I32 next = this->header[kNextId];
    clear(bias, gravity);
    this->header[kNextId] = next;
  }

  /// Adds a keyframe; if all slots are taken the oldest leaves, with its observations.
  /// @param interval  record of the motion since the keyframe before (Preintegration::kFloats);
  ///                  copied. Of no length if there is none.
  /// @param remove    takes the observations of a keyframe off the list
  /// @return its slot
  template <class Record, class Remove>
  I32 add_keyframe(const KeyframeState<P>& state, const Record& interval,
                   const Remove& remove) const;
  template <class Record>
  I32 add_keyframe(const KeyframeState<P>& state, const Record& interval) const {
    return add_keyframe(state, interval, [this](I32 keyframe) { remove_observations(keyframe); });
  }

  /// Columns of observations, a part of the list.
  template <class Numbers, class Bytes>
  struct Observations {
    Numbers landmarks, u, v;
    Bytes keyframes, generations;
  };
  /// Copies the first `n` observations but for those of the keyframe, and of landmarks whose slot
  /// was reused. `to` may be `from`.
  /// @return how many are left
  template <class From, class To>
  I32 keep_observations(I32 keyframe, int n, const From& from, const To& to) const;
  void set_observation_count(I32 n) const { this->header[kObservations] = n; }

  /// Takes the observations of a keyframe off the list.
  void remove_observations(I32 keyframe) const;

  /// Makes all landmarks one keyframe older and starts the search for slots to reuse anew. Once per
  /// keyframe, before its observations and landmarks are added.
  void age_landmarks() const;

  /// Puts a landmark into the slot of the one seen least recently; its age becomes 0.
  /// @param point       in the world frame, m
  /// @param descriptor  8 words
  /// @return its slot, or -1 if every landmark was seen by the current keyframe
  template <class Words>
  I32 add_landmark(const Vec3<P>& point, const Words& descriptor) const;

  /// Gives a landmark up: it counts as the oldest, and its observations no longer mean it.
  void retire_landmark(I32 landmark) const {
    this->ages[landmark] = work::narrow<Byte>(I32(kOldestAge));
    void_observations(landmark);
  }

  /// The landmark stays where it is and can be recognised, but nothing that was seen of it counts.
  void void_observations(I32 landmark) const {
    this->generations[landmark] = work::narrow<Byte>(I32(this->generations[landmark]) + I32(1));
  }

  /// Replaces a landmark's descriptor by a newer one (8 words).
  template <class Words>
  void update_descriptor(I32 landmark, const Words& descriptor) const;

  /// Links a landmark to a keyframe that saw it at pixel (u, v); its age becomes 0. A landmark's
  /// observations must be added in the order of the keyframes, at most one for each.
  /// @return false if the list is full; the observation is then not kept
  bool add_observation(I32 keyframe, I32 landmark, I32 u, I32 v) const;

  I32 keyframe_count() const { return this->header[kKeyframes]; }
  /// Slot of the k-th oldest keyframe.
  I32 keyframe_slot(I32 k) const {
    const I32 slot = I32(this->header[kOldest]) + k;
    const I32 slots = this->capacity.keyframes;
    return slot >= slots ? I32(slot - slots) : slot;
  }
  I32 newest_keyframe() const { return keyframe_slot(keyframe_count() - I32(1)); }
  I32 observation_count() const { return this->header[kObservations]; }
  /// Slots below this have been used; those above hold nothing.
  I32 landmark_count() const { return this->header[kLandmarks]; }

  KeyframeState<P> keyframe(I32 slot) const {
    return {load_pose<P>(element(this->keyframe_poses, slot, kPoseFloats), 0),
            load_vec3<P>(element(this->keyframe_velocities, slot, 3), 0)};
  }
  void set_keyframe(I32 slot, const KeyframeState<P>& state) const {
    store_pose<P>(element(this->keyframe_poses, slot, kPoseFloats), 0, state.T_world_camera);
    store_vec3<P>(element(this->keyframe_velocities, slot, 3), 0, state.velocity);
  }
  Vec3<P> point(I32 landmark) const { return load_vec3<P>(element(this->points, landmark, 3), 0); }
  void set_point(I32 landmark, const Vec3<P>& point) const {
    store_vec3<P>(element(this->points, landmark, 3), 0, point);
  }
  ImuBias<P> bias() const {
    return {load_vec3<P>(this->environment, 0), load_vec3<P>(this->environment, 3)};
  }
  void set_bias(const ImuBias<P>& bias) const {
    store_vec3<P>(this->environment, 0, bias.gyro);
    store_vec3<P>(this->environment, 3, bias.accel);
  }
  /// In the world frame, pointing down, m/s².
  Vec3<P> gravity() const { return load_vec3<P>(this->environment, 6); }
  void set_gravity(const Vec3<P>& gravity) const { store_vec3<P>(this->environment, 6, gravity); }
  BiasPrior<P> bias_prior() const {
    const auto& e = this->environment;
    return {{load_vec3<P>(e, 9), load_vec3<P>(e, 12)}, F(e[15]), F(e[16])};
  }
  void set_bias_prior(const BiasPrior<P>& prior) const {
    store_vec3<P>(this->environment, 9, prior.mean.gyro);
    store_vec3<P>(this->environment, 12, prior.mean.accel);
    this->environment[15] = prior.gyro_information;
    this->environment[16] = prior.accel_information;
  }

 private:
  enum Header : int {
    kKeyframes,     ///< number of keyframes
    kOldest,        ///< slot of the oldest
    kNextId,        ///< serial number of the next
    kObservations,  ///< number of observations
    kLandmarks,     ///< highest slot ever used, plus one
    kReuseCursor,   ///< slots below it are younger than kReuseAge
    kReuseAge,      ///< age of the landmarks to be replaced next
    kHeaderWords,
  };
  static_assert(kHeaderWords == kGraphHeaderWords);

  /// The `floats` of element i.
  template <class Span>
  static Span element(const Span& all, I32 i, int floats) {
    return all.subspan(I32(i * I32(floats)), floats);
  }

  template <class Remove>
  void drop_oldest_keyframe(const Remove& remove) const;
  I32 find_reusable_slot() const;
  I32 oldest_age_below(I32 age) const;
};

template <class P, class Where>
void PoseGraph<P, Where>::clear(const ImuBias<P>& bias, const Vec3<P>& gravity) const {
  const typename P::Function function("PoseGraph::clear");
  for (int i : P::range(0, kHeaderWords)) this->header[i] = I32(0);
  for (int i : P::range(0, this->capacity.landmarks)) {
    this->ages[i] = work::narrow<Byte>(I32(kUnusedAge));
    this->generations[i] = work::narrow<Byte>(I32(0));
  }
  for (int i : P::range(0, this->capacity.keyframes)) this->keyframe_ids[i] = I32(-1);
  set_bias(bias);
  set_gravity(gravity);
  set_bias_prior({bias, 0.0f, 0.0f});
}

template <class P, class Where>
template <class Record, class Remove>
typename P::I32 PoseGraph<P, Where>::add_keyframe(const KeyframeState<P>& state,
                                                  const Record& interval,
                                                  const Remove& remove) const {
  const typename P::Function function("PoseGraph::add_keyframe");
  if (keyframe_count() == I32(this->capacity.keyframes)) drop_oldest_keyframe(remove);
  this->header[kKeyframes] += I32(1);
  const I32 slot = newest_keyframe();
  set_keyframe(slot, state);
  const I32 id = this->header[kNextId];
  this->keyframe_ids[slot] = id;
  this->header[kNextId] = I32(id + I32(1));
  const auto record = this->interval_record(slot);
  for (int i : P::range(0, Preintegration<P>::kFloats)) record[i] = F(interval[i]);
  return slot;
}

template <class P, class Where>
template <class Remove>
void PoseGraph<P, Where>::drop_oldest_keyframe(const Remove& remove) const {
  const I32 oldest = this->header[kOldest];
  remove(oldest);
  this->keyframe_ids[oldest] = I32(-1);
  this->header[kOldest] = keyframe_slot(1);
  this->header[kKeyframes] -= I32(1);
}

template <class P, class Where>
template <class From, class To>
typename P::I32 PoseGraph<P, Where>::keep_observations(I32 keyframe, int n, const From& from,
                                                       const To& to) const {
  const auto now = this->generations;
  I32 kept = 0;
  for (int i : P::range(0, n)) {
    const I32 seen_by = from.keyframes[i];
    if (seen_by == keyframe) continue;
    const I32 landmark = from.landmarks[i];
    const I32 generation = from.generations[i];
    if (generation != I32(now[landmark])) continue;
    const I32 u = from.u[i], v = from.v[i];
    to.keyframes[kept] = work::narrow<Byte>(seen_by);
    to.generations[kept] = work::narrow<Byte>(generation);
    to.landmarks[kept] = work::narrow<U16>(landmark);
    to.u[kept] = work::narrow<U16>(u);
    to.v[kept] = work::narrow<U16>(v);
    ++kept;
  }
  return kept;
}

template <class P, class Where>
void PoseGraph<P, Where>::remove_observations(I32 keyframe) const {
  const typename P::Function function("PoseGraph::remove_observations");
  const Memory g = *this;
  const Observations<decltype(g.observation_u), decltype(g.observation_keyframes)> all{
      g.observation_landmarks, g.observation_u, g.observation_v, g.observation_keyframes,
      g.observation_generations};
  set_observation_count(keep_observations(keyframe, work::value(observation_count()), all, all));
}

template <class P, class Where>
void PoseGraph<P, Where>::age_landmarks() const {
  const typename P::Function function("PoseGraph::age_landmarks");
  const Memory g = *this;
  I32 oldest = 0;
  for (int i : P::range(0, g.capacity.landmarks)) {
    I32 age = g.ages[i];
    if (age < I32(kOldestAge)) {
      ++age;
      g.ages[i] = work::narrow<Byte>(age);
    }
    oldest = work::max(oldest, age);
  }
  this->header[kReuseCursor] = I32(0);
  this->header[kReuseAge] = oldest;
}

/// The oldest age below `age`, or 0.
template <class P, class Where>
typename P::I32 PoseGraph<P, Where>::oldest_age_below(I32 age) const {
  const auto all_ages = this->ages;
  I32 oldest = 0;
  for (int i : P::range(0, this->capacity.landmarks)) {
    const I32 other = all_ages[i];
    if (other < age) oldest = work::max(oldest, other);
  }
  return oldest;
}

/// Sweeps the slots for landmarks of the age to be replaced next, then for the age below. Age 0 is
/// of landmarks that the current keyframe sees: -1 if only those are left.
template <class P, class Where>
typename P::I32 PoseGraph<P, Where>::find_reusable_slot() const {
  const auto all_ages = this->ages;
  I32 cursor = this->header[kReuseCursor];
  I32 age = this->header[kReuseAge];
  I32 found = -1;
  while (age > I32(0)) {
    for (int i : P::range(work::value(cursor), this->capacity.landmarks)) {
      if (I32(all_ages[i]) == age) {
        found = I32(i);
        break;
      }
    }
    if (found >= I32(0)) break;
    age = oldest_age_below(age);
    cursor = 0;
  }
  this->header[kReuseCursor] = I32(found + I32(1));
  this->header[kReuseAge] = age;
  return found;
}

template <class P, class Where>
template <class Words>
typename P::I32 PoseGraph<P, Where>::add_landmark(const Vec3<P>& point,
                                                  const Words& descriptor) const {
  const typename P::Function function("PoseGraph::add_landmark");
  const I32 slot = find_reusable_slot();
  if (slot < I32(0)) return slot;
  this->generations[slot] = work::narrow<Byte>(I32(this->generations[slot]) + I32(1));
  this->ages[slot] = work::narrow<Byte>(I32(0));
  set_point(slot, point);
  update_descriptor(slot, descriptor);
  this->header[kLandmarks] = work::max(landmark_count(), I32(slot + I32(1)));
  return slot;
}

template <class P, class Where>
template <class Words>
void PoseGraph<P, Where>::update_descriptor(I32 landmark, const Words& descriptor) const {
  const typename P::Function function("PoseGraph::update_descriptor");
  const auto to =
      this->descriptors.subspan(I32(landmark << kLog2DescriptorWords), kGraphDescriptorWords);
  for (int i : P::range(0, kGraphDescriptorWords)) to[i] = typename P::U32(descriptor[i]);
}

template <class P, class Where>
bool PoseGraph<P, Where>::add_observation(I32 keyframe, I32 landmark, I32 u, I32 v) const {
  const typename P::Function function("PoseGraph::add_observation");
  const I32 at = observation_count();
  if (at == I32(this->capacity.observations)) return false;
  this->observation_keyframes[at] = work::narrow<Byte>(keyframe);
  this->observation_generations[at] = work::narrow<Byte>(I32(this->generations[landmark]));
  this->observation_landmarks[at] = work::narrow<U16>(landmark);
  this->observation_u[at] = work::narrow<U16>(u);
  this->observation_v[at] = work::narrow<U16>(v);
  this->ages[landmark] = work::narrow<Byte>(I32(0));
  this->header[kObservations] = I32(at + I32(1));
  return true;
}

}  // namespace leviosim::vio
