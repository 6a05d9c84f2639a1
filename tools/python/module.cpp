// The Python module leviosim._core: what the commands do, in the process of the interpreter. The
// package around it (leviosim/__init__.py) makes arrays and dictionaries of the files that come
// back, which are those that the commands write.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>

#include "platform_models/loader/loader.h"
#include "sim/base/error.h"
#include "sim/base/sha256.h"
#include "sim/energy/area.h"
#include "tools/app/budget/check.h"
#include "tools/app/budget/check_report.h"
#include "tools/app/cli/version.h"
#include "tools/app/comparison/comparability.h"
#include "tools/app/comparison/comparison.h"
#include "tools/app/comparison/comparison_files.h"
#include "tools/app/record/record.h"
#include "tools/app/record/statistics.h"
#include "tools/app/report/area_table.h"
#include "tools/app/report/run_summary.h"
#include "tools/app/run/recording_source.h"
#include "tools/app/run/replay.h"
#include "tools/app/run/replay_report.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_session.h"
#include "tools/app/run/simulate.h"
#include "tools/app/run/workload.h"
#include "tools/app/study/whatif/whatif.h"
#include "tools/app/study/whatif/whatif_report.h"
#include "traces/trajectories/trajectory_file.h"

namespace leviosim::tools {
namespace {

namespace py = pybind11;

/// Between two frames: Ctrl-C, and the caller's function of frames done and frames in all. The lock
/// of the interpreter is held only here.
/// @param callback  outlives the result, which may be copied without that lock
ProgressCallback watched(const py::object& callback) {
  return [&callback](const Progress& p) {
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!callback.is_none()) callback(p.done, p.total);
  };
}

/// Files by name; those that are no text as bytes.
py::dict as_dict(const std::map<std::string, std::string>& files) {
  py::dict all;
  for (const auto& [name, text] : files)
    if (name == kWorkTraceFile)
      all[py::str(name)] = py::bytes(text);
    else
      all[py::str(name)] = text;
  return all;
}

/// Of `leviosim run`, by the names of its options.
RunOptions run_options(const py::dict& words) {
  RunOptions options;
  options.quiet = true;
  for (const auto& [key, value] : words) {
    const auto name = key.cast<std::string>();
    const auto text = [&](std::string& to) { to = value.cast<std::string>(); };
    if (name == "platform")
      text(options.platform);
    else if (name == "set")
      options.overrides = value.cast<std::vector<std::string>>();
    else if (name == "data")
      text(options.data);
    else if (name == "profile")
      text(options.profile);
    else if (name == "frames")
      text(options.frames);
    else if (name == "cores")
      text(options.cores);
    else if (name == "seed")
      text(options.seed);
    else if (name == "size")
      text(options.size);
    else if (name == "fps")
      text(options.camera_fps);
    else if (name == "deadline")
      text(options.deadline);
    else if (name == "initial_delay")
      text(options.initial_delay);
    else if (name == "online")
      options.online = value.cast<bool>();
    else if (name == "native")
      options.native = value.cast<bool>();
    else if (name == "record")
      options.record = value.cast<bool>();
    else
      throw InputError(fmt::format("run: there is no option '{}'", name));
  }
  return options;
}

std::map<std::string, std::string> files_of_run(RunResult result, const Manifest& manifest,
                                                const RunRequest& request) {
  const RunFolder folder =
      run_folder("", std::make_shared<const RunResult>(std::move(result)), manifest,
                 request.native ? std::string() : platform::to_yaml(request.platform));
  std::map<std::string, std::string> files;
  for (const auto& [name, content] : files_of(folder))
    content.hand_to([&text = files[name]](std::string_view piece) { text += piece; });
  return files;
}

py::dict run(const py::dict& words, const py::object& progress) {
  RunOptions options = run_options(words);
  set_run_defaults(options);
  std::map<std::string, std::string> files;
  {
    const ProgressCallback watch = watched(progress);
    const py::gil_scoped_release unlocked;
    RunRequest request = make_request(options);
    request.data = data_folder(options, ProgressLine::Style::None);
    request.time_bands = TimeBandsOf::team;
    WorkRecording recording(request.cores);
    if (options.record) request.recording = &recording;
    const RunResult result = simulate(request, watch);
    const Manifest manifest = make_manifest(options, request, {"python"});
    files = files_of_run(result, manifest, request);
    if (options.record)
      files[kWorkTraceFile] = work_trace_of(std::move(recording), options, request, manifest);
  }
  return as_dict(files);
}

/// @param bytes  of a work trace; `name` is for messages
py::dict replay_bytes(const std::string& name, const py::bytes& bytes, const std::string& platform,
                      const std::vector<std::string>& set, const py::object& progress) {
  RunOptions options;
  options.platform = platform;
  options.overrides = set;
  std::map<std::string, std::string> files;
  std::string content = bytes;
  {
    const ProgressCallback watch = watched(progress);
    const py::gil_scoped_release unlocked;
    const InputDigest digest{name, static_cast<std::int64_t>(content.size()),
                             base::sha256_of(content)};
    const traces::WorkTrace trace(name, std::move(content));
    RunRequest request = replay_request(trace, options);
    request.time_bands = TimeBandsOf::team;
    const Replay result = replay(trace, request, watch);
    if (options.platform.empty()) options.platform = trace.info().platform;
    files = files_of_run(result.run, replay_manifest(trace, digest, options, {"python"}), request);
    files[kReplayFile] = replay_csv(result);
  }
  return as_dict(files);
}

/// The table of `leviosim whatif` as CSV.
std::string what_if(const std::string& name, const py::bytes& bytes,
                    const std::vector<std::string>& changes, unsigned threads) {
  std::string content = bytes;
  const py::gil_scoped_release unlocked;
  SweepInputs inputs(std::filesystem::current_path(), ProgressLine::Style::None);
  inputs.keep_trace(name, std::move(content));
  WhatIf asked(inputs, name, {});
  std::vector<Variant> variants;
  for (const std::string& change : changes)
    for (Variant& variant : asked.variants(change)) variants.push_back(std::move(variant));
  if (changes.empty()) variants = asked.standard_variants();
  return csv_text(whatif_rows(asked.results(variants, {.noun = "variant", .threads = threads})));
}

/// Statistics of an estimate against the truth, both files or folders as `leviosim eval` takes
/// them.
std::string evaluate_files(const std::string& estimate, const std::string& truth,
                           const std::string& align, const std::vector<double>& lengths_m) {
  const py::gil_scoped_release unlocked;
  const traces::TrajectoryPair pair = traces::read_pair(estimate, truth);
  const traces::Evaluation evaluation = traces::evaluate(
      pair.estimate.poses, pair.truth.poses,
      {.alignment = traces::parse_alignment(align), .stamps = pair.estimate.stamps});
  StatisticList list;
  add_ate(list, evaluation, traces::attitude_errors(evaluation));
  for (const double length : lengths_m)
    add_relative(list, evaluation, traces::relative_errors(evaluation, length));
  return json_text(statistics_json(list.rows()));
}

/// "leviosim compare --format json" of two runs. @param allow  as --allow
std::string compare_records(const std::string& a, const std::string& b, const std::string& allow) {
  const py::gil_scoped_release unlocked;
  RunRecord before = parse_record("a", a, Level::all);
  RunRecord after = parse_record("b", b, Level::all);
  before.name = "a";
  after.name = "b";
  return json_text(comparison_json(
      compare_runs(before, after, check_comparable(before, after, parse_allowed(allow)))));
}

/// What a budget says of a run. @param baseline  text of a record; empty: none
std::string check_record(const std::string& run, const std::string& budget,
                         const std::string& baseline) {
  const py::gil_scoped_release unlocked;
  const RunRecord record = parse_record("run", run, Level::all);
  const Budget limits = read_budget(budget);
  std::optional<RunRecord> before;
  if (!baseline.empty()) before = parse_record("baseline", baseline, Level::all);
  return json_text(check_json(check_budget(record, limits, before ? &*before : nullptr, nullptr)));
}

py::list parameters_of(const platform::ResolvedPlatform& chip) {
  py::list rows;
  for (const platform::Parameter& p : chip.parameters) {
    py::dict row;
    row["path"] = p.path;
    row["value"] = p.value;
    row["unit"] = p.unit;
    row["source"] = p.source;
    row["confidence"] = p.confidence;
    row["low"] = p.range ? py::cast(p.range->low) : py::none();
    row["high"] = p.range ? py::cast(p.range->high) : py::none();
    row["description"] = p.description;
    rows.append(std::move(row));
  }
  return rows;
}

py::list workload_parameters(const std::string& profile) {
  RunRequest request;
  request.profile = profile;
  py::list rows;
  for (const vio::Parameter& p : vio::parameters()) {
    if (!vio::has_parameter(profile, p)) continue;
    py::dict row;
    row["name"] = std::string(p.name);
    row["value"] = vio::value_text(p, value_of(request, p));
    row["unit"] = std::string(p.unit);
    row["low"] = p.low;
    row["high"] = p.high;
    row["description"] = std::string(p.description);
    rows.append(std::move(row));
  }
  return rows;
}

}  // namespace
}  // namespace leviosim::tools

