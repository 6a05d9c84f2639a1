// Threads of the host: independent jobs on several of them, and what is given back when one ends.
#pragma once

#include <pthread.h>

#include <cstddef>
#include <functional>

namespace leviosim::base {

/// Calls job(0) ... job(count - 1) on `threads` threads (0: as many as the host has) and returns
/// when all are done. Which thread runs which job is left to chance, so jobs must not depend on it.
/// The first exception stops the hand-out of jobs and is thrown again here, and
/// so does Interrupted (sim/base/interruption.h), which is asked for before every job.
void parallel_for(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& job);

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
