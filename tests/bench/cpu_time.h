// Time of this thread on its core. Where other programs run too, ratios of such times hold, those
// of wall-clock times do not.
#pragma once

#include <ctime>

namespace leviosim {

inline double cpu_seconds() {
  std::timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace leviosim
