// Recorded work: everything that timing a run on a chip needs, in a file (FORMAT.md). For every
// frame it holds the job of the front end, those of the optimisation that began with it, and what
// came out; so a chip can be timed without computing, and without the images.
//
// What is recorded is the work as it was divided among a number of cores. How much code each work
// segment fetches is part of it, for caches of any size (sim/work/code_reuse.h).
//
// Left out: values other than the poses.
#pragma once

#include <Eigen/Geometry>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/work/program.h"
#include "traces/trajectories/evaluation.h"
#include "traces/work_traces/bytes.h"
#include "traces/work_traces/memory_budget.h"
#include "traces/work_traces/section_file.h"
#include "traces/work_traces/work_columns.h"
#include "traces/work_traces/work_memory.h"

namespace leviosim::traces {

/// Work traces as files.
inline constexpr FileKind kWorkTraceFile{"LEVIOWT\n", "a work trace", 10};

class ByteReader;

/// One frame as it was recorded. Names in it are the trace's, and valid as long as that.
struct WorkFrame {
  int index = 0;            ///< in the data set
  std::int64_t t_ns = 0;    ///< camera timestamp
  std::string_view source;  ///< of the pose, a key of frames.csv
  bool keyframe = false;
  std::vector<int> facts;  ///< numbers that are not negative, named by WorkTraceInfo::facts
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();  ///< [m]

  std::int64_t start_ns = 0;    ///< the front end took it up, in simulated time of the recording
  bool optimiser_busy = false;  ///< at that time
  /// The frame at whose start the newest result of the optimiser began that the front end saw; -1
  /// if there was none.
  int seen = -1;
  bool optimised = false;  ///< an optimisation began with it

  work::Job front_end;
  std::vector<work::Job> iterations;  ///< of that optimisation; empty if none began
};

/// Facts about the recording that are the same for all frames.
struct WorkTraceInfo {
  struct Stage {
    std::string name;
    std::string unit;  ///< what one call is
    bool on_controller = false;
  };
  /// What stays in a memory at the end.
  struct Memory {
    std::string name;
    Bytes bytes;
    std::vector<work::Block> blocks;
  };

  std::string program;           ///< that wrote the trace
  std::string profile;           ///< of the workload
  std::uint32_t seed = 1;        ///< of its random draws
  std::string data;              ///< what was run on, in the words of the user
  std::int64_t first_frame = 0;  ///< index in the data
  std::string platform;          ///< of the recording, in the words of the user
  std::string platform_yaml;     ///< the platform, resolved: loads as a platform file
  int cores = 0;                 ///< among which the front end's work was divided
  int image_width = 0;
  int image_height = 0;
  std::int64_t frame_period_ns = 0;
  std::vector<Stage> stages;
  std::vector<std::string> facts;  ///< names of the numbers that each frame yields
  std::vector<Memory> l2;          ///< what the workload keeps there
  std::optional<Evaluation> ate;   ///< where ground truth exists; without its poses
  std::vector<std::pair<std::string, std::string>> inputs;  ///< name → SHA-256, for provenance
  std::vector<std::int64_t> stamps_ns;                      ///< of the camera, a frame each
};

/// The bytes of a file, for WorkTrace. Nothing is read of one that is larger than the memory.
/// @throws InputError
std::string work_trace_bytes(const std::filesystem::path& file, Bytes memory);

class WorkTrace {
 public:
  /// Reads the file and compares all checksums.
  /// @param memory  that the file and everything that is read from it may take at any time
  /// @throws InputError for anything that is no whole work trace of this version, and if
  ///         the memory does not suffice
  explicit WorkTrace(const std::filesystem::path& file, Bytes memory = kTraceMemory);
  /// Opens a work trace from its bytes; `name` is for messages.
  WorkTrace(std::string name, std::string bytes, Bytes memory = kTraceMemory);
  WorkTrace(const WorkTrace&) = delete;
  WorkTrace& operator=(const WorkTrace&) = delete;

  const std::string& name() const { return name_; }
  const WorkTraceInfo& info() const { return info_; }
  int frames() const { return static_cast<int>(info_.stamps_ns.size()); }
  const std::vector<std::string>& names() const { return names_; }
  std::size_t file_size() const { return bytes_.size(); }
  /// Memory that is allowed, and used by what is the same for all frames.
  const MemoryBudget& budget() const { return budget_; }

  /// Sections of frames, in order; decoded by WorkFrames (work_frames.h).
  struct Chunk {
    int first = 0;
    int frames = 0;
    Section section;
    Section offload;  ///< offload regions in the frames
  };
  const std::vector<Chunk>& chunks() const { return chunks_; }
  const Section& summary() const { return summary_; }
  const FileFields& fields() const { return fields_; }

 private:
  void read_summary(ByteReader& in);
  void read_chunks(ByteReader& in, const std::vector<Section>& sections);

  std::string name_;
  std::string bytes_;
  MemoryBudget budget_;
  WorkTraceInfo info_;
  std::vector<std::string> names_;
  FileFields fields_;
  std::vector<Chunk> chunks_;
  Section summary_;
};

/// Makes a trace of frames that are given in order; it holds those of a section only.
class WorkTraceWriter {
 public:
  /// @param cores  among which the work of the front end is divided
  /// @param sink   takes the bytes of the file as they come; without one they are held
  explicit WorkTraceWriter(int cores, std::function<void(std::string_view)> sink = {});
  ~WorkTraceWriter();
  WorkTraceWriter(WorkTraceWriter&&) noexcept;
  WorkTraceWriter& operator=(WorkTraceWriter&&) noexcept;

  void add(const WorkFrame& frame);
  /// Ends the file. `info.stamps_ns` and `info.cores` are those of the frames.
  /// @returns its bytes, if they were held
  std::string finish(WorkTraceInfo info);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace leviosim::traces
