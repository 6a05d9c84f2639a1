#include "workload/vision/guided_matcher.h"

#include <algorithm>

#include "sim/base/check.h"
#include "sim/work/tiles.h"

namespace leviosim::vio {
namespace {

constexpr int kNone = 0xffff;  ///< of 16 bits that index features and landmarks

/// Features by cell: those of cell c are order[begin[c]] … order[begin[c + 1] - 1].
template <class P>
struct Cells {
  using I = typename P::I32;
  using U16 = typename P::U16;

  /// @param cell  their side in px
  Cells(work::Machine& machine, int cell, int width, int height, int steps_per_px, int features)
      : columns((width + cell - 1) / cell),
        rows((height + cell - 1) / cell),
        side(cell * steps_per_px),
        begin(machine.local().template alloc<typename P::template Span<U16>>("cells of features",
                                                                             columns * rows + 1)),
        order(work::alloc_either<P, U16>(machine, "features by cell", features)) {}

  I cell_of(I x, I y) const { return (y / I(side)) * I(columns) + x / I(side); }

  int columns, rows;
  int side;  ///< in units of the coordinates
  typename P::template Span<U16> begin;
  typename P::template EitherSpan<U16> order;
};

/// Counting sort; leaves begin[c] at the first feature of cell c.
template <class P>
void sort_features(const FeatureList<P>& features, const Cells<P>& cells) {
  using I = typename P::I32;
  using U16 = typename P::U16;
  const typename P::Function function("sort_features");
  const int number = cells.columns * cells.rows;
  for (int c : P::range(0, number + 1)) cells.begin[c] = work::narrow<U16>(I(0));
  for (int i : P::range(0, features.count)) {
    const I cell = cells.cell_of(features.x[i], features.y[i]);
    cells.begin[cell] = work::narrow<U16>(I(cells.begin[cell]) + I(1));
  }
  I end = 0;
  for (int c : P::range(0, number + 1)) {
    end += I(cells.begin[c]);
    cells.begin[c] = work::narrow<U16>(end);
  }
  for (int i : P::down_range(features.count - 1, 0)) {
    const I cell = cells.cell_of(features.x[i], features.y[i]);
    const I at = I(cells.begin[cell]) - I(1);
    cells.begin[cell] = work::narrow<U16>(at);
    cells.order[at] = work::narrow<U16>(I(i));
  }
}

template <class P>
struct Candidate {
  typename P::I32 feature, distance;
};

/// The nearest descriptor among the features around (u, v).
/// @param descriptors  of the features
template <class P, class Words>
Candidate<P> search_around(const FeatureList<P>& features, const Words& descriptors,
                           const Cells<P>& cells, typename P::I32 u, typename P::I32 v, int radius,
                           const HeldDescriptor<P>& descriptor, int max_distance) {
  using I = typename P::I32;
  const typename P::Function function("search_around");
  const I side = cells.side, r = radius;
  const I left = work::max(I(u - r), I(0)) / side, top = work::max(I(v - r), I(0)) / side;
  const I right = work::min(I((u + r) / side), I(cells.columns - 1));
  const I bottom = work::min(I((v + r) / side), I(cells.rows - 1));
  const I limit = r * r;
  Candidate<P> best{kNone, max_distance};
  for (int row : P::range(work::value(top), work::value(bottom) + 1)) {
    const I first_cell = I(row) * I(cells.columns) + left;
    const I last_cell = first_cell + (right - left) + I(1);
    const I begin = cells.begin[first_cell], end = cells.begin[last_cell];
    for (int k : P::range(work::value(begin), work::value(end))) {
      const I feature = cells.order[k];
      const I dx = I(features.x[feature]) - u, dy = I(features.y[feature]) - v;
      const I distance_sq = dx * dx + dy * dy;
      if (distance_sq > limit) continue;
      const I distance = hamming_distance<P>(descriptor, descriptors, feature);
      if (distance < best.distance) best = {feature, distance};
    }
  }
  return best;
}

/// What each landmark found: a feature, or kNone.
template <class P>
struct Claims {
  typename P::template Span<typename P::U16> feature;
  typename P::template Span<typename P::Byte> distance;
};

template <class P, class Words>
void search(const GuidedInput<P>& input, const FeatureList<P>& features, const Words& descriptors,
            const Cells<P>& cells, const GuidedOptions& options, work::Share share,
            const Claims<P>& claims) {
  using F = typename P::F32;
  using I = typename P::I32;
  using U16 = typename P::U16;
  const PinholeCamera& c = input.camera;
  const F steps = static_cast<float>(input.steps);
  const F width = static_cast<float>(input.width), height = static_cast<float>(input.height);
  const int radius = static_cast<int>(options.radius_px * static_cast<float>(input.steps));
  for (int l : P::range(share.begin, share.end)) {
    claims.feature[l] = work::narrow<U16>(I(kNone));
    if (I(input.ages[l]) > I(input.max_age)) continue;
    const Vec3<P> world{F(input.points[3 * l]), F(input.points[3 * l + 1]),
                        F(input.points[3 * l + 2])};
    const Vec3<P> x = input.T_camera_world * world;
    if (!(x.z > F(options.min_depth))) continue;
    const F inverse = F(1.0f) / x.z;
    const F u = F(c.fx) * (x.x * inverse) + F(c.cx), v = F(c.fy) * (x.y * inverse) + F(c.cy);
    if (!(u > 0.0f) || !(v > 0.0f) || !(u < width) || !(v < height)) continue;
    const Candidate<P> best = search_around<P>(
        features, descriptors, cells, work::to_i32(F(u * steps)), work::to_i32(F(v * steps)),
        radius, hold_descriptor<P>(input.descriptors, l), options.max_distance);
    claims.feature[l] = work::narrow<U16>(best.feature);
    claims.distance[l] = work::narrow<typename P::Byte>(best.distance);
  }
}

/// Calls visit(input, first) with all landmarks, or with one tile of them after the other.
template <class P, class Visit>
void for_landmarks(work::Machine& machine, const GuidedInput<P>& input, Visit&& visit) {
  using F = typename P::F32;
  using U = typename P::U32;
  using Byte = typename P::Byte;
  if (!input.in_l2) return visit(input, 0);
  const work::PassingBlock<P, F> points{"tile of landmark points", input.points, 3};
  const work::PassingBlock<P, U> words{"tile of landmark descriptors", input.descriptors,
                                       kDescriptorWords};
  const work::PassingBlock<P, Byte> ages{"tile of landmark ages", input.ages, 1};
  // Blocks begin at words.
  constexpr Bytes kPadding(2 * 4);
  const work::TilePlan plan =
      work::plan_tiles(machine.local(), words.name, input.landmarks,
                       points.item() + words.item() + ages.item(), kPadding);
  work::for_each_tile<P>(
      machine, plan,
      [&](int, const work::Tile& tile, auto of_points, auto of_words, auto of_ages) {
        GuidedInput<P> part = input;
        part.points = of_points;
        part.descriptors = of_words;
        part.ages = of_ages;
        part.landmarks = tile.size();
        visit(part, tile.begin);
      },
      points, words, ages);
}

/// The landmark that gets a feature is its owner.
template <class P>
void settle(const Claims<P>& claims, int landmarks, int features,
            typename P::template EitherSpan<typename P::U16> owners, MatchList<P>& out) {
  using I = typename P::I32;
  using U16 = typename P::U16;
  const typename P::Function function("settle_claims");
  for (int f : P::range(0, features)) owners[f] = work::narrow<U16>(I(kNone));
  for (int l : P::range(0, landmarks)) {
    const I feature = claims.feature[l];
    if (feature == I(kNone)) continue;
    const I owner = owners[feature];
    if (owner != I(kNone) && I(claims.distance[owner]) <= I(claims.distance[l])) continue;
    owners[feature] = work::narrow<U16>(I(l));
  }
  int n = 0;
  for (int f : P::range(0, features)) {
    const I owner = owners[f];
    if (owner == I(kNone)) continue;
    out.query[n] = work::narrow<U16>(I(f));
    out.reference[n] = work::narrow<U16>(owner);
    out.distance[n] = work::narrow<U16>(I(claims.distance[owner]));
    ++n;
  }
  out.count = n;
}

}  // namespace

Bytes guided_memory(const GuidedOptions& options, int width, int height, int features,
                    int landmarks) {
  const int cell = options.cell_px;
  const int cells = ((width + cell - 1) / cell) * ((height + cell - 1) / cell) + 1;
  return Bytes(2LL * cells + 3LL * landmarks + 4LL * features);
}

template <class P>
void match_guided(work::Machine& machine, const GuidedInput<P>& input,
                  const FeatureList<P>& features, const GuidedOptions& options, MatchList<P>& out) {
  check(out.capacity >= std::min(features.count, input.landmarks),
        "the match list has room for every feature or every landmark");
  check(options.max_distance <= 255, "distances of guided matches are kept in a byte");
  work::Arena& local = machine.local();
  const work::EitherFrame frame(machine);
  const Cells<P> cells(machine, options.cell_px, input.width, input.height, input.steps,
                       features.count);
  const Claims<P> claims{
      local.alloc<typename P::template Span<typename P::U16>>("claimed features", input.landmarks),
      local.alloc<typename P::template Span<typename P::Byte>>("distances", input.landmarks)};
  const auto owners = work::alloc_either<P, typename P::U16>(machine, "owners", features.count);
  sort_features<P>(features, cells);
  for_landmarks<P>(machine, input, [&](const GuidedInput<P>& part, int first) {
    const Claims<P> of_part{claims.feature.subspan(first, part.landmarks),
                            claims.distance.subspan(first, part.landmarks)};
    with_descriptors(features, [&](const auto& descriptors) {
      machine.fork("search", [&](work::Core& core) {
        search<P>(part, features, descriptors, cells, options, core.share(part.landmarks), of_part);
      });
    });
  });
  settle<P>(claims, input.landmarks, features.count, owners, out);
}

template void match_guided(work::Machine&, const GuidedInput<work::Native>&,
                           const FeatureList<work::Native>&, const GuidedOptions&,
                           MatchList<work::Native>&);
template void match_guided(work::Machine&, const GuidedInput<work::Counting>&,
                           const FeatureList<work::Counting>&, const GuidedOptions&,
                           MatchList<work::Counting>&);

}  // namespace leviosim::vio
