// A point of a study, and the key under which its outcome is kept.
#pragma once

#include <string>
#include <string_view>

#include "platform_models/loader/schema.h"
#include "tools/app/run/run_request.h"
#include "tools/app/study/sequence.h"
#include "traces/work_traces/work_trace.h"

namespace leviosim::tools {

struct Sequence;

/// A run, native or on a chip, or recorded work that is timed on a chip.
struct Point {
  RunRequest request;
  std::string work;                          ///< what is read: work_of()
  const traces::WorkTrace* trace = nullptr;  ///< replayed if there is one
  const Sequence* sequence = nullptr;        ///< whose truth the run is compared with, if at all
  std::size_t row = 0;  ///< of the study's table; several points of a row are condensed
};

/// All that an outcome depends on, besides the program: work, parameters of the workload, the chip
/// and the camera. The folder does not count, and parameters count as they are, set or not.
/// @returns a line per part
std::string identity_of(const Point& point, const platform::Schema& schema);

/// A digest of everything that an outcome depends on, the simulator included.
/// @param kept      which figures of the point are kept
/// @param identity  identity_of() the point
/// @returns 64 hexadecimal digits
std::string point_key(std::string_view kept, const std::string& identity);

}  // namespace leviosim::tools
