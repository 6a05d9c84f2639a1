#include "workload/graph/departing_visual_terms.h"

#include "workload/graph/landmark_records.h"
#include "workload/graph/linearisation.h"
#include "workload/math/matrix.h"

namespace leviosim::vio {
namespace {

/// Rows of landmark i: its own derivatives (3 columns), those by its keyframes (6 each), residual.
template <class P>
MatrixView<P> gather_landmark(const LandmarkRecords<P>& records, int i, int number,
                              const ProjectionScratch<P>& scratch) {
  using F = typename P::F32;
  const int columns = 3 + 6 * number + 1;
  const MatrixView<P> rows(scratch.rows.subspan(0, 2 * number * columns), 2 * number, columns);
  fill<P>(rows, 0.0f);
  for (int j : P::range(0, number)) {
    const auto slot = records.slot(i, j);
    for (int row = 0; row < 2; ++row) {
      const int r = 2 * j + row;
      for (int c = 0; c < 3; ++c) rows(r, c) = F(slot[LandmarkRecords<P>::kByPoint + 3 * row + c]);
      for (int c : P::range(0, 6))
        rows(r, 3 + 6 * j + c) = F(slot[LandmarkRecords<P>::kByPose + 6 * row + c]);
      rows(r, columns - 1) = F(slot[LandmarkRecords<P>::kResidual + row]);
    }
  }
  return rows;
}

/// Householder reflections for the first three columns: from row 3 on, they are zero then.
template <class P>
void project_out_landmark(MatrixView<P> a) {
  using F = typename P::F32;
  const typename P::Function function("project_out_landmark");
  for (int k : P::range(0, 3)) {
    F length2 = 0.0f;
    for (int r : P::range(k, a.rows())) {
      const F v = a(r, k);
      length2 += v * v;
    }
    if (!(length2 > 0.0f)) continue;
    const F akk = a(k, k);
    F diagonal = work::sqrt(length2);
    if (akk > 0.0f) diagonal = -diagonal;
    const F head = akk - diagonal;
    const F tau = F(-1.0f) / (diagonal * head);
    a(k, k) = head;
    for (int c : P::range(k + 1, a.cols())) {
      F projection = 0.0f;
      for (int r : P::range(k, a.rows())) projection += a(r, k) * a(r, c);
      projection *= tau;
      for (int r : P::range(k, a.rows())) a(r, c) -= projection * a(r, k);
    }
  }
}

/// Adds the rows from the fourth on.
template <class P>
void add_projected(const Window<P>& window, MatrixView<P> rows, int first, int number,
                   const ReducedSystem<P>& system) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const typename P::Function function("add_projected");
  const int residual = rows.cols() - 1;
  const int stride = system.unknowns();
  for (int a : P::range(0, number)) {
    const I32 keyframe = window.observation_keyframes[first + a];
    const auto rhs = system.vector(keyframe);
    for (int b : P::range(0, a + 1)) {
      const auto block = system.block(keyframe, I32(window.observation_keyframes[first + b]));
      for (int r : P::range(0, 6))
        for (int c : P::range(0, a == b ? r + 1 : 6)) {
          F sum = block[r * stride + c];
          for (int e : P::range(3, rows.rows()))
            sum += rows(e, 3 + 6 * a + r) * rows(e, 3 + 6 * b + c);
          block[r * stride + c] = sum;
        }
    }
    for (int r : P::range(0, 6)) {
      F sum = rhs[r];
      for (int e : P::range(3, rows.rows())) sum -= rows(e, 3 + 6 * a + r) * rows(e, residual);
      rhs[r] = sum;
    }
  }
}

}  // namespace

template <class P>
bool departs(const Window<P>& window, int i, int departed, bool tracked) {
  using I32 = typename P::I32;
  const I32 first = window.first_observations[i];
  if (I32(window.observation_keyframes[first]) >= I32(departed)) return false;
  const I32 last = first + I32(window.observation_numbers[i]) - I32(1);
  return tracked || bool(I32(window.observation_keyframes[last]) != I32(window.keyframes - 1));
}

template <class P>
void forget_departed(const Window<P>& window, int departed, bool tracked,
                     const PoseGraph<P>& graph) {
  using I32 = typename P::I32;
  const typename P::Function function("forget_departed");
  for (int i : P::range(0, window.landmarks)) {
    if (!departs<P>(window, i, departed, tracked)) continue;
    const I32 slot = window.landmark_slots[i];
    if (I32(graph.generations[slot]) == I32(window.landmark_generations[i]))
      graph.void_observations(slot);
  }
}

template bool departs(const Window<work::Native>&, int, int, bool);
template bool departs(const Window<work::Counting>&, int, int, bool);
template void forget_departed(const Window<work::Native>&, int, bool,
                              const PoseGraph<work::Native>&);
template void forget_departed(const Window<work::Counting>&, int, bool,
                              const PoseGraph<work::Counting>&);

template <class P>
void add_departing_visual_terms(work::Machine& machine, const Window<P>& window,
                                const PixelModel<P>& model, int departed, bool tracked,
                                const LandmarkRecords<P>& all, const ProjectionScratch<P>& scratch,
                                const ReducedSystem<P>& system) {
  using I32 = typename P::I32;
  const typename P::Function function("add_departing_visual_terms");
  typename P::F32 cost = 0.0f;
  const auto add = [&](const LandmarkRecords<P>& records, int begin, int end) {
    for (int i : P::range(begin, end)) {
      if (!departs<P>(window, i, departed, tracked)) continue;
      const int first = work::value(I32(window.first_observations[i]));
      const int number = work::value(I32(window.observation_numbers[i]));
      const I32 valid = linearise_landmark<P>(window, model, i, records, cost);
      if (valid < I32(2)) continue;
      const MatrixView<P> rows = gather_landmark<P>(records, i, number, scratch);
      project_out_landmark<P>(rows);
      add_projected<P>(window, rows, first, number, system);
    }
  };
  all.fill(machine, window.landmarks, 0, add);
}

#define LEVIOSIM_INSTANTIATE(P)                                                                    \
  template void add_departing_visual_terms(work::Machine&, const Window<P>&, const PixelModel<P>&, \
                                           int, bool, const LandmarkRecords<P>&,                   \
                                           const ProjectionScratch<P>&, const ReducedSystem<P>&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
