#include "tools/app/cli/progress_line.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "sim/base/printable.h"

namespace leviosim::tools {
namespace {

/// Of so many, the first is shown, too: a tenth may take minutes.
constexpr std::int64_t kManySteps = 1000;

constexpr std::chrono::milliseconds kBetweenRewrites{100};

constexpr const char* kErase = "\r\x1b[K";

}  // namespace

ProgressLine::Style ProgressLine::style_of_stderr(bool quiet) {
  if (quiet) return Style::None;
  return ::isatty(STDERR_FILENO) == 1 ? Style::Rewritten : Style::Lines;
}

ProgressLine::ProgressLine(Style style) : style_(style), begin_(Clock::now()) {}

ProgressLine::~ProgressLine() { clear(); }

void ProgressLine::show(std::int64_t done, std::int64_t total,
                        const std::function<std::string()>& text) {
  if (style_ == Style::None) return;
  if (style_ == Style::Lines) {
    const std::int64_t tenth = done * 10 / total;
    if (tenth == last_tenth_ && (has_begun_ || done == 0 || total < kManySteps)) return;
    has_begun_ = true;
    last_tenth_ = tenth;
    std::fputs((printable(text()) + '\n').c_str(), stderr);
    return;
  }
  const Clock::time_point now = Clock::now();
  if (done < total && now - last_shown_ < kBetweenRewrites) return;
  last_shown_ = now;
  visible_ = true;
  std::fputs((kErase + printable(text())).c_str(), stderr);
  std::fflush(stderr);
}

void ProgressLine::clear() {
  if (!visible_) return;
  visible_ = false;
  std::fputs(kErase, stderr);
  std::fflush(stderr);
}

double ProgressLine::host_seconds() const {
  return std::chrono::duration<double>(Clock::now() - begin_).count();
}

std::string duration_text(double seconds) {
  const auto whole = static_cast<std::int64_t>(seconds + 0.5);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string time_left_text(std::int64_t done, std::int64_t total, double host_seconds) {
  if (done <= 0 || done >= total || !(host_seconds > 0)) return {};
  const double left = static_cast<double>(total - done) / static_cast<double>(done);
  return fmt::format(" · done in {}", duration_text(left * host_seconds));
}

std::string frame_progress(std::int64_t done, std::int64_t total, std::int64_t simulated_ns,
                           double host_seconds) {
  std::string text = fmt::format("frame {}/{} · simulated {:.2f} s", done, total,
                                 static_cast<double>(simulated_ns) * 1e-9);
  if (host_seconds > 0)
    text += fmt::format(" · {:.0f} frames/s", static_cast<double>(done) / host_seconds);
  return text + time_left_text(done, total, host_seconds);
}

}  // namespace leviosim::tools
