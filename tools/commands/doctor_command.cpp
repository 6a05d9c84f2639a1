// `leviosim doctor`: what this program is and what it finds on this machine.
#include "tools/commands/commands.h"

#include <fmt/format.h>
#include <png.h>
#include <unistd.h>
#include <yaml.h>
#include <zstd.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/interruption.h"
#include "sim/base/printable.h"
#include "sim/base/text.h"
#include "tools/app/cli/cache_folder.h"
#include "tools/app/cli/printout.h"
#include "tools/app/cli/screen.h"
#include "tools/app/cli/version.h"
#include "tools/app/record/statistic_list.h"
#include "traces/recordings/recording.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;

struct DoctorOptions {
  std::vector<std::string> folders;
  bool json = false;
};

struct Remark {
  std::string group;
  std::string name;
  bool found;
  std::string detail;  ///< where it is or what it is; of what is missing, what to do
};
using Findings = std::vector<Remark>;

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

void add_versions(Findings& all) {
  all.push_back({"program", "leviosim", true,
                 fmt::format("{} {}, compiled by C++ {}", version(), revision(), __VERSION__)});
  const std::vector<std::pair<const char*, std::string>> libraries{
      {"fmt",
       fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100)},
      {"zstd", ZSTD_versionString()},
      {"libpng", png_get_libpng_ver(nullptr)},
      {"libyaml", yaml_get_version_string()}};
  std::string list;
  for (const auto& [name, number] : libraries)
    list += fmt::format("{}{} {}", list.empty() ? "" : ", ", name, number);
  all.push_back({"program", "libraries", true, list});
}

/// The sizes of all files below a folder. [B]
std::uintmax_t size_below(const fs::path& folder, std::size_t& files) {
  std::uintmax_t bytes = 0;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error)) {
    throw_if_interrupted();
    std::error_code gone;
    if (!at->is_regular_file(gone) || gone) continue;
    const std::uintmax_t size = at->file_size(gone);
    if (gone) continue;
    bytes += size;
    ++files;
  }
  return bytes;
}

void add_cache(Findings& all) {
  try {
    const fs::path folder = cache_folder();
    std::size_t files = 0;
    const std::uintmax_t bytes = size_below(folder, files);
    all.push_back({"cache", "flights, results", base::exists(folder),
                   fmt::format("{}: {} files, {:.1f} MB", folder.string(), files,
                               static_cast<double>(bytes) * 1e-6)});
  } catch (const InputError& error) {
    all.push_back({"cache", "flights, results", false, error.what()});
  }
}

/// Recordings in a folder, or up to `depth` folders below it, in the order of their names.
void add_recordings(const fs::path& folder, int depth, Findings& all) {
  throw_if_interrupted();
  std::error_code error;
  const auto formats = traces::recording_formats();
  const auto format = std::find_if(formats.begin(), formats.end(), [&](const auto& known) {
    try {
      return known.is(folder);
    } catch (const InputError&) {  // it may not be looked into
      return false;
    }
  });
  if (format != formats.end()) {
    all.push_back({"data", format->name, true, folder.string()});
    return;
  }
  if (depth == 0) return;
  std::vector<fs::path> below;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    std::error_code gone;
    if (at->is_directory(gone)) below.push_back(at->path());
  }
  std::sort(below.begin(), below.end());
  for (const fs::path& next : below) add_recordings(next, depth - 1, all);
}

void add_data(const std::vector<std::string>& named, Findings& all) {
  constexpr int kDepth = 2;
  std::vector<std::string> folders = named;
  if (folders.empty()) folders = {variable("LEVIOSIM_DATA"), "."};
  const std::size_t before = all.size();
  for (const std::string& folder : folders)
    if (!folder.empty()) add_recordings(folder, kDepth, all);
  if (all.size() == before)
    all.push_back({"data", "recordings", false,
                   "none here nor in $LEVIOSIM_DATA; leviosim run takes --data synthetic"});
}

struct Tool {
  const char* program;
  const char* package;
};
constexpr std::array kTools{Tool{"riscv64-unknown-elf-g++", "gcc-riscv64-unknown-elf"},
                            Tool{"arm-none-eabi-g++", "gcc-arm-none-eabi"},
                            Tool{"qemu-riscv32", "qemu-user"},
                            Tool{"qemu-arm", "qemu-user"},
                            Tool{"clang-query", "clang-tools"},
                            Tool{"make", "make"}};

