#include "sim/kernel/frame_pool.h"

#include <new>

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

struct PooledFrame::ReturnAtThreadEnd {
  bool started = true;
  ~ReturnAtThreadEnd() {
    lists_.largest = 0;
    for (FreeBlock*& list : lists_.heads)
      while (list != nullptr) ::operator delete(std::exchange(list, list->next));
  }
};

void PooledFrame::start_recycling() {
  // The object is touched so that its destructor is registered; after that destructor has run it
  // must not be touched again, which `ended` (never destroyed) tells.
}

}  // namespace leviosim::sim
