#include "tools/app/run/workload.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "platform_models/loader/parameter_units.h"
#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"
#include "sim/soc/job_timer.h"
#include "tools/app/cli/version.h"
#include "tools/app/run/feed.h"
#include "tools/app/run/live_source.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/workload_options.h"

namespace leviosim::tools {
namespace {

/// Written by add_workload() only.
std::map<std::string, Workload, std::less<>>& workloads() {
  static std::map<std::string, Workload, std::less<>> all;
  return all;
}

constexpr int kAlignment = 4;  // bytes, of blocks in L1

/// The frames of a data set, each of which a function computes; nothing runs on the controller.
class FrameByFrame : public RunSource {
 public:
  /// Both outlive the source.
  FrameByFrame(const Workload& workload, const RunRequest& request)
      : workload_(workload),
        request_(request),
        feed_(request),
        machine_(cluster_machine(request, kAlignment)),
        process_(workload.begin(request)) {}

  int frames() const override { return feed_.size(); }
  std::int64_t time_ns(int frame) const override { return feed_.time_ns(frame); }
  std::int64_t arrival_ns(int frame) const override { return feed_.arrival_ns(frame); }
  bool begin_frame(const soc::FrameStart& start) override {
    frame_ = start.frame;
    return false;
  }
  const work::Job& process(FrameResult& result) override {
    result.index = frame_;
    result.t_ns = result.pose.t_ns = feed_.time_ns(frame_);
    process_(machine_, feed_.frame(frame_), result);
    job_ = machine_.take_job();
    return job_;
  }
  int iterations() const override { return 0; }
  const work::Job& optimise() override { check_failed("this workload has no optimiser", {}); }
  void publish() override {}
  std::vector<StageResult> empty_stages() const override {
    return named_stages(stages_of(request_));
  }
  RunSubject subject() const override { return subject_of(workload_.name, feed_); }
  void describe(RunResult& result) const override {
    if (result.camera) result.camera->fps = feed_.rate_hz();
  }

 private:
  const Workload& workload_;
  const RunRequest& request_;
  Feed feed_;
  work::Machine machine_;
  FrameFunction process_;
  int frame_ = 0;  ///< begun last
  work::Job job_;
};

using vio::Parameter;

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const Parameter& p : vio::parameters()) all.emplace_back(p.name);
  return all;
}

double value_in(const RunRequest& request, const vio::Profile& profile,
                const vio::Parameter& parameter) {
  if (!parameter.is_of_another()) return parameter.get(profile);
  for (const vio::Assignment& a : request.workload)
    if (a.parameter == &parameter) return a.value;
  return parameter.initial;
}

}  // namespace

}  // namespace leviosim::tools

namespace leviosim {

Cycles cycles_on(const platform::ResolvedPlatform& chip,
                 const std::function<void(work::Machine&)>& body, int cores) {
  tools::RunRequest request;
  request.platform = chip;
  request.cores = cores > 0 ? cores : chip.config.cluster.workers;
  work::Machine machine(tools::cluster_machine(request, tools::kAlignment));
  body(machine);
  soc::JobTimer timer(chip.config, request.cores);
  return timer.front_end_cycles(timer.front_end(machine.take_job()));
}

}  // namespace leviosim

