#include "workload/vision/patch_alignment.h"

#include <algorithm>
#include <cmath>

#include "sim/base/check.h"

namespace leviosim::vio {
namespace {

/// A place in an image: the pixel to the upper left of it, and the weights of its four neighbours.
template <class P>
struct Place {
  using F = typename P::F32;
  using I32 = typename P::I32;

  Place(F x, F y) : column(work::to_i32(x)), row(work::to_i32(y)) {
    const F right = x - work::to_f32(column), below = y - work::to_f32(row);
    const F left = F(1.0f) - right, above = F(1.0f) - below;
    nw = above * left;
    ne = above * right;
    sw = below * left;
    se = below * right;
  }

  I32 column, row;
  F nw, ne, sw, se;
};

/// Grey levels and their gradients, one after the other row by row.
template <class P>
struct Patch {
  using F = typename P::F32;
  using Span = typename P::template Span<F>;

  Patch(work::Arena& arena, int radius)
      : level(arena.alloc<Span>("patch", size(radius))),
        by_x(arena.alloc<Span>("patch by x", size(radius))),
        by_y(arena.alloc<Span>("patch by y", size(radius))) {}
  static int size(int radius) { return (2 * radius + 1) * (2 * radius + 1); }

  Span level, by_x, by_y;
  F xx = 0.0f, xy = 0.0f, yy = 0.0f;  ///< inverse of the normal matrix
  F contrast = 0.0f;                  ///< squares of the grey levels about their mean
};

/// Pixels of an image: all of them, or those around a feature. Pixel (column, row) of the image is
/// at index_of(column, row).
template <class P>
struct Pixels {
  typename P::template Span<const typename P::Byte> pixels;
  int stride;  ///< from row to row
  int left = 0, top = 0;

