// Takes the place of sim/work/arena.h in the code compiled for RV32: the allocator that a target
// has, which moves a pointer up and, at the end of a frame, back. It keeps no names, peaks or
// lists, so the code around it is what an embedded program would run. Members that only the
// simulator's reports need answer with nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "sim/base/units.h"
#include "sim/work/memory.h"
#include "sim/work/program.h"

namespace leviosim::work {

/// Without the text, which only a report of the simulator shows.
class MemoryOverflow {
 public:
  MemoryOverflow(std::string_view, std::string_view, Bytes = Bytes(0)) {}
};

class Arena {
 public:
  Arena(std::string_view, Bytes capacity, int = 4)
      : top_(new std::byte[static_cast<std::size_t>(capacity.count())]),
        end_(top_ + capacity.count()) {}

  template <class Span>
  Span alloc(std::string_view, int n) {
    using T = std::remove_pointer_t<decltype(Span().data())>;
    std::byte* const at = top_;
    top_ += (static_cast<std::size_t>(n) * sizeof(T) + 3) & ~std::size_t{3};
    if (top_ > end_) __builtin_trap();
    return Span(reinterpret_cast<T*>(at), n);
  }

  class Frame {
   public:
    explicit Frame(Arena& arena) : arena_(&arena), top_(arena.top_) {}
    ~Frame() { arena_->top_ = top_; }
    Frame(const Frame&) = delete;
    Frame& operator=(const Frame&) = delete;

   private:
    Arena* arena_;
    std::byte* top_;
  };

  std::string_view name() const { return {}; }
  Bytes capacity() const { return free(); }
  Bytes used() const { return Bytes(0); }
  Bytes free() const { return Bytes(end_ - top_); }
  Bytes peak() const { return Bytes(0); }
  std::vector<Block> blocks_at_peak() const { return {}; }
  std::vector<Block> live() const { return {}; }
  void reset_peak() {}
  void set_user(std::string_view) {}
  int overflow(std::string_view, Bytes) const { __builtin_trap(); }

  /// Part `k` of `n` of the free memory.
  Arena lend(std::string_view, int n, int k) {
    const std::ptrdiff_t each = (end_ - top_) / n / 8 * 8;
    return Arena(top_ + each * k, top_ + each * (k + 1));
  }

 private:
  Arena(std::byte* begin, std::byte* end) : top_(begin), end_(end) {}

  std::byte* top_;
  std::byte* end_;
};

}  // namespace leviosim::work
