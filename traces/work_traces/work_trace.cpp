#include "traces/work_traces/work_trace.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/opened_file.h"
#include "traces/work_traces/bytes.h"
#include "traces/work_traces/memory_budget.h"
#include "traces/work_traces/section_file.h"
#include "traces/work_traces/work_columns.h"
#include "traces/work_traces/work_frames.h"
#include "traces/work_traces/work_memory.h"

namespace leviosim::traces {
namespace {

constexpr int kFramesPerChunk = 32;
constexpr std::string_view kSummary = "summary\n";  ///< tells it from other sections
constexpr int kLevel = 9;  ///< of zstd; higher ones take longer than the run for 2 % of size
constexpr std::uint64_t kMostCores = 1024;
constexpr std::uint64_t kLargestSide = 1 << 16;
constexpr std::uint64_t kMostFrames = std::uint64_t{1} << 31;
constexpr std::uint64_t kLongestPeriod = std::uint64_t{1} << 42;  ///< an hour [ns]

void write_texts(ByteWriter& out, const std::vector<std::string>& texts) {
  out.whole(texts.size());
  for (const std::string& text : texts) out.text(text);
}

/// What the counters are called, and which code distances they mean.
void write_fields(ByteWriter& out) {
  out.whole(work::kOpCount);
  for (const work::OpInfo& op : work::op_list()) out.text(op.name);
  out.whole(work::kReuseDistances.size());
  for (const std::uint32_t end : work::kReuseDistances) out.whole(end);
  out.whole(work::kCompiledFor.size());
  for (const std::string_view set : work::kCompiledFor) out.text(set);
  out.whole(work::kCompiledCount);
}

void write_ate(ByteWriter& out, const Evaluation& ate) {
  for (const double value :
       {ate.translation.rmse, ate.translation.mean, ate.translation.median, ate.translation.max,
        ate.rotation_rmse_deg, ate.completion, ate.longest_gap_s.value_or(-1), ate.path_length_m,
        ate.size_ratio.value_or(-1), ate.located_rmse_m.value_or(-1)})
    out.f64(value);
  out.whole(ate.matched);
  out.whole(ate.estimates);
  out.text(ate.protocol);
}

std::string summary_of(const WorkTraceInfo& info, NameTable& names,
                       const std::vector<int>& chunk_frames) {
  ByteWriter out;
  out.append(kSummary);
  for (const std::string* text :
       {&info.program, &info.profile, &info.data, &info.platform, &info.platform_yaml})
    out.text(*text);
  out.whole(info.seed);
  out.whole(static_cast<std::uint64_t>(info.first_frame));
  out.whole(info.inputs.size());
  for (const auto& [name, sha256] : info.inputs) {
    out.text(name);
    out.text(sha256);
  }
  for (const int value : {info.cores, info.image_width, info.image_height})
    out.whole(static_cast<std::uint64_t>(value));
  out.whole(static_cast<std::uint64_t>(info.frame_period_ns));
  write_fields(out);
  out.whole(info.stages.size());
  for (const WorkTraceInfo::Stage& stage : info.stages) {
    out.text(stage.name);
    out.text(stage.unit);
    out.byte(stage.on_controller ? 1 : 0);
  }
  write_texts(out, info.facts);
  out.byte(info.ate ? 1 : 0);
  if (info.ate) write_ate(out, *info.ate);
  for (const WorkTraceInfo::Memory& memory : info.l2)
    for (const work::Block& block : memory.blocks) names.number_of(block.name);
  write_texts(out, names.names());
  out.whole(info.l2.size());
  for (const WorkTraceInfo::Memory& memory : info.l2) {
    out.text(memory.name);
    out.whole(static_cast<std::uint64_t>(memory.bytes.count()));
    out.whole(memory.blocks.size());
    for (const work::Block& block : memory.blocks) {
      out.whole(names.number_of(block.name));
      out.whole(static_cast<std::uint64_t>(block.offset.count()));
      out.whole(static_cast<std::uint64_t>(block.size.count()));
    }
  }
  out.whole(chunk_frames.size());
  for (const int frames : chunk_frames) out.whole(static_cast<std::uint64_t>(frames));
  out.whole(info.stamps_ns.size());
  std::int64_t before = 0;
  for (const std::int64_t t_ns : info.stamps_ns) {
    out.integer(t_ns - before);
    before = t_ns;
  }
  return out.take();
}

bool read_flag(ByteReader& in, const char* what) { return in.whole_below(2, what) == 1; }

std::int64_t read_number(ByteReader& in, std::uint64_t limit, const char* what) {
  return static_cast<std::int64_t>(in.whole_below(limit, what));
}

/// The number that a name has among those that are known.
template <class Names>
std::size_t number_of(ByteReader& in, const Names& known, std::string_view what) {
  const std::string name(in.text("a name"));
  const auto found = std::find(known.begin(), known.end(), name);
  if (found == known.end())
    in.fail(fmt::format("has {} '{}', which this leviosim does not know", what, name));
  return static_cast<std::size_t>(found - known.begin());
}

/// Appends the fields of compiled work: of each instruction set, in any order.
void read_compiled_fields(ByteReader& in, FileFields& fields) {
  const auto expect = [&](std::size_t expected, const char* what) {
    if (const std::uint64_t found = in.whole(what); found != expected)
      in.fail(fmt::format("has {} {}; expected {}", found, what, expected));
  };
  expect(work::kCompiledFor.size(), "instruction sets");
  std::vector<std::size_t> sets(work::kCompiledFor.size());
  for (std::size_t& set : sets)
    set = number_of(in, work::kCompiledFor, "work as compiled for instruction set");
  expect(work::kCompiledCount, "kinds of compiled work");
  for (const std::size_t set : sets)
    for (std::size_t k = 0; k < work::kCompiledCount; ++k)
      fields.push_back(kFirstCompiled + set * work::kCompiledCount + k);
}

/// Which counter each field of the file is.
FileFields read_fields(ByteReader& in) {
  std::vector<std::string_view> known;
  for (const work::OpInfo& op : work::op_list()) known.emplace_back(op.name);
  FileFields fields;
  for (std::uint64_t i = in.whole_below(work::kOpCount + 1, "operations"); i > 0; --i)
    fields.push_back(number_of(in, known, "operation"));
  const std::uint64_t classes = in.whole("classes of code reuse");
  if (classes != work::kReuseDistances.size())
    in.fail(fmt::format("has {} classes of code reuse; expected {}", classes,
                        work::kReuseDistances.size()));
  for (const std::uint32_t end : work::kReuseDistances)
    if (const std::uint64_t found = in.whole("the end of a class of code reuse"); found != end)
      in.fail(fmt::format("a class of code reuse ends at {} bytes; expected {}", found, end));
  for (std::size_t k = 0; k < work::kReuseClasses; ++k) fields.push_back(work::kOpCount + k);
  read_compiled_fields(in, fields);
  std::vector<std::size_t> sorted = fields;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
    in.fail("names an operation or an instruction set twice");
  return fields;
}

Evaluation read_ate(ByteReader& in) {
  Evaluation ate;
  double gap = 0, size_ratio = 0, located = 0;
  for (double* value :
       {&ate.translation.rmse, &ate.translation.mean, &ate.translation.median, &ate.translation.max,
        &ate.rotation_rmse_deg, &ate.completion, &gap, &ate.path_length_m, &size_ratio, &located})
    *value = in.f64("a figure of accuracy");
  if (gap >= 0) ate.longest_gap_s = gap;
  if (size_ratio >= 0) ate.size_ratio = size_ratio;
  if (located >= 0) ate.located_rmse_m = located;
  ate.matched = static_cast<std::size_t>(in.whole("matched poses"));
  ate.estimates = static_cast<std::size_t>(in.whole("poses"));
  ate.protocol = in.text("the protocol of the accuracy");
  return ate;
}

std::vector<std::string> read_names(ByteReader& in) {
  std::vector<std::string> names;
  for (std::size_t i = in.count("names", kTextMemory); i > 0; --i)
    names.emplace_back(in.text("a name"));
  return names;
}

/// @param names  where the names of the blocks stay
std::vector<WorkTraceInfo::Memory> read_l2(ByteReader& in, const std::vector<std::string>& names) {
  const auto bytes = [&] { return Bytes(read_number(in, kMostBytes, "bytes of memory")); };
  std::vector<WorkTraceInfo::Memory> memories(in.whole_below(kMostMemories + 1, "memories"));
  for (WorkTraceInfo::Memory& memory : memories) {
    memory.name = in.text("the name of a memory");
    memory.bytes = bytes();
    memory.blocks.resize(in.count("blocks of memory", kBlockMemory));
    for (work::Block& block : memory.blocks) {
      block.name = names[in.whole_below(names.size(), "the number of a name")];
      block.offset = bytes();
      block.size = bytes();
    }
  }
  return memories;
}

void read_stamps(ByteReader& in, std::vector<std::int64_t>& stamps) {
  std::int64_t before = 0;
  for (std::size_t i = in.count("time stamps", kFrameMemory); i > 0; --i) {
    const std::int64_t step = in.integer("the time between two frames");
    if ((!stamps.empty() && step <= 0) || step < 0 || step > (std::int64_t{1} << 61))
      in.fail("time stamps do not rise");
    before += step;
    if (before < 0 || before > (std::int64_t{1} << 61)) in.fail("a time stamp is out of range");
    stamps.push_back(before);
  }
}

void take_file(MemoryBudget& budget, std::uint64_t bytes, const std::string& name) {
  if (!budget.take(bytes))
    throw InputError(fmt::format("{}: {}", name, budget.refusal("the file", bytes)));
}

}  // namespace

std::string work_trace_bytes(const std::filesystem::path& path, Bytes memory) {
  const base::OpenedFile file(path, base::InputKind::work_trace);
  MemoryBudget budget(memory);
  take_file(budget, file.size(), path.string());
  return file.read_all();
}

WorkTrace::WorkTrace(const std::filesystem::path& file, Bytes memory)
    : WorkTrace(file.string(), work_trace_bytes(file, memory), memory) {}

WorkTrace::WorkTrace(std::string name, std::string bytes, Bytes memory)
    : name_(std::move(name)), bytes_(std::move(bytes)), budget_(memory) {
  take_file(budget_, bytes_.size(), name_);
  const std::vector<Section> sections = sections_of(kWorkTraceFile, name_, bytes_);
  if (!sections.empty()) summary_ = sections.back();
  const std::string summary = sections.empty() ? "" : unpacked(summary_, name_, budget_);
  if (!summary.starts_with(kSummary))
    throw InputError(fmt::format("{}, byte {}: the file ends before its summary: it is truncated",
                                 name_, bytes_.size()));
  const std::string place = fmt::format("{}, summary (section at byte {})", name_, summary_.offset);
  ByteReader in(summary, place, &budget_);
  in.take(kSummary.size(), "the begin of the summary");
  read_summary(in);
  read_chunks(in, sections);
  read_stamps(in, info_.stamps_ns);
  const int frames = chunks_.empty() ? 0 : chunks_.back().first + chunks_.back().frames;
  if (static_cast<std::size_t>(frames) != info_.stamps_ns.size())
    in.fail(fmt::format("{} time stamps for {} frames", info_.stamps_ns.size(), frames));
  in.expect_end();
}

/// Up to the sections of frames.
void WorkTrace::read_summary(ByteReader& in) {
  for (std::string* text :
       {&info_.program, &info_.profile, &info_.data, &info_.platform, &info_.platform_yaml})
    *text = in.text("a text");
  info_.seed = static_cast<std::uint32_t>(read_number(in, std::uint64_t{1} << 32, "a seed"));
  info_.first_frame = read_number(in, kMostFrames, "the first frame");
  for (std::size_t i = in.count("inputs", 2 * kTextMemory); i > 0; --i) {
    const std::string input(in.text("the name of an input"));
    info_.inputs.emplace_back(input, in.text("the digest of an input"));
  }
  info_.cores = static_cast<int>(read_number(in, kMostCores, "the number of cores"));
  if (info_.cores == 0) in.fail("work of no cores");
  info_.image_width = static_cast<int>(read_number(in, kLargestSide, "the width of an image"));
  info_.image_height = static_cast<int>(read_number(in, kLargestSide, "the height of an image"));
  info_.frame_period_ns = read_number(in, kLongestPeriod, "the frame period");
  fields_ = read_fields(in);
  info_.stages.resize(in.whole_below(kMostStages + 1, "stages"));
  for (WorkTraceInfo::Stage& stage : info_.stages) {
    stage.name = in.text("the name of a stage");
    stage.unit = in.text("the unit of a stage");
    stage.on_controller = read_flag(in, "whether a stage runs on the controller");
  }
  info_.facts.resize(in.whole_below(kMostFacts + 1, "facts of frames"));
  for (std::string& fact : info_.facts) fact = in.text("the name of a fact");
  if (read_flag(in, "whether the accuracy is known")) info_.ate = read_ate(in);
  names_ = read_names(in);
  info_.l2 = read_l2(in, names_);
}

void WorkTrace::read_chunks(ByteReader& in, const std::vector<Section>& sections) {
  int frames = 0;
  const std::size_t chunks = in.count("sections of frames", sizeof(Chunk));
  if (2 * chunks + 1 != sections.size())
    in.fail(fmt::format("{} sections of frames and kernels before it; expected {}",
                        sections.size() - 1, 2 * chunks));
  for (std::size_t i = 0; i < chunks; ++i) {
    const auto n = static_cast<int>(read_number(in, 1 << 16, "frames of a section"));
    if (n == 0) in.fail("a section without frames");
    chunks_.push_back({frames, n, sections[2 * i], sections[2 * i + 1]});
    frames += n;
    if (static_cast<std::size_t>(frames) > in.left()) in.fail("more frames than time stamps");
  }
}

struct WorkTraceWriter::State {
  State(int workers, std::function<void(std::string_view)> takes)
      : cores(workers), sink(std::move(takes)), chunk(names) {
    put(file_head(kWorkTraceFile));
  }

