#include "sim/events/frame_pool.h"

#include <new>
#include <utility>

#include "sim/base/threads.h"

namespace leviosim::sim {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kRecycle = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
constexpr bool kRecycle = false;
#else
constexpr bool kRecycle = true;
#endif
#else
constexpr bool kRecycle = true;
#endif

}  // namespace

constinit thread_local PooledFrame::Lists PooledFrame::lists_;

void PooledFrame::stop_recycling(void*) {
  lists_.largest = 0;
  lists_.ended = true;
  for (FreeBlock*& list : lists_.heads)
    while (list != nullptr) ::operator delete(std::exchange(list, list->next));
}

void PooledFrame::start_recycling() {
  static const base::AtThreadEnd at_thread_end(&stop_recycling);
  if (kRecycle && !lists_.ended && at_thread_end.set(&lists_)) lists_.largest = kLargest;
}

void* PooledFrame::allocate_slowly(std::size_t size) {
  start_recycling();
  // The whole size class, because the block may later serve any frame of it.
  return ::operator new(size > kLargest ? size : (size_class(size) + 1) * kGranule);
}

void PooledFrame::free_slowly(void* frame, std::size_t size) noexcept {
  start_recycling();
  if (size > lists_.largest) return ::operator delete(frame);
  FreeBlock*& list = lists_.heads[size_class(size)];
  list = new (frame) FreeBlock{list};
}

}  // namespace leviosim::sim
