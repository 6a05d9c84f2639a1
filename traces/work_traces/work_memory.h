// What the things in a work trace take of the host's memory once they are read, each with what a
// replay or a report makes of it later: the entries of the reader's MemoryBudget. And the numbers
// of things for which no budget stands.
#pragma once

#include <cstdint>

#include "sim/base/units.h"
#include "sim/work/program.h"

namespace leviosim::traces {

/// By default for a whole trace. The recording of a flight at 160x120 pixels takes 4 to 8 MiB.
inline constexpr Bytes kTraceMemory{std::int64_t{256} << 20};
/// Frames are read one after the other. All that is decoded of a trace is no more than the ceiling
/// and this many times the file, which bounds the time that a small file takes. Recordings reach
/// 300 to 400.
inline constexpr std::uint64_t kDecodedPerByte = 2048;
/// What a frame takes of that beside its contents: what a replay does for each, in bytes decoded in
/// the same time.
inline constexpr std::uint64_t kDecodedPerFrame = 16 << 10;

inline constexpr std::size_t kFrameMemory = 2048;  ///< stamp, result, comparison, rows of tables
inline constexpr std::size_t kJobMemory = 1024;    ///< with its timing
inline constexpr std::size_t kStageMemory =
    sizeof(work::StageRun) + 1024;  ///< of a stage in memory
inline constexpr std::size_t kStepMemory = sizeof(work::Step) + 64;
inline constexpr std::size_t kBlockMemory = 512;  ///< of a memory peak, with its statistics
inline constexpr std::size_t kTextMemory = 128;   ///< beside its characters

/// Kinds of stage; each gets some hundred statistics.
inline constexpr std::size_t kMostStages = 256;
/// Numbers that a frame yields.
inline constexpr std::size_t kMostFacts = 64;
/// What a memory of the summary takes.
inline constexpr std::size_t kMostMemories = 256;
/// Bytes of a memory or block. No memory of such chips comes near.
inline constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 40;
/// Bytes of a transfer. So low that sums over a trace do not overflow.
inline constexpr std::uint64_t kMostTransferred = std::uint64_t{1} << 34;

}  // namespace leviosim::traces
