// The timeline that a command was asked for: its options, and what the command does with it.
#pragma once

#include <optional>
#include <string>

#include "sim/outputs/output_file.h"
#include "sim/outputs/output_folder.h"
#include "tools/app/run/run_observer.h"
#include "tools/app/run/run_request.h"
#include "tools/app/timeline/perfetto_timeline.h"
#include "tools/app/timeline/timeline_collector.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

struct TimelineOptions {
  std::string file;
  std::string frames;
};

/// Declares --timeline and --timeline-frames.
void add_timeline_options(CLI::App& command, TimelineOptions& options);

class RequestedTimeline {
 public:
  /// Claims the file.
  /// @param results  what the command was asked to write else: a folder, in which the file is not
  /// @throws InputError for options that contradict the request, or a file that cannot be written
  RequestedTimeline(const TimelineOptions& options, const outputs::OutputRequest& results,
                    const RunRequest& request);

  /// To look on while the run happens.
  RunObserver& observer();
  /// Writes the file: a picture if its name ends in .svg. @throws InputError if that fails
  /// @param prints_name  with a line that tells its name; not where the printout is whole (JSON)
  void publish(const RunResult& run, bool prints_name);

 private:
  bool chosen_;  ///< its frames, since the user named none
  std::optional<outputs::OutputFile> file_;
  std::optional<TimelineCollector> picture_;  ///< events of what becomes a picture
  std::unique_ptr<outputs::Spool> spool_;     ///< of the file otherwise
  std::optional<PerfettoTimeline> timeline_;
};

/// None without --timeline. @throws InputError as RequestedTimeline, and for --timeline-frames
/// alone
std::optional<RequestedTimeline> requested_timeline(const TimelineOptions& options,
                                                    const outputs::OutputRequest& results,
                                                    const RunRequest& request);

}  // namespace leviosim::tools
