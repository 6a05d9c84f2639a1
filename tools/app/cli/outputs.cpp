#include "tools/app/cli/outputs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/interruption.h"
#include "sim/outputs/output_file.h"
#include "tools/app/cli/printout.h"

namespace leviosim::tools {
namespace {

/// What went wrong in doing it, if something did.
std::optional<std::string> fault_of(const std::function<std::optional<std::string>()>& put) {
  try {
    return put();
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace

void publish(outputs::OutputFolder& out, const Printout& report, const std::function<void()>& write,
             const std::string& label) {
  bool is_written = false;
  const std::optional<std::string> fault = fault_of([&] {
    write();
    throw_if_interrupted();
    std::optional<std::string> elsewhere = out.commit();
    is_written = true;
    return elsewhere;
  });
  Printout shown = report;
  if (fault) shown.next.clear();  // what it names is not there
  print(shown,
        is_written ? std::vector<ShownPath>{{label, out.shown_path()}} : std::vector<ShownPath>());
  if (fault) throw InputError(*fault);
}

std::optional<outputs::OutputFile> claimed_file(const outputs::OutputRequest& request) {
  if (request.path.empty()) return std::nullopt;
  // The record of a run's folder names its table and its page, but what else is written there is a
  // user's own: a table of another command would make the folder another run's.
  const std::filesystem::path path(request.path);
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const bool is_of_run = base::exists(folder / "manifest.json") && base::exists(path) &&
                         (path.extension() == ".csv" || path.extension() == ".json");
  if (is_of_run)
    throw InputError(fmt::format("{}: is a file of a run; choose a new file", request.shown()));
  return std::optional<outputs::OutputFile>(std::in_place, request);
}

void expect_different(const std::optional<outputs::OutputFile>& first, const char* first_option,
                      const std::optional<outputs::OutputFile>& second, const char* option) {
  if (first && second && first->path() == second->path())
    throw InputError(fmt::format("{} {}: is the file of {} too; expected two files", option,
                                 second->shown_path(), first_option));
}

void publish(std::initializer_list<FileOutput> files, const Printout& report) {
  std::optional<std::string> first_fault;
  throw_if_interrupted();
  std::vector<ShownPath> places;
  for (const FileOutput& output : files) {
    if (!output.file) continue;
    bool is_written = false;
    const std::optional<std::string> fault = fault_of([&] {
      std::optional<std::string> elsewhere = output.file->publish(output.content);
      is_written = true;
      return elsewhere;
    });
    if (is_written && !output.label.empty())
      places.push_back({output.label, output.file->shown_path()});
    if (fault && !first_fault) first_fault = fault;
  }
  print(report, places);
  if (first_fault) throw InputError(*first_fault);
}

}  // namespace leviosim::tools
