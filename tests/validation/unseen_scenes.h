// The scenes in which unseen_kernels.h are traced (leviosim-measure) and priced: each kernel on a
// smaller and a larger problem, on inputs that the compiler does not know. A class of a kernel
// makes inputs when it is constructed; run() is what the scene is of.
#pragma once

#include <cstdint>

#include "tests/validation/unseen_kernels.h"

namespace leviosim::unseen {

/// The same value, which the compiler does not know.
template <class T>
T opaque(T x) {
  volatile T hidden = x;
  return hidden;
}

struct Lcg {
  std::uint32_t state;
  std::uint32_t next() {
    state = state * 1664525u + 1013904223u;
    return state >> 8;
  }
  int below(int n) { return static_cast<int>(next() % static_cast<std::uint32_t>(n)); }
  /// From -1 to 1.
  float centred() { return static_cast<float>(below(20001) - 10000) * 1e-4f; }
};

template <class F>
void make_signal(F* re, F* im, F* cosine, F* sine, int n) {
  Lcg random{1234};
  for (int i = 0; i < n; ++i) {
    re[i] = F(random.centred());
    im[i] = F(random.centred());
  }
  const double angle = 6.283185307179586 / n;
  const double square = angle * angle;
  const double turn_c = 1 - square / 2 + square * square / 24;
  const double turn_s = angle * (1 - square / 6 + square * square / 120);
  double c = 1, s = 0;
  for (int k = 0; k < n / 2; ++k) {
    cosine[k] = F(static_cast<float>(c));
    sine[k] = F(static_cast<float>(s));
    const double next = c * turn_c - s * turn_s;
    s = s * turn_c + c * turn_s;
    c = next;
  }
}

/// `count` systems of four equations: g gᵀ + 1 for random g, and right sides.
template <class F>
void make_systems(F* a, F* b, int count) {
  Lcg random{99};
  for (int m = 0; m < count; ++m) {
    float g[16];
    for (float& x : g) x = random.centred();
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        float sum = i == j ? 1.0f : 0.0f;
        for (int k = 0; k < 4; ++k) sum += g[4 * i + k] * g[4 * j + k];
        a[16 * m + 4 * i + j] = F(sum);
      }
      b[4 * m + i] = F(random.centred());
    }
  }
}

/// Symbols are the rarer the higher they are. Any bytes are a stream of this model.
template <class Byte, class U16>
void make_stream(Byte* stream, U16* cumulative, int length, int symbols) {
  Lcg random{7};
  for (int i = 0; i < length; ++i) stream[i] = static_cast<Byte>(random.below(256));
  int sum = 0;
  for (int s = 0; s <= symbols; ++s) {
    cumulative[s] = static_cast<U16>(sum);
    sum += 2000 / (s + 2) + random.below(20) + 1;
  }
}

/// Bright discs and speckles on a dark, noisy ground.
template <class Byte>
void make_blobs(Byte* image, int width, int height) {
  Lcg random{31};
  for (int i = 0; i < width * height; ++i)
    image[i] = static_cast<Byte>(random.below(100) < 3 ? 200 : random.below(90));
  for (int disc = 0; disc < width * height / 100; ++disc) {
    const int cx = random.below(width), cy = random.below(height), r = 2 + random.below(4);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        if ((x - cx) * (x - cx) + (y - cy) * (y - cy) <= r * r)
          image[y * width + x] = static_cast<Byte>(150 + random.below(80));
  }
}

template <class Byte, class I>
void make_layer(Byte* input, Byte* weights, I* bias, int inputs, int outputs) {
  Lcg random{5};
  for (int i = 0; i < inputs; ++i) input[i] = static_cast<Byte>(random.below(256));
  for (int i = 0; i < inputs * outputs; ++i) weights[i] = static_cast<Byte>(random.below(256));
  for (int o = 0; o < outputs; ++o) bias[o] = I(random.below(20000) - 10000);
}

template <class P, class T>
using Read = typename P::template Span<const T>;
template <class P, class T>
using Write = typename P::template Span<T>;

template <class P>
class Biquads {
  using F = typename P::F32;

 public:
  explicit Biquads(int samples) : samples_(samples) {
    Lcg random{1};
    for (F& x : in_) x = F(random.centred());
    for (int k = 0; k < 20; ++k) {
      constexpr float kSection[] = {0.2f, 0.1f, 0.05f, -0.3f, 0.1f};
      coefficients_[k] = F(kSection[k % 5]);
    }
  }
  void run() {
    biquads<P>(Read<P, F>(in_, samples_), Write<P, F>(out_, samples_),
               Read<P, F>(coefficients_, 20), Write<P, F>(state_, 8), samples_, opaque(4));
  }

