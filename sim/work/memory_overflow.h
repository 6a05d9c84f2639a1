// Thrown where a block does not fit in an arena: what() names the stage, the block and the missing
// bytes.
#pragma once

#include <string>
#include <utility>

#include "sim/base/error.h"

namespace leviosim::work {

class MemoryOverflow : public InputError {
 public:
  /// @param memory  that is too small: "L1", "L2", or "scratch", a core's part of L1
  MemoryOverflow(const std::string& what, std::string memory)
      : InputError(what), memory_(std::move(memory)) {}
  const std::string& memory() const { return memory_; }

 private:
  std::string memory_;
};

}  // namespace leviosim::work
