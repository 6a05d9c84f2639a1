// Functions that the program for a target calls without the compiler of their callers seeing them:
// they lie in another source file, and nothing optimises across files
// (PARAMETERS.md#build-and-timers). So sizes that a caller knows are variables in them. The host's
// compiler is free, for it does not change what is counted.
#pragma once

#ifndef LEVIOSIM_TARGET_CALL
#define LEVIOSIM_TARGET_CALL
#endif
