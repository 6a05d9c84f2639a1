#include "tools/app/study/sweep/resolve.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "sim/base/error.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/run/replay.h"
#include "tools/app/run/run_options.h"
#include "tools/app/run/workload_overrides.h"
#include "traces/datasets/image_preparation.h"

namespace leviosim::tools {
namespace {

const std::string kPlatformPrefix = "platform.";

class Resolver {
 public:
  Resolver(const SweepPlan& plan, const SweepRow& settings, SweepInputs& inputs,
           const std::string& where)
      : plan_(plan), settings_(settings), inputs_(inputs), place_{where} {}

  ResolvedPoint resolve() {
    if (has("trace") == has("data"))
      place_.fail(has("trace") ? "has a trace and data; expected one of them"
                               : "has neither trace nor data; expected one of them");
    try {
      if (has("trace"))
        take_recording();
      else
        take_data();
    } catch (const InputError& error) {
      const std::string what = error.what();
      if (what.starts_with(place_.where)) throw;
      place_.fail(what);
    }
    point_.identity = identity_of(point_, point_.chip->schema());
    return std::move(point_);
  }

 private:
  bool has(const std::string& name) const { return settings_.count(name) > 0; }
  std::string text(const std::string& name, const std::string& otherwise = {}) const {
    const auto it = settings_.find(name);
    return it == settings_.end() ? otherwise : it->second;
  }
  std::vector<std::string> with_prefix(std::string_view prefix, bool keep) const {
    std::vector<std::string> found;
    for (const auto& [name, value] : settings_)
      if (name.starts_with(prefix))
        found.push_back(fmt::format("{}={}", keep ? name : name.substr(prefix.size()), value));
    return found;
  }

  void take_chip(platform::PlatformFile& file) {
    point_.chip = &file;
    point_.overrides = with_prefix(kPlatformPrefix, false);
    point_.request.platform = file.resolve(point_.overrides);
    const sim::ClusterConfig& cluster = point_.request.platform.config.cluster;
    point_.request.cores =
        has("cores") ? static_cast<int>(parse_whole("cores", text("cores"), 1, cluster.max_workers))
                     : cluster.workers;
  }

  void take_recording() {
    for (const auto& [name, value] : settings_)
      if (find_key(name, plan_.reference->schema(), place_).belongs_to_recording())
        place_.fail(
            fmt::format("{}: recorded work is that of a run as it was; expected data in place of "
                        "the trace",
                        name));
    SweepInputs::Trace& trace = inputs_.trace(text("trace"), place_);
    point_.trace = trace.work.get();
    point_.work = fmt::format("trace {}", trace.sha256);
    take_chip(has("platform") ? inputs_.platform(text("platform"), place_) : trace.platform);
    check_cores(*trace.work, point_.request);
  }

  void take_data() {
    if (!has("platform")) place_.fail("has no platform; expected one (leviosim platforms)");
    RunRequest& request = point_.request;
    const SweepInputs::Data& data = inputs_.data(text("data"), text("frames"), place_);
    request.data = data.folder;
    if (has("frames")) request.frames = traces::parse_frame_range(text("frames"));
    request.image_size = parse_size(text("size", "160x120"));
    traces::make_decimation(data.camera, request.image_size);
    request.profile = text("profile", "levio");
    request.seed = static_cast<std::uint32_t>(
        parse_whole("seed", text("seed", "1"), 0, std::numeric_limits<std::uint32_t>::max()));
    request.workload = parse_workload_overrides(with_prefix(vio::kParameterPrefix, true));
    profile_of(request);  // refuses parameters that contradict each other
    point_.work = data.work;
    take_chip(inputs_.platform(text("platform"), place_));
  }

  const SweepPlan& plan_;
  const SweepRow& settings_;
  SweepInputs& inputs_;
  platform::Place place_;
  ResolvedPoint point_;
};

}  // namespace

ResolvedPoint resolve(const SweepPlan& plan, const SweepRow& settings, SweepInputs& inputs,
                      const std::string& where) {
  return Resolver(plan, settings, inputs, where).resolve();
}

}  // namespace leviosim::tools
