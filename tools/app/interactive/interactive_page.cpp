#include "tools/app/interactive/interactive_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "platform_models/loader/platform_file.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/printable.h"
#include "sim/base/yaml_document.h"
#include "sim/chip/account.h"
#include "tools/app/html_report/page.h"
#include "tools/app/interactive/flight_data.h"
#include "tools/app/interactive/interactive_parts.h"
#include "tools/app/interactive/knobs.h"
#include "tools/app/interactive/packing.h"
#include "traces/work_traces/plain_file.h"

namespace leviosim::tools {
namespace {

/// Empty if there is none.
std::string_view interactive_part(std::string_view name) {
  const auto parts = interactive_parts();
  const auto it = std::find_if(parts.begin(), parts.end(),
                               [&](const base::BuiltinFile& p) { return p.name == name; });
  return it == parts.end() ? std::string_view() : it->text;
}

/// Values stay text: they are read as those of a file.
Json json_of(const base::YamlNode& node) {
  if (node.is_scalar()) return node.scalar();
  if (node.is_sequence()) {
    Json list = Json::array();
    for (const base::YamlNode& item : node.items()) list.push_back(json_of(item));
    return list;
  }
  if (!node.is_mapping()) return nullptr;
  Json map = Json::object();
  for (const base::YamlEntry& entry : node.entries())
    add_member(map, entry.key, json_of(entry.value));
  return map;
}

/// In the order in which they use each other.
std::string interactive_scripts() {
  std::string text;
  for (const char* name :
       {"replay_engine", "flight", "setting", "knobs", "answer", "latency", "stage_bars",
        "frame_gantt", "film", "flight_path", "player", "search", "interactive_main"})
    text += interactive_part(name);
  return text;
}

/// What cores spend time on: key → {"column" of the table of breakdowns, "meaning"}.
Json mechanisms_json() {
  Json mechanisms = Json::object();
  for (const sim::MechanismInfo& info : sim::kMechanisms)
    mechanisms[std::string(info.key)] = {{"column", info.column}, {"meaning", info.meaning}};
  return mechanisms;
}

/// A run may have none, whose file is a line of heads.
traces::Trajectory poses_of(const std::filesystem::path& file) {
  const std::string text = base::read_file(file, base::InputKind::table);
  return text.find('\n') + 1 < text.size() ? traces::read_tum(file) : traces::Trajectory();
}

std::string block(std::string_view id, std::string_view bytes) {
  return fmt::format("<script type=\"text/plain\" id=\"{}\">{}</script>\n", id, base64(bytes));
}

}  // namespace

bool has_engine() { return !interactive_part("engine").empty(); }

void expect_engine() {
  if (has_engine()) return;
  throw InputError(
      "report --interactive: this leviosim was built without the engine of such pages; expected "
      "packages clang, lld, wasi-libc, libc++-14-dev-wasm32 and libclang-rt-14-dev-wasm32, then "
      "tools/build.sh wasm leviosim");
}

std::string interactive_page(const std::string& run, Bytes memory) {
  const std::filesystem::path folder(run);
  const std::filesystem::path file = folder / kWorkTraceFile;
  if (!base::exists(file))
    throw InputError(fmt::format("{}: holds no {}; expected the folder of a run with --record",
                                 printable(run), kWorkTraceFile));
  const traces::WorkTrace trace(file, memory);
  std::vector<FilmFrame> film;
  if (base::exists(folder / kFilmFile)) film = read_film(folder / kFilmFile, memory);
  return interactive_page(
      {run, trace, read_run_folder(folder, true), poses_of(folder / kTrajectoryFile), film});
}

std::string interactive_page(const RecordedRun& run) {
  const traces::WorkTraceInfo& info = run.trace.info();
  platform::PlatformFile platform(run.trace.name(), info.platform_yaml);
  const platform::ResolvedPlatform chip = platform.resolve({});
  const std::string film = film_text(run);
  Json data =
      report_json(fmt::format("What if: {} on {}", info.profile, info.platform), Json::array());
  data["interactive"] = {{"run", shell_word(run.name)},
                         {"profile", info.profile},
                         {"platform", info.platform},
                         {"data", info.data},
                         {"frames", run.trace.frames()},
                         {"period_ns", info.frame_period_ns},
                         {"knobs", knobs_json(platform.schema(), chip, info.frame_period_ns)},
                         {"switches", switches_json(chip)},
                         {"mechanisms", mechanisms_json()},
                         {"flight", flight_json(run)},
                         {"chip", json_of(base::parse_yaml(info.platform_yaml))}};
  const std::string plain = traces::plain_file(run.trace, sim::code_of(chip.config));
  return html_page(
      data, {interactive_scripts(),
             fmt::format("<style>\n{}</style>\n", interactive_part("interactive")) +
                 block("engine", interactive_part("engine")) + block("trace", gzipped(plain)) +
                 (film.empty() ? "" : block("film", gzipped(film))),
             " 'wasm-unsafe-eval'; worker-src blob:"});
}

}  // namespace leviosim::tools
