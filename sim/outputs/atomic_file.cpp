#include "sim/outputs/atomic_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>

#include "sim/base/error.h"
#include "sim/outputs/file_system.h"

namespace leviosim::outputs {

void write_file_atomically(const std::filesystem::path& file, std::string_view contents) {
  const std::string shown = file.string();
  std::filesystem::path staging;
  Descriptor out;
  for (int k = 0; !out && (k == 0 || errno == EEXIST); ++k) {
    staging = file.parent_path() /
              fmt::format(".{}.partial-{}-{}", file.filename().string(), ::getpid(), k);
    out = Descriptor(::open(staging.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  }
  int error = out ? 0 : errno;
  if (out) {
    error = write_all(out.get(), contents);
    if (const int fault = out.close(); error == 0) error = fault;
    if (error == 0 && ::rename(staging.c_str(), file.c_str()) != 0) error = errno;
    if (error != 0) ::unlink(staging.c_str());
  }
  if (error != 0) throw InputError(fmt::format("{}: cannot be written: {}", shown, reason(error)));
}

}  // namespace leviosim::outputs
