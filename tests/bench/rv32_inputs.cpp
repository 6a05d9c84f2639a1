// leviosim_rv32_inputs DATA OUT: writes what the scenes (scenes.h) work on, as one file of blocks
// that both the RV32 program and its counted twin on the host read, so that both see the same bits.
// DATA is an ASL folder; frames are taken from it with a stride, so that keyframes come often.
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <vector>

#include "sim/base/error.h"
#include "tests/workload/graph/optimiser_scene.h"
#include "tests/workload/levio/two_view_scene.h"
#include "tools/app/run/feed.h"
#include "tools/app/run/live_source.h"

namespace leviosim::rv32 {
namespace {

constexpr int kFirstFrame = 40, kStride = 3, kFrames = 16;

/// A block: its size in bytes, then its bytes, padded to a word.
class Blocks {
 public:
  explicit Blocks(const char* path) : out_(path, std::ios::binary) {}
  template <class T>
  void add(const T* data, std::size_t n) {
    const auto bytes = static_cast<std::uint32_t>(n * sizeof(T));
    const char padding[4] = {};
    out_.write(reinterpret_cast<const char*>(&bytes), sizeof bytes);
    out_.write(reinterpret_cast<const char*>(data), bytes);
    out_.write(padding, (4 - bytes % 4) % 4);
  }
  template <class T>
  void add(const std::vector<T>& data) {
    add(data.data(), data.size());
  }
  bool good() const { return out_.good(); }

 private:
  std::ofstream out_;
};

/// Camera and body, then for each frame the time since the frame before with its IMU samples, and
/// the pixels.
void add_flight(Blocks& blocks, const std::string& folder) {
  tools::RunRequest request;
  request.data = folder;
  request.native = true;
  tools::Feed feed(request);
  const vio::Rig& rig = feed.rig();
  std::vector<float> body{rig.camera.fx, rig.camera.fy, rig.camera.cx, rig.camera.cy};
  body.insert(body.end(), rig.R_camera_body.begin(), rig.R_camera_body.end());
  blocks.add(body);
  std::vector<float> motion{0.0f};
  for (int i = 0, taken = 0; taken < kFrames; ++i) {
    const vio::FrameInput& input = feed.frame(i);
    if (i < kFirstFrame - kStride) continue;
    motion[0] += input.dt;
    for (const vio::ImuInput& sample : input.imu) {
      motion.push_back(sample.dt);
      motion.insert(motion.end(), sample.gyro, sample.gyro + 3);
      motion.insert(motion.end(), sample.accel, sample.accel + 3);
    }
    if (i < kFirstFrame || (i - kFirstFrame) % kStride != 0) continue;
    if (taken == 0) motion[0] = 0.0f;
    blocks.add(motion);
    blocks.add(input.pixels, static_cast<std::size_t>(input.width * input.height));
    motion = {0.0f};
    ++taken;
  }
}

/// The points of the first view as landmarks, the second view as the camera to be found.
void add_pnp(Blocks& blocks, const vio::test::TwoViewScene& scene, int matches) {
  std::vector<float> points, pixels;
  for (int i = 0; i < matches; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto& camera = vio::test::kCamera;
    for (int c = 0; c < 3; ++c) points.push_back(static_cast<float>(scene.points_a[k](c)));
    pixels.push_back(static_cast<float>(scene.seen_b[k].x()) * camera.fx + camera.cx);
    pixels.push_back(static_cast<float>(scene.seen_b[k].y()) * camera.fy + camera.cy);
  }
  blocks.add(points);
  blocks.add(pixels);
}

void add_two_views(Blocks& blocks) {
  vio::test::TwoViewSceneOptions options;
  options.matches = 120;
  options.outliers = 0.2;
  options.rounded = true;
  const auto scene = vio::test::make_two_view_scene(3, options);
  add_pnp(blocks, scene, 60);
  std::vector<float> a, b, E, pose;
  std::vector<std::uint8_t> mask;
  for (int i = 0; i < scene.n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (int c = 0; c < 2; ++c) {
      a.push_back(static_cast<float>(scene.seen_a[k](c)));
      b.push_back(static_cast<float>(scene.seen_b[k](c)));
    }
    mask.push_back(scene.outlier[k] ? 0 : 1);
  }
  const Eigen::Matrix3d essential = scene.essential();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      E.push_back(static_cast<float>(essential(r, c)));
      pose.push_back(static_cast<float>(scene.R_b_a(r, c)));
    }
  for (int c = 0; c < 3; ++c) pose.push_back(static_cast<float>(scene.t_b_a(c)));
  blocks.add(a);
  blocks.add(b);
  blocks.add(mask);
  blocks.add(E);
  blocks.add(pose);
}

/// A pose graph, block by block.
void add_graph(Blocks& blocks, vio::test::OptimiserSceneOptions options) {
  options.whole_pixels = true;
  vio::test::OptimiserScene<work::Native> scene(options);
  std::apply(
      [&](auto&... span) { (blocks.add(span.data(), static_cast<std::size_t>(span.size())), ...); },
      scene.graph.blocks());
}

void add_full_graph(Blocks& blocks) {
  vio::test::OptimiserSceneOptions options;
  options.landmarks = 300;
  add_graph(blocks, options);
}

/// As many landmarks, and pairs of observations of one landmark, as the released program's windows
/// have on average (workload/PARAMETERS.md#optimiser).
void add_usual_graph(Blocks& blocks) {
  vio::test::OptimiserSceneOptions options;
  options.landmarks = 318;
  options.shortest_track = options.longest_track = 2;
  options.longer_tracks = 0.164;
  add_graph(blocks, options);
}

}  // namespace
}  // namespace leviosim::rv32

int main(int argc, char** argv) {
  using namespace leviosim;
  if (argc != 3) {
    std::cerr << "usage: leviosim_rv32_inputs DATA OUT\n";
    return 2;
  }
  try {
    rv32::Blocks blocks(argv[2]);
    rv32::add_flight(blocks, argv[1]);
    rv32::add_two_views(blocks);
    rv32::add_full_graph(blocks);
    rv32::add_usual_graph(blocks);
    if (!blocks.good()) throw InputError(std::string(argv[2]) + ": cannot be written");
  } catch (const InputError& error) {
    std::cerr << error.what() << "\n";
    return 2;
  }
  return 0;
}
