#include "workload/flow/estimator.h"

#include <fmt/format.h>

#include <string>

#include "sim/base/error.h"
#include "sim/work/policy.h"
#include "workload/flow/block_matching.h"
#include "workload/flow/options.h"
#include "workload/vision/slices.h"

namespace leviosim::flow {
namespace {

// One displacement from those of many blocks: each axis has a histogram over half pixels, its
// fullest bin wins, and the mean over the bins within a pixel of it is the flow. Blocks on
// something that moves otherwise, or matched wrongly, fall elsewhere.
//
// Fixed point, because not all chips have floating-point units: 1/256 px.

inline constexpr int kFractionBits = 8;
/// Bins to either side of the fullest that take part in the mean: one pixel.
inline constexpr int kVoteRadius = 2;

/// Of one axis; bins for -(2 search + 1) … 2 search + 1 half pixels.
template <class P>
class Histogram {
  using I = typename P::I32;

 public:
  explicit Histogram(int search) : zero_(2 * search + 1) {
    for (int bin : P::range(0, bins())) count_[bin] = I(0);
  }

  void add(I half_pixels) {
    const I bin = half_pixels + I(zero_);
    count_[bin] = I(count_[bin]) + I(1);
  }

  /// The flow in 1/256 px, rounded down; the first of equally full bins wins. At least one
  /// displacement has been added.
  I flow() {
    I fullest = 0;
    I most = 0;
    for (int bin : P::range(0, bins())) {
      const I n = count_[bin];
      if (n > most) {
        most = n;
        fullest = bin;
      }
    }
    const int begin = work::value(work::max(I(0), I(fullest - I(kVoteRadius))));
    const int end = work::value(work::min(I(bins()), I(fullest + I(kVoteRadius + 1))));
    I sum = 0;
    I number = 0;
    for (int bin : P::range(begin, end)) {
      const I n = count_[bin];
      sum += n * I(bin);
      number += n;
    }
    // Bins are half pixels, hence one bit less; they are not negative, so the quotient is exact
    // in its rounding.
    return (sum << (kFractionBits - 1)) / number - (I(zero_) << (kFractionBits - 1));
  }

 private:
  static constexpr int kMostBins = 2 * (2 * Options::kLargestSearch + 1) + 1;
  int bins() const { return 2 * zero_ + 1; }

  int zero_;  ///< the bin of no displacement
  typename P::template Array<I, kMostBins> count_;
};

}  // namespace

void Options::validate() const {
  const auto require = [](bool ok, const char* option, int value, const std::string& expected) {
    if (!ok)
      throw InputError(fmt::format("optical flow: {} is {}, expected {}", option, value, expected));
  };
  require(side % 4 == 0 && side >= 4 && side <= kLargestSide, "side", side,
          fmt::format("a multiple of 4, at most {} px", kLargestSide));
  require(search >= 1 && search <= kLargestSearch, "search", search,
          fmt::format("1 to {} px", kLargestSearch));
  const int room = side - 2 * margin() - kBlock;
  require(room >= 0, "side", side,
          fmt::format("at least {} px: a block, the search and a pixel on either side",
                      2 * margin() + kBlock));
  require(grid >= 1 && grid <= room + 1, "grid", grid,
          fmt::format("1 to {}, the places for blocks along {} px", room + 1, side));
  require(min_matches >= 1 && min_matches <= blocks(), "min_matches", min_matches,
          fmt::format("1 to {}, the number of blocks", blocks()));
}

namespace {

/// What a block's displacement is stored as if it has none.
constexpr int kNoMatch = 0x7fff;

template <class P>
class EstimatorOf : public Estimator {
  using I = typename P::I32;
  using F = typename P::F32;
  using Table = typename P::template Span<I>;
  using Words = typename P::template Span<Word<P>>;

 public:
  EstimatorOf(const Options& options, work::Machine& machine)
      : options_(options), machine_(machine) {
    options.validate();
    work::Arena& memory = machine.local();
    memory.set_user(kStages[0]);
    const int words = options.side * options.side / 4;
    now_ = memory.alloc<Words>("image", words);
    before_ = memory.alloc<Words>("image before", words);
  }

  Flow process(const Input& input) override;

 private:
  void transfer(const std::uint8_t* pixels);
  /// Fills `list` with the first pixels of blocks that have texture.
  void select(Table list, Table kept);
  void search(Table list, Table best_column, Table best_difference);
  void refine(Table list, Table best_column, Table best_difference, Table displacement);
  Flow vote(Table displacement, const Input& input);

  Image<P> now() const { return {now_, options_.side}; }
  Image<P> before() const { return {before_, options_.side}; }
  /// First pixel of a block. Blocks lie on a grid, evenly spaced from margin to margin.
  I first_pixel(I block) const;
  /// What rotation of the camera moves the picture by, 1/256 px.
  I of_rotation(float rate, float dt) const;

