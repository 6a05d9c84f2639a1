#include "tools/app/run/run_folder.h"

#include <fmt/format.h>

#include <optional>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/outputs/output_record.h"
#include "tools/app/cli/version.h"
#include "tools/app/record/statistics.h"
#include "tools/app/result/summary.h"
#include "tools/app/run/run_tables.h"
#include "traces/trajectories/trajectory.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;

/// Name → SHA-256 of the data; the work of a replay came from those of its recording.
std::vector<std::pair<std::string, std::string>> inputs_of(const Manifest& manifest) {
  std::vector<std::pair<std::string, std::string>> list;
  if (manifest.recording.is_null())
    for (const InputDigest& input : manifest.inputs) list.emplace_back(input.name, input.sha256);
  else
    for (const Json& input : manifest.recording.at("inputs"))
      list.emplace_back(input.at("name").get<std::string>(), input.at("sha256").get<std::string>());
  return list;
}

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
  if (run.camera)
    facts.camera =
        fmt::format("{:g} frames/s, {}", run.camera->fps, info_of(run.camera->deadline).name);
  facts.image_width = run.image_width;
  facts.image_height = run.image_height;
  facts.first_frame = static_cast<std::int64_t>(manifest.first_frame);
  facts.frames = static_cast<std::int64_t>(expected_poses(run));
  facts.inputs = inputs_of(manifest);
  return facts;
}

/// The files of a folder, each of which has to hold what the run wrote.
class RecordedFiles {
 public:
  explicit RecordedFiles(fs::path folder)
      : folder_(std::move(folder)), record_(outputs::OutputRecord::read(folder_)) {
    // Of other files that were written here later, such as a report.
    if (record_ && !record_->names(kRecordFile)) record_.reset();
  }

  bool holds(const char* name) const {
    if (base::exists(folder_ / name)) return true;
    if (record_ && record_->names(name)) fail(name, "is missing");
    return false;
  }
  std::string read(const char* name) const {
    if (!holds(name)) fail(name, "is missing");
    std::string bytes = base::read_file(folder_ / name, base::InputKind::run_file);
    const outputs::FileState state = outputs::state_of_bytes(bytes);
    if (record_ && !record_->says(name, state))
      fail(name, fmt::format("holds {} bytes of SHA-256 {:.12}...", state.size, state.sha256));
    return bytes;
  }

 private:
  [[noreturn]] void fail(const char* name, const std::string& found) const {
    throw InputError(fmt::format("{}: {}; expected what {} says the run wrote",
                                 (folder_ / name).string(), found, outputs::kRecordName));
  }

  fs::path folder_;
  std::optional<outputs::OutputRecord> record_;
};

}  // namespace

RunRecord make_record(std::string name, const Manifest& manifest, const RunResult& run) {
  RunRecord record{figures_of(run)};
  record.name = std::move(name);
  record.facts = facts_of(manifest, run);
  if (run.timed) record.cycles = cycle_parts(run);
  return record;
}

RunFolder run_folder(std::string name, std::shared_ptr<const RunResult> kept,
                     const Manifest& manifest, const std::string& platform_yaml) {
  const RunResult& run = *kept;
  RunFolder folder{make_record(std::move(name), manifest, run), manifest_json(manifest, run)};
  folder.run = std::move(kept);
  const auto add = [&](const char* file, Table table) {
    if (!table.heads().empty()) folder.tables.emplace(file, std::move(table));
  };
  add(kFramesFile, frame_rows(run));
  add(kErrorsFile, error_rows(run));
  if (!run.timed) return folder;
  add(kStagesFile, stage_rows(run));
  add(kMemoryFile, memory_rows(run));
  add(kEnergyFile, energy_rows(run));
  add(kCyclesFile, cycle_rows(folder.record.cycles));
  folder.others["platform.yaml"] = platform_yaml;
  return folder;
}

std::map<std::string, outputs::Content> files_of(const RunFolder& run) {
  using outputs::Content;
  using outputs::Sink;
  std::map<std::string, Content> files;
  for (const auto& [name, text] : run.others) files.emplace(name, text);
  files.emplace(kRecordFile, [&](const Sink& sink) { sink(record_text(run.record)); });
  files.emplace(kManifestFile, [&](const Sink& sink) { sink(json_text(run.manifest, 2) + '\n'); });
  for (const auto& [name, table] : run.tables)
    files.emplace(name, [&table = table](const Sink& sink) { write_csv(table, sink); });
  if (run.run)
    files.emplace(kTrajectoryFile,
                  [&](const Sink& sink) { traces::write_tum(run.run->trajectory, sink); });
  return files;
}

void write_run_folder(outputs::OutputFolder& out, const RunFolder& run, const std::string& below) {
  for (const auto& [name, content] : files_of(run)) out.write(below + name, content);
}

RunFolder read_run_folder(const fs::path& folder, bool with_tables) {
  const RecordedFiles files(folder);
  if (!files.holds(kRecordFile))
    throw InputError(fmt::format("{}: {}", folder.string(),
                                 base::exists(folder / "stats.json")
                                     ? "is of an earlier leviosim, without run.json: run it again"
                                     : "no run folder; expected a folder that run or replay left, "
                                       "with run.json"));
  RunFolder run{parse_record((folder / kRecordFile).string(), files.read(kRecordFile), Level::all),
                {}};
  run.record.name = folder.string();
  if (!with_tables) return run;
  run.manifest = read_json((folder / kManifestFile).string(), files.read(kManifestFile));
  for (const char* name : {kFramesFile, kStagesFile, kMemoryFile, kEnergyFile, kErrorsFile})
    if (files.holds(name)) {
      const std::string text = files.read(name);
      if (!text.ends_with('\n'))
        throw InputError(
            fmt::format("{}: ends within a line: it was cut off", (folder / name).string()));
      run.tables.emplace(name, read_csv((folder / name).string(), text));
    }
  const auto frames = run.tables.find(kFramesFile);
  const std::int64_t rows = frames == run.tables.end() ? 0 : std::ssize(frames->second.rows());
  if (rows != run.record.facts.frames)
    throw InputError(fmt::format("{}: has {} frames; expected {}, as {} says",
                                 (folder / kFramesFile).string(), rows, run.record.facts.frames,
                                 kRecordFile));
  return run;
}

}  // namespace leviosim::tools
