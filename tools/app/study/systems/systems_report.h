// Published systems beside what leviosim predicts, as a table, as CSV and as a page with power
// over frame rate.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/energy/estimate.h"
#include "tools/app/html_report/page.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/run/run_request.h"
#include "tools/app/study/engine.h"
#include "tools/app/table/table_files.h"

namespace leviosim::tools {

// Low-power systems that estimate motion, as they were published:
// tools/app/validation/published/systems.csv, which is part of the program. Columns: system, year,
// class, chip, frames_per_s, power_mw, bound ("at most", or empty), workload (profiles of LEVIO,
// apart by blanks, or "flow"; empty: not modelled), platform, set (overrides of the platform, apart
// by blanks), absent (why it is not modelled), source.

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

// What leviosim predicts for published systems whose workload and chip it models: how many frames
// the chip could do, and what it takes at the published rate.
//
// Left out, as in all predictions here: camera, radio and the rest of the board.

struct Prediction {
  double most_frames_per_s = 0;  ///< that the chip could do
  /// At the published rate, the recorded one if that is lower, or what the chip can do.
  double frames_per_s = 0;
  std::optional<sim::Estimate<Watts>> power;  ///< none if the platform has no energy figures
  std::optional<sim::Estimate<Joules>> frame;
  std::string memory;  ///< "fits", or what is missing
};

/// A workload on the chip of a system; of a system that is not modelled, what was published.
struct SystemRow {
  PublishedSystem published;
  std::string workload = {};
  std::optional<Prediction> here = {};  ///< none if the system is not modelled
};

/// @param request   whose data, frames and seed all predictions are made with
/// @param progress  of the run of LEVIO
/// @throws InputError for data that cannot be used, Interrupted
std::vector<SystemRow> predict_systems(const std::vector<PublishedSystem>& systems,
                                       const RunRequest& request, const ProgressCallback& progress);

/// Milli-units in a unit: power is shown in mW, energy in mJ.
inline constexpr double kMilli = 1e3;

/// A row per system and workload, how to read it, and the sources.
std::string systems_table(const std::vector<SystemRow>& rows);

/// How many are modelled, and the one that takes the least energy per frame, in a sentence.
std::string systems_conclusion(const std::vector<SystemRow>& rows);

/// The rows of systems_table() with all digits, as CSV.
Table systems_rows(const std::vector<SystemRow>& rows);

/// The data of a page: power over frame rate, what was published and what is predicted, each as a
/// point. Systems without a rate or a power have none.
StudyPage systems_page(const std::vector<SystemRow>& rows);

}  // namespace leviosim::tools
