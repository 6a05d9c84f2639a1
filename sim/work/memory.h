// Views of memory through which kernels read and write. Under the counting policy every access
// counts a load or a store; under the native policy a view is a plain pointer.
//
// The index tells what the address costs: a plain `int` comes from a loop and is affine in the loop
// indices, so a compiler strength-reduces it to a stream; an I32 is data, so its address is
// computed. value() of an I32 is refused as an index. A run of elements at a computed place is
// subspan() with an I32: what it takes to compute the place has been counted, and from there on the
// elements are a stream. What a view does not count: values kept in C++ variables, which stand for
// registers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "sim/base/check.h"
#include "sim/work/counted.h"

namespace leviosim::work {

/// Where the memory of a view lies, seen from the core that works on it. Local is the core's own
/// memory: L1 for cluster cores, L2 for the fabric controller.
/// Shared is one word of local memory that all cores of the team use at the same time.
/// Either is local memory or L2, as there was room: known where the memory was allocated.
enum class Space : std::uint8_t { Local, L2, Shared, Either };

/// Storage of a byte under the counting policy. A type of its own, because a store through
/// `unsigned char*` may touch any object, so that the compiler would have to keep the counters in
/// memory.
enum class Byte : std::uint8_t {};

/// The scalar that a load of T yields: narrow integers are extended to 32 bits.
template <class T>
struct LoadedAs {
  using Type = T;
  static Type from(T stored) { return stored; }
};
template <>
struct LoadedAs<Byte> {
  using Type = I32;
  static Type from(Byte stored) { return I32(static_cast<std::int32_t>(stored)); }
};
template <>
struct LoadedAs<std::uint16_t> {
  using Type = I32;
  static Type from(std::uint16_t stored) { return I32(stored); }
};
template <>
struct LoadedAs<std::int16_t> {
  using Type = I32;
  static Type from(std::int16_t stored) { return I32(stored); }
};

/// Keeps the low bits of an integer for storage, as a store instruction does: nothing is counted.
template <class T>
T narrow(I32 x) {
  return static_cast<T>(x.v);
}
template <class T>
T narrow(std::int32_t x) {
  return static_cast<T>(x);
}

/// What a load and a store count as.
template <Op Load, Op Store>
struct Access {
  std::uint64_t weight;

  void load() const { count(Load, weight); }
  void store() const { count(Store, weight); }
};

/// The same, of memory of which each view knows whether it is local. No branch, so that the
/// optimiser folds the counters of a loop.
template <Op Load, Op Store>
struct AccessOfEither {
  std::uint64_t local, l2;  ///< one of them is zero

  void load() const {
    count(Load, local);
    count(Op::LoadL2, l2);
  }
  void store() const {
    count(Store, local);
    count(Op::StoreL2, l2);
  }
};

/// A memory cell as the left or right side of an expression: reading it counts a load, assigning a
/// store. `Accesses` says of which kind.
template <class T, class Accesses>
class Cell {
 public:
  using Value = typename LoadedAs<std::remove_const_t<T>>::Type;

  Cell(T* where, Accesses access) : where_(where), access_(access) {}

  operator Value() const {
    access_.load();
    return LoadedAs<std::remove_const_t<T>>::from(*where_);
  }
  const Cell& operator=(T stored) const requires(!std::is_const_v<T>) {
    access_.store();
    *where_ = stored;
    return *this;
  }
  const Cell& operator=(const Cell& other) const { return *this = static_cast<T>(Value(other)); }
  const Cell& operator+=(Value x) const { return *this = static_cast<T>(Value(*this) + x); }
  const Cell& operator-=(Value x) const { return *this = static_cast<T>(Value(*this) - x); }
  const Cell& operator*=(Value x) const { return *this = static_cast<T>(Value(*this) * x); }
  const Cell& operator/=(Value x) const { return *this = static_cast<T>(Value(*this) / x); }
  const Cell& operator^=(Value x) const { return *this = static_cast<T>(Value(*this) ^ x); }
  const Cell& operator|=(Value x) const { return *this = static_cast<T>(Value(*this) | x); }
  /// Multiply-add forms: `cell += a * b` loads, multiplies and adds in one operation, and stores.
  const Cell& operator+=(Product<Value> x) const requires requires { Value::kMul; }
  { return *this = static_cast<T>(Value(*this) + x); }
  const Cell& operator-=(Product<Value> x) const requires requires { Value::kMul; }
  { return *this = static_cast<T>(Value(*this) - x); }

