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
struct CodeScope<true> {
  explicit CodeScope(CodeName name) { rv32::enter_function(name.text); }
  ~CodeScope() { rv32::leave_function(); }
  CodeScope(const CodeScope&) = delete;
  CodeScope& operator=(const CodeScope&) = delete;
};

template <>
struct FunctionScope<true> {
  explicit FunctionScope(CodeName name) : code_(name) {
    if (!rv32::is_scene(name.text)) count(Op::Call);
  }

 private:
  CodeScope<true> code_;
};

}  // namespace leviosim::work
