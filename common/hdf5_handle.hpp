// Inside of common/ only: identifiers of the HDF5 library with an owner, and what its error stack has to say.
#pragma once

#include <hdf5.h>

#include <string>

namespace tailrun {

// Owns any HDF5 identifier; `close` is the library's function for its kind.
class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

// The library prints nothing by itself; failures are told in our own words.
void silence_hdf5();

// What the operating system said when the last call of the library failed, as ": No space left on device"; empty when
// it was not the system that refused. To be called before any other call of the library.
std::string reason_of_system();

// Opening without file locks: a file has its final name only when it is complete, so there is nothing to lock, and some
// network file systems have no locks at all. The caller closes the property list.
hid_t access_without_locks();

}  // namespace tailrun
