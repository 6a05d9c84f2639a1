// The end of a command: results are moved into place, then the report is printed, even if moving
// failed.
#pragma once

#include <functional>
#include <initializer_list>
#include <optional>
#include <string>

#include "sim/outputs/output_file.h"
#include "sim/outputs/output_folder.h"
#include "tools/app/cli/printout.h"

namespace leviosim::tools {

/// Writes a folder of results, gives it its name, and prints the report with the line
/// "results: DIR", which a whole printout goes without. @param write  the files
/// @throws InputError, after the report, if the results are not under their name; Interrupted
void publish(outputs::OutputFolder& out, const Printout& report, const std::function<void()>& write,
             const std::string& label = "results");

/// The file of an option; none if the option is empty. @throws InputError if it cannot be written
std::optional<outputs::OutputFile> claimed_file(const outputs::OutputRequest& request);

/// @throws InputError if the second option names the file of the first
void expect_different(const std::optional<outputs::OutputFile>& first, const char* first_option,
                      const std::optional<outputs::OutputFile>& second, const char* option);

struct FileOutput {
  std::optional<outputs::OutputFile>& file;
  outputs::Content content;
  std::string label;  ///< of the line after the report, "table"; empty: none
};

/// The same for single files: those that were claimed.
void publish(std::initializer_list<FileOutput> files, const Printout& report);

}  // namespace leviosim::tools
