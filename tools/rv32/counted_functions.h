// Included before everything else when the scenes are compiled for the host on counted scalars: the
// scopes of named functions charge what was counted to the function that is running, as the trace
// analysis does with instructions.
#pragma once

#include "sim/work/policy.h"

namespace leviosim::rv32 {

void enter_function(const char* name);
void leave_function();
/// Scenes are no calls.
bool is_scene(const char* name);

}  // namespace leviosim::rv32

namespace leviosim::work {

template <>
struct FunctionScope<true> {
  explicit FunctionScope(const char* name) {
    rv32::enter_function(name);
    if (!rv32::is_scene(name)) count(Op::Call);
  }
  ~FunctionScope() { rv32::leave_function(); }
  FunctionScope(const FunctionScope&) = delete;
  FunctionScope& operator=(const FunctionScope&) = delete;
};

}  // namespace leviosim::work
