#include "tools/app/study/flights/benchmark.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "sim/base/error.h"
#include "sim/base/sha256.h"
#include "tools/app/cli/interrupts.h"
#include "tools/app/cli/version.h"
#include "tools/app/run/flight_cache.h"
#include "traces/datasets/asl_reader.h"
#include "traces/synthesis/rendered_flight.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using traces::FrameRange;

/// The IMU as it was recorded, so that the truth is, too.
traces::RenderedFlightOptions rendered_options(const FlightPlan& plan) {
  traces::RenderedFlightOptions options;
  options.prepared = plan.size;
  options.imu = traces::ImuSource::recorded;
  options.repair = true;
  return options;
}

/// Of the text files from which a flight is drawn, as one.
std::string digest_of_motion(const traces::MotionRecord& record) {
  traces::Dataset files;
  files.frames_csv = record.mav0 / "cam0/data.csv";
  return digest_of(files);
}

FlightMotion open_one(const FlightPlan& plan, const std::string& name, const fs::path& folder) {
  const traces::MotionRecord record = traces::open_motion(folder);
  if (record.imu.empty())
    throw InputError(
        fmt::format("{}: there is no imu0/data.csv; a benchmark takes the IMU samples "
                    "that were recorded",
                    folder.string()));
  FlightMotion motion;
  motion.stamps_ns = traces::rendered_frame_stamps(record, rendered_options(plan));
  motion.sequence.name = name;
  motion.sequence.folder = folder.string();
  motion.sequence.inputs = digest_of_motion(record);
  motion.sequence.frames = motion.stamps_ns.size();
  motion.sequence.truth = traces::to_trajectory(record.ground_truth);
  motion.sequence.path_m =
      true_path_m(motion.sequence.truth, motion.stamps_ns.front(), motion.stamps_ns.back());
  motion.starts = starts_in_motion(motion.stamps_ns, motion.sequence.truth, plan.every_s);
  return motion;
}

/// The ranges of frames of a length in a flight, and how many starts have none.
struct Ranges {
  std::vector<FrameRange> frames;
  std::size_t too_late = 0;
};

Ranges ranges_of(const FlightMotion& motion, std::size_t length) {
  Ranges ranges;
  const std::size_t all = motion.stamps_ns.size();
  if (length == kWholeFlight) {
    ranges.frames.push_back({0, all});
    return ranges;
  }
  for (const std::size_t start : motion.starts.frames)
    if (length <= all - start)
      ranges.frames.push_back({start, start + length});
    else
      ++ranges.too_late;
  return ranges;
}

FlightPiece make_piece(const FlightMotion& motion, const FrameRange& frames) {
  FlightPiece piece;
  piece.frames = frames;
  const std::int64_t begin_ns = motion.stamps_ns[frames.begin];
  piece.start_s = static_cast<double>(begin_ns - motion.stamps_ns.front()) * 1e-9;
  piece.path_m = true_path_m(motion.sequence.truth, begin_ns, motion.stamps_ns[frames.end - 1]);
  return piece;
}

void add_pieces(Benchmark& benchmark, std::size_t length) {
  const FlightPlan& plan = benchmark.plan;
  for (const FlightMotion& motion : benchmark.motions)
    benchmark.too_late += ranges_of(motion, length).too_late;
  for (std::size_t set = 0; set < plan.sets.size(); ++set)
    for (std::size_t m = 0; m < benchmark.motions.size(); ++m)
      for (const std::uint64_t world : plan.sets[set].worlds)
        for (const FrameRange& frames : ranges_of(benchmark.motions[m], length).frames) {
          FlightPiece& piece =
              benchmark.pieces.emplace_back(make_piece(benchmark.motions[m], frames));
          piece.motion = m;
          piece.set = set;
          piece.world = world;
          piece.length = length;
        }
}

/// What the pictures of a piece are made from, in place of their digests.
std::string pictures_of(const Benchmark& benchmark, const FlightPiece& piece) {
  const auto& [width, height] = benchmark.plan.size;
  return fmt::format("rendered {} world {} size {}x{} frames {}:{} by {}",
                     benchmark.motions[piece.motion].sequence.inputs, piece.world, width, height,
                     piece.frames.begin, piece.frames.end, flight_version());
}

