// Functions inlined on the host, so that its compiler knows the sizes of a caller's matrices for
// counted scalars too, whose code it takes for too large. A target's compiler decides for itself
// (tools/rv32), so that the host's speed does not change the modelled code.
#pragma once

#ifndef LEVIOSIM_HOST_INLINE
#define LEVIOSIM_HOST_INLINE [[gnu::always_inline]] inline
#endif