PYBIND11_MODULE(_core, m) {
  using namespace leviosim;
  namespace py = pybind11;
  py::register_exception<InputError>(m, "InputError", PyExc_ValueError);
  m.attr("version") = std::string(tools::version());
  py::class_<platform::ResolvedPlatform>(m, "Platform")
      .def(py::init([](const std::string& name, const std::vector<std::string>& set) {
        return platform::resolve_platform(name, set);
      }))
      .def_readonly("name", &platform::ResolvedPlatform::name)
      .def_readonly("description", &platform::ResolvedPlatform::description)
      .def("yaml", &platform::to_yaml)
      .def("parameters", &tools::parameters_of)
      .def("area_csv", [](const platform::ResolvedPlatform& p) {
        return sim::knows_area(p.config) ? tools::csv_text(tools::area_rows(p.config))
                                         : std::string();
      });
  m.def("platform_names", &platform::platform_names);
  m.def("profiles", [] {
    std::map<std::string, std::string> all;
    for (const std::string& name : vio::profile_names())
      all[name] = std::string(vio::profile_description(name));
    return all;
  });
  m.def("workload_parameters", &tools::workload_parameters);
  m.def("run", &tools::run);
  m.def("replay", &tools::replay_bytes);
  m.def("whatif_csv", &tools::what_if);
  m.def("compare_json", &tools::compare_records);
  m.def("check_json", &tools::check_record);
  m.def("evaluate_json", &tools::evaluate_files);
}
