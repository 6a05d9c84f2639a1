// The container of binary files: a head with the kind and version of the file, then sections. Every
// byte is covered by a checksum (CRC-32 as in zlib), and contents are compressed with zstd.
//
//   head      8 bytes that name the kind of file, u32 version, u32 CRC of these twelve bytes
//   section   u32 bytes stored, u32 bytes of content, u32 CRC of these eight and of what is stored,
//             then what is stored: a zstd frame
//   …         until the end of the file
//
// The head keeps its meaning in all versions, so that a program can tell a file of another version
// from a damaged one.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "traces/work_traces/memory_budget.h"

namespace leviosim::traces {

/// No section of ours comes near; what a damaged or hostile file claims is not allocated. [bytes]
inline constexpr std::size_t kLargestSection = std::size_t{1} << 28;

struct FileKind {
  std::string_view magic;  ///< 8 bytes
  const char* name;        ///< "a work trace"
  std::uint32_t version;   ///< the one that is written and read
};

/// Checksum of one text after the other.
std::uint32_t crc_of(std::string_view a, std::string_view b = {});

std::string file_head(const FileKind& kind);
/// @param level  of zstd's compression
std::string packed_section(std::string_view content, int level);

/// A section in a file that is in memory.
struct Section {
  std::size_t offset = 0;        ///< of the section in the file
  std::string_view stored;       ///< compressed
  std::size_t content_size = 0;  ///< after decompression
};

/// All sections, their checksums compared. @param file  its name, for messages
/// @throws InputError for another kind of file, another version, truncation and damage, with the
///         byte of the file at which that shows
std::vector<Section> sections_of(const FileKind& kind, const std::string& file,
                                 std::string_view bytes);

/// The content. @param budget  pays for it
/// @throws InputError if the section does not decompress to the size that it states, and, before
///         anything is allocated, if the budget does not suffice
std::string unpacked(const Section& section, const std::string& file, MemoryBudget& budget);

}  // namespace leviosim::traces
