// Scenes of the released program's work (workload/levio), one for each unit of work whose
// instructions are known of the release: units.csv sets them side by side. That all of its
// functions are reached is left to the scene of the whole pipeline.
#pragma once

#include "tools/rv32/scene_data.h"
#include "workload/levio/geometry/eight_point.h"
#include "workload/levio/geometry/epnp_ransac.h"
#include "workload/levio/geometry/essential_ransac.h"
#include "workload/levio/geometry/pose_matrix.h"
#include "workload/levio/geometry/pose_recovery.h"
#include "workload/levio/geometry/two_view_point.h"
#include "workload/levio/optimiser/levio_optimiser.h"
#include "workload/levio/vision/levio_extractor.h"
#include "workload/levio/vision/levio_matcher.h"

namespace leviosim::rv32 {

template <class P>
class LevioScenes {
  template <class T>
  using Span = typename P::template Span<T>;
  using F = typename P::F32;
  using Byte = typename P::Byte;
  using Function = typename P::Function;

 public:
  /// @param data  outlives this
  LevioScenes(work::Arena& data, const vio::PinholeCamera& camera)
      : data_(data),
        fx_(camera.fx),
        fy_(camera.fy),
        cx_(camera.cx),
        cy_(camera.cy),
        camera_(camera) {}

  void vision(const Inputs::Block& pixels) {
    const vio::ImageView<P> image{load<Byte>(pixels), kWidth, kHeight};
    const vio::ExtractorOptions options;
    auto features = vio::alloc_features<P>(data_, options.max_features(kWidth, kHeight));
    const auto stage = machine_.stage("extraction");
    const Function scene("scene: levio feature extraction");
    vio::levio::extract_features<P>(machine_, image, options, vio::levio::DescriptorKind::Exact,
                                    features);
  }

  void vision_as_released(const Inputs::Block& pixels) {
    const vio::ImageView<P> image{load<Byte>(pixels), kWidth, kHeight};
    const vio::ExtractorOptions options;
    auto features = vio::alloc_features<P>(data_, options.max_features(kWidth, kHeight));
    const auto stage = machine_.stage("extraction");
    const Function scene("scene: levio feature extraction as released");
    vio::levio::extract_features<P>(machine_, image, options, vio::levio::DescriptorKind::Released,
                                    features);
  }

  /// @param inputs  at the matches of landmarks and pixels
  void two_views(Inputs inputs) {
    const Span<F> points = load<F>(inputs.next()), pixels = load<F>(inputs.next());
    {
      const auto stage = machine_.stage("EPnP");
      const Function scene("scene: levio EPnP RANSAC");
      vio::levio::estimate_pose_epnp<P>(machine_, {points, pixels, points.size() / 3}, camera_,
                                        random_, {});
    }
    const Span<F> a = load<F>(inputs.next()), b = load<F>(inputs.next());
    const vio::levio::TwoViewMatches<P> matches{a, b, a.size() / 2};
    const Span<F> pixels_a = pixels_of(a), pixels_b = pixels_of(b);
    const auto essential = vio::alloc_matrix<P>(data_, "essential matrix", 3, 3);
    {
      const Span<Byte> mask = data_.alloc<Span<Byte>>("mask", matches.n);
      const float threshold = 0.7f / fx_;
      const auto stage = machine_.stage("8-point");
      const Function scene("scene: levio 8-point RANSAC");
      vio::levio::estimate_essential<P>(machine_, matches, F(threshold * threshold), random_,
                                        {.iterations = 160}, essential, mask);
    }
    {
      const auto stage = machine_.stage("pose recovery");
      const Function scene("scene: levio pose recovery");
      vio::levio::recover_pose<P>(machine_, essential, {pixels_a, pixels_b, matches.n}, camera_);
    }
    inputs.next();  // which matches are no outliers
    sampson_scoring(inputs.next(), matches);
    triangulation(inputs.next(), pixels_a, pixels_b);
  }

