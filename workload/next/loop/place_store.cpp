#include "workload/next/loop/place_store.h"

#include "workload/next/loop/view_signature.h"
#include "workload/vision/features.h"

namespace leviosim::vio {

template <class P>
PlaceList<P>::PlaceList(work::Arena& arena, const PlaceOptions& places,
                        const LoopGraphOptions& graph)
    : poses(arena.alloc<Floats>("odometry of places", kPoseFloats * places.places)),
      nodes(arena.alloc<Floats>("nodes of places", kNodeFloats * places.places)),
      travelled(arena.alloc<Floats>("path to places", places.places)),
      closures(arena.alloc<Floats>("closures", kClosureFloats * graph.closures)) {
  slots = arena.alloc<Numbers>("slots of places", places.places);
  features = arena.alloc<Numbers>("numbers of features", places.places);
  closure_from = arena.alloc<Numbers>("earlier places of closures", graph.closures);
  closure_to = arena.alloc<Numbers>("later places of closures", graph.closures);
}

template <class P>
void PlaceList<P>::set_closure(int i, const Closure<P>& closure) const {
  using U16 = typename P::U16;
  const int at = kClosureFloats * i;
  store_vec3<P>(closures, at, closure.between);
  closures[at + 3] = closure.yaw;
  closures[at + 4] = closure.path;
  closure_from[i] = work::narrow<U16>(closure.from);
  closure_to[i] = work::narrow<U16>(closure.to);
}

template <class P>
Vec3<P> PlaceList<P>::axis(I32 i) const {
  const Floats at = part(poses, i, kPoseFloats);
  const Vec3<P> in_odometry{F(at[2]), F(at[5]), F(at[8])};
  return turned<P>(sincos_of<P>(node(i).yaw), in_odometry);
}

namespace {

/// Calls move(from, to, number) for every part of a list with what of it is in use.
template <class P, class Move>
void for_used_parts(const PlaceList<P>& from, PlaceList<P>& to, Move&& move) {
  to.count = from.count;
  to.closure_count = from.closure_count;
  const auto part = [&](const auto& source, const auto& target, int number) {
    move(source.subspan(0, number), target.subspan(0, number));
  };
  part(from.poses, to.poses, kPoseFloats * from.count);
  part(from.nodes, to.nodes, kNodeFloats * from.count);
  part(from.travelled, to.travelled, from.count);
  part(from.slots, to.slots, from.count);
  part(from.features, to.features, from.count);
  part(from.closures, to.closures, kClosureFloats * from.closure_count);
  part(from.closure_from, to.closure_from, from.closure_count);
  part(from.closure_to, to.closure_to, from.closure_count);
}

}  // namespace

template <class P>
void copy_places_in(work::Machine& machine, const PlaceList<P>& l2, PlaceList<P>& local) {
  for_used_parts(l2, local, [&](auto from, auto to) { machine.copy_in(to, from); });
}

template <class P>
void copy_places_out(work::Machine& machine, const PlaceList<P>& local, PlaceList<P>& l2) {
  for_used_parts(local, l2, [&](auto from, auto to) { machine.copy_out(to, from); });
}

template <class P>
PlaceFeatures<P>::PlaceFeatures(work::Arena& arena, const PlaceOptions& options)
    : capacity(options.features),
      descriptors(arena.alloc<Span<typename P::U32>>(
          "descriptors of places", kDescriptorWords * options.features * options.places)),
      signatures(arena.alloc<Span<typename P::U32>>("signatures of places",
                                                    kSignatureWords * options.places)),
      points(arena.alloc<Span<typename P::U16>>("points of places",
                                                3 * options.features * options.places)) {}

template <class P>
auto PlaceFeatures<P>::descriptors_of(typename P::I32 slot) const -> Span<typename P::U32> {
  using I32 = typename P::I32;
  const int each = kDescriptorWords * capacity;
  return descriptors.subspan(I32(slot * I32(each)), each);
}

template <class P>
auto PlaceFeatures<P>::points_of(typename P::I32 slot) const -> Span<typename P::U16> {
  using I32 = typename P::I32;
  const int each = 3 * capacity;
  return points.subspan(I32(slot * I32(each)), each);
}

template <class P>
auto PlaceFeatures<P>::signature_of(typename P::I32 slot) const -> Span<typename P::U32> {
  using I32 = typename P::I32;
  return signatures.subspan(I32(slot * I32(kSignatureWords)), kSignatureWords);
}

#define LEVIOSIM_INSTANTIATE(P)                                                     \
  template struct PlaceList<P>;                                                     \
  template struct PlaceFeatures<P>;                                                 \
  template void copy_places_in(work::Machine&, const PlaceList<P>&, PlaceList<P>&); \
  template void copy_places_out(work::Machine&, const PlaceList<P>&, PlaceList<P>&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
