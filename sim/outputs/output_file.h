// Single files that the user asked for by name. As folders of results (output_folder.h), they are
// claimed before any work is done, appear whole, and replace only what leviosim wrote, which the
// record of their folder names. Several processes may write different files of one folder.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "sim/outputs/new_file.h"
#include "sim/outputs/output_record.h"
#include "sim/outputs/output_request.h"

namespace leviosim::outputs {

class HeldRecord;

class OutputFile {
 public:
  /// @throws InputError if the file cannot be written, or must not be replaced
  explicit OutputFile(OutputRequest request);

  /// Writes the file and gives it its name. Once.
  /// @returns nothing, or why it has another name now, which the text tells
  /// @throws InputError if it cannot be written
  [[nodiscard]] std::optional<std::string> publish(std::string_view bytes);
  /// Where the file is after publish(), as the user would name it.
  const std::string& shown_path() const { return shown_path_; }
  /// Without links.
  const std::filesystem::path& path() const { return target_; }

 private:
  [[noreturn]] void refuse(const std::string& why) const;
  void judge() const;
  void remove_leftover() const;
  std::filesystem::path hidden() const;
  int replace(HeldRecord& record);
  std::string publish_aside(HeldRecord& record, const FileState& state);

  OutputRequest request_;
  std::string shown_path_;
  std::filesystem::path target_;
  std::unique_ptr<NewFile> file_;
};

/// Adds a line to the record of a folder, for what is not written through OutputFile.
/// @throws InputError if that fails
void add_to_record(const std::filesystem::path& folder, const std::string& name,
                   const FileState& state);

}  // namespace leviosim::outputs