/// What leviosim-measure needs besides those programs (tools/rv32/measure_kernels.py).
constexpr std::array kMeasureFiles{
    Tool{"/usr/lib/picolibc/riscv64-unknown-elf/lib", "picolibc-riscv64-unknown-elf"},
    Tool{"/usr/include/capstone/capstone.h", "libcapstone-dev"}};

void add_tools(Findings& all) {
  for (const Tool& tool : kTools) {
    std::string place;
    for (const std::string& folder : base::split(variable("PATH"), ':')) {
      const fs::path file = fs::path(folder) / tool.program;
      if (place.empty() && !folder.empty() && ::access(file.c_str(), X_OK) == 0)
        place = file.string();
    }
    all.push_back({"tools", tool.program, !place.empty(),
                   place.empty() ? fmt::format("apt-get install {}", tool.package) : place});
  }
  for (const Tool& file : kMeasureFiles) {
    const bool found = base::exists(file.program);
    all.push_back({"tools", file.package, found,
                   found ? file.program : fmt::format("apt-get install {}", file.package)});
  }
}

void add_terminal(Findings& all) {
  std::string encoding;
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"})
    if (encoding.empty()) encoding = variable(name);
  const bool terminal = ::isatty(STDOUT_FILENO) == 1;
  all.push_back({"terminal", terminal ? "terminal" : "file or pipe", true,
                 fmt::format("{} columns, {}, {}", output_width(),
                             terminal && variable("NO_COLOR").empty() ? "colours" : "no colours",
                             encoding.empty() ? "no locale is set" : encoding)});
}

/// The end of a path that is too long for its line, which sentences are not: they are broken.
std::string shown(const std::string& detail) {
  constexpr int kBefore = 42;
  const std::string text = printable(detail);
  const int room = table_width() - kBefore;
  if (display_width(text) <= room || text.find(' ') != std::string::npos) return text;
  return "…" + text.substr(text.size() - static_cast<std::size_t>(room) + 1);
}

Printout lines(const Findings& all) {
  std::string text;
  std::size_t missing = 0;
  for (const Remark& finding : all) {
    text += fmt::format("{:<8}  {:<23}  {:<3}  {}\n", finding.group, printable(finding.name),
                        finding.found ? "yes" : "no", shown(finding.detail));
    missing += finding.found ? 0 : 1;
  }
  return Printout(text).ending(fmt::format("in short: {} of {} found; runs need none of the rest",
                                           all.size() - missing, all.size()),
                               {"leviosim run"});
}

std::string document(const Findings& all) {
  Json rows = Json::array();
  for (const Remark& finding : all)
    rows.push_back({{"about", finding.group},
                    {"what", finding.name},
                    {"found", finding.found},
                    {"where", finding.detail}});
  return json_text(Json{{"version", std::string(version())}, {"findings", rows}}, 2) + '\n';
}

void run(const DoctorOptions& options) {
  for (const std::string& folder : options.folders)
    if (!base::is_folder(folder))
      throw InputError(fmt::format("doctor: {}: {}; expected a folder with recordings", folder,
                                   base::exists(folder) ? "is no folder" : "does not exist"));
  Findings all;
  add_versions(all);
  add_cache(all);
  add_tools(all);
  add_terminal(all);
  add_data(options.folders, all);
  print(printout(
      options.json, [&] { return lines(all); }, [&] { return document(all); }));
}

}  // namespace

Command add_doctor_command(CLI::App& app, const Arguments&) {
  CLI::App* command =
      app.add_subcommand("doctor", "Say what this machine has: versions, caches, data, compilers");
  const auto options = std::make_shared<DoctorOptions>();
  command
      ->add_option("FOLDER", options->folders,
                   "folders in which recordings are looked for [$LEVIOSIM_DATA and here]")
      ->take_all();
  add_examples(*command, {"leviosim doctor", "leviosim doctor flight"});
  add_json_option(*command, options->json);
  return {command, [=] { run(*options); }};
}

}  // namespace leviosim::tools
