// What the compilers of host and target are asked to do.
#pragma once

#include <cstring>

// Hints for the host's compiler alone. A target's compiler decides for itself (tools/rv32), so that
// the host's speed does not change the modelled code.

/// A function that is inlined, so that the compiler knows the sizes of a caller's matrices for
/// counted scalars too, whose code it takes for too large.
#ifndef LEVIOSIM_HOST_INLINE
#define LEVIOSIM_HOST_INLINE [[gnu::always_inline]] inline
#endif
/// After the parameters of a lambda that is to be inlined: `[&]() LEVIOSIM_HOST_INLINED { … }`.
#ifndef LEVIOSIM_HOST_INLINED
#define LEVIOSIM_HOST_INLINED __attribute__((always_inline))
#endif
/// A function that is compiled for wider vectors, too, which the program uses where the host has
/// them. Of whole numbers only: with others, every copy would have to round alike.
#ifndef LEVIOSIM_HOST_CLONES
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define LEVIOSIM_HOST_CLONES [[gnu::target_clones("avx2", "default")]]
#else
#define LEVIOSIM_HOST_CLONES
#endif
#endif
/// Whether host_value() (host_value.h) may compute in a way of the host's own.
#ifndef LEVIOSIM_HOST_SHORTCUTS
#define LEVIOSIM_HOST_SHORTCUTS 1
#endif

// Functions that the program for a target calls without the compiler of their callers seeing them:
// they lie in another source file, and nothing optimises across files
// (PARAMETERS.md#build-and-timers). So sizes that a caller knows are variables in them. The host's
// compiler is free, for it does not change what is counted.

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
