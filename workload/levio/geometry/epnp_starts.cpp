#include "workload/levio/geometry/epnp_starts.h"

#include <array>

#include "workload/levio/geometry/least_squares.h"
#include "workload/math/vec.h"

namespace leviosim::vio::levio {
namespace {

/// Column of L that belongs to a product of two coefficients.
enum Product : int { k11, k12, k22, k13, k23, k33, k14, k24, k34, k44 };

struct Unknowns {
  int number;
  std::array<Product, 5> products;
};
constexpr std::array<Unknowns, kStarts> kUnknownsOfStarts = {{
    {4, {k11, k12, k13, k14}},
    {3, {k11, k12, k22}},
    {5, {k11, k12, k22, k13, k23}},
}};

template <class P>
Vec3<P> difference(MatrixView<P> vectors, int k, int a, int b) {
  using F = typename P::F32;
  return {F(vectors(k, 3 * a) - vectors(k, 3 * b)),
          F(vectors(k, 3 * a + 1) - vectors(k, 3 * b + 1)),
          F(vectors(k, 3 * a + 2) - vectors(k, 3 * b + 2))};
}

/// β1 and its products with the others, of which β1β1 may come out negative.
template <class P>
void from_products_with_first(typename P::template Span<typename P::F32> x,
                              typename P::template Span<typename P::F32> betas) {
  using F = typename P::F32;
  F squared = x[0];
  F sign = 1.0f;
  if (squared < 0.0f) {
    squared = -squared;
    sign = -1.0f;
  }
  const F first = work::sqrt(squared);
  betas[0] = first;
  for (int k : P::range(1, kBetas)) betas[k] = sign * F(x[k]) / first;
}

/// β1 and β2 from their squares, which should have one sign; the sign of their product goes to β1.
template <class P>
void from_squares(typename P::template Span<typename P::F32> x,
                  typename P::template Span<typename P::F32> betas) {
  using F = typename P::F32;
  F first_squared = x[0], second_squared = x[2];
  if (first_squared < 0.0f) {
    first_squared = -first_squared;
    second_squared = -second_squared;
  }
  F first = work::sqrt(first_squared);
  F second = 0.0f;
  if (second_squared > 0.0f) second = work::sqrt(second_squared);
  if (F(x[1]) < 0.0f) first = -first;
  betas[0] = first;
  betas[1] = second;
  betas[2] = 0.0f;
  betas[3] = 0.0f;
}

/// A Jacobian row, and its residual.
template <class P>
void fill_step(const DistanceSystem<P>& system, typename P::template Span<typename P::F32> betas,
               MatrixView<P> jacobian, typename P::template Span<typename P::F32> residual) {
  using F = typename P::F32;
  const F b1 = betas[0], b2 = betas[1], b3 = betas[2], b4 = betas[3];
  for (int r : P::range(0, kDistances)) {
    const auto l = system.l.row(r);
    const F l11 = l[k11], l12 = l[k12], l22 = l[k22], l13 = l[k13], l23 = l[k23];
    const F l33 = l[k33], l14 = l[k14], l24 = l[k24], l34 = l[k34], l44 = l[k44];
    jacobian(r, 0) = 2.0f * l11 * b1 + l12 * b2 + l13 * b3 + l14 * b4;
    jacobian(r, 1) = l12 * b1 + 2.0f * l22 * b2 + l23 * b3 + l24 * b4;
    jacobian(r, 2) = l13 * b1 + l23 * b2 + 2.0f * l33 * b3 + l34 * b4;
    jacobian(r, 3) = l14 * b1 + l24 * b2 + l34 * b3 + 2.0f * l44 * b4;
    F rest = system.rho[r];
    rest -= F(l11 * b1) * b1;
    rest -= F(l12 * b1) * b2;
    rest -= F(l22 * b2) * b2;
    rest -= F(l13 * b1) * b3;
    rest -= F(l23 * b2) * b3;
    rest -= F(l33 * b3) * b3;
    rest -= F(l14 * b1) * b4;
    rest -= F(l24 * b2) * b4;
    rest -= F(l34 * b3) * b4;
    rest -= F(l44 * b4) * b4;
    residual[r] = rest;
  }
}

}  // namespace

template <class P>
void fill_distance_system(const DistanceSystem<P>& system, MatrixView<P> null_vectors,
                          MatrixView<P> control_points) {
  using F = typename P::F32;
  const typename P::Function function("levio_fill_distance_system");
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
void start_betas(const DistanceSystem<P>& system, int start,
                 typename P::template Span<typename P::F32> betas, work::Arena& scratch) {
  using F = typename P::F32;
  using Span = typename P::template Span<F>;
  const typename P::Function function("levio_start_betas");
  const Unknowns& unknowns = kUnknownsOfStarts[static_cast<std::size_t>(start)];
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> a = alloc_matrix<P>(scratch, "linear system", kDistances, unknowns.number);
  const Span b = scratch.alloc<Span>("right-hand side", kDistances);
  const Span x = scratch.alloc<Span>("products of betas", unknowns.number);
  for (int r : P::range(0, kDistances)) {
    for (int c : P::range(0, unknowns.number))
      a(r, c) = F(system.l(r, unknowns.products[static_cast<std::size_t>(c)]));
    b[r] = F(system.rho[r]);
  }
  least_squares<P>(a, b, x);
  if (start == 0) return from_products_with_first<P>(x, betas);
  from_squares<P>(x, betas);
  if (start == 2) betas[2] = F(x[3]) / F(betas[0]);
}

template <class P>
void refine_betas(const DistanceSystem<P>& system, typename P::template Span<typename P::F32> betas,
                  work::Arena& scratch) {
  using Span = typename P::template Span<typename P::F32>;
  const typename P::Function function("levio_refine_betas");
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> jacobian = alloc_matrix<P>(scratch, "Jacobian", kDistances, kBetas);
  const Span residual = scratch.alloc<Span>("residual", kDistances);
  const Span step = scratch.alloc<Span>("step", kBetas);
  for ([[maybe_unused]] int i : P::range(0, kGaussNewtonSteps)) {
    fill_step<P>(system, betas, jacobian, residual);
    least_squares<P>(jacobian, residual, step);
    for (int k : P::range(0, kBetas)) betas[k] += step[k];
  }
}

#define LEVIOSIM_INSTANTIATE(P)                                                                  \
  template void fill_distance_system<P>(const DistanceSystem<P>&, MatrixView<P>, MatrixView<P>); \
  template void start_betas<P>(const DistanceSystem<P>&, int, P::Span<P::F32>, work::Arena&);    \
  template void refine_betas<P>(const DistanceSystem<P>&, P::Span<P::F32>, work::Arena&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio::levio
