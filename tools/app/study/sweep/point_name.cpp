#include "tools/app/study/sweep/point_name.h"

#include <fmt/format.h>

#include <optional>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/cli/version.h"
#include "tools/app/run/max_memory.h"
#include "tools/app/run/replay.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/run_session.h"
#include "tools/app/run/simulate.h"
#include "tools/app/study/sweep/plan.h"
#include "tools/app/study/sweep/points.h"
#include "tools/app/study/sweep/sweep_inputs.h"
#include "tools/app/study/sweep/sweep_store.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;

bool holds_sweep(const fs::path& folder) {
  refuse_old_sweep(folder);
  return base::is_file(folder / kSweepFile);
}

/// The place of a point in its plan. @throws InputError if there is no such point
std::size_t index_of(const PointName& name, std::int64_t planned) {
  const std::int64_t number =
      parse_whole(fmt::format("{}: point", name.text()), name.number, 1, planned);
  return static_cast<std::size_t>(number - 1);
}

/// Why a point cannot be computed as it was, and what helps.
[[noreturn]] void refuse(const PointName& name, const std::string& why) {
  throw InputError(fmt::format("{}: {}; run it again: leviosim sweep PLAN --out {} --force",
                               name.text(), why, name.sweep));
}

/// The plan of a sweep as it was run, with its points.
struct Swept {
  SweepInputs inputs;
  SweepPlan plan;
  Expansion expansion;

  Swept(const fs::path& file, const std::string& text, const RecordOptions& options)
      : inputs(file.parent_path(), ProgressLine::style_of_stderr(options.quiet),
               trace_memory(options.memory)),
        plan(parse_plan(file.string(), text, inputs)),
        expansion(expand(plan, inputs)) {}
};

Manifest manifest_of(const ResolvedPoint& point, const SweepRow& settings) {
  const bool recorded = point.trace != nullptr;
  Manifest manifest =
      recorded ? manifest_of_recording(*point.trace) : manifest_of_data(point.request);
  const auto platform = settings.find("platform");
  manifest.platform = platform != settings.end() ? platform->second : point.trace->info().platform;
  manifest.overrides = point.overrides;
  return manifest;
}

}  // namespace

std::optional<PointName> point_name(const std::string& text) {
  if (holds_sweep(text)) {
    const std::int64_t planned = SweepStore(fs::path(text)).planned();
    throw InputError(fmt::format("{}: is a sweep; expected one of its points: {}:1 to {}:{}", text,
                                 text, text, planned));
  }
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || base::exists(text)) return std::nullopt;
  PointName name{text.substr(0, colon), text.substr(colon + 1)};
  if (!holds_sweep(name.sweep)) return std::nullopt;
  return name;
}

RunFolder read_point(const PointName& name, const RecordOptions& options) {
  const SweepStore store{fs::path(name.sweep)};
  const std::size_t i = index_of(name, store.planned());
  const std::optional<fs::path> file = store.place();
  if (!file) refuse(name, "the sweep does not say where its plan lies");
  if (store.simulator() != results_version()) refuse(name, "the sweep is of another leviosim");
  Swept swept(*file, store.plan_text(), options);
  const std::vector<SweepPoint>& points = swept.expansion.points;
  if (!store.holds(points)) refuse(name, "what the plan names has changed since the sweep");
  const SweepRow settings = points[i].settings;
  const ResolvedPoint point = resolve(swept.plan, settings, swept.inputs, name.text());
  return computed_run(
      name.text(), point.request, manifest_of(point, settings),
      [&](const RunRequest& request, const ProgressCallback& progress) {
        return point.trace != nullptr ? replay(*point.trace, request, progress).run
                                      : simulate(request, progress);
      },
      options.quiet);
}

}  // namespace leviosim::tools
