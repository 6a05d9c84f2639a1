// Writing the images of a made-up flight, and the folder they go to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "traces/image_preparation.h"

namespace leviosim::traces {

/// Told after each written frame; calls come one at a time but from any thread.
using FlightProgress = std::function<void(std::size_t done, std::size_t total)>;

/// Pixels of image i, row by row, 8-bit grey. Called from several threads.
using DrawImage = std::function<std::vector<std::uint8_t>(std::size_t i)>;

/// Folders are replaced only if asked, and only if they are ASL folders or empty. Throws
/// InputError.
void check_flight_folder(const std::filesystem::path& out_dir, bool overwrite);

/// Writes folder/<stamp>.png for each stamp, all of one size, on `threads` threads (0: as many as
/// the host has). Throws InputError if that fails.
void write_flight_images(const std::filesystem::path& folder,
                         const std::vector<std::int64_t>& stamps_ns, ImageSize size,
                         const DrawImage& draw, unsigned threads, const FlightProgress& progress);

}  // namespace leviosim::traces
