#include "workload/geometry/epnp_betas.h"

#include <array>

#include "sim/work/policy.h"
#include "workload/math/solve.h"
#include "workload/math/vec.h"

namespace leviosim::vio {
namespace {

/// Column of L that belongs to a product of two coefficients.
enum Product : int { k11, k12, k22, k13, k23, k33, k14, k24, k34, k44 };

/// The products that a hypothesis solves for. Each row begins with β1β1 and gives β2, β3 and β4 by
/// their product with β1.
struct LinearStart {
  int unknowns;
  std::array<Product, 5> columns;
  std::array<int, kBetas - 1> with_beta1;  ///< which unknown is β1β2, β1β3, β1β4; 0 if none
};
constexpr std::array<LinearStart, kBetaHypotheses> kStarts = {{
    {4, {k11, k12, k13, k14}, {1, 2, 3}},
    {3, {k11, k12, k22}, {1, 0, 0}},
    {5, {k11, k12, k22, k13, k23}, {1, 3, 0}},
}};

template <class P>
Vec3<P> difference(MatrixView<P> vectors, int k, int a, int b) {
  using F = typename P::F32;
  return {F(vectors(3 * a, k) - vectors(3 * b, k)),
          F(vectors(3 * a + 1, k) - vectors(3 * b + 1, k)),
          F(vectors(3 * a + 2, k) - vectors(3 * b + 2, k))};
}

}  // namespace

template <class P>
void fill_distance_system(const DistanceSystem<P>& system, MatrixView<P> null_vectors,
                          MatrixView<P> control_points) {
  using F = typename P::F32;
  const typename P::Function function("fill_distance_system");
  int pair = 0;
  for (int a : P::range(0, kControlPoints - 1))
    for (int b : P::range(a + 1, kControlPoints)) {
      const auto row = system.l.row(pair);
      Vec3<P> d[kBetas];
      for (int k = 0; k < kBetas; ++k) d[k] = difference<P>(null_vectors, k, a, b);
      row[k11] = dot(d[0], d[0]);
      row[k12] = 2.0f * dot(d[0], d[1]);
      row[k22] = dot(d[1], d[1]);
      row[k13] = 2.0f * dot(d[0], d[2]);
      row[k23] = 2.0f * dot(d[1], d[2]);
      row[k33] = dot(d[2], d[2]);
      row[k14] = 2.0f * dot(d[0], d[3]);
      row[k24] = 2.0f * dot(d[1], d[3]);
      row[k34] = 2.0f * dot(d[2], d[3]);
      row[k44] = dot(d[3], d[3]);
      F squared = 0.0f;
      for (int c = 0; c < 3; ++c) {
        const F along = control_points(a, c) - control_points(b, c);
        squared += along * along;
      }
      system.rho[pair] = squared;
      ++pair;
    }
}

template <class P>
bool initial_betas(const DistanceSystem<P>& system, int hypothesis,
                   typename P::template Span<typename P::F32> betas, work::Arena& scratch) {
  using F = typename P::F32;
  using Span = typename P::template Span<F>;
  const typename P::Function function("initial_betas");
  const LinearStart& start = kStarts[static_cast<std::size_t>(hypothesis)];
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> a = alloc_matrix<P>(scratch, "linear system", kDistances, start.unknowns);
  const Span b = scratch.alloc<Span>("right-hand side", kDistances);
  const Span x = scratch.alloc<Span>("products of betas", start.unknowns);
  for (int r : P::range(0, kDistances)) {
    for (int c : P::range(0, start.unknowns))
      a(r, c) = F(system.l(r, start.columns[static_cast<std::size_t>(c)]));
    b[r] = F(system.rho[r]);
  }
  if (!solve_qr<P>(a, b, x)) return false;

  // β1β1 comes out negative where noise exceeds the model: its sign goes to the other products.
  F squared = x[0];
  F sign = 1.0f;
  if (squared < 0.0f) {
    squared = -squared;
    sign = -1.0f;
  }
  if (!(squared > 0.0f)) return false;
  const F beta1 = work::sqrt(squared);
  const F scale = sign / beta1;
  betas[0] = beta1;
  for (int k : P::range(1, kBetas)) {
    const int unknown = start.with_beta1[static_cast<std::size_t>(k - 1)];
    if (unknown > 0) {
      betas[k] = x[unknown] * scale;
    } else {
      betas[k] = 0.0f;
    }
  }
  return true;
}

template <class P>
void refine_betas(const DistanceSystem<P>& system, typename P::template Span<typename P::F32> betas,
                  int steps, work::Arena& scratch) {
  using F = typename P::F32;
  using Span = typename P::template Span<F>;
  const typename P::Function function("refine_betas");
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> jacobian = alloc_matrix<P>(scratch, "Jacobian", kDistances, kBetas);
  const Span residual = scratch.alloc<Span>("residual", kDistances);
  const Span step = scratch.alloc<Span>("step", kBetas);
  for ([[maybe_unused]] int i : P::range(0, steps)) {
    const F b1 = betas[0], b2 = betas[1], b3 = betas[2], b4 = betas[3];
    for (int r : P::range(0, kDistances)) {
      const auto l = system.l.row(r);
      const F l11 = l[k11], l12 = l[k12], l22 = l[k22], l13 = l[k13], l23 = l[k23];
      const F l33 = l[k33], l14 = l[k14], l24 = l[k24], l34 = l[k34], l44 = l[k44];
      // L ββ = ½ βᵀ (its gradient), because it is quadratic.
      const F d1 = 2.0f * l11 * b1 + l12 * b2 + l13 * b3 + l14 * b4;
      const F d2 = l12 * b1 + 2.0f * l22 * b2 + l23 * b3 + l24 * b4;
      const F d3 = l13 * b1 + l23 * b2 + 2.0f * l33 * b3 + l34 * b4;
      const F d4 = l14 * b1 + l24 * b2 + l34 * b3 + 2.0f * l44 * b4;
      jacobian(r, 0) = d1;
      jacobian(r, 1) = d2;
      jacobian(r, 2) = d3;
      jacobian(r, 3) = d4;
      const F twice = b1 * d1 + b2 * d2 + b3 * d3 + b4 * d4;
      residual[r] = system.rho[r] - 0.5f * twice;
    }
    if (!solve_qr<P>(jacobian, residual, step)) return;
    for (int k : P::range(0, kBetas)) betas[k] += step[k];
  }
}

#define LEVIOSIM_INSTANTIATE(P)                                                                  \
  template void fill_distance_system<P>(const DistanceSystem<P>&, MatrixView<P>, MatrixView<P>); \
  template bool initial_betas<P>(const DistanceSystem<P>&, int, P::Span<P::F32>, work::Arena&);  \
  template void refine_betas<P>(const DistanceSystem<P>&, P::Span<P::F32>, int, work::Arena&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
