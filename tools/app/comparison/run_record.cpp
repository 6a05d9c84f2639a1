#include "tools/app/comparison/run_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/outputs/output_record.h"
#include "tools/app/cli/version.h"
#include "tools/app/report/json_reader.h"
#include "tools/app/report/statistics.h"
#include "tools/app/result/summary.h"

namespace leviosim::tools {
namespace {

/// f(), whose faults about JSON become one message.
template <class F>
auto reading(const std::string& where, const char* what, F&& f) {
  try {
    return f();
  } catch (const std::exception&) {
    throw InputError(fmt::format("{}: does not hold {} as leviosim writes it", where, what));
  }
}

/// JSON would round fractions and cut off digits.
template <class Whole>
void whole(const Json& number, Whole& value) {
  if (!number.is_number_integer()) throw std::out_of_range("no whole number");
  number.get_to(value);
  if (number != value) throw std::out_of_range("too large");
}

void check_format(const std::string& where, const Json& document, const char* format, int known) {
  if (document.value("format", "") != format)
    throw InputError(fmt::format("{}: no {}", where, format));
  int version = 0;
  if (document.contains("version") && document.at("version").is_number_integer())
    document.at("version").get_to(version);
  if (version != known)
    throw InputError(
        fmt::format("{}: {} of version {}; this leviosim reads version {}: run it again", where,
                    format, version, known));
}

std::vector<std::pair<std::string, std::string>> digests(const Json& inputs) {
  std::vector<std::pair<std::string, std::string>> list;
  for (const Json& input : inputs)
    list.emplace_back(input.at("name").get<std::string>(), input.at("sha256").get<std::string>());
  return list;
}

std::string camera_text(double rate, std::string_view deadline) {
  return fmt::format("{:g} frames/s, {}", rate, deadline);
}

/// What facts_of_manifest() would read from the manifest of this run.
RunFacts facts_of(const Manifest& manifest, const RunResult& run) {
  RunFacts facts;
  facts.program = fmt::format("{} {}", version(), revision());
  facts.profile = run.profile;
  facts.workload = manifest.workload;
  facts.seed = manifest.seed;
  if (run.timed) {
    facts.platform = manifest.platform;
    facts.overrides = manifest.overrides;
    facts.cores = run.cores;
  }
  if (run.camera) facts.camera = camera_text(run.camera->fps, info_of(run.camera->deadline).name);
  facts.image_width = run.image_width;
  facts.image_height = run.image_height;
  facts.first_frame = static_cast<std::int64_t>(manifest.first_frame);
  facts.frames = static_cast<std::int64_t>(expected_poses(run));
  if (!manifest.recording.is_null())
    facts.inputs = digests(manifest.recording.at("inputs"));
  else
    for (const InputDigest& input : manifest.inputs)
      facts.inputs.emplace_back(input.name, input.sha256);
  return facts;
}

RunFacts facts_of_manifest(const Json& m) {
  RunFacts facts;
  const Json& program = m.at("program");
  facts.program = fmt::format("{} {}", program.at("version").get<std::string>(),
                              program.at("revision").get<std::string>());
  m.at("profile").get_to(facts.profile);
  if (m.contains("workload")) m.at("workload").get_to(facts.workload);
  whole(m.at("seed"), facts.seed);
  if (const Json& platform = m.at("platform"); !platform.is_null()) {
    platform.at("name").get_to(facts.platform);
    platform.at("overrides").get_to(facts.overrides);
    whole(platform.at("cores"), facts.cores);
  }
  if (m.contains("camera")) {
    const Json& camera = m.at("camera");
    facts.camera = camera_text(camera.at("frames_per_second").get<double>(),
                               camera.at("deadline").get<std::string>());
  }
  whole(m.at("image").at("width"), facts.image_width);
  whole(m.at("image").at("height"), facts.image_height);
  whole(m.at("data").at("first_frame"), facts.first_frame);
  whole(m.at("data").at("frames"), facts.frames);
  // The work of a replay came from the data of its recording.
  facts.inputs = digests(m.contains("recording") ? m.at("recording").at("inputs") : m.at("inputs"));
  return facts;
}

/// "epnp_ransac" of "stages.epnp_ransac.calls" with the end ".calls"; empty for other names.
std::string stage_key(const std::string& name, std::string_view end) {
  constexpr std::string_view kStages = "stages.";
  if (name.rfind(kStages, 0) != 0 || name.size() <= kStages.size() + end.size()) return {};
  if (name.compare(name.size() - end.size(), end.size(), end) != 0) return {};
  std::string key = name.substr(kStages.size(), name.size() - kStages.size() - end.size());
  return key.find('.') == std::string::npos ? key : std::string();
}

/// Of a statistic that is a text.
void add_text(const std::string& name, const Json& value, RunFigures& run) {
  const std::string key = stage_key(name, ".runs_on");
  for (StageName& stage : run.stages)
    if (stage.key == key) stage.on_controller = value == "controller";
}

/// Adds the numbers of stats.json, and the stages that it names.
void add_statistics(const Json& document, RunFigures& run) {
  for (const Json& entry : document.at("statistics")) {
    const Json& value = entry.at("value");
    const auto text = [&](const char* key) { return entry.at(key).get<std::string>(); };
    const std::string name = text("name");
    if (value.is_string()) {
      add_text(name, value, run);
      continue;
    }
    if (std::string key = stage_key(name, ".calls"); !key.empty())
      run.stages.push_back({key, key, false});
    Statistic statistic{name, text("unit"), text("description"), {}};
    if (!value.is_null()) statistic.value = value.get<double>();
    run.statistics.push_back(std::move(statistic));
  }
}

/// @param names  of all stages; those of cycles.csv prevail
void name_stages(RunRecord& record, std::vector<std::string> names) {
  for (const StageParts& parts : record.cycles) names.push_back(parts.stage);
  for (StageName& stage : record.stages)
    for (const std::string& name : names)
      if (key_of(name) == stage.key) stage.name = name;
}

/// Of all stages, also of those that were never called.
std::vector<std::string> names_in(const std::string& file, const std::string& stages_csv) {
  constexpr const char* kTitle = "stage";
  const Json table = columns_json(read_csv(file, stages_csv),
                                  [](const std::string& title) { return title == kTitle; });
  std::vector<std::string> names;
  for (const Json& name : table.value(kTitle, Json::array()))
    if (name.is_string()) names.push_back(name.get<std::string>());
  return names;
}

/// @param bytes  of the file; null if it is missing
void check_recorded(const std::filesystem::path& file, const outputs::OutputRecord& record,
                    const std::string* bytes) {
  const std::string name = file.filename().string();
  const auto fail = [&](const std::string& found) {
    throw InputError(fmt::format("{}: {}; expected what {} says the run wrote", file.string(),
                                 found, outputs::kRecordName));
  };
  if (bytes == nullptr) {
    if (record.names(name)) fail("is missing");
    return;
  }
  const outputs::FileState state = outputs::state_of_bytes(*bytes);
  if (!record.says(name, state))
    fail(fmt::format("holds {} bytes of SHA-256 {:.12}...", state.size, state.sha256));
}

}  // namespace

const StageParts* RunRecord::stage_parts(std::string_view stage) const {
  const auto it = std::find_if(cycles.begin(), cycles.end(),
                               [&](const StageParts& s) { return s.stage == stage; });
  return it == cycles.end() ? nullptr : &*it;
}

RunRecord make_record(std::string name, const Manifest& manifest, const RunResult& run,
                      std::vector<StageParts> cycles) {
  return {figures_of(run), std::move(name), facts_of(manifest, run), std::move(cycles)};
}

RunFiles read_run_files(const std::filesystem::path& folder) {
  if (!base::exists(folder / "manifest.json") || !base::exists(folder / "stats.json"))
    throw InputError(fmt::format(
        "{}: no run folder; expected a folder that run or replay left, with manifest.json and "
        "stats.json",
        folder.string()));
  std::optional<outputs::OutputRecord> record = outputs::OutputRecord::read(folder);
  // Of other files that were written here later, such as a report.
  if (record && !record->names("manifest.json")) record.reset();
  RunFiles files;
  const auto read = [&](const char* name, bool needed) {
    const bool is_there = needed || base::exists(folder / name);
    if (is_there) files[name] = base::read_file(folder / name, base::InputKind::run_file);
    if (record) check_recorded(folder / name, *record, is_there ? &files[name] : nullptr);
  };
  for (const char* name : {"manifest.json", "stats.json", kFramesFile}) read(name, true);
  for (const char* name : {kCyclesFile, kStagesFile, kMemoryFile, kEnergyFile, kErrorsFile})
    read(name, false);
  return files;
}

RunRecord record_of_files(const std::string& where, const RunFiles& files) {
  const auto at = [&](const char* name) { return (std::filesystem::path(where) / name).string(); };
  RunRecord record;
  record.name = where;
  if (const auto file = files.find(kCyclesFile); file != files.end())
    record.cycles = parse_cycles(at(kCyclesFile), file->second);
  const std::string manifest_file = where + "/manifest.json";
  const Json manifest = read_json(manifest_file, files.at("manifest.json"));
  reading(manifest_file, "a manifest", [&] {
    check_format(manifest_file, manifest, "leviosim manifest", kManifestVersion);
    record.facts = facts_of_manifest(manifest);
  });
  const std::string statistics_file = where + "/stats.json";
  const Json statistics = read_json(statistics_file, files.at("stats.json"));
  reading(statistics_file, "statistics", [&] {
    check_format(statistics_file, statistics, "leviosim statistics", kStatisticsVersion);
    add_statistics(statistics, record);
  });
  const auto stages = files.find(kStagesFile);
  name_stages(record, stages == files.end() ? std::vector<std::string>()
                                            : names_in(at(kStagesFile), stages->second));
  const std::vector<RecordedFrame> frames = read_frames(at(kFramesFile), files.at(kFramesFile));
  if (std::ssize(frames) != record.facts.frames)
    throw InputError(fmt::format("{}/frames.csv: has {} frames; expected {}, as manifest.json says",
                                 where, frames.size(), record.facts.frames));
  complete(record, frames);
  return record;
}

RunRecord read_run_folder(const std::filesystem::path& folder) {
  return record_of_files(folder.string(), read_run_files(folder));
}

Json facts_json(const RunFacts& facts) {
  Json json;
  if (facts.measured) json["measured"] = true;
  json["program"] = facts.program;
  json["profile"] = facts.profile;
  if (!facts.workload.empty()) json["workload"] = facts.workload;
  json["seed"] = facts.seed;
  json["platform"] = facts.platform;
  json["overrides"] = facts.overrides;
  json["cores"] = facts.cores;
  if (!facts.camera.empty()) json["camera"] = facts.camera;
  json["image"] = {facts.image_width, facts.image_height};
  json["first_frame"] = facts.first_frame;
  json["frames"] = facts.frames;
  json["inputs"] = Json::object();
  for (const auto& [name, sha256] : facts.inputs) json["inputs"][name] = sha256;
  return json;
}

RunFacts facts_of_json(const std::string& where, const Json& json) {
  return reading(where, "the facts of a run", [&] {
    RunFacts facts;
    facts.measured = json.value("measured", false);
    json.at("program").get_to(facts.program);
    json.at("profile").get_to(facts.profile);
    if (json.contains("workload")) json.at("workload").get_to(facts.workload);
    whole(json.at("seed"), facts.seed);
    json.at("platform").get_to(facts.platform);
    json.at("overrides").get_to(facts.overrides);
    whole(json.at("cores"), facts.cores);
    facts.camera = json.value("camera", "");
    whole(json.at("image").at(0), facts.image_width);
    whole(json.at("image").at(1), facts.image_height);
    whole(json.at("first_frame"), facts.first_frame);
    whole(json.at("frames"), facts.frames);
    for (const auto& [name, sha256] : json.at("inputs").items())
      facts.inputs.emplace_back(name, sha256.get<std::string>());
    return facts;
  });
}

}  // namespace leviosim::tools
