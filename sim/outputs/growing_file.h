// Files that grow by lines, while other programs rename them, link them, or put others in their
// place: what is read and written is what was locked. A new file appears whole; to one that is
// there, lines are added at its end, all or nothing.
//
// Left out: programs that write without a lock, other than that nothing is written once they have
// changed the size or the name of the file.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "sim/base/opened_file.h"
#include "sim/outputs/file_system.h"

namespace leviosim::outputs {

/// Opens a file and locks it. Starts again where the name leads to another file by then.
/// @param flags  of open(2), besides O_CLOEXEC, O_NONBLOCK and O_NOCTTY
/// @param error  why there is no descriptor; EWOULDBLOCK: another process has the lock
/// @throws Interrupted while it waits
Descriptor open_locked(const std::filesystem::path& path, int flags,
                       std::chrono::milliseconds patience, int& error);

/// What is to become of the end of a file.
struct Addition {
  std::uint64_t whole = 0;  ///< bytes that stay; after them stands a line that lacks its end
  std::string lines;        ///< that come after them; empty: nothing is written
};

/// @param addition  from the file as it is under the lock; nothing if there is none. Called again
///                  where another process made, replaced or changed the file meanwhile
/// @throws InputError for other things of that name, for files with several names (a line would be
///         added to all of them), if others have it for too long, and if it cannot be written;
///         Interrupted; what `addition` throws
void add_lines(const std::filesystem::path& path, base::InputKind kind,
               std::chrono::milliseconds patience,
               const std::function<Addition(std::optional<base::OpenedFile>)>& addition);

}  // namespace leviosim::outputs
