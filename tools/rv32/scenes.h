// What is measured: every stage of the workload, and small pieces of it, on fixed inputs. The same
// source runs twice: natively on RV32, where a trace of addresses is taken, and on the host on
// counted scalars, which tells what was counted for it. A scene is the life of a Function named
// "scene: …"; what is outside of scenes is not measured.
//
// One worker: the forks of a team of eight do the same, in eight shares.
#pragma once

#include <vector>

#include "sim/work/machine.h"
#include "tools/rv32/inputs.h"
#include "tools/rv32/levio_scenes.h"
#include "tools/rv32/scene_data.h"
#include "workload/graph/optimiser.h"
#include "workload/inertial/initialisation.h"
#include "workload/math/inverse_power.h"
#include "workload/math/solve.h"
#include "workload/vio/odometry/odometry.h"
#include "workload/vio/profile.h"
#include "workload/vio/triangulation.h"
#include "workload/vision/extractor.h"
#include "workload/vision/matcher.h"

namespace leviosim::rv32 {

constexpr int kFrames = 16;

template <class P>
class Scenes {
  template <class T>
  using Span = typename P::template Span<T>;
  using F = typename P::F32;
  using Byte = typename P::Byte;
  using U32 = typename P::U32;
  using Function = typename P::Function;

 public:
  explicit Scenes(const unsigned char* inputs) : inputs_(inputs) {}

  void run() {
    read_flight();
    vision();
    matching();
    LevioScenes<P> levio(data_, camera());
    levio.vision(flight_[0].pixels);
    levio.vision_as_released(flight_[0].pixels);
    levio.two_views(inputs_);
    two_views();
    optimiser();
    levio.optimiser(inputs_);
    inertial();
    linear_algebra();
    functions();
    pipelines();
  }

 private:
  struct Frame {
    Inputs::Block motion, pixels;
  };

  template <class T>
  Span<T> load(const Inputs::Block& block) {
    return rv32::load<Span<T>>(data_, block);
  }
  Span<F> noise(int n, float scale) {
    const Span<F> span = data_.alloc<Span<F>>("noise", n);
    for (int i = 0; i < n; ++i) span.data()[i] = F(noise_.next() * scale);
    return span;
  }
  vio::MatrixView<P> matrix(int rows, int cols) {
    rows = opaque(rows), cols = opaque(cols);
    return {noise(rows * cols, 1.0f), rows, cols};
  }
  /// A positive definite matrix.
  vio::MatrixView<P> square(int n) {
    const auto m = matrix(n, n), a = matrix(n, n);
    vio::multiply_transposed<P>(m, a, a);
    return m;
  }

  /// Uses a result, so that the compiler cannot drop what made it.
  void keep(const vio::Vec3<P>& v) { kept_ = kept_ + v; }

  void read_flight() {
    rig_ = inputs_.next();
    for (Frame& frame : flight_) frame = {inputs_.next(), inputs_.next()};
  }
  vio::PinholeCamera camera() const {
    return {rig_.real(0), rig_.real(1), rig_.real(2), rig_.real(3)};
  }

  void vision() {
    const vio::ImageView<P> image{load<Byte>(flight_[0].pixels), kWidth, kHeight};
    const vio::ExtractorOptions options;
    auto features = vio::alloc_features<P>(data_, options.max_features(kWidth, kHeight));
    {
      const auto stage = machine_.stage("extraction");
      const Function scene("scene: feature extraction");
      vio::extract_features<P>(machine_, image, options, features);
    }
    {
      vio::ExtractorOptions fine;  // which neither profile asks for
      fine.subpixel_steps = 8;
      const auto stage = machine_.stage("extraction between pixels");
      const Function scene("scene: feature extraction between pixels");
      vio::extract_features<P>(machine_, image, fine, features);
    }
  }

