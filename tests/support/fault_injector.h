// What fault_injector.cpp answers to a test.
#pragma once

#include <cstdint>

/// Of one command.
struct FaultAnswer {
  int wait_status = 0;       ///< of waitpid(2)
  std::uint64_t calls = 0;   ///< of the kind, up to the end of the command
  std::uint64_t failed = 0;  ///< of them
};
