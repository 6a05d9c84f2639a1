// A folder of results, which appears under its name only when it is whole. It is claimed before any
// work is done: what could be refused at the end is refused at the start.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/outputs/output_place.h"
#include "sim/outputs/spool.h"
#include "sim/outputs/staging_folder.h"

namespace leviosim::outputs {

class OutputFolder : public OutputPlace {
 public:
  /// @throws InputError naming the entry for which the folder cannot be used; Interrupted
  explicit OutputFolder(OutputRequest request);
  ~OutputFolder() { remove_empty_parents(); }
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Makes sure that so much can be written. [bytes] @throws InputError if the disk is full
  void reserve(std::uint64_t bytes);
  /// Writes a file, "chosen/run.json", with the folders to it. Each name once; several threads
  /// may. @throws InputError if that fails
  void write(const std::string& name, const Content& content);
  /// For what is collected before it is written here. @param name  for messages
  Spool spool(const std::string& name) const;
  /// Gives the folder its name.
  /// @returns nothing, or why it has another name now, which the text tells
  [[nodiscard]] std::optional<std::string> commit();

 private:
  void judge() const;
  void make_parents();
  void remove_empty_parents();

  std::vector<std::filesystem::path> made_parents_;
  std::optional<StagingFolder> staging_;
};

}  // namespace leviosim::outputs
