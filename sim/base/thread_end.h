// What is given back when a thread of the host ends.
#pragma once

#include <pthread.h>

namespace leviosim::base {

/// One place in each thread. A thread_local object with a destructor needs memory in each thread
/// that uses it, without which the C library ends the program; this one does without.
class AtThreadEnd {
 public:
  /// @param give_back  called with what the thread has set, if anything
  explicit AtThreadEnd(void (*give_back)(void*))
      : made_(pthread_key_create(&key_, give_back) == 0) {}
  AtThreadEnd(const AtThreadEnd&) = delete;
  AtThreadEnd& operator=(const AtThreadEnd&) = delete;

  /// @param what  not null
  /// @returns false if it will not be given back
  [[nodiscard]] bool set(void* what) const { return made_ && pthread_setspecific(key_, what) == 0; }

 private:
  pthread_key_t key_{};
  bool made_;
};

}  // namespace leviosim::base