  void matching() {
    // References: most are current descriptors with some bits flipped, in another order.
    constexpr int kCurrent = 300, kReferences = 500;
    const auto words = data_.alloc<Span<U32>>("descriptors", 8 * (kCurrent + kReferences));
    for (int i = 0; i < words.size(); ++i) {
      const int from = 8 * ((i / 8 * 7) % kCurrent) + i % 8;
      std::uint32_t word = noise_.bits();
      if (i >= 8 * kCurrent && i < 8 * (kCurrent + 250))
        word = work::value(U32(words.data()[from])) ^ (word & noise_.bits() & noise_.bits());
      words.data()[i] = U32(word);
    }
    const auto current = words.subspan(0, 8 * kCurrent);
    const auto references = words.subspan(8 * kCurrent, 8 * kReferences);
    auto matches = vio::alloc_matches<P>(data_, kCurrent);
    const auto stage = machine_.stage("matching");
    {
      const Function scene("scene: matching");
      vio::match_two_way<P>(machine_, current, kCurrent, references, kReferences, {}, matches);
    }
    const Function scene("scene: levio matching");
    vio::levio::match_two_way<P>(machine_, current, kCurrent, references, kReferences, {}, matches);
  }

  /// What only `next` does with two views; the rest is in levio_scenes.h.
  void two_views() {
    inputs_.next(), inputs_.next();  // matches of landmarks and pixels
    const Span<F> a = load<F>(inputs_.next()), b = load<F>(inputs_.next());
    const vio::levio::TwoViewMatches<P> matches{a, b, a.size() / 2};
    inputs_.next(), inputs_.next();  // which of them are outliers, and the essential matrix
    const Inputs::Block pose = inputs_.next();
    vio::Mat3<P> R;
    vio::Vec3<P> t{F(pose.real(9)), F(pose.real(10)), F(pose.real(11))};
    for (int i = 0; i < 9; ++i) R.m[i / 3][i % 3] = F(pose.real(i));
    const vio::Pose<P> first = vio::Pose<P>::identity(), second{R, t};
    const Function scene("scene: triangulation");
    for (int i = 0; i < opaque(40); ++i)
      vio::triangulate<P>(first, second, matches.in_a(i), matches.in_b(i), machine_.local());
  }

  void optimiser() {
    work::Machine controller(machine("L2"));
    vio::PoseGraph<P> graph(controller.local(), vio::GraphCapacity{});
    fill(graph, inputs_);
    vio::Window<P> window(controller.local(), graph.capacity);
    vio::OptimiserOptions options;
    {
      const Function scene("scene: optimiser snapshot");
      vio::take_snapshot<P>(graph, vio::ImuNoise{}, controller.local(), window);
    }
    vio::LmState<P> damping(options);
    for (int i = 0; i < 2; ++i) {
      const auto stage = controller.stage("optimiser");
      const Function scene("scene: optimiser iteration");
      vio::optimise_once<P>(controller, window, damping, options);
    }
  }

  void inertial() {
    constexpr int kSamples = 40;
    const Span<F> readings = noise(6 * (kSamples + 1), 0.5f);
    const Span<F> record = data_.alloc<Span<F>>("record", vio::Preintegration<P>::kFloats);
    const vio::Preintegration<P> interval(record);
    interval.reset(vio::ImuBias<P>::zero());
    const auto sample = [&](int i) {
      return vio::ImuSample<P>{F(0.005f), vio::load_vec3<P>(readings, 6 * i),
                               vio::load_vec3<P>(readings, 6 * i + 3)};
    };
    const vio::ImuNoise noise_model;
    {
      const Function scene("scene: IMU pre-integration");
      for (int i = 0; i < opaque(kSamples); ++i)
        interval.integrate(sample(i), sample(i + 1), noise_model);
    }
    const vio::StillnessOptions options;
    const Span<F> memory = noise(vio::StillnessDetector<P>::floats(options), 0.1f);
    const Function scene("scene: standstill");
    vio::StillnessDetector<P> still(options, memory);
    for (int i = 0; i < opaque(25); ++i) {
      still.add(sample(i));
      if (i > 21) keep(still.evaluate().accel_mean);
      still.end_frame();
    }
    keep(vio::mean_force<P>(readings, opaque(30)));
  }

