#pragma once
/// Values per line that copies share.
///
/// Responses of many outputs take hundreds of megabytes, nearly all for the covariance of their
/// noise, and are copied for every band and every trial. Here a copy, or a part of adjacent lines,
/// refers to the same values until one of them is changed, which copies first (its own part alone).

#include <atomic>
#include <cstddef>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

namespace hydrapod::data {

/// Reads and changes as std::vector<T> does. Two objects that share values may be used on two
/// threads; one object may be changed by several threads in different places once it has been
/// changed by one (resize() does), as nothing is copied then.
template <class T>
class PerLine {
 public:
  using value_type = T;
  using const_iterator = const T*;
  using iterator = T*;

  PerLine() = default;
  PerLine(std::vector<T> values)  // NOLINT(google-explicit-constructor): is a vector
      : all_(std::make_shared<std::vector<T>>(std::move(values))), size_(all_->size()) {}
  PerLine(std::initializer_list<T> values) : PerLine(std::vector<T>(values)) {}
  PerLine(const PerLine&) = default;
  PerLine& operator=(const PerLine&) = default;
  PerLine(PerLine&& other) noexcept { swap(other); }
  PerLine& operator=(PerLine&& other) noexcept {
    PerLine taken(std::move(other));
    swap(taken);
    return *this;
  }
  ~PerLine() = default;

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] const T* data() const { return all_ ? all_->data() + first_ : nullptr; }
  [[nodiscard]] const T* begin() const { return data(); }
  [[nodiscard]] const T* end() const { return data() + size_; }
  [[nodiscard]] const T& operator[](std::size_t k) const { return data()[k]; }
  [[nodiscard]] const T& front() const { return data()[0]; }
  [[nodiscard]] const T& back() const { return data()[size_ - 1]; }

  /// `count` lines from `first` on, which are shared.
  [[nodiscard]] PerLine part(std::size_t first, std::size_t count) const {
    PerLine some = *this;
    some.first_ += first;
    some.size_ = count;
    return some;
  }

  T* begin() { return own().data(); }
  T* end() { return own().data() + size_; }
  T& operator[](std::size_t k) { return own()[k]; }
  T& front() { return own().front(); }
  T& back() { return own().back(); }
  void resize(std::size_t size) {
    own().resize(size);
    size_ = size;
  }
  void reserve(std::size_t size) { own().reserve(size); }
  void push_back(T value) { emplace_back(std::move(value)); }
  template <class... Arguments>
  T& emplace_back(Arguments&&... arguments) {
    own().emplace_back(std::forward<Arguments>(arguments)...);
    ++size_;
    return all_->back();
  }
  void clear() { *this = PerLine(); }
  void assign(std::size_t size, const T& value) { *this = PerLine(std::vector<T>(size, value)); }

  friend bool operator==(const PerLine& a, const PerLine& b) {
    if (a.size_ != b.size_) return false;
    for (std::size_t k = 0; k < a.size_; ++k)
      if (!(a[k] == b[k])) return false;
    return true;
  }

 private:
  void swap(PerLine& other) noexcept {
    all_.swap(other.all_);
    std::swap(first_, other.first_);
    std::swap(size_, other.size_);
  }
  /// Values that nobody else refers to.
  std::vector<T>& own() {
    if (!all_)
      all_ = std::make_shared<std::vector<T>>();
    else if (all_.use_count() > 1 || size_ != all_->size())
      *this = PerLine(std::vector<T>(data(), data() + size_));
    else  // what the last other owner, perhaps another thread, has read was read before
      std::atomic_thread_fence(std::memory_order_acquire);
    return *all_;
  }

  std::shared_ptr<std::vector<T>> all_{};
  std::size_t first_{}, size_{};
};

}  // namespace hydrapod::data
