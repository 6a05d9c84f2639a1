#include "tools/app/run/replay_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/base/printable.h"
#include "tools/app/run/replay.h"
#include "tools/app/run/trace_source.h"
#include "tools/app/table/json.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr std::size_t kMostRows = 10;

/// "busy", "begins", or "idle": what the optimiser does when a frame begins.
std::string_view optimiser_of(const FrameComparison::Start& start) {
  if (start.optimiser_busy) return "busy";
  return start.optimised ? "begins" : "idle";
}

bool newly_queued(const FrameComparison& frame) {
  return frame.replayed.waited_ns > 0 && frame.recorded.waited_ns == 0;
}

bool is_worth_a_row(const FrameComparison& frame) {
  return !frame.computes_the_same() || newly_queued(frame);
}

std::string seen_text(int seen) { return seen < 0 ? "none" : fmt::format("frame {}", seen); }

std::string ms(std::int64_t ns) { return fmt::format("{:.2f}", static_cast<double>(ns) * 1e-6); }

std::string differing_frames(const Replay& replay) {
  Table table({{"frame"},
               {"optimiser: recorded", kLeft},
               {"here", kLeft},
               {"result seen: recorded", kLeft},
               {"here", kLeft},
               {"waited ms: recorded"},
               {"here"}});
  std::size_t rows = 0;
  for (const FrameComparison& frame : replay.frames) {
    if (!is_worth_a_row(frame) || ++rows > kMostRows) continue;
    const FrameComparison::Start& a = frame.recorded;
    const FrameComparison::Start& b = frame.replayed;
    table.add({fmt::format("{}", frame.frame), std::string(optimiser_of(a)),
               std::string(optimiser_of(b)), seen_text(a.seen), seen_text(b.seen), ms(a.waited_ns),
               ms(b.waited_ns)});
  }
  if (rows == 0) return {};
  std::string text = terminal_text(table);
  if (rows > kMostRows) text += fmt::format("… and {} more in replay.csv\n", rows - kMostRows);
  return text;
}

}  // namespace

std::string replay_report(const Replay& replay, const traces::WorkTrace& trace) {
  const auto count = [&](auto&& predicate) {
    return std::count_if(replay.frames.begin(), replay.frames.end(), predicate);
  };
  const auto differs = [](const FrameComparison& f) { return !f.computes_the_same(); };
  const auto first = std::find_if(replay.frames.begin(), replay.frames.end(), differs);
  std::string text =
      fmt::format("replay of {}, recorded on {} with {} cores\n", printable(trace.name()),
                  printable(trace.info().platform), trace.info().cores);
  if (first == replay.frames.end())
    text +=
        "in every frame the algorithm sees what it saw in the recording: a run on this chip "
        "computes the same\n";
  else
    text += fmt::format(
        "a run on this chip computes something else from frame {} on; work and trajectory here are "
        "those of the recording\n"
        "  {} frames see another result of the optimiser\n"
        "  {} optimisations are left out, as the optimiser is still busy; {} might begin that were "
        "not recorded\n",
        first->frame, count([](const auto& f) { return f.sees_another_result(); }),
        count([](const auto& f) { return f.recorded.optimised && !f.replayed.optimised; }),
        count(
            [](const auto& f) { return f.recorded.optimiser_busy && !f.replayed.optimiser_busy; }));
  if (const auto queued = count(newly_queued); queued > 0)
    text += fmt::format("{} frames wait for the front end that did not in the recording\n", queued);
  if (replay.run.l1_size != replay.recorded_l1)
    text += fmt::format(
        "L1 has {} bytes instead of {}: the scratch of the cores lies elsewhere in it, but "
        "accesses "
        "that straddle words are those of the recording\n",
        replay.run.l1_size.count(), replay.recorded_l1.count());
  return text + differing_frames(replay) + '\n';
}

std::string replay_csv(const Replay& replay) {
  std::string text =
      "frame,same,recorded_optimiser,optimiser,recorded_seen_frame,seen_frame,recorded_waited_ns,"
      "waited_ns\n";
  for (const FrameComparison& f : replay.frames)
    text += fmt::format("{},{},{},{},{},{},{},{}\n", f.frame, f.computes_the_same() ? 1 : 0,
                        optimiser_of(f.recorded), optimiser_of(f.replayed), f.recorded.seen,
                        f.replayed.seen, f.recorded.waited_ns, f.replayed.waited_ns);
  return text;
}

Json recording_json(const traces::WorkTrace& trace, const std::string& sha256) {
  const traces::WorkTraceInfo& info = trace.info();
  Json json;
  json["trace_sha256"] = sha256;
  json["program"] = info.program;
  json["platform"] = info.platform;
  json["cores"] = info.cores;
  json["inputs"] = Json::array();
  for (const auto& [name, digest] : info.inputs) {
    Json& entry = json["inputs"].emplace_back(Json::object());
    entry["name"] = name;
    entry["sha256"] = digest;
  }
  return json;
}

}  // namespace leviosim::tools
