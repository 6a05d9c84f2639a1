#include "tools/app/comparison/run_record.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/outputs/output_record.h"
#include "tools/app/comparison/record_source.h"
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

void check_format(const std::string& where, const Json& document, const char* format, int known) {
  if (document.value("format", "") != format)
    throw InputError(fmt::format("{}: no {}", where, format));
  const int version = document.value("version", 0);
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

RunRecord make_record(std::string name, const Manifest& manifest, const RunResult& run,
                      std::vector<StageParts> cycles) {
  RunRecord record{figures_of(run), std::move(name),
                   facts_of_manifest(manifest_json(manifest, run)), std::move(cycles)};
  name_stages(record);
  return record;
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
  const Json manifest = parse_json(manifest_file, files.at("manifest.json"));
  reading(manifest_file, "a manifest", [&] {
    check_format(manifest_file, manifest, "leviosim manifest", kManifestVersion);
    record.facts = facts_of_manifest(manifest);
  });
  const std::string statistics_file = where + "/stats.json";
  const Json statistics = parse_json(statistics_file, files.at("stats.json"));
  reading(statistics_file, "statistics", [&] {
    check_format(statistics_file, statistics, "leviosim statistics", kStatisticsVersion);
    add_statistics(statistics, record);
  });
  name_stages(record);
  const std::vector<RecordedFrame> frames = read_frames(at(kFramesFile), files.at(kFramesFile));
  if (std::ssize(frames) != record.facts.frames)
    throw InputError(fmt::format("{}/frames.csv: has {} frames; expected {}, as manifest.json says",
                                 where, frames.size(), record.facts.frames));
  const auto errors = files.find(kErrorsFile);
  complete(record, frames,
           errors == files.end() ? std::vector<PositionPair>()
                                 : read_positions(at(kErrorsFile), errors->second));
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
