// SPDX-License-Identifier: BSD-3-Clause
// Discrete Fourier transforms of 2, 3, 4, 5 and 8 complex numbers, of several lines at once where T is a vector. Every
// operation is one IEEE operation per lane, so the bits depend neither on the number of lanes nor on the processor.
// Included once for each instruction set, in a namespace of its own.

#if defined(__CUDACC__)
#define STRAY_BUTTERFLY __host__ __device__ __forceinline__
#else
#define STRAY_BUTTERFLY inline __attribute__((always_inline))
#endif

template <class T>
struct Pair {
  T re, im;
};

template <class T>
STRAY_BUTTERFLY Pair<T> operator+(Pair<T> const& a, Pair<T> const& b) {
  return {a.re + b.re, a.im + b.im};
}
template <class T>
STRAY_BUTTERFLY Pair<T> operator-(Pair<T> const& a, Pair<T> const& b) {
  return {a.re - b.re, a.im - b.im};
}
template <class T>
STRAY_BUTTERFLY Pair<T> times(Pair<T> const& a, double factor) {
  return {a.re * factor, a.im * factor};
}
template <class T, class U>
STRAY_BUTTERFLY Pair<T> times(Pair<T> const& a, U const& re, U const& im) {
  return {a.re * re - a.im * im, a.re * im + a.im * re};
}
// sign is -1 in exp(-2 pi i jk/n), 1 in exp(2 pi i jk/n).
template <int sign, class T>
STRAY_BUTTERFLY Pair<T> times_i(Pair<T> const& a) {
  if constexpr (sign > 0) return {-a.im, a.re};
  return {a.im, -a.re};
}

template <int sign, class T>
STRAY_BUTTERFLY void transform_4(Pair<T>& a, Pair<T>& b, Pair<T>& c, Pair<T>& d) {
  Pair<T> const even = a + c, odd = b + d, rest = a - c, turned = times_i<sign>(b - d);
  a = even + odd;
  b = rest + turned;
  c = even - odd;
  d = rest - turned;
}

template <int radix, int sign, class T>
STRAY_BUTTERFLY void transform(Pair<T> (&a)[radix]) {
  if constexpr (radix == 2) {
    Pair<T> const first = a[0];
    a[0] = first + a[1];
    a[1] = first - a[1];
  } else if constexpr (radix == 3) {
    constexpr double sin = 0.86602540378443864676;
    Pair<T> const sum = a[1] + a[2], turned = times_i<sign>(times(a[1] - a[2], sin)), rest = a[0] - times(sum, 0.5);
    a[0] = a[0] + sum;
    a[1] = rest + turned;
    a[2] = rest - turned;
  } else if constexpr (radix == 4) {
    transform_4<sign>(a[0], a[1], a[2], a[3]);
  } else if constexpr (radix == 5) {
    constexpr double cos1 = 0.30901699437494742410, sin1 = 0.95105651629515357212;
    constexpr double cos2 = -0.80901699437494742410, sin2 = 0.58778525229247312917;
    Pair<T> const sum1 = a[1] + a[4], sum2 = a[2] + a[3], difference1 = a[1] - a[4], difference2 = a[2] - a[3];
    Pair<T> const even1 = a[0] + times(sum1, cos1) + times(sum2, cos2);
    Pair<T> const even2 = a[0] + times(sum1, cos2) + times(sum2, cos1);
    Pair<T> const odd1 = times_i<sign>(times(difference1, sin1) + times(difference2, sin2));
    Pair<T> const odd2 = times_i<sign>(times(difference1, sin2) - times(difference2, sin1));
    a[0] = a[0] + sum1 + sum2;
    a[1] = even1 + odd1;
    a[2] = even2 + odd2;
    a[3] = even2 - odd2;
    a[4] = even1 - odd1;
  } else {
    static_assert(radix == 8);
    constexpr double root = 0.70710678118654752440;
    transform_4<sign>(a[0], a[2], a[4], a[6]);
    transform_4<sign>(a[1], a[3], a[5], a[7]);
    Pair<T> const one = times(a[3] + times_i<sign>(a[3]), root), two = times_i<sign>(a[5]),
                  three = times(times_i<sign>(a[7]) - a[7], root);
    Pair<T> const even[4] = {a[0], a[2], a[4], a[6]}, odd[4] = {a[1], one, two, three};
    for (int k = 0; k < 4; ++k) {
      a[k] = even[k] + odd[k];
      a[k + 4] = even[k] - odd[k];
    }
  }
}
