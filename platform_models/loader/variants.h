// A platform with some of its numbers changed, many times over: sensitivity sweeps and bands
// need hundreds of variants of a chip and read its file once. The checks are those of files and -p.
#pragma once

#include <string>
#include <vector>

#include "platform_models/loader/document.h"
#include "platform_models/loader/loader.h"
#include "platform_models/loader/schema.h"

namespace leviosim::platform {

/// A parameter and the number it is to be, in the parameter's unit.
struct Change {
  std::string path;
  double value = 0;
};

class Variants {
 public:
  explicit Variants(ResolvedPlatform platform);

  const ResolvedPlatform& platform() const { return platform_; }
  /// Nullptr if the platform does not give this parameter.
  const Parameter* find(const std::string& path) const;

  /// @throws InputError for unknown paths, values out of limits and broken rules
  sim::ChipConfig config(const std::vector<Change>& changes) const;

 private:
  Settings changed(const std::vector<Change>& changes) const;

  ResolvedPlatform platform_;
  Schema schema_;
  Settings settings_;
};

}  // namespace leviosim::platform