namespace leviosim::tools {

void add_workload(Workload workload) {
  check(workload.begin || workload.source, "a workload says how a run of it begins");
  vio::add_profile(workload);
  for (const platform::CodeTable& table : workload.code) platform::add_compiled_code(table);
  include_own_code(digest_of_file("/proc/self/exe").sha256);
  std::string name = workload.name;
  workloads().emplace(std::move(name), std::move(workload));
}

std::unique_ptr<RunSource> make_source(const RunRequest& request) {
  const auto it = workloads().find(request.profile);
  if (it == workloads().end()) return std::make_unique<LiveSource>(request);
  if (it->second.source) return it->second.source(request);
  return std::make_unique<FrameByFrame>(it->second, request);
}

double value_of(const RunRequest& request, const vio::Parameter& parameter) {
  return value_in(request, profile_of(request), parameter);
}

std::vector<double> parameter_values(const RunRequest& request) {
  const vio::Profile profile = profile_of(request);
  std::vector<double> values;
  for (const vio::Parameter& p : vio::parameters()) values.push_back(value_in(request, profile, p));
  return values;
}

double value_of(const RunRequest& request, std::string_view parameter) {
  const vio::Parameter* const found = vio::find_parameter(parameter);
  check(found != nullptr, "a parameter of this name");
  return value_of(request, *found);
}

std::vector<vio::StageName> stages_of(const RunRequest& request) {
  const vio::OtherProfile* const other = vio::other_profile(request.profile);
  if (other == nullptr) return vio::stage_names(profile_of(request));
  std::vector<vio::StageName> names;
  for (const std::string& name : other->stages) names.push_back({name, "frame", false});
  return names;
}

SplitOverrides split_overrides(const std::vector<std::string>& overrides) {
  SplitOverrides split;
  for (const std::string& text : overrides)
    (platform::trim(text).starts_with(vio::kParameterPrefix) ? split.workload : split.chip)
        .push_back(text);
  return split;
}

std::vector<vio::Assignment> parse_workload_overrides(const std::vector<std::string>& overrides) {
  std::vector<vio::Assignment> assignments;
  for (const std::string& text : overrides) {
    const std::string where = "-p " + text;
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos)
      throw InputError(where + ": expected path=value, such as workload.window=6");
    const Parameter& parameter =
        workload_parameter(where, std::string(platform::trim(text.substr(0, equals))));
    for (const vio::Assignment& other : assignments)
      if (other.parameter == &parameter)
        throw InputError(fmt::format("{}: '{}' is already given", where, parameter.name));
    assignments.push_back(
        {&parameter, parse_workload_value(where, parameter, text.substr(equals + 1))});
  }
  return assignments;
}

namespace {

/// "; profiles without it: levio-no-imu" of what is a part of a pipeline, such as "workload.imu".
std::string profiles_without(std::string_view name) {
  const std::string part = fmt::format("-no-{}", name.substr(name.rfind('.') + 1));
  std::string profiles;
  for (const std::string& profile : vio::profile_names())
    if (profile.find(part) != std::string::npos)
      profiles += fmt::format("{}{}", profiles.empty() ? "; profiles without it: " : ", ", profile);
  return profiles;
}

}  // namespace

const Parameter& workload_parameter(const std::string& where, const std::string& name) {
  const Parameter* const parameter = vio::find_parameter(name);
  if (parameter == nullptr)
    throw InputError(fmt::format("{}: the workload has no parameter '{}'{}{}", where, name,
                                 base::did_you_mean(name, names()), profiles_without(name)));
  return *parameter;
}

double parse_workload_value(const std::string& where, const Parameter& parameter,
                            const std::string& text) {
  const std::string_view value = platform::trim(text);
  const auto fail = [&] {
    throw InputError(fmt::format("{}: '{}' is no value of {}; expected {}", where, value,
                                 parameter.name, valid_values(parameter)));
  };
  if (parameter.kind == Parameter::Kind::toggle) {
    if (value != "off" && value != "on") fail();
    return value == "on" ? 1 : 0;
  }
  const std::optional<platform::Measure> measure = platform::split_measure(value);
  if (!measure || (!measure->unit.empty() && measure->unit != parameter.unit) ||
      !vio::is_valid(parameter, measure->number))
    fail();
  return measure->number;
}

std::string valid_values(const Parameter& parameter) {
  if (parameter.kind == Parameter::Kind::toggle) return "off or on";
  const std::string kind = parameter.kind == Parameter::Kind::whole ? "a whole number" : "a number";
  const std::string of = parameter.unit.empty() ? "" : fmt::format(" of {}", parameter.unit);
  return fmt::format("{}{} from {} to {}", kind, of, vio::value_text(parameter, parameter.low),
                     vio::value_text(parameter, parameter.high));
}

}  // namespace leviosim::tools