  void linear_algebra() {
    const auto A9 = matrix(9, 9), H9 = square(9);
    const Span<F> b9 = noise(9, 1.0f), x9 = noise(9, 1.0f);
    {
      const Function scene("scene: Gauss 9x9");
      vio::solve_gauss<P>(A9, b9, x9);
    }
    const Function scene("scene: inverse power 9x9");
    vio::smallest_eigenvector<P>(H9, x9, machine_.local(), opaque(15), F(1e-8f));
  }

  /// Elementary functions, a hundred times each.
  void functions() {
    const Span<F> x = noise(101, 3.0f);
    const Span<F> y = noise(100, 1.0f);
    {
      const Function scene("scene: sin");
      for (int i = 0; i < opaque(100); ++i) y.data()[i] = vio::sin_of<P>(x.data()[i]);
    }
    {
      const Function scene("scene: cos");
      for (int i = 0; i < opaque(100); ++i) y.data()[i] = vio::cos_of<P>(x.data()[i]);
    }
    const Function scene("scene: atan2");
    for (int i = 0; i < opaque(100); ++i)
      y.data()[i] = vio::atan2_of<P>(x.data()[i], x.data()[i + 1]);
  }

  void pipelines() {
    vio::Profile levio;
    levio.optimiser.anchor.rotation = 0.01f;
    levio.released = true;
    {
      const Function scene("scene: pipeline");
      pipeline(levio);
    }
    vio::Profile next = vio::profile_named("next", 1);
    next.optimiser_keyframes = 4;  // so that some leave the window within these frames
    {
      const Function scene("scene: pipeline, next");
      pipeline(next);
    }
    // These frames end before the initialisation has, so what follows on it needs a map without.
    next.alignment.enabled = false;
    const Function scene("scene: pipeline, next without initialisation");
    pipeline(next);
  }

  /// Everything together, with fewer hypotheses than in earnest: who calls what, and what comes
  /// after what.
  [[gnu::noinline]] void pipeline(vio::Profile profile) {
    profile.epnp.iterations = 16;
    profile.essential.iterations = 40;
    profile.keyframe_parallax = 0.02f;
    vio::Rig rig{camera(), kWidth, kHeight, {}};
    for (int i = 0; i < 9; ++i) rig.R_camera_body[static_cast<std::size_t>(i)] = rig_.real(4 + i);
    work::Machine cluster(machine("L1")), controller(machine("L2"));
    const auto odometry = vio::make_odometry(P::kCounting, profile, rig, cluster, controller);
    vio::FrameInput input;
    std::vector<std::uint8_t> pixels(kWidth * kHeight);
    for (const Frame& frame : flight_) {
      frame.pixels.copy_to(pixels.data(), kWidth * kHeight);
      input = {pixels.data(), kWidth, kHeight, frame.motion.real(0), {}};
      for (int i = 1; i < frame.motion.template size<float>(); i += 7) {
        const auto v = [&](int k) { return frame.motion.real(i + k); };
        input.imu.push_back({v(0), {v(1), v(2), v(3)}, {v(4), v(5), v(6)}});
      }
      const bool optimising = odometry->begin_optimisation();
      const vio::FrameReport report = odometry->process_frame(input);
      if (optimising) {
        odometry->optimise();
        odometry->publish();
      }
      reports_.push_back(report);
    }
  }

 public:
  const std::vector<vio::FrameReport>& reports() const { return reports_; }

 private:
  Inputs inputs_;
  Inputs::Block rig_;
  Frame flight_[kFrames];
  work::Arena data_{"data", Bytes(4 << 20)};
  work::Machine machine_{machine("L1")};
  Noise noise_;
  vio::Vec3<P> kept_{F(0.0f), F(0.0f), F(0.0f)};
  std::vector<vio::FrameReport> reports_;
};

}  // namespace leviosim::rv32