  /// @param inputs  at a pose graph
  void optimiser(Inputs& inputs) {
    work::Machine controller(machine("L2"));
    vio::PoseGraph<P> graph(controller.local(), vio::GraphCapacity{});
    fill(graph, inputs);
    vio::Window<P> window(controller.local(), graph.capacity);
    vio::take_snapshot<P>(graph, vio::ImuNoise{}, controller.local(), window);
    const vio::OptimiserOptions options;
    vio::LmState<P> damping(options);
    for (int i = 0; i < 2; ++i) {
      const auto stage = controller.stage("optimiser");
      const Function scene("scene: levio optimiser iteration");
      vio::levio::optimise_once<P>(controller, window, damping, options);
      vio::estimate_biases<P>(window, vio::ImuNoise{}, vio::BiasOptions{});
    }
  }

 private:
  template <class T>
  Span<T> load(const Inputs::Block& block) {
    return rv32::load<Span<T>>(data_, block);
  }

  /// Of normalised coordinates, two per match.
  Span<F> pixels_of(const Span<F>& normalised) {
    const Span<F> pixels = data_.alloc<Span<F>>("pixels", normalised.size());
    for (int i = 0; i < pixels.size(); i += 2) {
      pixels.data()[i] = F(work::value(normalised.data()[i]) * fx_ + cx_);
      pixels.data()[i + 1] = F(work::value(normalised.data()[i + 1]) * fy_ + cy_);
    }
    return pixels;
  }

  /// Scores a hypothesis that most matches support, as the best one of the released program.
  /// @param true_essential  nine elements, row by row
  void sampson_scoring(const Inputs::Block& true_essential,
                       const vio::levio::TwoViewMatches<P>& matches) {
    const Span<F> E = load<F>(true_essential);
    const Span<Byte> mask = data_.alloc<Span<Byte>>("scored mask", matches.n);
    const auto inliers = data_.alloc<Span<typename P::I32>>("scored inliers", 1);
    const Span<F> error = data_.alloc<Span<F>>("scored errors", 1);
    const float threshold = 0.7f / fx_;
    const auto stage = machine_.stage("scoring");
    const Function scene("scene: levio Sampson scoring");
    vio::levio::score_essential<P>({E, 3, 3}, matches, F(threshold * threshold), mask,
                                   {inliers, error});
  }

  /// @param pose  of the second view: a rotation, row by row, and a translation
  void triangulation(const Inputs::Block& pose, const Span<F>& a, const Span<F>& b) {
    vio::Pose<P> second;
    for (int i = 0; i < 9; ++i) second.R.m[i / 3][i % 3] = F(pose.real(i));
    second.t = {F(pose.real(9)), F(pose.real(10)), F(pose.real(11))};
    const auto T_a = vio::alloc_matrix<P>(data_, "first pose", 4, 4);
    const auto T_b = vio::alloc_matrix<P>(data_, "second pose", 4, 4);
    vio::levio::store_pose<P>(T_a, vio::Pose<P>::identity());
    vio::levio::store_pose<P>(T_b, second);
    const auto stage = machine_.stage("triangulation");
    const Function scene("scene: levio triangulation");
    for (int i = 0; i < opaque(40); ++i) {
      const vio::Vec2<P> in_a{F(a[2 * i]), F(a[2 * i + 1])}, in_b{F(b[2 * i]), F(b[2 * i + 1])};
      const vio::Vec3<P> point =
          vio::levio::triangulate<P>(T_a, T_b, in_a, in_b, camera_, machine_.local());
      error_sq_ += vio::levio::reprojection_error_sq<P>(T_b, point, in_b, camera_);
    }
  }

  work::Arena& data_;
  float fx_, fy_, cx_, cy_;
  vio::levio::CameraConstants<P> camera_;
  vio::levio::ShiftRegister<P> random_{7};
  work::Machine machine_{machine("L1")};
  F error_sq_ = 0.0f;  ///< of all points, so that the compiler cannot drop what made it
};

}  // namespace leviosim::rv32