 private:
  T* where_;
  Accesses access_;
};

/// View of `size` consecutive elements under the counting policy. `straddles` is 1 if the elements
/// do not lie on their natural boundary in the target's memory, so that each access takes two. A
/// byte lies in one word wherever it is.
template <class T, Space S = Space::Local>
class CountedSpan {
  static constexpr bool kEither = S == Space::Either;
  static constexpr Op in(Op local, Op l2, Op shared) {
    return S == Space::L2 ? l2 : S == Space::Shared ? shared : local;
  }
  template <Op Load, Op Store>
  using AccessFor = std::conditional_t<kEither, AccessOfEither<Load, Store>, Access<Load, Store>>;
  using Streaming = AccessFor<in(Op::LoadStream, Op::LoadL2, Op::LoadShared),
                              in(Op::StoreStream, Op::StoreL2, Op::StoreShared)>;
  using Indexing = AccessFor<in(Op::LoadIndexed, Op::LoadL2, Op::LoadShared),
                             in(Op::StoreIndexed, Op::StoreL2, Op::StoreShared)>;
  using Stream = Cell<T, Streaming>;
  using Indexed = Cell<T, Indexing>;

 public:
  CountedSpan() = default;
  CountedSpan(T* data, int size, bool straddles = false)
      : data_(data), size_(size), straddles_(sizeof(T) > 1 && straddles) {}
  /// A read-only view of the same memory.
  operator CountedSpan<const T, S>() const requires(!std::is_const_v<T>) {
    CountedSpan<const T, S> view(data_, size_, straddles_);
    view.in_l2_ = in_l2_;
    return view;
  }
  /// A view of local memory where there may be one of either.
  operator CountedSpan<T, Space::Either>() const requires(S == Space::Local) {
    return {data_, size_, straddles_};
  }
  operator CountedSpan<const T, Space::Either>() const
      requires(S == Space::Local && !std::is_const_v<T>) {
    return {data_, size_, straddles_};
  }
  /// The same memory, which lies in L2.
  CountedSpan in_l2() const requires kEither {
    CountedSpan view = *this;
    view.in_l2_ = true;
    return view;
  }

  int size() const { return size_; }
  T* data() const { return data_; }
  Stream operator[](int i) const { return {data_ + i, access<Streaming>()}; }
  Indexed operator[](I32 i) const { return {data_ + i.v, access<Indexing>()}; }
  Stream operator[](PlainInt i) const = delete;
  CountedSpan subspan(int offset, int size) const { return part(data_ + offset, size); }
  CountedSpan subspan(I32 offset, int size) const { return part(data_ + offset.v, size); }
  CountedSpan subspan(PlainInt offset, int size) const = delete;

 private:
  template <class, Space>
  friend class CountedSpan;

  CountedSpan part(T* data, int size) const {
    CountedSpan view = *this;
    view.data_ = data;
    view.size_ = size;
    return view;
  }
  template <class Accesses>
  Accesses access() const {
    const std::uint64_t weight = access_weight(straddles_);
    if constexpr (kEither)
      return {in_l2_ ? 0 : weight, in_l2_ ? weight : 0};
    else
      return {weight};
  }

  T* data_ = nullptr;
  int size_ = 0;
  /// Not the weight itself: that has the type of counters, so that counting might change it, for
  /// all that the compiler knows.
  bool straddles_ = false;
  bool in_l2_ = false;  ///< of Space::Either
};

/// A view of memory under the native policy.
template <class T>
class NativeSpan {
 public:
  NativeSpan() = default;
  NativeSpan(T* data, int size, bool = false) : data_(data), size_(size) {}
  operator NativeSpan<const T>() const requires(!std::is_const_v<T>) { return {data_, size_}; }

  int size() const { return size_; }
  T* data() const { return data_; }
  T& operator[](int i) const { return data_[i]; }
  NativeSpan subspan(int offset, int size) const { return {data_ + offset, size}; }
  NativeSpan in_l2() const { return *this; }

 private:
  T* data_ = nullptr;
  int size_ = 0;
};

/// Fixed-size array on a core's call stack, with counted accesses.
template <class T, int N>
class CountedArray {
 public:
  static constexpr int size() { return N; }
  auto operator[](int i) { return CountedSpan<T>(data_, N)[i]; }
  auto operator[](I32 i) { return CountedSpan<T>(data_, N)[i]; }
  auto operator[](int i) const { return CountedSpan<const T>(data_, N)[i]; }
  auto operator[](I32 i) const { return CountedSpan<const T>(data_, N)[i]; }
  void operator[](PlainInt i) const = delete;
  operator CountedSpan<T>() { return {data_, N}; }
  operator CountedSpan<const T>() const { return {data_, N}; }

  T data_[N];
};

template <class T, int N>
class NativeArray {
 public:
  static constexpr int size() { return N; }
  T& operator[](int i) { return data_[i]; }
  const T& operator[](int i) const { return data_[i]; }
  operator NativeSpan<T>() { return {data_, N}; }
  operator NativeSpan<const T>() const { return {data_, N}; }

  T data_[N];
};

}  // namespace leviosim::work
