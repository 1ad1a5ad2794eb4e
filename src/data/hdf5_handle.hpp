#pragma once
/// HDF5's C interface with owners for its handles. Its own error output is silenced: callers say
/// what went wrong.

#include <hdf5.h>

#include <string>
#include <utility>

namespace hydrapod::data {

/// Owns one HDF5 identifier; `close` is the function that gives it back.
class Hdf5Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Hdf5Handle() = default;
  Hdf5Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    if (this != &other) {
      reset();
      id_ = std::exchange(other.id_, H5I_INVALID_HID);
      close_ = other.close_;
    }
    return *this;
  }
  ~Hdf5Handle() { reset(); }

  [[nodiscard]] hid_t id() const { return id_; }
  [[nodiscard]] bool ok() const { return id_ >= 0; }
  /// Leaves the identifier to the end of the program, unclosed.
  void abandon() { id_ = H5I_INVALID_HID; }
  /// True when closing went well (buffers are written then).
  bool reset() {
    const hid_t id = std::exchange(id_, H5I_INVALID_HID);
    return id < 0 || close_(id) >= 0;
  }

 private:
  hid_t id_{H5I_INVALID_HID};
  Close close_{};
};

/// No messages of HDF5 on stderr while it lives.
class Hdf5Silence {
 public:
  Hdf5Silence() {
    // Nothing is left to the end of the program: there HDF5 crashes over a file that a full disk
    // has kept it from closing.
    [[maybe_unused]] static const herr_t once = H5dont_atexit();
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  Hdf5Silence(const Hdf5Silence&) = delete;
  Hdf5Silence& operator=(const Hdf5Silence&) = delete;
  ~Hdf5Silence() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

 private:
  H5E_auto2_t function_{};
  void* data_{};
};

}  // namespace hydrapod::data
