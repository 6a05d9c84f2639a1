// A point of a finished sweep as a run that can be compared: "swept:3". A sweep keeps figures only,
// not where cycles went, so the point is replayed or computed again, as the sweep's plan says.
#pragma once

#include <optional>
#include <string>

#include "tools/app/run/record_source.h"

namespace leviosim::tools {

/// "swept:3", where `swept` is the folder of a sweep.
struct PointName {
  std::string sweep;
  std::string number;  ///< as typed

  std::string text() const { return sweep + ':' + number; }
};

/// Nothing for all else, such as a folder that is called so.
/// @throws InputError for a sweep without a number, saying which there are
std::optional<PointName> point_name(const std::string& text);

/// @param memory,quiet  of the options; the chip is the point's
/// @throws InputError for a number that the sweep does not have, for points whose plan, trace or
///         data are no longer what they were, and as the run does
RunFolder read_point(const PointName& name, const RecordOptions& options);

}  // namespace leviosim::tools
