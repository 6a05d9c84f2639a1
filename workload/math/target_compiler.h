// Functions that the program for a target calls without the compiler of their callers seeing them:
// they lie in another source file, and nothing optimises across files
// (PARAMETERS.md#build-and-timers). So sizes that a caller knows are variables in them. The host's
// compiler is free, for it does not change what is counted.
#pragma once

#include <cstring>

#ifndef LEVIOSIM_TARGET_CALL
#define LEVIOSIM_TARGET_CALL
#endif
/// Clears as memset does, with the target's C library, whose memset goes byte by byte.
#ifndef LEVIOSIM_TARGET_CLEAR
#define LEVIOSIM_TARGET_CLEAR std::memset
#endif
/// Before a loop whose steps are not written out one after the other. On the host neither: they are
/// too many for its registers.
#define LEVIOSIM_ROLLED _Pragma("GCC unroll 1")
/// After an assignment to a variable that has 8 bits in the program for the target: it is brought
/// into their range there and then. The host has 32 bits, whose sums it can vectorise.
#ifndef LEVIOSIM_TARGET_BYTE
#define LEVIOSIM_TARGET_BYTE(variable)
#endif
