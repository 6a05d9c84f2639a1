// Blocks that lie in the memory behind (L2 behind L1, external memory behind L2) and pass through
// local memory in tiles: two buffers a block, of which the DMA fills one while the cores work on
// the other. What is computed goes back the same way. Where two have no room, one will do, and
// nothing hides.
//
// How much passes is a closed formula: every item of the plan once, and those within its reach once
// more for each tile that has them beside its own. Left out: tiles of more than one dimension.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>
#include <tuple>
#include <utility>

#include "sim/work/machine.h"

namespace leviosim::work {

/// Items [begin, end) to work on, for which the items [first, last) are there.
struct Tile {
  int begin, end;
  int first, last;

  int size() const { return end - begin; }
  int items() const { return last - first; }
};

/// Items [begin, end) of `all` in tiles of `each`, the last may have fewer; every tile has `reach`
/// items more on either side, as far as there are any.
class TilePlan {
 public:
  /// @param buffers  for each block, two or one
  TilePlan(int begin, int end, int each, int reach, int all, int buffers = 2)
      : begin_(begin), end_(end), each_(each), reach_(reach), all_(all), buffers_(buffers) {}

  int buffers() const { return buffers_; }

  int count() const { return (end_ - begin_ + each_ - 1) / each_; }
  Tile operator[](int i) const {
    const int begin = begin_ + i * each_;
    const int end = std::min(begin + each_, end_);
    return {begin, end, std::max(0, begin - reach_), std::min(all_, end + reach_)};
  }
  /// Items that a buffer must hold.
  int most_items() const { return std::min(all_, each_ + 2 * reach_); }

 private:
  int begin_, end_, each_, reach_, all_, buffers_;
};

/// `n` items in the fewest tiles of about equal size of which two fit in the free space.
/// @param item   bytes of an item, of all blocks that pass together
/// @param block  the largest of them, for the message
/// @param kept   of the free space for others
/// @throws MemoryOverflow if not even one item fits
TilePlan plan_tiles(const Arena& arena, std::string_view block, int n, Bytes item,
                    Bytes kept = Bytes(0));

/// A block in L2, `each` elements an item.
template <class P, class T>
struct PassingBlock {
  std::string_view name;  ///< of a tile, in the memory table
  typename P::template Span<const T> in_l2;
  int each = 1;
  bool again = false;  ///< it passed before, or would be in local memory if that had room

  Bytes item() const { return Bytes(static_cast<std::int64_t>(sizeof(T)) * each); }
};

/// Two buffers, or one, into which tiles of a block are fetched.
template <class P, class T>
class TilesIn {
 public:
  using Span = typename P::template Span<T>;

  TilesIn(Machine& machine, const PassingBlock<P, T>& block, const TilePlan& plan) : block_(block) {
    buffers_[0] = machine.local().template alloc<Span>(block.name, plan.most_items() * block.each);
    buffers_[1] = plan.buffers() == 1 ? buffers_[0]
                                      : machine.local().template alloc<Span>(
                                            block.name, plan.most_items() * block.each);
  }
  void fetch(Machine& machine, int i, const Tile& tile) {
    const int n = tile.items() * block_.each;
    const Bytes bytes = block_.item() * tile.items();
    const Bytes more = block_.again ? bytes : block_.item() * (tile.items() - tile.size());
    under_way_ = machine.start_copy_in(view(i, tile),
                                       block_.in_l2.subspan(tile.first * block_.each, n), more);
    machine.note_tile(block_.name, bytes);
  }
  void wait(Machine& machine) { machine.wait(under_way_); }
  Span view(int i, const Tile& tile) const {
    return buffers_[static_cast<std::size_t>(i % 2)].subspan(0, tile.items() * block_.each);
  }

 private:
  PassingBlock<P, T> block_;
  std::array<Span, 2> buffers_;
  Machine::Ticket under_way_;
};

/// Two buffers, or one, whose contents go to L2 while the next are computed. Needs a finish() at
/// the end.
template <class P, class T>
class TilesOut {
 public:
  using Span = typename P::template Span<T>;

  /// @param again  a program with room would not have sent them
  TilesOut(Machine& machine, std::string_view name, int elements, bool again = false,
           int buffers = 2)
      : name_(name), again_(again), number_(buffers) {
    for (int b = 0; b < number_; ++b)
      buffers_[static_cast<std::size_t>(b)] = machine.local().template alloc<Span>(name, elements);
  }
  /// The buffer to compute the next tile in; the same again if nothing was sent.
  Span next(Machine& machine) {
    wait_for_slot(machine);
    return buffers_[slot()];
  }
  /// Sends what next() gave, as far as it fits in `in_l2`.
  void send(Machine& machine, Span in_l2) {
    const Bytes bytes(static_cast<std::int64_t>(sizeof(T)) * in_l2.size());
    under_way_[slot()] = machine.start_copy_out(in_l2, buffers_[slot()], again_ ? bytes : Bytes(0));
    is_under_way_[slot()] = true;
    machine.note_tile(name_, bytes);
    ++sent_;
  }
  void finish(Machine& machine) {
    for (int i = 0; i < 2; ++i, ++sent_) wait_for_slot(machine);
    sent_ = 0;
  }

 private:
  std::size_t slot() const { return static_cast<std::size_t>(sent_ % number_); }
  /// That what the buffer held is where it was sent.
  void wait_for_slot(Machine& machine) {
    if (!is_under_way_[slot()]) return;
    machine.wait(under_way_[slot()]);
    is_under_way_[slot()] = false;
  }

  std::string_view name_;
  bool again_;
  int number_;  ///< of buffers
  std::array<Span, 2> buffers_;
  std::array<Machine::Ticket, 2> under_way_;
  std::array<bool, 2> is_under_way_{};
  int sent_ = 0;
};

/// Calls work(i, tile, views…) for every tile, with a view of what was fetched of each block. Local
/// memory: the plan's buffers for each block.
template <class P, class Work, class... T>
void for_each_tile(Machine& machine, const TilePlan& plan, Work&& work,
                   const PassingBlock<P, T>&... blocks) {
  if (plan.count() == 0) return;
  const Arena::Frame memory(machine.local());
  std::tuple<TilesIn<P, T>...> tiles{TilesIn<P, T>(machine, blocks, plan)...};
  const auto fetch = [&](int i) {
    std::apply([&](auto&... in) { (in.fetch(machine, i, plan[i]), ...); }, tiles);
  };
  fetch(0);
  for (int i : P::range(0, plan.count())) {
    std::apply([&](auto&... in) { (in.wait(machine), ...); }, tiles);
    const bool more = i + 1 < plan.count();
    if (more && plan.buffers() == 2) fetch(i + 1);
    std::apply([&](auto&... in) { work(i, plan[i], in.view(i, plan[i])...); }, tiles);
    if (more && plan.buffers() == 1) fetch(i + 1);
  }
}

}  // namespace leviosim::work
