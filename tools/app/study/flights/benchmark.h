// A benchmark of flights: the pieces that a plan asks for, and the native runs over them. Worlds
// are rendered along recorded motions when a run needs them, each once, and only the frames of its
// pieces; they are kept in the user's cache (run/flight_cache.h). Runs that are finished need no
// pictures: they are found by what the pictures are made from.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/flights/flight_pieces.h"
#include "tools/app/study/flights/flight_plan.h"
#include "tools/app/study/point.h"
#include "tools/app/study/runner.h"
#include "tools/app/study/sequence.h"
#include "traces/datasets/frame_range.h"
#include "traces/synthesis/place.h"

namespace leviosim::tools {

/// A motion or recording of the plan, opened.
struct FlightMotion {
  Sequence sequence;  ///< of the whole flight; a motion's has no pictures
  bool recorded = false;
  std::vector<std::int64_t> stamps_ns;
  Starts starts{};  ///< of a motion
};

/// Frames of a flight in one world, or as they were recorded.
struct FlightPiece {
  std::size_t motion = 0;             ///< of the benchmark
  std::size_t set = 0;                ///< of the plan
  traces::Place world{};              ///< of a motion
  std::size_t disturbance = 0;        ///< of the plan
  std::size_t length = kWholeFlight;  ///< as in the plan
  traces::FrameRange frames;          ///< of the whole flight
  double start_s = 0;                 ///< from the first frame of the flight
  double path_m = 0;                  ///< of the truth
};

struct Benchmark {
  FlightPlan plan;
  std::vector<FlightMotion> motions;  ///< those of the plan, then its recordings
  std::vector<FlightPiece> pieces;    ///< by length, set, motion, world, start, then disturbance
  std::size_t too_late =
      0;  ///< starts in motion from which a length goes beyond the end of a flight
};

/// @param folder  holds an ASL folder for each motion and recording of the plan; images of motions
///                need not be there
/// @throws InputError naming the option or file
Benchmark make_benchmark(FlightPlan plan, const std::string& folder);

/// A run for each variant, piece and seed, in this order; its row is row_of(). The benchmark must
/// outlive them. Those of motions name no data yet.
std::vector<Point> benchmark_runs(const Benchmark& benchmark);
std::size_t row_of(const Benchmark& benchmark, std::size_t variant, std::size_t piece);

/// A line for each piece.
std::string list_text(const Benchmark& benchmark);

/// What is drawn of a motion in a world: the frames of all its pieces. Recordings are not drawn.
struct DrawnFlight {
  std::size_t motion = 0;
  traces::Place world{};
  std::vector<traces::FrameRange> frames;  ///< merged()
};
/// By motion, then world.
std::vector<DrawnFlight> drawn_flights(const Benchmark& benchmark);

/// Draws what runs need that are not finished, and tells them where it is.
/// @throws InputError, Interrupted
void draw_flights(const Benchmark& benchmark, const Measure& how, const RunnerOptions& options,
                  std::vector<Point>& runs);

}  // namespace leviosim::tools
