// Counting against native for each kernel: what it costs to know the work. Each iteration runs both
// policies one after the other on the same data; the counter `ratio` is counting time over native.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "sim/work/machine.h"
#include "tests/bench/cpu_time.h"
#include "workload/inertial/preintegration.h"
#include "workload/levio/geometry/epnp_ransac.h"
#include "workload/levio/geometry/essential_ransac.h"
#include "workload/levio/geometry/jacobi.h"
#include "workload/levio/vision/levio_matcher.h"
#include "workload/math/matrix.h"
#include "workload/vision/extractor.h"
#include "workload/vision/matcher.h"

namespace leviosim::vio {
namespace {

/// Reproducible numbers in [-1, 1).
class Noise {
 public:
  float next() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<float>(static_cast<std::int32_t>(state_ >> 32)) * 0x1p-31f;
  }

 private:
  std::uint64_t state_ = 1;
};

constexpr PinholeCamera kCamera{114.66f, 114.32f, 77.80f, 62.09f};

/// One kernel on its own data: built once per policy, run many times.
template <class P>
struct Bench {
  template <class T>
  using Span = typename P::template Span<T>;
  using F = typename P::F32;

  work::Machine machine{{.cores = 8, .capacity = Bytes(1 << 22), .record = P::kCounting}};
  work::Arena data{"bench", Bytes(1 << 24)};
  Noise noise;

