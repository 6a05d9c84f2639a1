// The optimiser's work memory: one record of Jacobian blocks per landmark (paper section IV.B,
// "Optimizer" in its memory table: up to 743.6 kB of L2).
//
// A record has a slot for each keyframe of the window, used for the landmark's observations in
// their order, and the landmark's own block:
//   per slot   2×6 derivative by the pose (rotation, position), 2×3 derivative by the landmark,
//              2 residuals: 80 bytes
//   at the end the inverse of the landmark's block of the normal equations (6, symmetric) and its
//              right-hand side (3): 36 bytes
// For 8 keyframes and 1000 landmarks 676 kB.
//
// They are walked twice an iteration: filled, and read for the landmarks' steps. Those that local
// memory has no room for lie in the memory behind it and pass in tiles (sim/work/tiles.h).
#pragma once

#include <algorithm>

#include "sim/work/tiles.h"
#include "workload/math/vec.h"

namespace leviosim::vio {

/// What memory of an arena is left beside what make() allocates.
template <class Make>
Bytes room_beside(work::Arena& arena, const Make& make) {
  const work::Arena::Frame frame(arena);
  [[maybe_unused]] const auto made = make();
  return arena.free();
}

template <class P>
class LandmarkRecords {
 public:
  using F = typename P::F32;
  using Span = typename P::template Span<F>;

  // Places in a slot.
  static constexpr int kByPose = 0;    ///< two rows of 6
  static constexpr int kByPoint = 12;  ///< two rows of 3
  static constexpr int kResidual = 18;
  static constexpr int kSlotFloats = 20;
  // Places in the landmark's own block.
  static constexpr int kInverse = 0;
  static constexpr int kRightHandSide = 6;
  static constexpr int kOwnFloats = 9;

  LandmarkRecords(work::Arena& arena, int landmarks, int keyframes)
      : floats_(floats_of(keyframes)),
        keyframes_(keyframes),
        resident_(landmarks),
        memory_(arena.alloc<Span>(kName, landmarks * floats_)) {}

  /// Of which some may lie behind the machine's local memory.
  /// @param room  that local memory has for them
  LandmarkRecords(work::Machine& machine, int landmarks, int keyframes, Bytes room)
      : floats_(floats_of(keyframes)), keyframes_(keyframes) {
    const Bytes each(static_cast<std::int64_t>(sizeof(float)) * floats_);
    const auto fitting =
        static_cast<int>(std::min<std::int64_t>(room.count() / each.count(), landmarks));
    resident_ = landmarks;
    if (fitting < landmarks && machine.behind().capacity() > Bytes(0)) {
      tile_ = std::max(1, fitting / kTilesInRoom);
      resident_ = std::max(0, fitting - 2 * tile_);
      behind_ = machine.behind().alloc<Span>(kName, (landmarks - resident_) * floats_);
    }
    memory_ = machine.local().alloc<Span>(kName, resident_ * floats_);
  }

  /// Calls use(records, begin, end) for all of the `n` records, a run of them at a time, which are
  /// there to be filled.
  /// @param kept  so many of them are read afterwards
  template <class Use>
  void fill(work::Machine& machine, int n, int kept, const Use& use) const {
    use(*this, 0, std::min(n, resident_));
    if (n <= resident_) return;
    const work::Arena::Frame memory(machine.local());
    work::TilesOut<P, F> out(machine, kTileName, tile_ * floats_, true);
    const work::TilePlan plan(resident_, n, tile_, 0, n);
    for (int i : P::range(0, plan.count())) {
      const work::Tile tile = plan[i];
      use(at(tile, out.next(machine)), tile.begin, tile.end);
      const int last = std::min(tile.end, kept);
      if (last > tile.begin)
        out.send(machine, behind_.subspan((tile.begin - resident_) * floats_,
                                          (last - tile.begin) * floats_));
    }
    out.finish(machine);
  }

  /// The same of records that have been filled.
  template <class Use>
  void read(work::Machine& machine, int n, const Use& use) const {
    use(*this, 0, std::min(n, resident_));
    const work::TilePlan plan(0, std::max(0, n - resident_), std::max(1, tile_), 0, n - resident_);
    work::for_each_tile<P>(
        machine, plan,
        [&](int, const work::Tile& t, Span records) {
          const work::Tile tile{t.begin + resident_, t.end + resident_, 0, 0};
          use(at(tile, records), tile.begin, tile.end);
        },
        work::PassingBlock<P, F>{kTileName, behind_, floats_, true});
  }

  /// Floats of a record.
  static int floats_of(int keyframes) { return keyframes * kSlotFloats + kOwnFloats; }
  Span record(int i) const { return memory_.subspan(place(i), floats_); }
  /// Slot of the j-th observation of landmark i.
  Span slot(int i, int j) const { return memory_.subspan(place(i) + j * kSlotFloats, kSlotFloats); }
  /// Landmark i's own block.
  Span own(int i) const { return memory_.subspan(place(i) + keyframes_ * kSlotFloats, kOwnFloats); }

  void store_inverse(int i, const Mat3<P>& inverse) const {
    const Span to = own(i);
    int at = kInverse;
    for (int r = 0; r < 3; ++r)
      for (int c = r; c < 3; ++c) to[at++] = inverse.m[r][c];
  }
  Mat3<P> inverse(int i) const {
    const Span from = own(i);
    const F xx = from[0], xy = from[1], xz = from[2], yy = from[3], yz = from[4], zz = from[5];
    return {{{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}};
  }

 private:
  static constexpr std::string_view kName = "landmark Jacobian records";
  static constexpr std::string_view kTileName = "tile of landmark Jacobian records";
  /// Two buffers of a tile take a quarter of the room: what stays does not travel.
  static constexpr int kTilesInRoom = 8;

  int place(int i) const { return (i - begin_) * floats_; }
  /// The records of a tile.
  LandmarkRecords at(const work::Tile& tile, Span memory) const {
    LandmarkRecords records = *this;
    records.begin_ = tile.begin;
    records.memory_ = memory;
    return records;
  }

  int floats_;
  int keyframes_;
  int begin_ = 0;     ///< number of the first in memory_
  int resident_ = 0;  ///< so many stay in local memory
  int tile_ = 0;
  Span memory_;
  Span behind_;  ///< the others
};

}  // namespace leviosim::vio
