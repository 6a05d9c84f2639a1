// The memory of loop closure in L2: places, which are keyframes kept to be recognised, with some of
// their features, and closures found between them. All of it is allocated once; what does not fit
// any more is removed (loop_graph.h).
//
// A feature is a descriptor (32 B) and its point in the camera frame of the place, in whole
// millimetres of 16 bits (6 B); points farther than 32 m are left out. A place has besides a
// signature (128 B), its pose as the odometry had it, its node of the pose graph, and
// the path until there (70 B). Places are listed in the order in which they were visited; the list
// is small and worked on in L1, features stay in L2 and are fetched by slot.
#pragma once

#include "sim/work/machine.h"
#include "workload/inertial/record.h"
#include "workload/next/loop/yaw_transform.h"
#include "workload/vio/loop_options.h"

namespace leviosim::vio {

inline constexpr int kNodeFloats = 4;  ///< x, y, z [m], yaw [rad]
inline constexpr int kClosureFloats = 5;

/// A closure: where place `to` lies as seen from the earlier place `from`, in the odometry's
/// coordinates at `from`, and how far the odometry had turned too little.
template <class P>
struct Closure {
  using F = typename P::F32;
  typename P::I32 from, to;
  Vec3<P> between;  ///< [m]
  F yaw;            ///< [rad]
  F path;           ///< of odometry that is part of it, m: its drift adds to its error
};

/// Places and closures, in L2 or as a copy in L1.
template <class P>
struct PlaceList {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using Floats = typename P::template Span<F>;
  using Numbers = typename P::template Span<typename P::U16>;

  PlaceList() = default;
  PlaceList(work::Arena& arena, const PlaceOptions& places, const LoopGraphOptions& graph);

  Pose<P> odometry(I32 i) const { return load_pose<P>(part(poses, i, kPoseFloats), 0); }
  void set_odometry(I32 i, const Pose<P>& T) const {
    store_pose<P>(part(poses, i, kPoseFloats), 0, T);
  }
  Vec3<P> odometry_position(I32 i) const { return load_vec3<P>(part(poses, i, kPoseFloats), 9); }
  /// Its corrected position, and the yaw that corrects.
  YawTransform<P> node(I32 i) const {
    const Floats at = part(nodes, i, kNodeFloats);
    return {F(at[3]), load_vec3<P>(at, 0)};
  }
  void set_node(I32 i, const YawTransform<P>& node) const {
    const Floats at = part(nodes, i, kNodeFloats);
    store_vec3<P>(at, 0, node.t);
    at[3] = node.yaw;
  }
  Closure<P> closure(int i) const {
    const int at = kClosureFloats * i;
    return {I32(closure_from[i]), I32(closure_to[i]), load_vec3<P>(closures, at),
            F(closures[at + 3]), F(closures[at + 4])};
  }
  void set_closure(int i, const Closure<P>& closure) const;
  /// Of a place's optical axis, in the corrected world.
  Vec3<P> axis(I32 i) const;

  Floats poses;      ///< kPoseFloats each: T_odometry_camera
  Floats nodes;      ///< kNodeFloats each: corrected position, and the yaw that corrects
  Floats travelled;  ///< path until there, m
  Numbers slots;     ///< where the features are
  Numbers features;  ///< how many
  Floats closures;   ///< kClosureFloats each
  Numbers closure_from, closure_to;
  int count = 0;
  int closure_count = 0;

 private:
  static Floats part(const Floats& all, I32 i, int floats) {
    return all.subspan(I32(i * I32(floats)), floats);
  }
};

/// Copies what is in use.
template <class P>
void copy_places_in(work::Machine& machine, const PlaceList<P>& l2, PlaceList<P>& local);
template <class P>
void copy_places_out(work::Machine& machine, const PlaceList<P>& local, PlaceList<P>& l2);

/// Features by slot, in L2.
template <class P>
struct PlaceFeatures {
  template <class T>
  using Span = typename P::template Span<T>;

  PlaceFeatures(work::Arena& arena, const PlaceOptions& options);

  Span<typename P::U32> descriptors_of(typename P::I32 slot) const;
  Span<typename P::U16> points_of(typename P::I32 slot) const;
  Span<typename P::U32> signature_of(typename P::I32 slot) const;

  int capacity;  ///< features of a place
  Span<typename P::U32> descriptors, signatures;
  Span<typename P::U16> points;
};

/// Largest coordinate of a stored point [m].
inline constexpr float kFarthestPoint = 32.0f;

/// A coordinate of up to ±kFarthestPoint in millimetres, and back.
template <class P>
typename P::I32 stored_coordinate(typename P::F32 metres) {
  return work::to_i32(metres * typename P::F32(1000.0f) + typename P::F32(32768.5f));
}
template <class P>
typename P::F32 loaded_coordinate(typename P::I32 stored) {
  using F = typename P::F32;
  return work::to_f32(stored - typename P::I32(32768)) * F(0.001f);
}

}  // namespace leviosim::vio