  int index_of(const Place<P>& at) const {
    return (work::value(at.row) - top) * stride + work::value(at.column) - left;
  }
};

/// What a window of `side` pixels takes if its rows begin and end at words.
constexpr int window_stride(int side) { return (side + 3 + 3) / 4 * 4; }
/// Side of what a patch needs that may move by max_shift: its pixels and those to interpolate with.
int window_side(int reach, float max_shift) {
  return 2 * (reach + static_cast<int>(std::ceil(max_shift))) + 2;
}

/// Copies the window of `reach` pixels and one more around a place that may move by max_shift from
/// L2 to `room`, as far as it lies in the image: words, if the rows of the image begin at words.
template <class P>
Pixels<P> fetch_window(const ConstImageView<P>& image, const Place<P>& at, int reach,
                       float max_shift, typename P::template Span<typename P::Byte> room) {
  const int around = reach + static_cast<int>(std::ceil(max_shift));
  const bool words = image.width % 4 == 0;
  const auto clamp = [](int i, int size) { return std::max(0, std::min(i, size)); };
  int left = clamp(work::value(at.column) - around, image.width);
  int right = clamp(work::value(at.column) + around + 2, image.width);
  if (words) {
    left = left / 4 * 4;
    right = (right + 3) / 4 * 4;
  }
  const int top = clamp(work::value(at.row) - around, image.height);
  const int bottom = clamp(work::value(at.row) + around + 2, image.height);
  const int stride = right - left;
  const auto copy_rows = [&](auto element) {
    using Element = decltype(element);
    using Loaded = typename work::LoadedAs<Element>::Type;
    constexpr int kBytes = sizeof(Element);
    for (int row : P::range(top, bottom)) {
      const typename P::template L2Span<const Element> from(
          reinterpret_cast<const Element*>(image.pixels.data() + row * image.width + left),
          stride / kBytes);
      const typename P::template Span<Element> to(
          // uncounted: makes a view of words, whose accesses are counted
          reinterpret_cast<Element*>(room.data() + (row - top) * stride), stride / kBytes);
      for (int i : P::range(0, stride / kBytes)) {
        const Loaded loaded = from[i];
        if constexpr (kBytes == 1)
          to[i] = work::narrow<Element>(loaded);
        else
          to[i] = loaded;
      }
    }
  };
  if (words)
    copy_rows(typename P::U32());
  else
    copy_rows(typename P::Byte());
  return {room, stride, left, top};
}

/// Whether all pixels within `reach` of the place, and one more, lie in the image.
template <class P>
bool is_inside(const ConstImageView<P>& image, const Place<P>& at, int reach) {
  using I32 = typename P::I32;
  return at.column >= I32(reach) && at.row >= I32(reach) &&
         at.column < I32(image.width - reach - 1) && at.row < I32(image.height - reach - 1);
}

/// Squares of the numbers of a patch about their mean.
template <class P>
typename P::F32 about_mean(typename P::F32 squares, typename P::F32 sum, int radius) {
  using F = typename P::F32;
  return squares - sum * sum * F(1.0f / static_cast<float>(Patch<P>::size(radius)));
}

/// The grey level between four pixels, the first of which is pixels[i].
template <class P, class Pixels>
typename P::F32 level_at(const Pixels& pixels, int i, int width, const Place<P>& at) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const F nw = work::to_f32(I32(pixels[i])), ne = work::to_f32(I32(pixels[i + 1]));
  const F sw = work::to_f32(I32(pixels[i + width])), se = work::to_f32(I32(pixels[i + width + 1]));
  return nw * at.nw + ne * at.ne + sw * at.sw + se * at.se;
}

/// Grey levels and gradients of the patch around a place, and the contrast.
/// @return sums of the gradients
template <class P>
Vec2<P> sample_patch(const Pixels<P>& image, const Place<P>& at, int radius, Patch<P>& patch) {
  using F = typename P::F32;
  const int width = image.stride;
  const int centre = image.index_of(at);
  F sum_x = 0.0f, sum_y = 0.0f, sum = 0.0f, squares = 0.0f;
  int i = 0;
  for (int v : P::range(-radius, radius + 1))
    for (int u : P::range(-radius, radius + 1)) {
      const int p = centre + v * width + u;
      const F level = level_at<P>(image.pixels, p, width, at);
      const F gx = (level_at<P>(image.pixels, p + 1, width, at) -
                    level_at<P>(image.pixels, p - 1, width, at)) *
                   F(0.5f);
      const F gy = (level_at<P>(image.pixels, p + width, width, at) -
                    level_at<P>(image.pixels, p - width, width, at)) *
                   F(0.5f);
      patch.level[i] = level;
      patch.by_x[i] = gx;
      patch.by_y[i] = gy;
      sum += level;
      squares += level * level;
      sum_x += gx;
      sum_y += gy;
      ++i;
    }
  patch.contrast = about_mean<P>(squares, sum, radius);
  return {sum_x, sum_y};
}

/// @return whether the patch tells both coordinates
template <class P>
bool take_patch(const Pixels<P>& image, const Place<P>& at, int radius, Patch<P>& patch) {
  using F = typename P::F32;
  const typename P::Function function("take_patch");
  // Without their mean, the gradients do not see a difference of brightness.
  const int n = Patch<P>::size(radius);
  const Vec2<P> sums = sample_patch<P>(image, at, radius, patch);
  const F mean_x = sums.x * F(1.0f / static_cast<float>(n));
  const F mean_y = sums.y * F(1.0f / static_cast<float>(n));
  F xx = 0.0f, xy = 0.0f, yy = 0.0f;
  for (int i : P::range(0, n)) {
    const F gx = F(patch.by_x[i]) - mean_x, gy = F(patch.by_y[i]) - mean_y;
    patch.by_x[i] = gx;
    patch.by_y[i] = gy;
    xx += gx * gx;
    xy += gx * gy;
    yy += gy * gy;
  }
  constexpr float kFlattest = 1e-3f;  // of an edge: along it, nothing changes
  const F determinant = xx * yy - xy * xy;
  if (!(determinant > F(kFlattest) * (xx + yy) * (xx + yy))) return false;
  const F scale = F(1.0f) / determinant;
  patch.xx = yy * scale;
  patch.xy = -(xy * scale);
  patch.yy = xx * scale;
  return true;
}

/// How an image differs from a patch.
template <class P>
struct Difference {
  using F = typename P::F32;

  F x = 0.0f, y = 0.0f;          ///< gradients times errors
  F sum = 0.0f, squares = 0.0f;  ///< of the errors
};

template <class P>
Difference<P> compare(const Pixels<P>& image, const Patch<P>& patch, const Place<P>& at,
                      int radius) {
  using F = typename P::F32;
  const int width = image.stride;
  const int centre = image.index_of(at);
  Difference<P> difference;
  int i = 0;
  for (int v : P::range(-radius, radius + 1))
    for (int u : P::range(-radius, radius + 1)) {
      const F error =
          level_at<P>(image.pixels, centre + v * width + u, width, at) - F(patch.level[i]);
      difference.x += F(patch.by_x[i]) * error;
      difference.y += F(patch.by_y[i]) * error;
      difference.sum += error;
      difference.squares += error * error;
      ++i;
    }
  return difference;
}

/// Moves `at` (px) to where the image agrees with the patch.
/// @param pixels  of the image, around `at`
/// @return whether it does
template <class P>
bool follow_patch(const ConstImageView<P>& image, const Pixels<P>& pixels, const Patch<P>& patch,
                  float max_shift, const PatchAlignmentOptions& options, Vec2<P>& at) {
  using F = typename P::F32;
  const typename P::Function function("follow_patch");
  const Vec2<P> start = at;
  for ([[maybe_unused]] int iteration : P::range(0, options.iterations)) {
    const Place<P> place(at.x, at.y);
    if (!is_inside<P>(image, place, options.radius)) return false;
    const Difference<P> d = compare<P>(pixels, patch, place, options.radius);
    const F dx = patch.xx * d.x + patch.xy * d.y, dy = patch.xy * d.x + patch.yy * d.y;
    at = {at.x - dx, at.y - dy};
    if (work::abs(F(at.x - start.x)) > F(max_shift) || work::abs(F(at.y - start.y)) > F(max_shift))
      return false;
    if (work::abs(dx) < F(options.last_step) && work::abs(dy) < F(options.last_step))
      return bool(about_mean<P>(d.squares, d.sum, options.radius) <
                  F(options.max_difference) * patch.contrast);
  }
  return false;
}

/// The pixels of an image around a place, where the core reaches them.
template <class P>
class PixelSource {
 public:
  using Room = typename P::template Span<typename P::Byte>;