  void put(const std::string& bytes) {
    if (sink)
      sink(bytes);
    else
      held += bytes;
  }

  void end_chunk() {
    chunk_frames.push_back(chunk.frames());
    const ChunkWriter::Contents contents = chunk.finish();
    put(packed_section(contents.frames, kLevel));
    put(packed_section(contents.offload, kLevel));
  }

  int cores;
  std::function<void(std::string_view)> sink;
  std::string held;
  NameTable names;
  ChunkWriter chunk;
  std::vector<int> chunk_frames;
  std::vector<std::int64_t> stamps_ns;
  std::optional<std::size_t> facts;  ///< of each frame
};

WorkTraceWriter::WorkTraceWriter(int cores, std::function<void(std::string_view)> sink)
    : state_(std::make_unique<State>(cores, std::move(sink))) {}
WorkTraceWriter::~WorkTraceWriter() = default;
WorkTraceWriter::WorkTraceWriter(WorkTraceWriter&&) noexcept = default;
WorkTraceWriter& WorkTraceWriter::operator=(WorkTraceWriter&&) noexcept = default;

void WorkTraceWriter::add(const WorkFrame& frame) {
  state_->stamps_ns.push_back(frame.t_ns);
  if (!state_->facts) state_->facts = frame.facts.size();
  check_equal(frame.facts.size(), *state_->facts, "facts of each frame of a trace");
  state_->chunk.add(frame);
  if (state_->chunk.frames() == kFramesPerChunk) state_->end_chunk();
}

std::string WorkTraceWriter::finish(WorkTraceInfo info) {
  if (state_->chunk.frames() > 0) state_->end_chunk();
  info.cores = state_->cores;
  if (state_->facts) check_equal(info.facts.size(), *state_->facts, "names of facts of frames");
  info.stamps_ns = state_->stamps_ns;
  state_->put(packed_section(summary_of(info, state_->names, state_->chunk_frames), kLevel));
  return std::move(state_->held);
}

}  // namespace leviosim::traces
