// What this flight and rendered ones have in common: writing the images.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "sim/outputs/output_folder.h"
#include "traces/datasets/image_file.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::traces {

/// Pixels of image i, row by row, 8-bit grey. Called from several threads.
using DrawImage = std::function<std::vector<std::uint8_t>(std::size_t i)>;

/// Writes mav0/cam0/data/<stamp>.png for each stamp, all of one size, on `threads` threads (0: as
/// many as the host has). Throws InputError if that fails.
void write_flight_images(outputs::OutputFolder& out, const std::vector<std::int64_t>& stamps_ns,
                         ImageSize size, const DrawImage& draw, unsigned threads,
                         const FlightProgress& progress);

/// Gives a flight its name. Throws InputError if it has another one now.
void commit_flight(outputs::OutputFolder& out);

}  // namespace leviosim::traces
