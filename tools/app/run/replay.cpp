#include "tools/app/run/replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "platform_models/loader/override.h"
#include "sim/base/error.h"
#include "sim/chip/accelerator.h"
#include "tools/app/run/simulate.h"
#include "tools/app/run/trace_source.h"

namespace leviosim::tools {
namespace {

bool has_values_of(const platform::ResolvedPlatform& a, const platform::ResolvedPlatform& b) {
  return std::equal(a.parameters.begin(), a.parameters.end(), b.parameters.begin(),
                    b.parameters.end(),
                    [](const platform::Parameter& x, const platform::Parameter& y) {
                      return x.path == y.path && x.value == y.value && x.unit == y.unit;
                    });
}

platform::ResolvedPlatform platform_in(const traces::WorkTrace& trace,
                                       const std::vector<std::string>& overrides) {
  return platform::resolve_platform_text(trace.name() + ", platform of the recording",
                                         trace.info().platform_yaml, overrides);
}

}  // namespace

void check_cores(const traces::WorkTrace& trace, const RunRequest& request) {
  const int recorded = trace.info().cores;
  const int most = request.platform.config.cluster.workers;
  if (recorded > most)
    throw InputError(fmt::format(
        "{}: its work was divided among {} cores; {} has {}, expected as many "
        "(cluster.workers={}), "
        "or work that is recorded for {}: run --record --cores {}, in a sweep base: {{ data: … }}",
        trace.name(), recorded, request.platform.name, most, recorded, most, most));
  if (request.cores != recorded)
    throw InputError(fmt::format(
        "{}: its work was divided among {} cores, and how a program divides its work among {} is "
        "not in it; replay with --cores {}, or record again with run --record --cores {}, in a "
        "sweep "
        "base: {{ data: … }}",
        trace.name(), recorded, request.cores, recorded, request.cores));
}

std::string shipped_chip(const traces::WorkTrace& trace) {
  const std::string& name = trace.info().platform;
  const std::vector<std::string> known = platform::platform_names();
  const bool is_shipped = std::find(known.begin(), known.end(), name) != known.end() &&
                          has_values_of(platform_in(trace, {}), platform::resolve_platform(name));
  return is_shipped ? name : std::string();
}

platform::ResolvedPlatform recorded_platform(const traces::WorkTrace& trace,
                                             const std::vector<std::string>& overrides) {
  if (platform::split_overrides(overrides).base)
    if (const std::string chip = shipped_chip(trace); !chip.empty())
      return platform::resolve_platform(chip, overrides);
  return platform_in(trace, overrides);
}

Replay replay(const traces::WorkTrace& trace, const RunRequest& request,
              const ProgressCallback& progress) {
  check_cores(trace, request);
  const auto begin = std::chrono::steady_clock::now();
  const sim::ChipConfig& chip = request.platform.config;
  TraceSource source(trace, chip.cluster.l1.size, chip.l2.size, sim::has_accelerators(chip),
                     sim::code_of(chip));
  Replay result;
  result.run = simulate_source(request, source, progress);
  result.run.host_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  result.frames = source.comparisons();
  result.recorded_l1 = recorded_platform(trace).config.cluster.l1.size;
  return result;
}

}  // namespace leviosim::tools