  Options options_;
  work::Machine& machine_;
  Words now_, before_;
  bool has_before_ = false;
  int textured_ = 0;
};

template <class P>
typename P::I32 EstimatorOf<P>::first_pixel(I block) const {
  const int steps = options_.grid > 1 ? options_.grid - 1 : 1;
  const I room = options_.side - 2 * options_.margin() - kBlock;
  const I row = block / I(options_.grid);
  const I column = block - row * I(options_.grid);
  const I y = (row * room) / I(steps) + I(options_.margin());
  const I x = (column * room) / I(steps) + I(options_.margin());
  return y * I(options_.side) + x;
}

template <class P>
void EstimatorOf<P>::transfer(const std::uint8_t* pixels) {
  const auto stage = machine_.stage(kStages[0]);
  std::swap(now_, before_);
  // The camera's buffer as the transfer sees it; it is only read.
  const auto* words = reinterpret_cast<const Word<P>*>(pixels);
  machine_.copy_in(now_, typename P::template L2Span<const Word<P>>(words, now_.size()));
}

template <class P>
void EstimatorOf<P>::select(Table list, Table kept) {
  const auto stage = machine_.stage(kStages[1]);
  machine_.fork("texture", [&](work::Core& core) {
    const auto [begin, end] = core.share(options_.blocks());
    I next = begin;
    for (int block : P::range(begin, end)) {
      const I first = first_pixel(block);
      if (texture<P>(before(), work::value(first)) > I(options_.min_texture)) {
        list[next] = first;
        next += I(1);
      }
    }
    kept[core.id] = next - I(begin);
  });
  textured_ = vio::compact_slices<P>(options_.blocks(), 1, kept,
                                     [&](int to, int from) { list[to] = I(list[from]); });
}

template <class P>
void EstimatorOf<P>::search(Table list, Table best_column, Table best_difference) {
  const int rows = options_.candidates();
  const I reach = options_.search;
  machine_.fork("search", [&](work::Core& core) {
    const auto [begin, end] = core.share(textured_ * rows);
    for (int item : P::range(begin, end)) {
      const I entry = I(item) / I(rows);
      const I row = I(item) - entry * I(rows);
      const I block = list[entry];
      const I first = (row - reach) * I(options_.side) + (block - reach);
      const Candidate<P> best =
          best_in_row<P>(before(), work::value(block), now(), work::value(first), rows);
      best_column[item] = best.number;
      best_difference[item] = best.difference;
    }
  });
}

template <class P>
void EstimatorOf<P>::refine(Table list, Table best_column, Table best_difference,
                            Table displacement) {
  const int rows = options_.candidates();
  const I search = options_.search;
  machine_.fork("refine", [&](work::Core& core) {
    const auto [begin, end] = core.share(textured_);
    for (int entry : P::range(begin, end)) {
      I best_row = 0;
      I least = 0x7fffffff;
      for (int row : P::range(0, rows)) {
        const I difference = best_difference[entry * rows + row];
        if (difference < least) {
          least = difference;
          best_row = row;
        }
      }
      I x = kNoMatch;
      I y = kNoMatch;
      if (least < I(options_.max_difference)) {
        const I dx = best_column[I(I(entry) * I(rows) + best_row)] - search;
        const I dy = best_row - search;
        const I block = list[entry];
        const I match = dy * I(options_.side) + (block + dx);
        const HalfPixels<P> half = best_half_pixel<P>(
            half_pixel_differences<P>(before(), work::value(block), now(), work::value(match)),
            least);
        x = (dx << 1) + half.x;
        y = (dy << 1) + half.y;
      }
      displacement[2 * entry] = x;
      displacement[2 * entry + 1] = y;
    }
  });
}

// Small angles: the tangent is the angle.
template <class P>
typename P::I32 EstimatorOf<P>::of_rotation(float rate, float dt) const {
  const F angle = F(rate) * F(dt);
  const F scale = options_.focal_length * static_cast<float>(1 << kFractionBits);
  return work::to_i32(F(angle * scale));
}

template <class P>
Flow EstimatorOf<P>::vote(Table displacement, const Input& input) {
  const auto stage = machine_.stage(kStages[3]);
  Histogram<P> x(options_.search), y(options_.search);
  I matched = 0;
  for (int entry : P::range(0, textured_)) {
    const I dx = displacement[2 * entry];
    if (dx == I(kNoMatch)) continue;
    x.add(dx);
    y.add(displacement[2 * entry + 1]);
    matched += I(1);
  }
  Flow flow;
  flow.textured = textured_;
  flow.matched = work::value(matched);
  if (matched < I(options_.min_matches)) return flow;
  I flow_x = x.flow();
  I flow_y = y.flow();
  if (options_.gyro) {
    // A fixed point moves by -ω × p: at the centre of the image by f (-ω_y, ω_x) per second.
    flow_x += of_rotation(input.rate_y, input.dt);
    flow_y -= of_rotation(input.rate_x, input.dt);
  }
  flow.x = work::value(flow_x);
  flow.y = work::value(flow_y);
  flow.quality = work::value(I(I(matched * I(255)) / I(options_.blocks())));
  return flow;
}

template <class P>
Flow EstimatorOf<P>::process(const Input& input) {
  transfer(input.pixels);
  if (!std::exchange(has_before_, true)) return {};
  work::Arena& memory = machine_.local();
  const work::Arena::Frame frame(memory);
  const Table list = memory.alloc<Table>("blocks with texture", options_.blocks());
  const Table displacement = memory.alloc<Table>("displacements", 2 * options_.blocks());
  const Table kept = memory.alloc<Table>("blocks per core", machine_.cores());
  const int rows = options_.blocks() * options_.candidates();
  const Table best_column = memory.alloc<Table>("best columns", rows);
  const Table best_difference = memory.alloc<Table>("best differences", rows);
  select(list, kept);
  {
    const auto stage = machine_.stage(kStages[2]);
    search(list, best_column, best_difference);
    refine(list, best_column, best_difference, displacement);
  }
  return vote(displacement, input);
}

}  // namespace

std::unique_ptr<Estimator> make_estimator(bool counting, const Options& options,
                                          work::Machine& machine) {
  if (counting) return std::make_unique<EstimatorOf<work::Counting>>(options, machine);
  return std::make_unique<EstimatorOf<work::Native>>(options, machine);
}

}  // namespace leviosim::flow