/// "rendered/MH_01_easy-world-4-160x120-1a2b3c4d5e6f".
std::string name_in_cache(const Benchmark& benchmark, const DrawnFlight& flight) {
  const Sequence& sequence = benchmark.motions[flight.motion].sequence;
  const auto& [width, height] = benchmark.plan.size;
  std::string made_from = fmt::format("{} by {}", sequence.inputs, flight_version());
  for (const FrameRange& range : flight.frames)
    made_from += fmt::format(" {}:{}", range.begin, range.end);
  return fmt::format("rendered/{}-world-{}-{}x{}-{}", sequence.name, flight.world, width, height,
                     base::sha256_of(made_from).substr(0, 12));
}

std::string draw(const Benchmark& benchmark, const DrawnFlight& flight,
                 const RunnerOptions& runner) {
  const Sequence& sequence = benchmark.motions[flight.motion].sequence;
  traces::RenderedFlightOptions options = rendered_options(benchmark.plan);
  options.seed = flight.world;
  options.frames = flight.frames;
  options.threads = runner.threads;
  return cached_flight(name_in_cache(benchmark, flight),
                       [&](const fs::path& folder) {
                         render_flight(sequence.folder, folder, options,
                                       fmt::format("{}, world {}", sequence.name, flight.world),
                                       runner.progress);
                       })
      .string();
}

}  // namespace

Benchmark make_benchmark(FlightPlan plan, const std::string& folder) {
  Benchmark benchmark;
  benchmark.plan = std::move(plan);
  for (const std::string& name : benchmark.plan.motions) {
    throw_if_interrupted();
    benchmark.motions.push_back(open_one(benchmark.plan, name, fs::path(folder) / name));
  }
  for (const std::size_t length : benchmark.plan.lengths) add_pieces(benchmark, length);
  if (benchmark.pieces.empty())
    throw InputError(fmt::format(
        "{}: no piece begins in mid-air every {:g} s and ends within its flight; expected shorter "
        "pieces, or whole flights",
        benchmark.plan.name, benchmark.plan.every_s));
  return benchmark;
}

std::size_t row_of(const Benchmark& benchmark, std::size_t variant, std::size_t piece) {
  return variant * benchmark.pieces.size() + piece;
}

std::vector<Point> benchmark_runs(const Benchmark& benchmark) {
  std::vector<Point> runs;
  for (std::size_t v = 0; v < benchmark.plan.variants.size(); ++v)
    for (std::size_t p = 0; p < benchmark.pieces.size(); ++p)
      for (const std::uint32_t seed : benchmark.plan.seeds) {
        const FlightPiece& piece = benchmark.pieces[p];
        Point& run = runs.emplace_back();
        run.request.profile = benchmark.plan.variants[v].profile;
        run.request.workload = benchmark.plan.variants[v].workload;
        run.request.image_size = benchmark.plan.size;
        run.request.native = true;
        run.request.seed = seed;
        run.work = pictures_of(benchmark, piece);
        run.sequence = &benchmark.motions[piece.motion].sequence;
        run.row = row_of(benchmark, v, p);
      }
  return runs;
}

std::vector<DrawnFlight> drawn_flights(const Benchmark& benchmark) {
  std::map<std::pair<std::size_t, std::uint64_t>, std::vector<FrameRange>> all;
  for (const FlightPiece& piece : benchmark.pieces)
    all[{piece.motion, piece.world}].push_back(piece.frames);
  std::vector<DrawnFlight> flights;
  for (auto& [of, ranges] : all)
    flights.push_back({of.first, of.second, merged(std::move(ranges))});
  return flights;
}

void draw_flights(const Benchmark& benchmark, const Measure& how, const RunnerOptions& options,
                  std::vector<Point>& runs) {
  const OutcomeCache cache(options.cache);
  const platform::Schema schema;
  const auto piece_of = [&](const Point& run) -> const FlightPiece& {
    return benchmark.pieces[run.row % benchmark.pieces.size()];
  };
  for (const DrawnFlight& flight : drawn_flights(benchmark)) {
    std::vector<Point*> open;
    for (Point& run : runs) {
      throw_if_interrupted();
      const FlightPiece& piece = piece_of(run);
      if (piece.motion == flight.motion && piece.world == flight.world &&
          !cache.find(run_key(run, how, schema)))
        open.push_back(&run);
    }
    if (open.empty()) continue;
    const std::string folder = draw(benchmark, flight, options);
    for (Point* run : open) {
      run->request.data = folder;
      run->request.frames = within(flight.frames, piece_of(*run).frames);
    }
  }
}

}  // namespace leviosim::tools
