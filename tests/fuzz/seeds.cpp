// Writes the seeds of fuzz targets that need more than text: work traces, images, trajectories,
// points of sweeps.
//   seeds FOLDER   makes FOLDER/TARGET/* for the targets work_trace, work_trace_content, image,
//   film,
//                  evaluation, asl_tables, history and sweep_points
#include <fmt/core.h>

#include <Eigen/Geometry>
#include <fstream>

#include "platform_models/loader/loader.h"
#include "tests/fuzz/checked_run.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/image_files.h"
#include "tests/traces/trace_parts.h"
#include "tests/traces/work_trace_example.h"
#include "tools/app/history/history.h"

namespace {

using namespace leviosim;                   // NOLINT: a program of one file
using namespace leviosim::traces::testing;  // NOLINT

namespace fs = std::filesystem;

void write(const fs::path& file, std::string_view content) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << content;
}

std::string joined(const std::vector<std::string>& parts) {
  std::string all;
  for (std::size_t i = 0; i < parts.size(); ++i)
    all += (i == 0 ? "" : std::string(fuzz::kBetweenParts)) + parts[i];
  return all;
}

void write_trace(const fs::path& folder, const std::string& name, const std::string& trace) {
  write(folder / "work_trace" / name, trace);
  std::vector<std::string> contents;
  for (const traces::Section& section : traces::sections_of(traces::kWorkTraceFile, name, trace)) {
    traces::MemoryBudget budget(traces::kTraceMemory);
    contents.push_back(traces::unpacked(section, name, budget));
  }
  write(folder / "work_trace_content" / name, joined(contents));
}

void write_traces(const fs::path& folder) {
  for (const int frames : {0, 1, 2, 5})
    write_trace(folder, fmt::format("example_{}", frames), example_trace(frames));
  write_trace(folder, "kernels", example_trace_with_offload(2));
  write_trace(folder, "two_sections", example_trace_with_offload(33));
  TraceParts parts;
  parts.frames = {section(1, list(1, constant_series(3, 9)),
                          frame_facts(4) +
                              list(1, stage(bytes({4, 4, 0, 8, 0, 0, 5, 0, 2, 0, 0,
                                                   0}))) +  // transfer, work, wait, fork
                              list(2, list(1, stage(list(1, bytes({3, 2, 64}))))))};
  parts.segments = 2 + parts.cores;
  write_trace(folder, "by_hand", parts.file());
}

void write_images(const fs::path& folder) {
  cv::Mat grey(48, 64, CV_8UC1);
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x < grey.cols; ++x)
      grey.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(x * y);
  cv::Mat deep;
  grey.convertTo(deep, CV_16UC1);
  write(folder / "image/grey.png", tests::png_of(grey));
  write(folder / "image/deep.png", tests::png_of(deep));
  write(folder / "image/small.png", tests::png_of(grey(cv::Rect(0, 0, 8, 8)).clone()));
  write(folder / "image/grey.pgm", "P5 2 2 255\n1234");
  write(folder / "image/grey.jpg", tests::jpeg_of(grey));
  write(folder / "image/progressive.jpg", tests::jpeg_of(grey, 90, true));
  traces::ByteWriter frame;  // of a film: image, features of five kinds, a map point
  frame.text(tests::jpeg_of(grey));
  for (const char* features : {"ab", "abcd", "", "abcdefgh", "abcd"}) frame.text(features);
  frame.whole(1);
  for (const int millimetres : {1200, -40, 3}) frame.integer(millimetres);
  write(folder / "film/frame", frame.bytes());
  const std::string png = tests::png_of(grey);
  for (const char* kind : {"zTXt", "iTXt", "iCCP", "eXIf", "abCd"})
    write(folder / "image" / (std::string(kind) + ".png"),
          tests::with_chunk(png, kind, tests::deflated(std::string(1000, 'x'))));
}

/// A walk round a circle, in one of the formats.
std::string poses(const std::string& format, int number) {
  std::string text;
  for (int i = 0; i < number; ++i) {
    const double angle = 0.3 * i;
    const Eigen::Vector3d p(2 * std::cos(angle), 2 * std::sin(angle), 0.1 * i);
    const Eigen::Quaterniond q(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
    const Eigen::Matrix3d R = q.toRotationMatrix();
    if (format == "tum")
      text += fmt::format("{:.9f} {} {} {} {} {} {} {}\n", 1 + 0.05 * i, p.x(), p.y(), p.z(), q.x(),
                          q.y(), q.z(), q.w());
    else if (format == "euroc")
      text += fmt::format("{},{},{},{},{},{},{},{},0,0,0,0,0,0,0,0,0\n", 1000000000 + 50000000L * i,
                          p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z());
    else
      for (int row = 0; row < 3; ++row)
        text += fmt::format("{} {} {} {}{}", R(row, 0), R(row, 1), R(row, 2), p[row],
                            row < 2 ? " " : "\n");
  }
  return text;
}

void write_trajectories(const fs::path& folder) {
  for (const char* estimate : {"tum", "euroc"})
    for (const char* truth : {"tum", "euroc"})
      write(folder / "evaluation" / fmt::format("{}_{}", estimate, truth),
            joined({poses(estimate, 12), poses(truth, 14)}));
  write(folder / "evaluation/kitti", joined({poses("kitti", 9), poses("kitti", 9)}));
  std::string times;
  for (int i = 0; i < 9; ++i) times += fmt::format("{}\n", 1 + 0.05 * i);
  write(folder / "evaluation/kitti_times", joined({poses("kitti", 9), poses("kitti", 9), times}));
  write(folder / "asl_tables/ground_truth", "g" + poses("euroc", 5));
}

/// A sweep of two points, one of them finished.
void write_sweep(const fs::path& file) {
  write(file, R"({"sweep":"leviosim sweep 4","points":2,"keys":"k","simulator":"0","program":"p",)"
              R"("parameters":["cores"],"place":"plan.yaml","plan":"points: { grid: {} }"})"
              "\n"
              R"({"point":1,"key":"one","set":[["cores","4"]],)"
              R"("record":{"statistics":{"energy.frame":[3.5,"mJ"]}}})"
              "\n");
}

void write_history(const fs::path& folder) {
  const fs::path empty = folder / "empty";
  write(empty, "");
  const tools::PastRun run{.origin = {"c1", "main", 1, "subject"}, .record = fuzz::checked_run()};
  write(folder / "run", tools::History::read(empty.string()).line_for(run));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "expected one argument: the folder for the seeds\n");
    return 2;
  }
  write_traces(argv[1]);
  write_images(argv[1]);
  write_trajectories(argv[1]);
  write_history(fs::path(argv[1]) / "history");
  write_sweep(fs::path(argv[1]) / "sweep_points/clean");
}
