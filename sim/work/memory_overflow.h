// Thrown where a block does not fit in an arena: what() names the stage, the block and the missing
// bytes.
#pragma once

#include "sim/base/error.h"

namespace leviosim::work {

class MemoryOverflow : public InputError {
 public:
  using InputError::InputError;
};

}  // namespace leviosim::work
