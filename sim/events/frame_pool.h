// Memory for coroutine frames: free lists by size class.
//
// A sub-coroutine (sim/events/task.h) allocates a frame at every call and frees it at its end, so
// that general-purpose malloc would cost more than the event itself. Frames of the same size class
// are recycled instead.
//
// The lists are thread_local and lie outside objects, as the tally of counted operations does
// (sim/work/counts.h): several simulations may run in several host threads, a frame's operator new
// has no place to carry a pool in, and nothing simulated can observe which block a frame gets. A
// frame freed in another thread than it was allocated in joins the lists of the thread that frees
// it. Each thread returns its lists to the system when it ends. With AddressSanitizer nothing is
// recycled, so that it sees every use after free.
#pragma once

#include <array>
#include <cstddef>
#include <new>

namespace leviosim::sim {

/// Base of promise types: allocates their coroutine frames.
class PooledFrame {
 public:
  static void* operator new(std::size_t size) {
    Lists& lists = lists_;
    if (size > lists.largest) return allocate_slowly(size);
    FreeBlock*& list = lists.heads[size_class(size)];
    if (list == nullptr) return allocate_slowly(size);
    FreeBlock* const block = list;
    list = block->next;
    return block;
  }

  static void operator delete(void* frame, std::size_t size) noexcept {
    Lists& lists = lists_;
    if (size > lists.largest) return free_slowly(frame, size);
    FreeBlock*& list = lists.heads[size_class(size)];
    list = new (frame) FreeBlock{list};
  }

 private:
  static constexpr std::size_t kGranule = 64;             // one cache line of the host
  static constexpr std::size_t kLargest = 32 * kGranule;  // larger frames are not recycled

  struct FreeBlock {
    FreeBlock* next;
  };
  /// `largest` is 0 before a thread's first frame and once it has ended: all then go the slow way.
  struct Lists {
    std::size_t largest = 0;
    bool ended = false;
    std::array<FreeBlock*, kLargest / kGranule> heads{};
  };

  static std::size_t size_class(std::size_t size) { return (size - 1) / kGranule; }
  static void* allocate_slowly(std::size_t size);
  static void free_slowly(void* frame, std::size_t size) noexcept;
  static void start_recycling();
  static void stop_recycling(void*);

  static constinit thread_local Lists lists_;
};

}  // namespace leviosim::sim