  PixelSource(work::Arena& scratch, const PatchView<P>& view, int reach, float max_shift)
      : view_(view), reach_(reach), max_shift_(max_shift) {
    const int side = window_side(reach, max_shift);
    if (view.in_l2) window_ = scratch.alloc<Room>("window of an image", side * window_stride(side));
  }
  /// @param place  gives the place, which is asked for only where there is a window around it
  template <class GetPlace>
  Pixels<P> around(GetPlace&& place) const {
    if (view_.in_l2) return fetch_window<P>(view_.image, place(), reach_, max_shift_, window_);
    return {view_.image.pixels, view_.image.width};
  }

 private:
  const PatchView<P>& view_;
  int reach_;
  float max_shift_;
  Room window_;
};

}  // namespace

Bytes patch_scratch(const PatchAlignmentOptions& options, float max_shift, bool before_in_l2,
                    bool now_in_l2) {
  const auto window = [](int side) { return side * window_stride(side); };
  return Bytes(3LL * 4 * Patch<work::Native>::size(options.radius) +
               (before_in_l2 ? window(window_side(options.radius + 1, 0.0f)) : 0) +
               (now_in_l2 ? window(window_side(options.radius, max_shift)) : 0));
}

template <class P>
void align_patches(work::Machine& machine, const PatchView<P>& before, const PatchView<P>& now,
                   int steps, float max_shift, const PatchAlignmentOptions& options,
                   const MatchList<P>& matches,
                   typename P::template Span<typename P::Byte> aligned) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  check(options.radius <= PatchAlignmentOptions::kMostRadius, "the radius of a patch");
  const F to_px = 1.0f / static_cast<float>(steps), unit = static_cast<float>(steps);
  const Bytes scratch = patch_scratch(options, max_shift, before.in_l2, now.in_l2);
  machine.fork(
      "align",
      [&](work::Core& core) {
        Patch<P> patch(core.scratch, options.radius);
        const PixelSource<P> old_pixels(core.scratch, before, options.radius + 1, 0.0f);
        const PixelSource<P> new_pixels(core.scratch, now, options.radius, max_shift);
        const auto [begin, end] = core.share(matches.count);
        for (int m : P::range(begin, end)) {
          const auto judge = [&](PatchVerdict verdict) {
            aligned[m] = work::narrow<typename P::Byte>(I32(static_cast<int>(verdict)));
          };
          judge(PatchVerdict::Unknown);
          const I32 feature = matches.query[m], old = matches.reference[m];
          const Place<P> from(work::to_f32(I32(before.x[old])) * to_px,
                              work::to_f32(I32(before.y[old])) * to_px);
          if (!is_inside<P>(before.image, from, options.radius + 1)) continue;
          if (!take_patch<P>(old_pixels.around([&] { return from; }), from, options.radius, patch))
            continue;
          Vec2<P> at{work::to_f32(I32(now.x[feature])) * to_px,
                     work::to_f32(I32(now.y[feature])) * to_px};
          judge(PatchVerdict::Disagrees);
          if (!follow_patch<P>(now.image, new_pixels.around([&] { return Place<P>(at.x, at.y); }),
                               patch, max_shift, options, at))
            continue;
          judge(PatchVerdict::Agrees);
          now.x[feature] = work::narrow<U16>(work::to_i32(F(at.x * unit + F(0.5f))));
          now.y[feature] = work::narrow<U16>(work::to_i32(F(at.y * unit + F(0.5f))));
        }
      },
      scratch);
}

template void align_patches(work::Machine&, const PatchView<work::Native>&,
                            const PatchView<work::Native>&, int, float,
                            const PatchAlignmentOptions&, const MatchList<work::Native>&,
                            work::Native::Span<work::Native::Byte>);
template void align_patches(work::Machine&, const PatchView<work::Counting>&,
                            const PatchView<work::Counting>&, int, float,
                            const PatchAlignmentOptions&, const MatchList<work::Counting>&,
                            work::Counting::Span<work::Counting::Byte>);

}  // namespace leviosim::vio
