/* The host's C headers ask for this list when the target has 32 bits. Nothing is missing. */
