// Folders of runs: their files with kBetweenParts between them, in the order below, as records of
// runs and pages of reports are made of them.
#include "tools/app/run/run_folder.h"

#include "tests/fuzz/fuzz_target.h"
#include "tools/app/comparison/run_record.h"
#include "tools/app/html_report/page.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim;
  static const char* const names[] = {"manifest.json",    "stats.json",       tools::kFramesFile,
                                      tools::kCyclesFile, tools::kStagesFile, tools::kMemoryFile,
                                      tools::kEnergyFile, tools::kErrorsFile};
  const std::vector<std::string> parts = fuzz::parts_of(fuzz::text_of(data, size));
  if (parts.size() < 3) return 0;  // which every folder has
  tools::RunFiles files;
  for (std::size_t i = 0; i < std::min(parts.size(), std::size(names)); ++i)
    files[names[i]] = parts[i];
  return fuzz::only_input_errors([&] {
    const tools::RunRecord record = tools::record_of_files("fuzzed", files);
    tools::Json runs = tools::Json::array({tools::run_json(record, files)});
    const std::string page = tools::script_json(tools::report_json("fuzzed", std::move(runs)));
    if (page.find("</") != std::string::npos) std::abort();
  });
}
