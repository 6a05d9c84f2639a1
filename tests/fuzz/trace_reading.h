// Reads a work trace to its end and runs some of its work on GAP9 with accelerators.
#pragma once

#include <string>

namespace leviosim::fuzz {

/// @param bytes         of the file; it may take 8 MiB of memory, so that small inputs meet the
/// limit
/// @param timed_frames  so many of its first frames are timed as a replay does
/// @throws InputError
void read_and_time(std::string bytes, int timed_frames);

}  // namespace leviosim::fuzz
