#include "tools/app/cli/terminal.h"

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "sim/base/error.h"
#include "sim/base/interruption.h"

namespace leviosim::tools {
namespace {

/// Of a closed pipe the process dies quietly, as other programs do, once all is put in order.
[[noreturn]] void fail(int error) {
  if (error == EPIPE) throw_if_interrupted();
  throw InputError(
      fmt::format("stdout: cannot be written: {}", std::generic_category().message(error)));
}

}  // namespace

void print_result_text(std::string_view text) {
  const std::string safe = printable_lines(text);
  if (std::fwrite(safe.data(), 1, safe.size(), stdout) < safe.size()) fail(errno);
}

void flush_results() {
  if (std::fflush(stdout) != 0) fail(errno);
  if (std::ferror(stdout) != 0) fail(EIO);  // of an earlier write
}

void print_error(std::string_view message) {
  std::fputs(fmt::format("leviosim: {}\n", printable(message)).c_str(), stderr);
}

}  // namespace leviosim::tools
