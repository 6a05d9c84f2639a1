#include "traces/synthesis/smoothing_spline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "traces/datasets/rng.h"

namespace leviosim::traces {
namespace {

constexpr double kTwoPi = 6.283185307179586476925;

/// Uneven times from 0 to about `seconds`.
std::vector<double> uneven_times(double seconds, double step_s) {
  Rng rng(1);
  std::vector<double> times;
  for (double t = 0; t < seconds; t += step_s * rng.uniform(0.5, 1.5)) times.push_back(t);
  return times;
}

Eigen::MatrixXd sampled(const std::vector<double>& times, double (*f)(double)) {
  Eigen::MatrixXd samples(static_cast<Eigen::Index>(times.size()), 1);
  for (std::size_t i = 0; i < times.size(); ++i)
    samples(static_cast<Eigen::Index>(i), 0) = f(times[i]);
  return samples;
}

double sine(double t) { return std::sin(kTwoPi * t); }
double line(double t) { return 3 - 2 * t; }

TEST(SmoothingSpline, InterpolatesWithItsDerivatives) {
  const std::vector<double> times = uneven_times(2, 0.01);
  const SmoothingSpline spline(times, sampled(times, sine));
  for (const double t : times) EXPECT_NEAR(spline.at(t).value[0], sine(t), 1e-14);
  for (double t = 0.25; t < 1.75; t += 0.0037) {
    const SplineState state = spline.at(t);
    EXPECT_NEAR(state.value[0], sine(t), 1e-6);
    EXPECT_NEAR(state.first[0], kTwoPi * std::cos(kTwoPi * t), 1e-3);
    EXPECT_NEAR(state.second[0], -kTwoPi * kTwoPi * sine(t), 0.1);
  }
}

TEST(SmoothingSpline, DerivativesAreThoseOfTheCurve) {
  const std::vector<double> times = uneven_times(1, 0.05);
  const SmoothingSpline spline(times, sampled(times, sine), 5.0);
  constexpr double kStep = 1e-5;
  for (double t = 0.003; t < 0.9; t += 0.0301) {
    const SplineState before = spline.at(t - kStep), after = spline.at(t + kStep);
    EXPECT_NEAR((after.value - before.value)[0] / (2 * kStep), spline.at(t).first[0], 1e-6);
    EXPECT_NEAR((after.first - before.first)[0] / (2 * kStep), spline.at(t).second[0], 1e-3);
  }
}

TEST(SmoothingSpline, StraightLinesStayAndGoOn) {
  const std::vector<double> times = uneven_times(1, 0.05);
  for (const double half_gain_hz : {SmoothingSpline::kInterpolate, 1.0}) {
    const SmoothingSpline spline(times, sampled(times, line), half_gain_hz);
    for (const double t : {-5.0, 0.0, 0.333, 7.0}) {
      EXPECT_NEAR(spline.at(t).value[0], line(t), 1e-9);
      EXPECT_NEAR(spline.at(t).first[0], -2, 1e-9);
    }
  }
}

TEST(SmoothingSpline, TwoSamplesMakeALine) {
  const SmoothingSpline spline({1, 3}, sampled({1, 3}, line));
  EXPECT_NEAR(spline.at(2).value[0], line(2), 1e-12);
}

TEST(SmoothingSpline, GainIsThatOfTheLowPass) {
  // At f_half a sine keeps half of its amplitude, an octave above 1/17, an octave below 16/17.
  std::vector<double> times;
  for (int i = 0; i <= 4000; ++i) times.push_back(i * 0.005);
  for (const auto& [octaves, gain] : {std::pair(0.0, 0.5), {1.0, 1.0 / 17}, {-1.0, 16.0 / 17}}) {
    const SmoothingSpline spline(times, sampled(times, sine), std::exp2(-octaves));
    for (double t = 8.25; t < 12; t += 0.5)
      EXPECT_NEAR(spline.at(t).value[0] / sine(t), gain, 1e-3) << octaves;
  }
}

}  // namespace
}  // namespace leviosim::traces
