// SPDX-License-Identifier: LGPL-2.1-or-later
// Memory and launches: of CUDA where nvcc compiles, else of the CPU, by emulation.hpp.
#pragma once

#include <cstdlib>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#ifndef __CUDACC__
#include "device/emulation.hpp"
#endif

namespace hexaplast::device {

#ifdef __CUDACC__
inline void check(cudaError_t error) {
  if (error == cudaErrorInsufficientDriver)
    throw std::runtime_error("there is no driver of NVIDIA's, or one older than this CUDA");
  if (error != cudaSuccess) throw std::runtime_error(std::string("CUDA: ") + cudaGetErrorString(error));
}
inline cudaStream_t stream = nullptr;  // of what is launched; null: that of the device
inline void* allocate(std::size_t bytes) {
  void* at;
  check(cudaMalloc(&at, bytes));
  check(cudaMemset(at, 0xff, bytes));  // NaN: what nobody writes shows
  return at;
}
inline void release(void* at) { cudaFree(at); }
inline void copy(void* to, const void* from, std::size_t bytes) {
  check(cudaStreamSynchronize(stream));
  check(cudaMemcpy(to, from, bytes, cudaMemcpyDefault));
}
/// Single numbers, so many bytes from one to the next.
inline void copy_rows(double* to, std::size_t to_next, const double* from, std::size_t from_next, int count) {
  check(cudaStreamSynchronize(stream));
  check(cudaMemcpy2D(to, to_next, from, from_next, sizeof(double), count, cudaMemcpyDefault));
}
inline void copy_on_device(void* to, const void* from, std::size_t bytes) {
  check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice, stream));
}
inline void clear(void* at, std::size_t bytes) { check(cudaMemsetAsync(at, 0, bytes, stream)); }
inline void fill(void* at, std::size_t bytes) { check(cudaMemsetAsync(at, 0xff, bytes, stream)); }
template <class... Parameters, class... Args>
void launch(void (*kernel)(Parameters...), int blocks, int threads, const Args&... args) {
  kernel<<<blocks, threads, 0, stream>>>(args...);
  check(cudaGetLastError());
}
#else
inline void* allocate(std::size_t bytes) {
  void* const at = std::malloc(bytes);
  if (!at && bytes > 0) throw std::runtime_error("out of memory");
  return std::memset(at, 0xff, bytes);
}
inline void release(void* at) { std::free(at); }
inline void copy(void* to, const void* from, std::size_t bytes) { std::memcpy(to, from, bytes); }
inline void copy_rows(double* to, std::size_t to_next, const double* from, std::size_t from_next, int count) {
  for (int k = 0; k < count; ++k) to[k * to_next / sizeof(double)] = from[k * from_next / sizeof(double)];
}
inline void copy_on_device(void* to, const void* from, std::size_t bytes) { std::memcpy(to, from, bytes); }
inline void clear(void* at, std::size_t bytes) { std::memset(at, 0, bytes); }
inline void fill(void* at, std::size_t bytes) { std::memset(at, 0xff, bytes); }  ///< int: -1
void launch(auto* kernel, int blocks, int threads, const auto&... args) { emulate(kernel, blocks, threads, args...); }
#endif

/// An array on the device.
template <class T>
class Array {
 public:
  Array() = default;
  explicit Array(std::size_t count) : count_(count), at_(static_cast<T*>(allocate(count * sizeof(T)))) {}
  Array(const T* from, std::size_t count) : Array(count) { set(from); }
  explicit Array(const std::vector<T>& from) : Array(from.data(), from.size()) {}

  void set(const void* from) const { copy(at_.get(), from, bytes()); }
  void set(const std::vector<T>& from) const { set(from.data()); }
  /// The first ones become those; there may be more room then.
  void assign(const T* from, std::size_t count) {
    reserve(count);
    copy(at_.get(), from, count * sizeof(T));
  }
  void reserve(std::size_t count) {
    if (count > count_) *this = Array(count + count / 2);
  }
  void get(void* to) const { copy(to, at_.get(), bytes()); }
  operator T*() const { return at_.get(); }
  std::size_t size() const { return count_; }
  std::size_t bytes() const { return count_ * sizeof(T); }
  std::vector<T> values() const {
    std::vector<T> to(count_);
    get(to.data());
    return to;
  }

 private:
  struct Release {
    void operator()(T* at) const { release(at); }
  };
  std::size_t count_ = 0;
  std::unique_ptr<T, Release> at_;
};

}  // namespace hexaplast::device
