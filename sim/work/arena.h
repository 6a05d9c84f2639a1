// Named stack allocator: how a workload occupies a memory of the chip.
//
// An arena keeps two books. *Offsets* are where a block lies in the modelled memory; they are
// packed to the arena's alignment (1 = no alignment, like a plain bump allocator, so that words may
// straddle and cost two accesses). *Host storage* is where the values live on the host, always
// aligned.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/units.h"
#include "sim/work/memory.h"
#include "sim/work/program.h"

namespace leviosim::work {

class MemoryOverflow;

class Arena {
 public:
  /// @param name       as shown to the user, e.g. "L1"
  /// @param capacity   what fits in the modelled memory
  /// @param alignment  of every block's offset, in bytes
  Arena(std::string_view name, Bytes capacity, int alignment = 4);

  /// Allocates `n` elements, uninitialised, named for the memory table. T must be trivial.
  /// @throws InputError naming stage, block and missing bytes if it does not fit.
  template <class Span>
  Span alloc(std::string_view name, int n) {
    using T = std::remove_pointer_t<decltype(Span().data())>;
    static_assert(std::is_trivial_v<T>);
    const Bytes offset = place(name, Bytes(static_cast<std::int64_t>(sizeof(T)) * n));
    const bool straddles = offset.count() % static_cast<std::int64_t>(sizeof(T)) != 0;
    return Span(reinterpret_cast<T*>(host(Bytes(static_cast<std::int64_t>(sizeof(T)) * n))), n,
                straddles);
  }

  /// Frees, at the end of its life, all that was allocated during it.
  class Frame {
   public:
    explicit Frame(Arena& arena)
        : arena_(&arena),
          blocks_(arena.live_.size()),
          used_(arena.used_),
          host_used_(arena.host_used_) {}
    ~Frame() {
      arena_->live_.resize(blocks_);
      arena_->used_ = used_;
      arena_->host_used_ = host_used_;
    }
    Frame(const Frame&) = delete;
    Frame& operator=(const Frame&) = delete;

   private:
    Arena* arena_;
    std::size_t blocks_;
    Bytes used_;
    Bytes host_used_;
  };

  std::string_view name() const { return name_; }
  Bytes capacity() const { return capacity_; }
  Bytes used() const { return used_; }
  Bytes free() const { return capacity_ - used_; }

  /// Peak since reset_peak(), and the blocks that were alive at it.
  Bytes peak() const { return peak_; }
  const std::vector<Block>& blocks_at_peak() const { return at_peak_; }
  void reset_peak();
  /// What the arena serves now, for error messages.
  void set_user(std::string_view stage) { user_ = stage; }

  const std::vector<Block>& live() const { return live_; }

  /// What is thrown where a block of this size does not fit into the free space.
  MemoryOverflow overflow(std::string_view block, Bytes size) const;

  /// Part `k` of `n` equal parts of the free space, as an arena of its own (the scratch of one core
  /// inside a fork). It borrows this arena's memory, which must not be allocated from meanwhile.
  Arena lend(std::string_view name, int n, int k);

 private:
  Arena(const Arena& lender, std::string_view name, Bytes offset, Bytes capacity, Bytes host_offset,
        Bytes host_capacity);
  Bytes place(std::string_view name, Bytes size);
  std::byte* host(Bytes size);
  std::byte* storage();

  std::string_view name_;
  std::string_view user_;
  Bytes capacity_;
  int alignment_;
  Bytes base_{0};  ///< offset of a lent arena inside the modelled memory
  Bytes used_{0};
  Bytes peak_{0};
  std::vector<Block> live_;
  std::vector<Block> at_peak_;
  std::unique_ptr<std::byte[]> owned_;
  std::byte* storage_ = nullptr;  ///< made when something is allocated
  Bytes host_capacity_{0};
  Bytes host_used_{0};
};

/// Thrown where a block does not fit in an arena: what() names the stage, the block and the missing
/// bytes.
class MemoryOverflow : public InputError {
 public:
  /// @param memory  that is too small: "L1", "L2", or "scratch", a core's part of L1
  MemoryOverflow(const std::string& what, std::string memory, Bytes missing = Bytes(0))
      : InputError(what), memory_(std::move(memory)), missing_(missing) {}
  const std::string& memory() const { return memory_; }
  /// Of the memory; 0 if that was not said.
  Bytes missing() const { return missing_; }

 private:
  std::string memory_;
  Bytes missing_;
};

}  // namespace leviosim::work
