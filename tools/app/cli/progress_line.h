// Progress on stderr: one line that is rewritten if stderr is a terminal, else ten lines in all, so
// that logs stay short. stdout is left to results. A stderr that cannot be written is no fault.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

namespace leviosim::tools {

class ProgressLine {
 public:
  enum class Style { None, Lines, Rewritten };

  /// What suits stderr; nothing if `quiet`.
  static Style style_of_stderr(bool quiet);

  explicit ProgressLine(Style style);
  /// Leaves a clean line behind.
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Shows `text` if it is time to: several times a second on a terminal, else at every tenth, and
  /// the first of a thousand or more.
  void show(std::int64_t done, std::int64_t total, const std::function<std::string()>& text);
  /// Removes the rewritten line.
  void clear();

  double host_seconds() const;

 private:
  using Clock = std::chrono::steady_clock;

  Style style_;
  Clock::time_point begin_;
  Clock::time_point last_shown_;
  std::int64_t last_tenth_ = 0;
  bool has_begun_ = false;
  bool visible_ = false;
};

/// "0:01:13"
std::string duration_text(double seconds);

/// " · done in 0:01:13", if the rest takes as long as what is done; empty before the first and
/// after the last.
std::string time_left_text(std::int64_t done, std::int64_t total, double host_seconds);

/// "frame 123/300 · simulated 6.15 s · 42 frames/s · done in 0:00:04"
std::string frame_progress(std::int64_t done, std::int64_t total, std::int64_t simulated_ns,
                           double host_seconds);

}  // namespace leviosim::tools