 private:
  static inline F in_[1024], out_[1024], coefficients_[20], state_[8];
  int samples_;
};

/// Of the CRC, the median and the histogram.
template <class Byte>
void make_bytes(Byte* bytes, int n) {
  Lcg random{2};
  for (int i = 0; i < n; ++i) bytes[i] = static_cast<Byte>(random.below(256));
}

template <class P>
class Crc32 {
  using Byte = typename P::Byte;
  using U = typename P::U32;

 public:
  explicit Crc32(int n) : n_(n) {
    make_bytes(bytes_, n);
    for (std::uint32_t k = 0; k < 256; ++k) {
      std::uint32_t c = k;
      for (int bit = 0; bit < 8; ++bit) c = (c & 1) != 0 ? 0xedb88320u ^ (c >> 1) : c >> 1;
      table_[k] = U(c);
    }
  }
  void run() {
    result_ = work::value(crc32<P>(Read<P, Byte>(bytes_, n_), Read<P, U>(table_, 256), n_));
  }

 private:
  static inline Byte bytes_[4096];
  static inline U table_[256];
  int n_;
  volatile std::uint32_t result_ = 0;
};

/// So many products of 4 x 4.
template <class P>
class Products {
  using F = typename P::F32;

 public:
  explicit Products(int calls) : calls_(calls) {
    Lcg random{3};
    for (F& x : factors_) x = F(random.centred());
  }
  void run() {
    for (int k = 0; k < calls_; ++k)
      product<P>(Read<P, F>(factors_ + 4 * k, 16), Read<P, F>(factors_ + 4 * k + 16, 16),
                 Write<P, F>(results_ + 4 * k, 16), opaque(4));
  }

 private:
  static inline F factors_[1056], results_[1056];
  int calls_;
};

template <class P>
class Median {
  using Byte = typename P::Byte;

 public:
  explicit Median(int side) : side_(side) { make_bytes(image_, side * side); }
  void run() {
    median<P>(Read<P, Byte>(image_, side_ * side_), Write<P, Byte>(filtered_, side_ * side_), side_,
              side_);
  }

 private:
  static inline Byte image_[48 * 48], filtered_[48 * 48];
  int side_;
};

template <class P>
class Histogram {
  using Byte = typename P::Byte;
  using I = typename P::I32;

 public:
  explicit Histogram(int n) : n_(n) { make_bytes(bytes_, n); }
  void run() { histogram<P>(Read<P, Byte>(bytes_, n_), Write<P, I>(bins_, 256), n_); }

 private:
  static inline Byte bytes_[4096];
  static inline I bins_[256];
  int n_;
};

template <class P>
class Fft {
  using F = typename P::F32;

 public:
  Fft(int n, int stages) : n_(n), stages_(stages) { make_signal(re_, im_, cosine_, sine_, n); }
  void run() {
    fft_radix2<P>(Write<P, F>(re_, n_), Write<P, F>(im_, n_), Read<P, F>(cosine_, n_ / 2),
                  Read<P, F>(sine_, n_ / 2), n_, stages_);
  }

 private:
  static inline F re_[1024], im_[1024], cosine_[512], sine_[512];
  int n_, stages_;
};

/// So many systems of four equations.
template <class P>
class Systems {
  using F = typename P::F32;

 public:
  explicit Systems(int calls) : calls_(calls) { make_systems(matrices_, sides_, calls); }
  void run() {
    const int n = opaque(4);
    for (int call = 0; call < calls_; ++call)
      cholesky_solve<P>(Write<P, F>(matrices_ + call * n * n, n * n),
                        Write<P, F>(sides_ + call * n, n), n);
  }

 private:
  static inline F matrices_[200 * 16], sides_[200 * 4];
  int calls_;
};

template <class P>
class RangeDecoder {
  using Byte = typename P::Byte;
  using U16 = typename P::U16;
  static constexpr int kSymbols = 24;

 public:
  RangeDecoder(int count, int length) : count_(count), length_(length) {
    make_stream(stream_, cumulative_, length, kSymbols);
  }
  void run() {
    result_ = work::value(
        range_decode<P>(Read<P, Byte>(stream_, length_), Read<P, U16>(cumulative_, kSymbols + 1),
                        Write<P, Byte>(decoded_, count_), opaque(kSymbols), count_));
  }

