// What may go well later with the same input: another process is in the way, or a disk is full. The
// program ends with a status of its own (COMMANDS.md), which schedulers try again on.
#pragma once

#include <cerrno>
#include <string>

#include "sim/base/error.h"

namespace leviosim::outputs {

class TryAgain : public InputError {
 public:
  using InputError::InputError;
};

/// @param error  of errno @throws TryAgain for a full disk, a quota or a file server that is away;
/// InputError for others
[[noreturn]] inline void fail_writing(int error, const std::string& message) {
  for (const int passing : {ENOSPC, EDQUOT, EIO, ESTALE, ETIMEDOUT, EAGAIN})
    if (error == passing) throw TryAgain(message);
  throw InputError(message);
}

}  // namespace leviosim::outputs
