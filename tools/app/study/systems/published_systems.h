// Low-power systems that estimate motion, as they were published:
// tools/app/validation/published/systems.csv, which is part of the program. Columns: system, year,
// class, chip, frames_per_s, power_mw, bound ("at most", or empty), workload (profiles of LEVIO,
// apart by blanks, or "flow"; empty: not modelled), platform, set (overrides of the platform, apart
// by blanks), absent (why it is not modelled), source.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace leviosim::tools {

struct PublishedSystem {
  std::string name;
  int year = 0;
  std::string kind;
  std::string chip;
  std::optional<double> frames_per_s;
  std::optional<double> power_mw;
  bool is_bound = false;               ///< the power is at most that
  std::vector<std::string> workloads;  ///< that are timed on its chip; none: not modelled
  std::string absent;                  ///< why it is not modelled, "an FPGA"
  std::string platform;
  std::vector<std::string> overrides;
  std::string source;

  /// mJ; absent if rate or power is.
  std::optional<double> frame_mj() const;
};

/// What `workload` says of the optical flow.
inline constexpr std::string_view kFlowWorkload = "flow";

/// @throws InputError with file and line
std::vector<PublishedSystem> parse_systems(const std::string& file, std::string_view text);

std::vector<PublishedSystem> published_systems();

}  // namespace leviosim::tools