 private:
  static inline Byte stream_[3300], decoded_[1600];
  static inline U16 cumulative_[kSymbols + 1];
  int count_, length_;
  volatile std::int32_t result_ = 0;
};

template <class P>
class Components {
  using Byte = typename P::Byte;
  using U16 = typename P::U16;

 public:
  Components(int width, int height) : width_(width), height_(height) {
    make_blobs(image_, width, height);
  }
  void run() {
    const int area = width_ * height_;
    result_ = work::value(
        label_components<P>(Read<P, Byte>(image_, area), Write<P, U16>(labels_, area + width_),
                            Write<P, U16>(parents_, area / 2 + 2), width_, height_, opaque(128)));
  }

 private:
  static inline Byte image_[80 * 60];
  static inline U16 labels_[80 * 61], parents_[80 * 60 / 2 + 2];
  int width_, height_;
  volatile std::int32_t result_ = 0;
};

template <class P>
class Dense {
  using Byte = typename P::Byte;
  using I = typename P::I32;

 public:
  Dense(int inputs, int outputs) : inputs_(inputs), outputs_(outputs) {
    make_layer(input_, weights_, bias_, inputs, outputs);
  }
  void run() {
    const Quantisation quantisation = {opaque(121), opaque(130), opaque(128), opaque(0x59c00000),
                                       opaque(8)};
    dense_u8<P>(Read<P, Byte>(input_, inputs_), Read<P, Byte>(weights_, inputs_ * outputs_),
                Read<P, I>(bias_, outputs_), Write<P, Byte>(output_, outputs_), inputs_, outputs_,
                quantisation);
  }

 private:
  static inline Byte input_[128], weights_[128 * 64], output_[64];
  static inline I bias_[64];
  int inputs_, outputs_;
};

/// Makes the inputs of a kernel, then runs it while a scene of that name lives.
#define LEVIOSIM_SCENE(name, ...) \
  {                               \
    __VA_ARGS__;                  \
    const Scene scene(name);      \
    kernel.run();                 \
  }

/// @tparam Scene  what lives while a scene runs, made from its name
template <class P, class Scene>
void all_scenes() {
  LEVIOSIM_SCENE("scene: biquads 256", Biquads<P> kernel(opaque(256)))
  LEVIOSIM_SCENE("scene: biquads 1024", Biquads<P> kernel(opaque(1024)))
  LEVIOSIM_SCENE("scene: crc32 1024", Crc32<P> kernel(opaque(1024)))
  LEVIOSIM_SCENE("scene: crc32 4096", Crc32<P> kernel(opaque(4096)))
  LEVIOSIM_SCENE("scene: product 64", Products<P> kernel(opaque(64)))
  LEVIOSIM_SCENE("scene: product 256", Products<P> kernel(opaque(256)))
  LEVIOSIM_SCENE("scene: median 24", Median<P> kernel(opaque(24)))
  LEVIOSIM_SCENE("scene: median 48", Median<P> kernel(opaque(48)))
  LEVIOSIM_SCENE("scene: histogram 1024", Histogram<P> kernel(opaque(1024)))
  LEVIOSIM_SCENE("scene: histogram 4096", Histogram<P> kernel(opaque(4096)))
  LEVIOSIM_SCENE("scene: fft 256", Fft<P> kernel(opaque(256), opaque(8)))
  LEVIOSIM_SCENE("scene: fft 1024", Fft<P> kernel(opaque(1024), opaque(10)))
  LEVIOSIM_SCENE("scene: cholesky 50", Systems<P> kernel(opaque(50)))
  LEVIOSIM_SCENE("scene: cholesky 200", Systems<P> kernel(opaque(200)))
  LEVIOSIM_SCENE("scene: range decoder 400", RangeDecoder<P> kernel(opaque(400), opaque(900)))
  LEVIOSIM_SCENE("scene: range decoder 1600", RangeDecoder<P> kernel(opaque(1600), opaque(3300)))
  LEVIOSIM_SCENE("scene: components 40x30", Components<P> kernel(opaque(40), opaque(30)))
  LEVIOSIM_SCENE("scene: components 80x60", Components<P> kernel(opaque(80), opaque(60)))
  LEVIOSIM_SCENE("scene: dense 64x32", Dense<P> kernel(opaque(64), opaque(32)))
  LEVIOSIM_SCENE("scene: dense 128x64", Dense<P> kernel(opaque(128), opaque(64)))
}
#undef LEVIOSIM_SCENE

}  // namespace leviosim::unseen

/// What leviosim-measure runs.
template <class P>
void scenes() {
  leviosim::unseen::all_scenes<P, typename P::Function>();
}
