// Single files that the user asked for by name. As folders of results, they are
// claimed before any work is done, appear whole, and replace only what leviosim wrote, which the
// record of their folder names. Several processes may write different files of one folder.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "sim/outputs/output_place.h"
#include "sim/outputs/spool.h"

namespace leviosim::outputs {

class OutputFile : public OutputPlace {
 public:
  /// @throws InputError if the file cannot be written, or must not be replaced; Interrupted
  explicit OutputFile(OutputRequest request);

  /// Writes the file and gives it its name. Once.
  /// @returns nothing, or why it has another name now, which the text tells
  /// @throws InputError if it cannot be written; Interrupted
  [[nodiscard]] std::optional<std::string> publish(const Content& content);
  /// For what is collected before it is published.
  Spool spool() const { return Spool(path().parent_path(), request().shown()); }

 private:
  void judge() const;
};

}  // namespace leviosim::outputs
