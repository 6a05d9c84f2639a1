// Hints for the host's compiler alone. A target's compiler decides for itself (tools/rv32), so that
// the host's speed does not change the modelled code.
#pragma once

/// A function that is inlined, so that the compiler knows the sizes of a caller's matrices for
/// counted scalars too, whose code it takes for too large.
#ifndef LEVIOSIM_HOST_INLINE
#define LEVIOSIM_HOST_INLINE [[gnu::always_inline]] inline
#endif
/// Before a loop that is to be vectorised: if its steps were written out first, it would not be.
#ifndef LEVIOSIM_HOST_VECTORISED
#define LEVIOSIM_HOST_VECTORISED _Pragma("GCC unroll 1")
#endif
