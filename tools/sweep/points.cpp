#include "tools/sweep/points.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <set>

#include "sim/check.h"
#include "sim/error.h"
#include "tools/cli/command_line.h"
#include "tools/cli/interrupts.h"
#include "tools/replay/replay.h"
#include "tools/run/run_options.h"
#include "tools/run/workload_overrides.h"
#include "tools/sweep/point_key.h"
#include "tools/sweep/sampling.h"
#include "traces/image_preparation.h"

namespace leviosim::tools {
namespace {

using Kind = SweepKey::Kind;

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
    point_.request.platform = file.resolve(with_prefix("platform.", false));
    const sim::ClusterConfig& cluster = point_.request.platform.config.cluster;
    point_.request.cores =
        has("cores") ? static_cast<int>(parse_whole("cores", text("cores"), 1, cluster.max_workers))
                     : cluster.workers;
    point_.identity += fmt::format("cores {}\n{}", point_.request.cores,
                                   canonical_text(file.schema(), point_.request.platform));
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
    point_.identity = fmt::format("trace {}\n", trace.sha256);
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
    point_.identity = fmt::format("data {}\nsize {}x{}\nseed {}\nprofile {}\n", data.sha256,
                                  request.image_size.width, request.image_size.height, request.seed,
                                  request.profile);
    const vio::Profile profile = profile_of(request);
    for (const vio::Parameter& p : vio::parameters())
      point_.identity += fmt::format("{} {}\n", p.name, value_text(p, p.get(profile)));
    take_chip(inputs_.platform(text("platform"), place_));
  }

  const SweepPlan& plan_;
  const SweepRow& settings_;
  SweepInputs& inputs_;
  platform::Place place_;
  ResolvedPoint point_;
};

PointParameter chip_parameter(const SweepPlan& plan, const SweepKey& key,
                              const platform::ResolvedPlatform& chip) {
  const auto it = std::find_if(chip.parameters.begin(), chip.parameters.end(),
                               [&](const auto& p) { return p.path == key.path; });
  if (it == chip.parameters.end()) return {key.name, {}, {}, {}};
  if (!key.is_number(plan.reference->schema())) return {key.name, it->value, {}, {}};
  const SweepNumber number =
      number_of(key, it->value + it->unit, *plan.reference, platform::Place{key.name});
  return {key.name, number.text(), number.value, number.unit};
}

PointParameter workload_value(const SweepKey& key, const RunRequest& request) {
  const double value = key.parameter->get(profile_of(request));
  return {key.name, value_text(*key.parameter, value), value, std::string(key.parameter->unit)};
}

/// What a key is where nothing sets it.
std::string unset(const SweepKey& key, const ResolvedPoint& point) {
  const RunRequest& r = point.request;
  if (key.kind == Kind::cores) return fmt::format("{}", r.cores);
  if (point.trace != nullptr) return {};
  if (key.kind == Kind::seed) return fmt::format("{}", r.seed);
  if (key.kind == Kind::profile) return r.profile;
  if (key.kind == Kind::size) return fmt::format("{}x{}", r.image_size.width, r.image_size.height);
  return {};
}

PointParameter parameter_of(const SweepPlan& plan, const SweepKey& key, const SweepRow& settings,
                            const ResolvedPoint& point) {
  if (key.kind == Kind::chip) return chip_parameter(plan, key, point.request.platform);
  if (key.kind == Kind::workload && point.trace == nullptr)
    return workload_value(key, point.request);
  const auto set = settings.find(key.name);
  const std::string text = set != settings.end() ? set->second : unset(key, point);
  if (key.kind == Kind::seed || key.kind == Kind::cores)
    return {key.name, text, platform::parse_number(text), {}};
  return {key.name, text, {}, {}};
}

std::string text_of(const SweepRow& row) {
  std::vector<std::string> parts;
  for (const auto& [name, value] : row) parts.push_back(fmt::format("{}={}", name, value));
  return fmt::format("{}", fmt::join(parts, " "));
}

/// Points of a group set what the base sets for all.
SweepRow with_base(SweepRow row, const SweepRow& base) {
  row.insert(base.begin(), base.end());
  return row;
}

}  // namespace

ResolvedPoint resolve(const SweepPlan& plan, const SweepRow& settings, SweepInputs& inputs,
                      const std::string& where) {
  return Resolver(plan, settings, inputs, where).resolve();
}

Expansion expand(const SweepPlan& plan, SweepInputs& inputs) {
  Expansion expansion;
  std::set<std::string> seen;
  for (const SweepGroup& group : plan.groups) {
    const std::vector<SweepRow> rows = rows_of(group);
    if (expansion.asked + rows.size() > kMostPoints)
      group.place.fail(fmt::format("gives more than {} points in all", kMostPoints));
    for (const SweepRow& row : rows) {
      throw_if_interrupted();
      ++expansion.asked;
      SweepPoint point;
      point.settings = with_base(row, plan.base);
      try {
        const ResolvedPoint resolved =
            resolve(plan, point.settings, inputs,
                    fmt::format("{}: point {}", group.place.where, text_of(row)));
        point.key = point_key(resolved.identity);
        if (!seen.insert(point.key).second) continue;
        for (const SweepKey& key : plan.keys)
          point.parameters.push_back(parameter_of(plan, key, point.settings, resolved));
      } catch (const InputError& error) {
        if (!plan.skip_impossible) throw;
        expansion.impossible.emplace_back(error.what());
        continue;
      }
      point.number = static_cast<int>(expansion.points.size()) + 1;
      expansion.points.push_back(std::move(point));
    }
  }
  if (expansion.points.empty())
    throw InputError(fmt::format("{}: no point of the plan is possible: {}", plan.file,
                                 expansion.impossible.front()));
  return expansion;
}

std::string settings_text(const SweepPoint& point) {
  std::vector<std::string> parts;
  for (const PointParameter& p : point.parameters)
    parts.push_back(fmt::format("{}={}", p.name, p.text));
  return fmt::format("{}", fmt::join(parts, " "));
}

}  // namespace leviosim::tools
