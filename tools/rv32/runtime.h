// Output of the RV32 program (runtime.cpp).
#pragma once

namespace leviosim::rv32 {

/// To standard error.
void write_text(const char* text);

}  // namespace leviosim::rv32
