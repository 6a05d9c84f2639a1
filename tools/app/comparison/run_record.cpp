#include "tools/app/comparison/run_record.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/outputs/output_record.h"
#include "tools/app/comparison/frame_statistics.h"
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
  number.get_to(value);
  if (!number.is_number_integer() || number != value) throw std::out_of_range("no whole number");
}

void check_format(const std::string& where, const Json& document, const char* format, int newest) {
  if (document.value("format", "") != format)
    throw InputError(fmt::format("{}: no {}", where, format));
  const int version = document.value("version", 0);
  if (version < 1 || version > newest)
    throw InputError(
        fmt::format("{}: {} of version {}, which this leviosim does not know; "
                    "expected 1 to {}",
                    where, format, version, newest));
}

std::vector<std::pair<std::string, std::string>> digests(const Json& inputs) {
  std::vector<std::pair<std::string, std::string>> list;
  for (const Json& input : inputs)
    list.emplace_back(input.at("name").get<std::string>(), input.at("sha256").get<std::string>());
  return list;
}

std::string camera_text(const Json& camera) {
  return fmt::format("{:g} frames/s, {}", camera.at("frames_per_second").get<double>(),
                     camera.at("deadline").get<std::string>());
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
  if (m.contains("camera")) facts.camera = camera_text(m.at("camera"));
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
void add_text(const std::string& name, const Json& value, RunRecord& record) {
  const std::string key = stage_key(name, ".runs_on");
  for (StageName& stage : record.stages)
    if (stage.key == key) stage.on_controller = value == "controller";
}

void add_statistics(const Json& document, RunRecord& record) {
  for (const Json& entry : document.at("statistics")) {
    const Json& value = entry.at("value");
    const auto text = [&](const char* key) { return entry.at(key).get<std::string>(); };
    const std::string name = text("name");
    if (value.is_string()) {
      add_text(name, value, record);
      continue;
    }
    if (std::string key = stage_key(name, ".calls"); !key.empty())
      record.stages.push_back({key, key, false});
    Statistic statistic{name, text("unit"), text("description"), {}};
    if (!value.is_null()) statistic.value = value.get<double>();
    record.statistics.push_back(std::move(statistic));
  }
}

void name_stages(RunRecord& record) {
  for (StageName& stage : record.stages)
    for (const StageParts& parts : record.cycles)
      if (key_of(parts.stage) == stage.key) stage.name = parts.stage;
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

const Statistic* RunRecord::find(std::string_view statistic) const {
  const auto it = std::find_if(statistics.begin(), statistics.end(),
                               [&](const Statistic& s) { return s.name == statistic; });
  return it == statistics.end() ? nullptr : &*it;
}

std::optional<double> RunRecord::value(std::string_view statistic) const {
  const Statistic* found = find(statistic);
  return found == nullptr ? std::nullopt : found->value;
}

const StageParts* RunRecord::stage_parts(std::string_view stage) const {
  const auto it = std::find_if(cycles.begin(), cycles.end(),
                               [&](const StageParts& s) { return s.stage == stage; });
  return it == cycles.end() ? nullptr : &*it;
}

Json parse_json(const std::string& where, const std::string& text) {
  Json document = Json::parse(text, nullptr, false);  // takes a NUL for the end
  if (text.find('\0') != std::string::npos || document.is_discarded() || !document.is_object())
    throw InputError(fmt::format("{}: no JSON document", where));
  return document;
}

RunRecord record_of(const std::string& where, const Json& manifest, const Json& statistics,
                    const std::string& frames_csv, std::vector<StageParts> cycles) {
  RunRecord record;
  record.name = where;
  reading(where + "/manifest.json", "a manifest", [&] {
    check_format(where + "/manifest.json", manifest, "leviosim manifest", kManifestVersion);
    record.facts = facts_of_manifest(manifest);
  });
  reading(where + "/stats.json", "statistics", [&] {
    check_format(where + "/stats.json", statistics, "leviosim statistics", kStatisticsVersion);
    add_statistics(statistics, record);
  });
  record.cycles = std::move(cycles);
  name_stages(record);
  const std::int64_t rows = add_frame_statistics(where + "/frames.csv", frames_csv, record);
  if (rows != record.facts.frames)
    throw InputError(fmt::format("{}/frames.csv: has {} frames; expected {}, as manifest.json says",
                                 where, rows, record.facts.frames));
  add_memory_statistics(record);
  add_operations(record);
  return record;
}

RunRecord make_record(std::string name, const Manifest& manifest, const RunResult& run,
                      std::vector<StageParts> cycles) {
  return record_of(name, manifest_json(manifest, run), statistics(run), frames_csv(run),
                   std::move(cycles));
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
  std::vector<StageParts> cycles;
  if (const auto file = files.find(kCyclesFile); file != files.end())
    cycles = parse_cycles(std::filesystem::path(where) / kCyclesFile, file->second);
  return record_of(where, parse_json(where + "/manifest.json", files.at("manifest.json")),
                   parse_json(where + "/stats.json", files.at("stats.json")), files.at(kFramesFile),
                   std::move(cycles));
}

RunRecord read_run_folder(const std::filesystem::path& folder) {
  return record_of_files(folder.string(), read_run_files(folder));
}

Json facts_json(const RunFacts& facts) {
  Json json;
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
