/// What the HDF5 reader and writer share: the lock, handles, number types and error texts.
///
/// The HDF5 C library is not thread-safe, so whoever uses it holds a process-wide lock: one thread
/// at a time has files open, others wait.
#pragma once

#include <mutex>
#include <string>
#include <utility>

#include <hdf5.h>

#include "relumbre/store/stored_as.h"

namespace relumbre {

/// The lock on the library. While it is held HDF5 prints no errors; the caller's own error printing
/// is put back afterwards.
class Hdf5Session {
 public:
  Hdf5Session();
  ~Hdf5Session();
  Hdf5Session(const Hdf5Session&) = delete;
  Hdf5Session& operator=(const Hdf5Session&) = delete;

 private:
  std::unique_lock<std::recursive_mutex> lock_;
  H5E_auto2_t printer_ = nullptr;
  void* printer_data_ = nullptr;
};

/// Owns an HDF5 identifier of any kind.
class Hdf5Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Hdf5Handle() = default;
  Hdf5Handle(hid_t id, Closer closer) : id_(id), closer_(closer) {}
  ~Hdf5Handle() {
    if (id_ >= 0) closer_(id_);
  }
  Hdf5Handle(Hdf5Handle&& o) noexcept : id_(std::exchange(o.id_, -1)), closer_(o.closer_) {}
  Hdf5Handle& operator=(Hdf5Handle&& o) noexcept {
    std::swap(id_, o.id_);
    std::swap(closer_, o.closer_);
    return *this;
  }
  [[nodiscard]] hid_t get() const { return id_; }
  [[nodiscard]] bool valid() const { return id_ >= 0; }

 private:
  hid_t id_ = -1;
  Closer closer_ = nullptr;
};

/// HDF5's identifiers of a number in memory and in the file; not to be closed.
hid_t memory_type(Number number);
hid_t file_type(Number number);
std::size_t size_of(Number number);

/// The innermost message on HDF5's error stack, " (HDF5: ...)", or nothing.
std::string hdf5_reason();

}  // namespace relumbre
