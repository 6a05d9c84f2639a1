// What a plan names, opened once each: platforms, traces, folders of data. Paths in a plan are
// relative to its folder.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "platform_models/loader/platform_file.h"
#include "platform_models/loader/value.h"
#include "tools/app/cli/progress_line.h"
#include "traces/datasets/picture_memory.h"
#include "traces/work_traces/work_trace.h"

namespace leviosim::tools {

class SweepInputs {
 public:
  struct Trace {
    std::unique_ptr<traces::WorkTrace> work;
    std::string sha256;
    platform::PlatformFile platform;  ///< of the recording
  };
  struct Data {
    std::string folder;
    std::string work;  ///< work_of() the frames
    traces::CameraModel camera;
  };

  /// @param progress  of the synthetic flight, if it has to be made
  /// @param memory    that each reader of a trace may take
  SweepInputs(std::filesystem::path folder, ProgressLine::Style progress,
              Bytes memory = traces::kTraceMemory)
      : folder_(std::move(folder)), progress_(progress), memory_(memory) {}

  /// What is returned stays valid as long as this. Asking for what was opened before reads only, so
  /// several threads may.
  /// @throws InputError, which begins with `place`, for what cannot be opened
  platform::PlatformFile& platform(const std::string& name, const platform::Place& place);
  Trace& trace(const std::string& name, const platform::Place& place);
  /// A trace that is at hand, and has no file.
  Trace& keep_trace(const std::string& name, std::string bytes);
  const Data& data(const std::string& name, const std::string& frames,
                   const platform::Place& place);

  /// Of all runs.
  const std::shared_ptr<traces::PictureMemory>& pictures() const { return pictures_; }

 private:
  std::filesystem::path beside(const std::string& name) const;

  std::filesystem::path folder_;
  ProgressLine::Style progress_;
  Bytes memory_;
  std::map<std::string, platform::PlatformFile> platforms_;
  std::map<std::string, Trace> traces_;
  std::map<std::pair<std::string, std::string>, Data> data_;
  std::shared_ptr<traces::PictureMemory> pictures_ = std::make_shared<traces::PictureMemory>();
};

}  // namespace leviosim::tools
