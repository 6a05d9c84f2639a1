// The frames of a work trace, written and read in chunks: of each chunk first the series of its
// work segments (work_columns.h), then the frames with their jobs, in which a work segment is the
// number of its series.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "traces/work_traces/work_columns.h"
#include "traces/work_traces/work_trace.h"

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
  /// The contents of its two sections; starts the next chunk.
  struct Contents {
    std::string frames;
    std::string offload;
  };
  Contents finish();

 private:
  enum class Kind { Serial, Share, MasterShare, Controller };
  /// With stage and step, and the kind of kernel if it is about calls.
  using Place = std::tuple<Kind, std::string_view, std::string_view, std::string_view>;
  /// Segments of work by their place: some series.
  struct SeriesTable {
    std::map<Place, std::uint64_t> numbers;
    std::vector<CountsSeries> series;

    std::uint64_t number_of(const Place& place);
    /// Their descriptions and columns.
    void write(ByteWriter& content) const;
  };

  void write_job(const work::Job& job, bool on_controller);
  void write_stage(const work::StageRun& stage, bool on_controller);
  void write_peak(const work::MemoryPeak& peak);
  void write_counts(const Place& place, const work::Segment& segment);
  void write_offload(const Place& place, const work::Segment& segment);

  NameTable* names_;
  int frames_ = 0;
  ByteWriter text_;  ///< the frames and their jobs
  SeriesTable work_;
  ByteWriter offload_text_;  ///< offload regions of every work segment
  SeriesTable offload_work_;
  std::map<std::string, std::uint64_t> peaks_;  ///< written → number
};

/// Gives the frames of a trace one after the other. Several may read the same trace at once.
class WorkFrames {
 public:
  /// @param trace  outlives the reader and the names in what it gives
  /// @param offload  whether the offload regions are read, too
  /// @param code  the instruction set whose compiled work is needed, which spares reading that of
  ///              others; all by default
  /// @throws InputError if they are asked for, and the trace has none
  /// Memory: what trace.budget() has left, at any time.
  explicit WorkFrames(const WorkTrace& trace, bool offload = false,
                      std::optional<work::CompiledFor> code = {});

  /// The next frame; storage of `frame` is used again. False at the end.
  /// @throws InputError for what cannot have been recorded
  bool next(WorkFrame& frame);
  /// Of a new reader: the next frame is this one. Frames before its chunk are not read.
  void skip_to(int frame);

 private:
  void open_chunk(WorkFrame& frame);
  void open_offload(const WorkTrace::Chunk& chunk);
  void close_chunk();
  void drop_storage(WorkFrame& frame);
  void add_decoded(std::uint64_t bytes);
  std::string_view read_name();
  void read_facts(WorkFrame& frame);
  void read_iterations(WorkFrame& frame);
  void read_job(work::Job& job, bool on_controller);
  void read_stage(work::StageRun& stage, bool on_controller);
  std::string_view read_stage_name();
  void read_step(work::Step& step, bool on_controller);
  work::Transfer read_transfer(bool background, bool on_controller);
  work::TransferWait read_wait();
  void read_fork(work::Fork& fork, bool on_controller);
  void read_peak(work::MemoryPeak& peak);
  void read_counts(std::uint64_t series, work::Segment& segment);
  void read_offload(work::Segment& segment);
  void open_series(ByteReader& in, std::vector<SeriesReader>& series);

  const WorkTrace* trace_;
  bool with_offload_;
  std::optional<work::CompiledFor> code_;
  MemoryBudget budget_;
  std::uint64_t of_chunk_ =
      0;  ///< used of it at the first frame of the chunk, with peaks since then
  std::uint64_t decoded_ = 0;  ///< of all sections and frames so far [bytes]
  std::size_t next_chunk_ = 0;
  int frame_ = 0;        ///< number of the next
  int frames_left_ = 0;  ///< of the chunk
  std::string place_;    ///< of the chunk, for messages
  std::string content_;
  ByteReader text_;
  std::vector<SeriesReader> series_;
  std::string offload_place_;
  std::string offload_content_;
  ByteReader offload_text_;
  std::vector<SeriesReader> offload_series_;
  std::vector<work::MemoryPeak> peaks_;
  std::vector<bool> stage_names_;  ///< by number of the name, whether it is that of a stage
  std::size_t stages_ = 0;         ///< so many are
  std::int32_t background_ = 0;    ///< transfers of the job so far
  std::int32_t waits_ = 0;
};

}  // namespace leviosim::traces