  Span<F> noise_floats(int n, float scale) {
    const auto span = data.alloc<Span<F>>("noise", n);
    for (int i = 0; i < n; ++i) span[i] = F(noise.next() * scale);
    return span;
  }
  /// A picture with corners: overlapping random rectangles.
  ImageView<P> picture(int w, int h) {
    std::vector<int> grey(static_cast<std::size_t>(w * h), 128);
    for (int k = 0; k < 400; ++k) {
      const int x0 = static_cast<int>(std::abs(noise.next()) * static_cast<float>(w));
      const int y0 = static_cast<int>(std::abs(noise.next()) * static_cast<float>(h));
      const int side = 4 + static_cast<int>(std::abs(noise.next()) * 16);
      const int value = static_cast<int>(std::abs(noise.next()) * 255);
      for (int y = y0; y < std::min(h, y0 + side); ++y)
        for (int x = x0; x < std::min(w, x0 + side); ++x)
          grey[static_cast<std::size_t>(y * w + x)] = value;
    }
    const auto pixels = data.alloc<Span<typename P::Byte>>("picture", w * h);
    for (int i = 0; i < w * h; ++i)
      pixels[i] = work::narrow<typename P::Byte>(grey[static_cast<std::size_t>(i)]);
    return {pixels, w, h};
  }
};

template <class P>
std::function<void()> extraction(Bench<P>& b) {
  const ImageView<P> image = b.picture(160, 120);
  return [&b, image] {
    const work::Arena::Frame frame(b.machine.local());
    const ExtractorOptions options;
    FeatureList<P> out = alloc_features<P>(b.machine.local(), options.max_features(160, 120));
    const auto stage = b.machine.stage("extraction");
    extract_features<P>(b.machine, image, options, out);
    benchmark::DoNotOptimize(out.count);
  };
}

/// @param match  match_two_way() of everything else, or that of `levio`
template <class P>
std::function<void()> matching_by(decltype(&match_two_way<P>) match, Bench<P>& b) {
  constexpr int kCurrent = 360, kReference = 1000;
  const auto words = b.data.template alloc<typename P::template Span<typename P::U32>>(
      "words", 8 * (kCurrent + kReference));
  for (int i = 0; i < words.size(); ++i)
    words[i] = typename P::U32(static_cast<std::uint32_t>(b.noise.next() * 2147483000.0f));
  return [&b, words, match] {
    const work::Arena::Frame frame(b.machine.local());
    MatchList<P> out = alloc_matches<P>(b.machine.local(), kCurrent);
    const auto stage = b.machine.stage("matching");
    match(b.machine, words.subspan(0, 8 * kCurrent), kCurrent,
          words.subspan(8 * kCurrent, 8 * kReference), kReference, {}, out);
    benchmark::DoNotOptimize(out.count);
  };
}

template <class P>
std::function<void()> matching(Bench<P>& b) {
  return matching_by<P>(match_two_way<P>, b);
}

template <class P>
std::function<void()> levio_matching(Bench<P>& b) {
  return matching_by<P>(levio::match_two_way<P>, b);
}

template <class P>
std::function<void()> epnp(Bench<P>& b) {
  using F = typename P::F32;
  constexpr int kMatches = 100;
  const auto points = b.noise_floats(3 * kMatches, 2.0f);
  const auto pixels = b.noise_floats(2 * kMatches, 0.3f);
  for (int i = 0; i < kMatches; ++i) {
    const float x = work::value(F(points[3 * i])), y = work::value(F(points[3 * i + 1]));
    const float z = work::value(F(points[3 * i + 2])) + 4.0f;
    points[3 * i + 2] = F(z);
    pixels[2 * i] += F(kCamera.fx * x / z + kCamera.cx);
    pixels[2 * i + 1] += F(kCamera.fy * y / z + kCamera.cy);
  }
  const auto random = std::make_shared<levio::ShiftRegister<P>>(1u);
  return [&b, points, pixels, random] {
    const work::Arena::Frame frame(b.machine.local());
    const auto stage = b.machine.stage("epnp");
    benchmark::DoNotOptimize(levio::estimate_pose_epnp<P>(
        b.machine, {points, pixels, kMatches}, levio::CameraConstants<P>(kCamera), *random, {}));
  };
}

template <class P>
std::function<void()> eight_point(Bench<P>& b) {
  using F = typename P::F32;
  constexpr int kMatches = 150;
  const auto a = b.noise_floats(2 * kMatches, 0.6f);
  const auto c = b.noise_floats(2 * kMatches, 0.002f);
  for (int i = 0; i < kMatches; ++i) {  // a sideways step in front of points at various depths
    const float depth = 2.0f + std::abs(b.noise.next()) * 3.0f;
    c[2 * i] += F(work::value(F(a[2 * i])) - 0.15f / depth);
    c[2 * i + 1] += F(a[2 * i + 1]);
  }
  const auto random = std::make_shared<levio::ShiftRegister<P>>(1u);
  return [&b, a, c, random] {
    const work::Arena::Frame frame(b.machine.local());
    const MatrixView<P> E = alloc_matrix<P>(b.machine.local(), "E", 3, 3);
    const auto mask = b.machine.local().template alloc<typename P::template Span<typename P::Byte>>(
        "mask", kMatches);
    const F pixel = 0.7f / kCamera.fx;
    const auto stage = b.machine.stage("8-point");
    benchmark::DoNotOptimize(levio::estimate_essential<P>(b.machine, {a, c, kMatches},
                                                          pixel * pixel, *random, {}, E, mask));
  };
}

template <class P>
std::function<void()> jacobi12(Bench<P>& b) {
  const auto square = b.noise_floats(144, 1.0f);
  return [&b, square] {
    const work::Arena::Frame frame(b.machine.local());
    const auto A = alloc_matrix<P>(b.machine.local(), "A", 12, 12);
    const auto V = alloc_matrix<P>(b.machine.local(), "V", 12, 12);
    multiply_transposed<P>(A, MatrixView<P>(square, 12, 12), MatrixView<P>(square, 12, 12));
    benchmark::DoNotOptimize(levio::jacobi_eigen<P>(A, V, 120, 1e-8f));
  };
}

template <class P>
std::function<void()> preintegration(Bench<P>& b) {
  using F = typename P::F32;
  const auto record =
      b.data.template alloc<typename P::template Span<F>>("record", Preintegration<P>::kFloats);
  const auto readings = b.noise_floats(6 * 11, 0.5f);
  return [record, readings] {
    const Preintegration<P> interval(record);
    interval.reset(ImuBias<P>::zero());
    const auto sample = [&](int i) {
      return ImuSample<P>{0.005f, load_vec3<P>(readings, 6 * i), load_vec3<P>(readings, 6 * i + 3)};
    };
    for (int i = 0; i < 10; ++i) interval.integrate(sample(i), sample(i + 1), {});
    benchmark::DoNotOptimize(record.data());
  };
}

double seconds(const std::function<void()>& body, int times) {
  const double begin = cpu_seconds();
  for (int i = 0; i < times; ++i) body();
  return cpu_seconds() - begin;
}

/// Runs both policies alternately; reports the median of the ratios.
template <class MakeNative, class MakeCounting>
void compare(benchmark::State& state, MakeNative make_native, MakeCounting make_counting,
             int times) {
  Bench<work::Native> native;
  Bench<work::Counting> counting;
  const auto plain = make_native(native);
  const auto counted = make_counting(counting);
  std::vector<double> ratios, microseconds;
  for (auto _ : state) {
    const double a = seconds(plain, times);
    const double b = seconds(counted, times);
    counting.machine.take_job();
    ratios.push_back(b / a);
    microseconds.push_back(1e6 * a / times);
  }
  std::sort(ratios.begin(), ratios.end());
  std::sort(microseconds.begin(), microseconds.end());
  state.counters["ratio"] = ratios[ratios.size() / 2];
  state.counters["native_us"] = microseconds[microseconds.size() / 2];
}

BENCHMARK_CAPTURE(compare, extraction, extraction<work::Native>, extraction<work::Counting>, 5)
    ->Iterations(15)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(compare, matching, matching<work::Native>, matching<work::Counting>, 5)
    ->Iterations(15)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(compare, levio_matching, levio_matching<work::Native>,
                  levio_matching<work::Counting>, 5)
    ->Iterations(15)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(compare, epnp, epnp<work::Native>, epnp<work::Counting>, 3)
    ->Iterations(15)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(compare, eight_point, eight_point<work::Native>, eight_point<work::Counting>, 3)
    ->Iterations(15)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(compare, jacobi12, jacobi12<work::Native>, jacobi12<work::Counting>, 200)
    ->Iterations(15)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(compare, preintegration, preintegration<work::Native>,
                  preintegration<work::Counting>, 2000)
    ->Iterations(15)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace leviosim::vio

BENCHMARK_MAIN();
