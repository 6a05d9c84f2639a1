// What the compilers of host and target are asked to do.
#pragma once

/// Hints for the host's compiler alone. A target's compiler decides for itself (tools/rv32), so
/// that the host's speed does not change the modelled code. A function that is inlined, so that the
/// compiler knows the sizes of a caller's matrices for counted scalars too, whose code it takes for
/// too large.
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
