// The frames of a work trace, written and read in chunks: of each chunk first the series of its
// pieces of work (work_columns.h), then the frames with their jobs, in which a piece of work is the
// number of its series.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "traces/work_columns.h"
#include "traces/work_trace.h"

namespace leviosim::traces {

/// Numbers names in the order of their first appearance.
class NameTable {
 public:
  std::uint64_t number_of(std::string_view name);
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::map<std::string, std::uint64_t, std::less<>> numbers_;
  std::vector<std::string> names_;
};

class ChunkWriter {
 public:
  explicit ChunkWriter(NameTable& names) : names_(&names) {}

  void add(const WorkFrame& frame);
  int frames() const { return frames_; }
  /// The content of the section; starts the next chunk.
  std::string finish();

 private:
  enum class Kind { Serial, Share, MasterShare, Controller };
  using Place = std::tuple<Kind, std::string_view, std::string_view>;  ///< with stage and step

  void write_job(const work::Job& job, bool on_controller);
  void write_stage(const work::StageRun& stage, bool on_controller);
  void write_peak(const work::MemoryPeak& peak);
  void write_counts(const Place& place, const work::Counts& counts);
  std::uint64_t series_of(const Place& place);

  NameTable* names_;
  int frames_ = 0;
  ByteWriter text_;  ///< the frames and their jobs
  std::map<Place, std::uint64_t> series_numbers_;
  std::vector<std::vector<work::Counts>> series_;
  std::map<std::string, std::uint64_t> peaks_;  ///< written → number
};

/// Gives the frames of a trace one after the other. Several may read the same trace at once.
class WorkFrames {
 public:
  /// @param trace  outlives the reader and the names in what it gives
  explicit WorkFrames(const WorkTrace& trace) : trace_(&trace) {}

  /// The next frame; storage of `frame` is used again. False at the end.
  /// @throws InputError for what cannot have been recorded
  bool next(WorkFrame& frame);

 private:
  void open_chunk();
  void close_chunk();
  std::string_view read_name();
  void read_facts(WorkFrame& frame);
  void read_job(work::Job& job, bool on_controller);
  void read_stage(work::StageRun& stage, bool on_controller);
  void read_step(work::Step& step, bool on_controller);
  void read_fork(work::Fork& fork, bool on_controller);
  void read_peak(work::MemoryPeak& peak);
  void read_counts(std::uint64_t series, work::Counts& counts);

  const WorkTrace* trace_;
  std::size_t next_chunk_ = 0;
  int frame_ = 0;        ///< number of the next
  int frames_left_ = 0;  ///< of the chunk
  std::string place_;    ///< of the chunk, for messages
  std::string content_;
  ByteReader text_;
  std::vector<SeriesReader> series_;
  std::vector<work::MemoryPeak> peaks_;
  std::int32_t background_ = 0;  ///< transfers of the job so far
  std::int32_t waits_ = 0;
};

}  // namespace leviosim::traces
